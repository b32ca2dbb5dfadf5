// Clocks of the prior that change in the middle of a swing, by an integrator that knows nothing of
// beats: how the fit does where the date was found, and where it was told as the nearest beat.
//   study_moment [LOGS] [SEED] [each]
#include "support/changed_in_a_swing.hpp"
#include "support/prior_clocks.hpp"

#include <array>
#include <cstdlib>
#include <fmt/format.h>
#include <string>

namespace {

using namespace goingrate;

struct Tally {
  std::string name;
  int stated = 0, within = 0, beyond5 = 0, logs_beyond5 = 0, contradicted = 0;
  double sum2 = 0.0;
};

double worst(const FitSummary& fit, const test::DrawnClock& drawn, Tally& tally) {
  double largest = 0.0;
  tally.contradicted += fit.status == FitStatus::converged ? 0 : 1;
  for (const auto& [name, value] : drawn.truth) {
    const FittedParameter* p = fit.find(name);
    if (name == "lambda0" || p == nullptr || !(p->sigma > 0.0)) continue;
    const double z = std::abs(p->value - value) / p->sigma;
    ++tally.stated;
    tally.within += p->low68 <= value && value <= p->high68 ? 1 : 0;
    tally.beyond5 += z > 5.0 ? 1 : 0;
    tally.sum2 += std::min(z * z, 25.0);
    largest = std::max(largest, z);
  }
  tally.logs_beyond5 += largest > 5.0 ? 1 : 0;
  return largest;
}

} // namespace

int main(int count, char** words) {
  const int logs = count > 1 ? std::atoi(words[1]) : 100;
  const auto seed = static_cast<std::uint64_t>(count > 2 ? std::atoll(words[2]) : 1);
  std::array<Tally, 3> tallies{{{"found"}, {"told as the beat"}, {"taken for the beat"}}};
  for (int i = 0; i < logs; ++i) {
    const std::uint64_t own = seed + static_cast<std::uint64_t>(i);
    test::DrawnClock drawn = test::ClockPrior(own).draw();
    const Scenario& scenario = drawn.scenario;
    const double T0 = scenario.clock.nominal_period_s;
    const double moment = RandomStream(own, StreamPurpose::missed).uniform() - 0.5;
    const auto cycle = static_cast<double>(*scenario.events.front().at_period);
    const auto times = test::crossings_of_a_changed_clock(
        scenario.clock, scenario.events.front().applied_to(scenario.clock),
        drawn.truth.at("lambda0"), cycle + moment, static_cast<std::size_t>(*scenario.periods),
        scenario.sensor.jitter_rms_s, own);
    std::vector<Beat> beats;
    for (const double time : times) {
      beats.push_back(event_at(Instant::from_seconds(time)));
      beats.back().cycle = static_cast<std::int64_t>(beats.size()) - 1;
    }
    const TimingData data = timing_data(beats);
    FitOptions found = drawn.options, told = drawn.options, taken = drawn.options;
    found.events.front().movable = true;
    told.events.front().at_crossing = false;
    std::array<double, 3> off{};
    for (std::size_t way = 0; way < 3; ++way)
      off[way] =
          worst(fit_clock(data, T0, std::array{found, told, taken}[way]), drawn, tallies[way]);
    if (count > 3)
      fmt::print("{}: {} moment {:.2f}, worst {:.1f} {:.1f} {:.1f}\n", own, drawn.changed, moment,
                 off[0], off[1], off[2]);
  }
  for (const Tally& t : tallies)
    fmt::print(
        "{}: {} parameters stated, 68 % interval holds {:.3f}, rms z {:.2f}, over 5 sigma {} "
        "in {} logs, {} logs not converged\n",
        t.name, t.stated, static_cast<double>(t.within) / std::max(1, t.stated),
        std::sqrt(t.sum2 / std::max(1, t.stated)), t.beyond5, t.logs_beyond5, t.contradicted);
}
