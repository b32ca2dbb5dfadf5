// The pushes of an escapement that rests, as a log shows them: once in N swings (Synchronome,
// Shortt), or when the amplitude has fallen to a limit (Hipp).
//
// Between two pushes, N swings apart, lambda^2 falls by L, and the circular error follows it. At
// the m-th crossing after a push, 1 <= m <= N, amplitude and lateness differ from their means by
//   (L / 2A) u_m  and  (s L T0 / 16) U_m + (the phase shift by the push) u_m,
//   u_m = ((N + 1)/2 - m) / N,   U_m = m (N - m) / (2 N) less its mean,
// to first order in pi eps N (dynamics/intermittent.hpp). A push that lasts through the vertical is
// under way at the N-th crossing. That crossing is early by the effect of the push so far, and its
// amplitude is between those before and after. These shapes are fitted (that of the N-th crossing
// from N = 6 on); N and the swing of the push are those that explain most of the log.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace goingrate {

struct TimingData;
struct Wheel;

/// The pushes found in a log.
struct ImpulseCycle {
  struct Estimate {
    double value, sigma;
  };
  double periods;  ///< from one push to the next, in the mean
  bool is_regular; ///< every interval is this whole number
  double gain;     ///< of 2 log L, less the price of the search
  double first;    ///< the first push comes in the period that begins with this cycle of the data
  std::vector<double> cycles{};             ///< the cycle of every push, where they are irregular
  std::optional<Estimate> amplitude_step{}; ///< how much a push raises the amplitude, rad
  Estimate lateness{0.0,
                    0.0};    ///< of the clock half-way between two pushes, by the circular error, s
  /// Step of the saw-tooth in the lateness, including the effect of a push on its own period, s.
  Estimate kick{0.0, 0.0};
  Estimate middle{0.0, 0.0}; ///< lateness of the crossing during which a push is under way, s
  double amplitude_middle = 0.0; ///< amplitude at that crossing above its lowest, rad
  /// The friction if these pushes alone drive the clock: fall/(2 pi N A (1 + 11 A^2/96)), or, if
  /// pushes are seen one by one, from the slope of ln A between them. nullopt if it differs from
  /// one part of the log to another, for example because pushes are regular only for a while. A
  /// strong tooth of a wheel that turns in N swings has a similar effect, from which the friction
  /// would come out too small.
  std::optional<Estimate> epsilon{};
};

/// Finds the pushes. N is searched from 2 to 60. Pushes at irregular intervals must each exceed the
/// scatter of the amplitudes by twelve standard deviations. A saw-tooth must explain more than a
/// sine of the same period, and its gain less the price must exceed 18: one false alarm in some
/// thousand logs (ImpulseCycleTest.NoiseShowsNoPushes). The coverage of the intervals of a step and
/// of epsilon is printed by tests/studies/impulses.sh.
std::optional<ImpulseCycle> find_impulse_cycle(const TimingData& data);

/// Finds pushes that wait for the swing to fall and do not stand out one by one, from the lines of a
/// spectrum: a saw-tooth whose mean interval need not be a whole number. A line that explains more
/// than the saw-tooth is a wheel's. Each push is within a swing of its place by the mean interval,
/// or was moved from there swing by swing. Logs of fewer than 200,000 cycles, waits of at most 60, two
/// overtones or more among the lines. The friction is left open.
/// ImpulseCycleTest.PushesThatWaitAreFoundFromTimesAlone
std::optional<ImpulseCycle> find_waiting_pushes(const TimingData& data,
                                                const std::vector<Wheel>& lines);

/// Subtracts the saw-tooth from times and amplitudes. To first order, the result is a clock that is
/// pushed equally in every swing.
void level_impulses(const ImpulseCycle& found, TimingData& data);

} // namespace goingrate
