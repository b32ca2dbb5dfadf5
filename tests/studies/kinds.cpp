// Which change is found, and when, in logs of random clocks that change once and of which nothing
// is told: through analyse(), as `goingrate report` does it. Prints a table and what is stated of
// the clock; arguments: logs a row, first seed.
#include "base/workers.hpp"
#include "goingrate/analysis/analyse.hpp"
#include "goingrate/log/writing.hpp"
#include "support/prior_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

namespace goingrate {
namespace {

struct Row {
  const char* name;
  double drive_rms;
  std::optional<double> amplitude_rms;
};

constexpr Row rows[] = {{"steady drive, times", 0.0, {}},
                        {"steady drive, amplitudes", 0.0, 6e-5},
                        {"drive 3 %, times", 0.03, {}},
                        {"drive 3 %, amplitudes", 0.03, 6e-5}};

// A clock of the prior that changes by a quarter of what it says, or in T0 by 30 parts in a
// million.
test::DrawnClock drawn(const Row& row, std::uint64_t seed) {
  test::DrawnClock clock = test::ClockPrior(seed).draw();
  Scenario& scenario = clock.scenario;
  scenario.method = {};
  scenario.drive.fast_rms = row.drive_rms;
  scenario.sensor.amplitude_rms = row.amplitude_rms;
  constexpr double share = 0.25;
  clock.truth.erase("lambda0"); // known in first order only
  ClockEvent& event = scenario.events.front();
  const auto reduce = [&](std::optional<double>& value, const char* name) {
    const double before = clock.truth.at(name);
    if (value) *value = clock.truth[std::string(name) + "@1"] = before + share * (*value - before);
  };
  reduce(event.mu, "mu"), reduce(event.phi0, "phi0"), reduce(event.epsilon, "epsilon");
  if (seed % 4 == 3) { // T0 in place of these
    clock.truth.erase(clock.changed + "@1");
    clock.changed = "T0";
    event = {};
    event.at_period = clock.options.events.front().cycle;
    event.nominal_period_s = clock.truth["T0@1"] = clock.truth["T0"] * (1.0 + 3e-5);
  }
  return clock;
}

// What became of one log.
struct Outcome {
  bool found = false, dated = false, right = false, several = false, contradicts = false;
  int stated = 0, within_sigma = 0;
  double worst = 0.0; // of what is stated, in its sigma
};

Outcome outcome_of(const test::DrawnClock& clock, std::uint64_t seed) {
  constexpr int decimals = 9;
  LoadRequest load;
  load.path = "kinds.csv";
  AnalysisRequest request;
  request.traces_profiles = false;
  const std::string text = native_log_text(test::simulated_log(clock.scenario, seed), decimals);
  const Analysis data = analyse(load_text(text, load), request);
  Outcome outcome;
  outcome.contradicts = data.fit.status == FitStatus::contradicts_log;
  outcome.found = !data.fit.events.empty();
  outcome.several = data.fit.events.size() > 1;
  if (data.fit.events.size() != 1) return outcome;
  const FitEvent& event = data.fit.events.front();
  constexpr std::int64_t beats_off = 5;
  outcome.dated =
      std::abs(event.cycle - clock.scenario.events.front().at_period.value()) <= beats_off;
  outcome.right = outcome.dated && event.names == std::vector<std::string>{clock.changed};
  for (const auto& [name, value] : clock.truth) {
    const FittedParameter* stated = data.fit.find(name);
    if (stated == nullptr || !std::isfinite(stated->sigma) || !(stated->sigma > 0.0)) continue;
    const double off = std::abs(stated->value - value) / stated->sigma;
    ++outcome.stated;
    outcome.within_sigma += off < 1.0;
    outcome.worst = std::max(outcome.worst, off);
  }
  return outcome;
}

void print(const Row& row, const std::vector<Outcome>& outcomes) {
  const auto count = [&](auto member) {
    return static_cast<int>(std::count_if(outcomes.begin(), outcomes.end(),
                                          [&](const Outcome& one) { return one.*member; }));
  };
  int stated = 0, within = 0;
  double worst = 0.0;
  for (const Outcome& one : outcomes) {
    stated += one.stated;
    within += one.within_sigma;
    worst = std::max(worst, one.worst);
  }
  std::printf("%-26s %5zu %6d %6d %6d %8d %12d %7d %7.2f %7.1f\n", row.name, outcomes.size(),
              count(&Outcome::found), count(&Outcome::dated), count(&Outcome::right),
              count(&Outcome::several), count(&Outcome::contradicts), stated,
              stated > 0 ? static_cast<double>(within) / stated : 0.0, worst);
}

} // namespace
} // namespace goingrate

int main(int count, char** words) {
  using namespace goingrate;
  const std::size_t logs = count > 1 ? std::strtoull(words[1], nullptr, 10) : 40;
  const std::uint64_t first = count > 2 ? std::strtoull(words[2], nullptr, 10) : 1;
  std::printf("%-26s %5s %6s %6s %6s %8s %12s %7s %7s %7s\n", "log", "logs", "found", "dated",
              "right", "several", "contradicts", "stated", "in 1 σ", "worst σ");
  for (const Row& row : rows) {
    std::vector<Outcome> outcomes(logs);
    share(logs, [&](std::size_t i) {
      const std::uint64_t seed = first + i;
      outcomes[i] = outcome_of(drawn(row, seed), seed);
      if (outcomes[i].worst > 5.0)
        std::fprintf(stderr, "%s, seed %llu: something stated %.1f σ off\n", row.name,
                     static_cast<unsigned long long>(seed), outcomes[i].worst);
    });
    print(row, outcomes);
    std::fflush(stdout);
  }
}
