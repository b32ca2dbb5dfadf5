// Clocks drawn from a prior, with one jump of mu, phi0 or epsilon at a known cycle: whether the
// search finds what a fit that is started from the truth finds, whether what is stated is right,
// and whether what could be stated is. Arguments: logs (600), first seed (1), "each" for a line a
// log.
#include "goingrate/fit/clock_fit.hpp"
#include "support/simulated.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace goingrate;

struct DrawnClock {
  Scenario scenario;
  std::string changed; // mu, phi0 or epsilon
  FitOptions options;
  std::map<std::string, double> truth;
};

class ClockPrior {
public:
  explicit ClockPrior(std::uint64_t seed) : seed_(seed), chance_(seed, StreamPurpose::amplitude_noise) {}

  DrawnClock draw() {
    DrawnClock drawn;
    constexpr std::array periods_s{1.0, 1.5, 2.0, 3.0};
    constexpr std::array names{"mu", "phi0", "epsilon"};
    const double T0 = periods_s[seed_ / 2 % periods_s.size()];
    drawn.changed = names[seed_ / 8 % names.size()];
    const double epsilon = geometric(1e-4, 1.6e-3), phi0 = between(0.01, 0.05);
    const double amplitude = phi0 * between(1.3, 3.0);
    const double mu = 0.25 * two_pi_ * epsilon * amplitude * amplitude / phi0; // at rest
    const auto periods = static_cast<std::int64_t>(between(600.0, 3000.0));
    const auto at = static_cast<std::int64_t>(between(0.15, 0.4) * static_cast<double>(periods));
    Scenario& scenario = drawn.scenario;
    scenario.clock = {T0, epsilon, mu, phi0};
    scenario.periods = periods;
    scenario.method.method = Method::direct;
    scenario.sensor.jitter_rms_s = geometric(1e-6, 1e-4);
    ClockEvent event;
    event.at_period = at;
    const double factor = between(1.3, 2.2);
    double after = 0.0;
    if (drawn.changed == "mu") event.mu = after = factor * mu;
    // The amplitude falls with less angle or more friction; it must stay above the angle.
    if (drawn.changed == "phi0") event.phi0 = after = phi0 / factor;
    if (drawn.changed == "epsilon") event.epsilon = after = epsilon / factor;
    scenario.events = {event};
    drawn.options.events = {{at, {drawn.changed}}};
    if (seed_ % 2 == 0) drawn.options.fixed["T0"] = T0;
    drawn.truth = {{"T0", T0},     {"epsilon", epsilon},   {"mu", mu},
                   {"phi0", phi0}, {"lambda0", amplitude}, {drawn.changed + "@1", after}};
    return drawn;
  }

private:
  static constexpr double two_pi_ = 6.283185307179586;
  double between(double low, double high) { return low + (high - low) * chance_.uniform(); }
  double geometric(double low, double high) {
    return low * std::pow(high / low, chance_.uniform());
  }
  std::uint64_t seed_;
  RandomStream chance_;
};

double two_log_likelihood(const FitSummary& fit) {
  const auto k = static_cast<double>(fit.correlated.size());
  return 2.0 * k - fit.quality.aic;
}

double processor_s() { // of this thread
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Outcome {
  bool failed = false;
  double behind = 0.0; // in 2 log L, of the fit that was told the truth
  double worst = 0.0;  // |z| of what is stated
  std::string worst_name;
  bool has_twin = false;
  int could = 0, stated = 0; // parameters that the informed fit states, and of these the search's
  double seconds = 0.0;
  std::string model;
  double p = 0.0;
};

Outcome outcome_of(std::uint64_t seed) {
  DrawnClock drawn = ClockPrior(seed).draw();
  const auto beats = test::simulated_beats(drawn.scenario, seed);
  const TimingData data = timing_data(beats);
  const double period_s = drawn.truth.at("T0");
  Outcome outcome;
  const double begin = processor_s();
  const FitSummary found = fit_clock(data, period_s, drawn.options);
  outcome.seconds = processor_s() - begin;
  FitOptions informed = drawn.options;
  for (const auto& [name, value] : drawn.truth)
    if (!informed.fixed.contains(name)) informed.start[name] = value;
  const FitSummary told = fit_clock(data, period_s, informed);
  outcome.failed = !found.has_result() || !told.has_result();
  if (outcome.failed) return outcome;
  outcome.behind = two_log_likelihood(told) - two_log_likelihood(found);
  outcome.model = std::string(name_of(found.dynamics)) + " " + found.model.name() + " / " +
                  std::string(name_of(told.dynamics)) + " " + told.model.name();
  outcome.p = found.quality.p_value;
  outcome.has_twin = std::any_of(found.notes.begin(), found.notes.end(),
                                 [](const FitNote& note) { return note.kind == NoteKind::twin; });
  for (const auto& [name, value] : drawn.truth) {
    const FittedParameter *own = found.find(name), *best = told.find(name);
    // The amplitude at rest is known to first order only: good for a start.
    if (name == "lambda0" || own == nullptr || best == nullptr ||
        drawn.options.fixed.contains(name))
      continue;
    const bool stated = std::isfinite(own->value) && own->sigma > 0.0;
    if (std::isfinite(best->value) && best->sigma < 0.05 * std::abs(value)) {
      ++outcome.could;
      outcome.stated += stated ? 1 : 0;
    }
    if (!stated) continue;
    const double z = std::abs(own->value - value) / own->sigma;
    if (z <= outcome.worst) continue;
    outcome.worst = z;
    outcome.worst_name = name;
  }
  return outcome;
}

} // namespace

int main(int count, char** words) {
  const auto logs = static_cast<std::size_t>(count > 1 ? std::atoi(words[1]) : 600);
  const auto first_seed = static_cast<std::uint64_t>(count > 2 ? std::atoll(words[2]) : 1);
  const bool each = count > 3 && std::string(words[3]) == "each";
  std::vector<Outcome> outcomes(logs);
  const auto half = [&](std::size_t begin) {
    for (std::size_t i = begin; i < logs; i += 2)
      outcomes[i] = outcome_of(first_seed + i);
  };
  std::thread other(half, 1);
  half(0);
  other.join();
  std::size_t failed = 0, behind = 0, wrong = 0, unlisted = 0;
  int could = 0, stated = 0;
  double seconds = 0.0;
  for (std::size_t i = 0; i < logs; ++i) {
    const Outcome& o = outcomes[i];
    if (each)
      fmt::print(
          "{}: behind {:.2f}, worst {} {:.1f} sigma, stated {}/{}, p {:.2g}, {:.1f} s{}  {}\n",
          first_seed + i, o.behind, o.worst_name, o.worst, o.stated, o.could, o.p, o.seconds,
          o.failed     ? ", no fit"
          : o.has_twin ? ", twin"
                       : "",
          o.model);
    failed += o.failed ? 1 : 0;
    behind += o.behind > 1.0 ? 1 : 0;
    wrong += o.worst > 5.0 ? 1 : 0;
    unlisted += o.worst > 5.0 && !o.has_twin ? 1 : 0;
    could += o.could;
    stated += o.stated;
    seconds += o.seconds;
  }
  fmt::print("{} logs, {:.3g} s of processor a fit, {} without a result\n", logs,
             seconds / static_cast<double>(logs), failed);
  fmt::print("2 log L more than 1 behind the fit from the truth: {}\n", behind);
  fmt::print("something stated more than 5 sigma off: {}, of these without a twin told: {}\n",
             wrong, unlisted);
  fmt::print("parameters that the fit from the truth knows to 5 %: {}, stated: {:.1f} %\n", could,
             100.0 * stated / std::max(1, could));
}
