// A log reduced to what a fit needs.
#pragma once

#include "goingrate/fit/impulse_cycle.hpp"
#include "goingrate/log/beats.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace goingrate {

/// A cause outside the clock to which the rate responds in proportion: rate excess = coefficient *
/// value. Names: "temperature" (C from the mean), "pressure" (mbar from the mean), "drift" (days
/// since the middle of the log).
struct RateTerm {
  std::string name;
  std::string unit;              ///< of the coefficient: 1/K, 1/mbar, 1/day
  std::vector<double> advance_s; ///< one per beat: integral of the value over the time so far, so
                                 ///< that the clock is ahead by coefficient * advance
  std::vector<std::uint8_t> is_known{}; ///< 1 or 0 for each beat; empty: all are
  double sigma = 0.0;  ///< of the errors of values; errors `step_s` apart are independent
  double step_s = 0.0; ///< time between readings; 0: one at each beat, a period apart
};

/// All times from one beat on are late by the same amount while the rate is unchanged: the sensor
/// was moved, or the clock was knocked.
struct Displacement {
  std::size_t beat = 0; ///< the first that is late
  double late_s = 0.0;
  double gain = 0.0; ///< of 2 log L, less the price of the search over all beats
};

/// The effect of a turning wheel of the train: a sinusoid in the times or in the amplitudes.
struct Wheel {
  double turn_s = 0.0;        ///< its period
  double late_s = 0.0;        ///< amplitude of the lateness; 0 where it was found in the amplitudes
  double amplitude_rad = 0.0; ///< of the amplitudes; 0 where it was found in the lateness
  double gain = 0.0;          ///< of 2 log L, about
};

/// Readings of a clock at uneven times.
struct UnevenReadings {
  std::vector<double> elapsed_s; ///< since the first beat
  std::vector<double> late_s;    ///< by how much the clock is late, from any origin
};

/// Times and amplitudes of a run of good beats; all vectors have one entry per beat.
struct TimingData {
  double reference_period_s = 0.0;   ///< the mean period: makes the lateness small
  std::vector<double> cycle;         ///< n_i, 0 for the first beat
  std::vector<double> elapsed_s;     ///< t_i - t_0
  std::vector<double> lateness_s;    ///< t_i - t_0 - n_i * reference period, no digits lost
  std::vector<double> amplitude_rad; ///< NaN where unknown; empty if the log has none
  std::vector<RateTerm> terms;       ///< causes to which the fitted rate may respond
  /// Standard deviations of times and of amplitudes, one per beat, divided by the rms of all; empty
  /// if all are equal. A fit with noise of the drive treats those of the times as equal.
  std::vector<double> time_noise{}, amplitude_noise{};
  UnevenReadings as_read{}; ///< where the beats stand in for these, at even times; else empty
  std::string no_swings{}; ///< why these are not a pendulum's swings; empty if they are
  /// Pushes of an escapement that rests; their saw-tooth was subtracted from times and amplitudes.
  std::optional<ImpulseCycle> impulses{};
  std::vector<Displacement> displaced{}; ///< subtracted from the times, the greatest gain first
  /// Subtracted: of the times, then of the amplitudes, each the strongest first.
  std::vector<Wheel> wheels{};
  /// What all of them do to each time and each amplitude; empty if there are none.
  std::vector<double> wheel_late_s{}, wheel_amplitude_rad{};
  double time_base_sigma = 0.0; ///< relative, of the clock that took the times, and thus of T0

  /// Number of beats.
  [[nodiscard]] std::size_t size() const { return cycle.size(); }
  /// Whether the log has amplitudes.
  [[nodiscard]] bool has_amplitude() const { return !amplitude_rad.empty(); }
};

/// No pendulum swings more slowly: that of 20 s is 99 m long.
inline constexpr double longest_swing_s = 20.0;

/// Finds displacements one after the other, subtracts each from the times and records it in
/// `displaced`: up to eight that are clearly larger than all others (2 log L of each above 100, of
/// any other below 25). If there are more, they are a noise of the clock, and none is subtracted.
/// No pendulum causes displacements, so they would only distort a fit.
/// (FitDisplacedTest.AMovedSensorLeavesTheClock,
/// FitDisplacedTest.KicksThatFollowEachOtherAreANoise)
void level_displacements(TimingData& data);

/// Subtracts the strictly periodic parts (spectra/lines.hpp) with periods of up to ten minutes from
/// times and amplitudes, at most 20 from each, and notes them. A turning wheel of the train causes
/// them, not the pendulum; a fit would take them for noise of the drive. A log of more than 131,072
/// beats is treated block by block.
/// (WheelsTest.AWheelLeavesTheClock, WheelsTest.ALogWithoutOneStaysAsItIs)
void level_wheels(TimingData& data);

/// Throws ArgumentError for fewer than three beats. The data have the term "drift".
TimingData timing_data(std::span<const Beat> beats);

/// The term of a series with one value per beat; its mean over time is subtracted. Unknown values
/// (NaN) are put on the line between their known neighbours, at the ends equal to the nearest; all
/// are 0 if none is known.
RateTerm rate_term(std::string name, std::string unit, const TimingData& data,
                   std::span<const double> values);

/// Standard deviations divided by the rms of the known ones, as in TimingData. An unknown one
/// counts as the rms. Empty if none is known, or if all lie within a tenth of the rms, since
/// weights would then gain nothing.
std::vector<double> relative_noise(std::span<const double> sigmas);

/// The beats with the given indices (increasing). What belongs to the log as a whole (no_swings,
/// impulses, displaced, wheels and what they do, time_base_sigma) is not copied.
TimingData subset(const TimingData& data, std::span<const std::size_t> chosen);

} // namespace goingrate
