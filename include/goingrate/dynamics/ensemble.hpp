// Many realisations of one clock, in SIMD lanes and on all cores.
//
// Realisation k equals that of ClockRun with seed + k, bit for bit, so that a batch system can
// distribute realisations; the number of threads changes nothing. If the return map can be used,
// eight realisations advance side by side in the SIMD lanes. A lane whose state leaves the patch of
// the others, or the domain of the map, is computed like a single run for that period.
#pragma once

#include "goingrate/clock/scenario.hpp"
#include "goingrate/dynamics/clock_run.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace goingrate {

/// The number of realisations of one scenario, and their seeds.
struct EnsembleOptions {
  std::uint64_t seed = 1; ///< of realisation 0
  std::size_t realisations = 1;
  std::size_t threads = 0; ///< 0: one per core
};

/// Called for each period of each realisation, periods of one realisation in order; from several
/// threads at once, but never for one realisation from two.
using PeriodSink = std::function<void(std::size_t realisation, const Period&)>;

/// Realisations of any seeds, some at a time, for a caller with threads of its own. Each thread
/// needs its own copy, whose return maps grow with use. The result of a seed does not depend on the
/// seeds that are run with it (EnsembleTest.AnySeedsInAnyCompany).
class Realisations {
public:
  /// Checks the scenario and chooses the method once. Throws as ClockRun does.
  explicit Realisations(const Scenario& scenario);
  Realisations(const Realisations& other); ///< an independent copy
  Realisations& operator=(const Realisations&) = delete;
  ~Realisations();

  /// The start of every realisation, cycle 0.
  [[nodiscard]] const Period& start() const;
  /// Runs one realisation per seed; `sink` as for run_ensemble, with the index of the seed in
  /// `seeds`. Eight at a time are the cheapest. Returns the status of each.
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
