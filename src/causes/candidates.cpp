#include "candidates.hpp"

#include "lag.hpp"
#include "step_search.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/pulse.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>

namespace goingrate::timing_model {

Cause cause_of(ChangeKind kind) {
  return kind == ChangeKind::regulation ? Cause::length_step
         : kind == ChangeKind::friction ? Cause::friction_step
                                        : Cause::drive_step;
}

std::vector<Cause> same_course_as(ChangeKind kind) {
  if (kind != ChangeKind::regulation) return {};
  return {Cause::magnet, Cause::log_clock, Cause::unlogged_weather};
}

Candidate step_candidate(ChangeKind kind, double place, const Account& account,
                         const RateBlocks& blocks) {
  constexpr double doubt_blocks = 3.0; // a change of friction shows late, as a gradual bend
  FittedStep found = StepSearch(account, blocks, place, doubt_blocks).best(kind);
  return {cause_of(kind),
          std::move(found.courses),
          same_course_as(kind),
          blocks.length_s * found.place,
          found.time_s,
          true,
          found.gain};
}

namespace {

// Keeps the best of all causes that are considered.
class CandidateSearch {
public:
  CandidateSearch(const DiagnosisInput& input, const RateBlocks& blocks, const Account& account,
                  std::span<const Candidate> taken)
      : input_(input), blocks_(blocks), account_(account), taken_(taken), make_(blocks) {}

  [[nodiscard]] Candidate run() const {
    Candidate best;
    consider_weather(best);
    const StepScan scan(account_, blocks_);
    consider_steps(scan, best);
    consider_visits(scan, best);
    consider_drifts(best);
    consider_settling(best);
    return best;
  }

private:
  void consider(Candidate candidate, Candidate& best) const {
    candidate.gain = account_.gain_of(candidate.courses);
    if (candidate.gain > best.gain) best = std::move(candidate);
  }

  void consider_weather(Candidate& best) const {
    for (std::size_t k = 0; k < input_.data->terms.size(); ++k) {
      const std::string& name = input_.data->terms[k].name;
      const bool temperature = name == "temperature";
      if (!temperature && name != "pressure") continue;
      const auto& values = blocks_.values[k];
      if (std::all_of(values.begin(), values.end(), [](double v) { return std::abs(v) < 1e-9; }))
        continue;
      consider({temperature ? Cause::temperature : Cause::pressure, {{values}, {}}}, best);
      if (temperature) consider_lag(values, best);
    }
    constexpr double day_s = seconds_per_day;
    if (blocks_.length_s * static_cast<double>(blocks_.rate.size()) < 0.8 * day_s) return;
    consider({Cause::unlogged_weather,
              {{make_.wave(day_s, 0.0), make_.wave(day_s, 0.25 * two_pi)}, {}},
              {Cause::log_clock}},
             best);
  }

  // Lagged temperature, and the memory of the time before the log. With an immediate part, as of a
  // rod before its compensation, the first course is the response in the end.
  [[nodiscard]] Candidate lagging(const std::vector<double>& values, double lag_s,
                                  bool also_at_once) const {
    std::vector<std::vector<double>> courses{lagged(values, blocks_.length_s, lag_s)};
    if (also_at_once) {
      std::vector<double> ahead(values);
      for (std::size_t i = 0; i < ahead.size(); ++i)
        ahead[i] -= courses.front()[i];
      courses.push_back(std::move(ahead));
    }
    courses.push_back(memory(values.size(), blocks_.length_s, lag_s));
    Candidate candidate{.cause = Cause::temperature,
                        .courses = {.rate = std::move(courses), .amplitude = {}, .times = 1}};
    candidate.time_s = lag_s;
    // In less than two turns of the weather's day, a lag and its memory follow any drift.
    if (blocks_.length_s * static_cast<double>(values.size()) < 2.0 * seconds_per_day)
      candidate.alternatives = {Cause::length_drift, Cause::log_clock};
    return candidate;
  }

  void consider_lag(const std::vector<double>& values, Candidate& best) const {
    const FixedNoiseAccount noise = account_.in_noise_beside({{values}, {}});
    for (const bool also_at_once : {false, true}) {
      const auto loss = [&](double lag_s) {
        return -noise.gain_of(lagging(values, lag_s, also_at_once).courses);
      };
      const std::vector<double> lags = lags_to_try(values.size(), blocks_.length_s);
      const auto coarse = std::min_element(lags.begin(), lags.end(),
                                           [&](double a, double b) { return loss(a) < loss(b); });
      if (coarse == lags.end()) return;
      consider(lagging(values, refined_lag(*coarse, loss), also_at_once), best);
    }
  }

  // The times, in blocks, at which a step would explain most, and those of dated changes.
  [[nodiscard]] std::vector<double> places(const StepScan& scan) const {
    constexpr std::size_t most_places = 3, blocks_apart = 4;
    std::vector<double> places;
    for (const std::size_t block : scan.best_steps(most_places, blocks_apart))
      places.push_back(static_cast<double>(block));
    for (const Change& change : input_.changes) {
      const double place = change.at_s / blocks_.length_s;
      if (place > 2.0 && place + 3.0 < static_cast<double>(blocks_.rate.size()))
        places.push_back(place);
    }
    return places;
  }

  void consider_steps(const StepScan& scan, Candidate& best) const {
    for (const double place : places(scan))
      for (const ChangeKind kind :
           {ChangeKind::regulation, ChangeKind::drive, ChangeKind::friction}) {
        pulse();
        Candidate step = step_candidate(kind, place, account_, blocks_);
        if (step.gain > best.gain && !is_in_a_wake(step)) best = std::move(step);
      }
  }

  // While a clock settles after a step, its rate is not exactly a sum of a few exponentials, and
  // the residual of a large step resembles small steps.
  [[nodiscard]] bool is_in_a_wake(const Candidate& step) const {
    constexpr double settling_times = 5.0; // time constants
    constexpr double least_share = 0.1;
    return std::any_of(taken_.begin(), taken_.end(), [&](const Candidate& before) {
      const double since_s = step.at_s - before.at_s;
      return is_step(before.cause) && before.cause != Cause::length_step && since_s > 0.0 &&
             since_s < settling_times * before.time_s && step.gain < least_share * before.gain;
    });
  }

  // A temporary disturbance, which is rarer than a single change and so needs a greater gain.
  void consider_visits(const StepScan& scan, Candidate& best) const {
    const auto [from, to] = scan.best_visit();
    const FittedVisit found = fitted_visit(account_, blocks_, from, to);
    const double gain = account_.gain_of(found.courses) - convincing_gain;
    if (gain <= best.gain) return;
    best = {Cause::magnet,
            found.courses,
            {Cause::length_step, Cause::log_clock, Cause::unlogged_weather},
            blocks_.length_s * found.from,
            blocks_.length_s * found.to,
            true,
            gain};
  }

  // A ramp of the rate, with and without the amplitude following it.
  void consider_drift(const Courses& ramp, double from_s, Candidate& best) const {
    const bool seen = account_.sees_amplitude();
    Candidate drift;
    drift.cause = seen ? Cause::length_drift : Cause::growing_friction;
    drift.courses = ramp;
    drift.alternatives = {Cause::log_clock, Cause::unlogged_weather};
    if (!seen) drift.alternatives.insert(drift.alternatives.begin(), Cause::length_drift);
    drift.at_s = from_s;
    consider(drift, best);
    if (!seen) return;
    drift.cause = Cause::growing_friction;
    drift.courses.amplitude = ramp.rate;
    drift.alternatives.clear();
    consider(std::move(drift), best);
  }

  // Ramps that last throughout the log, or begin within it.
  void consider_drifts(Candidate& best) const {
    const auto t = make_.power(1), t2 = make_.power(2);
    consider_drift({.rate = {t}, .amplitude = {}}, 0.0, best);
    consider_drift({.rate = {t, t2}, .amplitude = {}}, 0.0, best);
    const auto beginning = [&](double place) {
      return Courses{.rate = {make_.ramp(place)}, .amplitude = {}, .dates = 1};
    };
    const auto blocks = static_cast<double>(blocks_.rate.size());
    const double stride = blocks / 16.0, margin = 2.0 * stride; // a date needs both sides
    if (stride < 1.0) return;
    const FixedNoiseAccount noise = account_.in_noise_beside(beginning(0.5 * blocks));
    double onset = margin, most = -std::numeric_limits<double>::infinity();
    for (double place = margin; place <= blocks - margin; place += stride) {
      const double gain = noise.gain_of(beginning(place));
      if (gain <= most) continue;
      most = gain;
      onset = place;
    }
    const auto loss = [&](double place) { return -noise.gain_of(beginning(place)); };
    constexpr int bits = 10;
    onset = boost::math::tools::brent_find_minima(loss, onset - stride, onset + stride, bits).first;
    consider_drift(beginning(onset), onset * blocks_.length_s, best);
  }

  // The settling of a clock that was started or wound before the log begins.
  void consider_settling(Candidate& best) const {
    const double length_s = blocks_.length_s * static_cast<double>(blocks_.rate.size());
    for (double time_s = blocks_.length_s; time_s < 0.3 * length_s; time_s *= 2.0) {
      const auto dying = make_.dying(0.0, time_s);
      consider({.courses = {.rate = {dying}, .amplitude = {dying}, .times = 1},
                .time_s = time_s,
                .is_fault = false},
               best);
    }
  }

  const DiagnosisInput& input_;
  const RateBlocks& blocks_;
  const Account& account_;
  std::span<const Candidate> taken_;
  CourseMaker make_;
};

} // namespace

Candidate best_candidate(const DiagnosisInput& input, const RateBlocks& blocks,
                         const Account& account, std::span<const Candidate> taken) {
  return CandidateSearch(input, blocks, account, taken).run();
}

} // namespace goingrate::timing_model
