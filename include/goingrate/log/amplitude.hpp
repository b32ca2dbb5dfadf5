// Amplitudes from the passage of a flag, and the effect of a sensor off the vertical on times.
//
// Notation: a sensor at the angle alpha sees a pendulum of amplitude lambda late by
// asin(alpha/lambda) T0 / 2 pi while it rises and early by as much while it falls.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <optional>
#include <span>

namespace goingrate {

/// Turning angle (rad) of a free pendulum of small-swing period `period_s` that passes a centred
/// flag, `flag_width_rad` wide as seen from the pivot, in `width_s`. For small swings it is
/// (w/2) / sin(tau/2), tau = 2 pi width / T0; here free_passage_time (restoring.hpp) = tau is
/// solved for lambda, to 1e-12 (AmplitudeTest.WidthsGiveTheAmplitudeOfTheFullEquation). Friction
/// and drive change it by 1e-4 of lambda at most. NaN if no swing has such a width.
double amplitude_from_width(double width_s, double flag_width_rad, double period_s,
                            double gravity_share = 1.0);

/// Period of small swings, s: the median over neighbouring good beats of their period less its
/// circular error, with amplitudes from the widths; `period_s`, an estimate, if no beat has both.
/// The mean period of a ring-down from 1 rad is 5 % longer, and would make the amplitudes as much
/// too large.
double small_swing_period(const ClockLog& log, double flag_width_rad, double period_s,
                          double gravity_share = 1.0);

/// Accounts for friction between the edges of a flag, in times that are the middle of its dark time
/// and in amplitudes from its width: a pendulum that is slowed down takes longer over the second
/// half. With phi = lambda exp(-epsilon psi) sin psi and epsilon = -(d log lambda/d cycle)/2 pi of
/// neighbouring amplitudes, an edge at w/2 is passed at -tau/2 + m and at tau/2 + m with
///   tan m = tanh(epsilon tau/2) tan(tau/2),
///   lambda = (w/2) exp(epsilon (tau/2 + m)) / sin(tau/2 + m).
/// Dry friction and quadratic drag, whose shares are found from how the fall depends on the
/// amplitude, act on the flag 21 % less and 18 % more than linear friction of the same fall where the
/// swing is wide; epsilon is changed accordingly. (AmplitudeTest.SoIsThatOfOtherLaws)
void correct_widths_for_friction(ClockLog& log, double flag_width_rad, double period_s);

/// Standard deviation of that amplitude for a width known to `sigma_s`:
/// lambda / tan(tau/2) * pi sigma / T0.
double amplitude_sigma_from_width(double width_s, double sigma_s, double amplitude_rad,
                                  double period_s);

/// Fills the amplitudes of a log from its widths; events whose width fits no swing become issues.
void set_amplitudes_from_widths(ClockLog& log, double flag_width_rad, double period_s,
                                double gravity_share = 1.0);

/// Fills the amplitudes from the two half-periods that a sensor at `offset_rad` sees, which differ
/// by 4 asin(alpha/lambda) T0 / 2 pi. The events must be numbered and of both directions.
void set_amplitudes_from_halves(std::span<Beat> beats, double offset_rad, double period_s);

/// The amplitudes of a run of good beats.
struct AmplitudeSummary {
  double mean_rad = 0.0;
  double rms_rad = 0.0;   ///< determines the circular error
  double sigma_rad = 0.0; ///< of a single amplitude: the scatter from beat to beat, with jitter
};

/// Mean of the amplitudes that are known, and their scatter: the robust size of second differences
/// of consecutive ones over sqrt(6), to which slow changes do not contribute. Nothing
/// with fewer than five amplitudes (AmplitudeTest.TheScatterOfAmplitudesIsThatOfTheSensor).
std::optional<AmplitudeSummary> summarise_amplitudes(std::span<const Beat> good);

/// A quantity of the sensor or the clock that is estimated from the log.
struct SensorEstimate {
  double value = 0.0;
  double sigma = 0.0;
};

/// Findings about the sensor and the swing, as far as the log shows them.
struct SensorFindings {
  std::optional<SensorEstimate> beat_error_s{};
  bool sides_are_unknown = false; ///< ticks were heard, and it is not known which are on which side
  std::optional<SensorEstimate> offset_rad{};
  bool at_vertical = false; ///< the times were moved to the vertical
  std::optional<AmplitudeSummary> amplitude{};
  double gravity_share = 1.0; ///< of the restoring torque (clock/restoring.hpp), as given
};

/// Beat error, s: how much longer the pendulum is on the left (from a downward crossing to the next
/// upward one) than on the right; others call half of it by the same name. Its scatter
/// gives sigma. nullopt without 3 whole swings.
std::optional<SensorEstimate> beat_error(std::span<const Beat> beats);

/// The angle (rad) of the sensor from the vertical, from numbered beats with amplitudes. With
/// crossings in both directions it follows from the beat error of each swing. Otherwise it follows
/// from the correlation of times and amplitudes: the alpha that minimises the second differences of
/// t - asin(alpha/lambda) T0 / 2 pi, by Gauss-Newton steps without outliers beyond five robust
/// standard deviations. Noise in the amplitudes biases this estimate towards zero. It also needs
/// amplitudes that scatter from beat to beat: if they wander with the drive, the rate changes with
/// them, which would look like an offset. nullopt if neither way works, or with fewer than 30 beats
/// for the second (AmplitudeTest.OffsetFromBothDirections,
/// AmplitudeTest.OffsetFromTheCorrelation, AmplitudeTest.ADriveThatVariesIsNoOffset).
std::optional<SensorEstimate> sensor_offset(std::span<const Beat> beats, double period_s);

/// Moves every event to the vertical, with its own amplitude: for a rising pendulum
/// t - asin(rising/lambda) T0 / 2 pi, for a falling one t + asin(falling/lambda) T0 / 2 pi. The
/// angles are those at which the sensor sees each: alpha and alpha for a beam off the vertical,
/// -w/2 and +w/2 for the leading edge of a centred flag.
///
/// The next term, of order epsilon and amplitude^2, is below 1e-4 of the correction. Events without
/// an amplitude that reaches the angle become issues and are moved with the log's median amplitude.
/// Trinity clock, 2013-03-30: the robust scatter of its periods falls from 44.5 to 31.6 us
/// (TrinityTest.EdgeCorrectionLowersTheNoise).
void move_to_vertical(ClockLog& log, double rising_rad, double falling_rad, double period_s);

/// The rate that the clock would have at vanishing amplitude (without the circular error):
/// (1 + rate) T(lambda)/T0 - 1, with T(lambda) the period of a free pendulum (restoring.hpp).
double rate_without_circular_error(double rate_excess, double amplitude_rad,
                                   double gravity_share = 1.0);

} // namespace goingrate
