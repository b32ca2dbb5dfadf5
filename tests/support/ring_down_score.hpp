// Scores the fits of many ring-downs.
#pragma once

#include "goingrate/analysis/analyse.hpp"
#include "support/ring_downs.hpp"

#include <map>

namespace goingrate::test {

/// What one log came to.
struct RingDownOutcome {
  bool read = false, fitted = false, described = false; // numbered; has a result; has a decay
  std::string status, law;
  bool law_is_open = true;
  double behind = 0.0; // of the true law, in BIC
  struct Stated {
    bool is_stated = false, in68 = false, in95 = false;
    double relative_sigma = 0.0, z = 0.0;
    void of(double truth, double value, double sigma, double low68, double high68, double low95,
            double high95) {
      is_stated = std::isfinite(value) && sigma > 0.0;
      if (!is_stated) return;
      in68 = truth >= low68 && truth <= high68;
      in95 = truth >= low95 && truth <= high95;
      relative_sigma = sigma / value;
      z = (value - truth) / sigma;
    }
  };
  std::array<Stated, 5> q{}; // at the last amplitude, a quarter of the way up, ..., the first
  Stated T0, time_s;
  double amplitude_error = 0.0; // of the first amplitude, relative
};

inline RingDownOutcome outcome_of(const RingDown& drawn) {
  RingDownOutcome outcome;
  try {
    LoadRequest request = drawn.request;
    request.path = "ring-down.csv";
    AnalysisRequest road;
    road.traces_profiles = false;
    const Analysis data = analyse(load_text(drawn.text, request), road);
    outcome.read = true;
    outcome.fitted = data.fit.has_result();
    outcome.status = std::string(name_of(data.fit.status));
    if (outcome.fitted) {
      const FittedParameter& T0 = data.fit["T0"];
      outcome.T0.of(drawn.T0, T0.value, T0.sigma, T0.low68, T0.high68, T0.low95, T0.high95);
    }
    if (!data.fit.decay) return outcome;
    const Decay& decay = *data.fit.decay;
    outcome.described = true;
    outcome.law_is_open = decay.law_is_open();
    if (!decay.laws.empty()) outcome.law = decay.laws.front().friction;
    for (const FrictionLaw& law : decay.laws)
      if (law.friction == drawn.law) outcome.behind = law.behind;
    const auto score = [](RingDownOutcome::Stated& stated, double truth, const DecayEstimate& e) {
      stated.of(truth, e.value, e.sigma, e.low68, e.high68, e.low95, e.high95);
    };
    const auto& course = decay.q_at_amplitude;
    for (std::size_t k = 0; k < outcome.q.size() && !course.empty(); ++k) {
      const QAtAmplitude& at = course[k * (course.size() - 1) / (outcome.q.size() - 1)];
      score(outcome.q[k], quality_factor(drawn.friction, at.amplitude_rad), at.q);
    }
    if (!course.empty())
      outcome.amplitude_error = course.back().amplitude_rad / drawn.first_rad - 1.0;
    score(outcome.time_s,
          drawn.T0 * quality_factor(drawn.friction, decay.amplitude_rad) *
              decay_periods_per_q(decay.amplitude_rad),
          decay.time_s);
  } catch (const std::exception& error) {
    outcome.status = error.what();
  }
  return outcome;
}

} // namespace goingrate::test
