// Clocks drawn from a prior, with one jump of mu, phi0 or epsilon at a known cycle, or with a rough
// drive and amplitudes: whether the search finds what a fit that is started from the truth finds,
// whether what is stated is right, and whether what could be stated is. Arguments: logs (600),
// first seed (1), jump or rough, "each" for a line a log.
#include "goingrate/fit/clock_fit.hpp"
#include "support/prior_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace goingrate;

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

Outcome outcome_of(std::uint64_t seed, bool rough) {
  test::ClockPrior prior(seed);
  const test::DrawnClock drawn = rough ? prior.draw_rough() : prior.draw();
  const auto beats = test::simulated_beats(drawn.scenario, seed);
  const TimingData data = timing_data(beats);
  const double period_s = drawn.truth.at("T0");
  Outcome outcome;
  const double begin = processor_s();
  const FitSummary found = fit_clock(data, period_s, drawn.options);
  outcome.seconds = processor_s() - begin;
  const FitSummary told = fit_clock(data, period_s, test::told_the_truth(drawn));
  outcome.failed = !found.has_result() || !told.has_result();
  if (outcome.failed) return outcome;
  outcome.behind = test::two_log_likelihood(told) - test::two_log_likelihood(found);
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
  const bool rough = count > 3 && std::string(words[3]) == "rough";
  const bool each = count > 4 && std::string(words[4]) == "each";
  std::vector<Outcome> outcomes(logs);
  const auto half = [&](std::size_t begin) {
    for (std::size_t i = begin; i < logs; i += 2)
      outcomes[i] = outcome_of(first_seed + i, rough);
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
