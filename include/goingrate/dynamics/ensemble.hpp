// Many realisations of one clock, in SIMD lanes and on all cores.
//
// Realisation k is what ClockRun gives alone with seed + k, bit for bit, so that a batch system can
// share realisations out; the number of threads changes nothing. Where the return map serves, eight
// realisations advance side by side in the lanes of the processor; a lane whose state leaves the
// patch of the others, or its domain, goes the way of a single run for that period.
#pragma once

#include "goingrate/clock/scenario.hpp"
#include "goingrate/dynamics/clock_run.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace goingrate {

/// How many runs of one scenario.
struct EnsembleOptions {
  std::uint64_t seed = 1; ///< of realisation 0
  std::size_t realisations = 1;
  std::size_t threads = 0; ///< 0: one per core
};

/// Called for each period of each realisation, periods of one realisation in order; from several
/// threads at once, but never for one realisation from two.
using PeriodSink = std::function<void(std::size_t realisation, const Period&)>;

/// Realisations of any seeds, some at a time, for a caller with threads of its own: each thread has
/// its copy, whose return maps grow as they are used. What a seed gives does not depend on what
/// runs beside it (EnsembleTest.AnySeedsInAnyCompany).
class Realisations {
public:
  /// Checks the scenario and chooses the method once. Throws as ClockRun does.
  explicit Realisations(const Scenario& scenario);
  Realisations(const Realisations& other); ///< an independent copy
  Realisations& operator=(const Realisations&) = delete;
  ~Realisations();

  /// The start of every realisation, cycle 0.
  [[nodiscard]] const Period& start() const;
  /// Runs one realisation a seed, `sink` as of run_ensemble with the seed's place in `seeds`;
  /// eight at a time are the cheapest. Returns the status of each.
  std::vector<SwingStatus> run(std::span<const std::uint64_t> seeds, const PeriodSink& sink);

private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

/// Runs all realisations. Returns the status of each; a realisation whose clock stops ends early.
///
/// Throws as ClockRun does; EnsembleTest.RealisationsAreSingleRunsWhateverTheThreads.
std::vector<SwingStatus> run_ensemble(const Scenario& scenario, const EnsembleOptions& options,
                                      const PeriodSink& sink);

/// The last period of each realisation; cheaper than a sink for each period: five times the
/// throughput of single runs for a noisy clock at point C (tests/studies/solvers.txt).
std::vector<Period> final_periods(const Scenario& scenario, const EnsembleOptions& options);

} // namespace goingrate
