// Logs of many realisations of a scenario, made and numbered in memory.
#pragma once

#include "goingrate/analysis/load.hpp"
#include "goingrate/clock/scenario.hpp"
#include "goingrate/dynamics/ensemble.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace goingrate {

/// One realisation as a log.
struct SimulatedLog {
  std::string text;                          ///< native, as `simulate` writes it
  SwingStatus status = SwingStatus::crossed; ///< crossed, or why the clock stopped
  std::int64_t periods = 0;                  ///< completed
};

/// Makes logs. Not thread-safe: each thread needs its own copy.
class SimulatedLogs {
public:
  /// Throws as ClockRun does.
  explicit SimulatedLogs(const Scenario& scenario) : scenario_(scenario), clocks_(scenario) {}

  /// One log per seed, byte for byte that of `simulate` with this seed.
  std::vector<SimulatedLog> make(std::span<const std::uint64_t> seeds);

private:
  Scenario scenario_;
  Realisations clocks_;
};

/// The parameters of the scenario's clock, its noise and its sensor by the names that a fit has for
/// them: T0 (s), epsilon, mu and phi0 or impulse and impulse_angle, quadratic_drag, dry_friction,
/// gravity_share, lambda0 (phi' at the first upward crossing, by direct integration), offset (rad);
/// what changes at the k-th event as mu\@k and the like; jitter_rms (s) and amplitude_rms (rad)
/// where times are not rounded, drive_rms, slow_rms, slow_time (s) where the drive is random alone.
/// Zeros (except gravity_share) are left out, and so are properties that are not a single number.
/// For an escapement that rests (intermittent.hpp), the drive is its mean over time, and lambda0 is
/// that of the mean course of the amplitude.
/// Throws as ClockRun does.
std::map<std::string, double> true_parameters(const Scenario& scenario);

} // namespace goingrate
