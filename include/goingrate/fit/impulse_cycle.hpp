// How often a log shows that the pendulum gets a push: once in N swings (Synchronome, Shortt), or
// when its amplitude has fallen to a limit (Hipp).
//
// Between two pushes, N swings apart, lambda^2 falls by L, and the circular error follows it. At
// the m-th crossing after a push, 1 <= m <= N, amplitude and lateness depart from their means by
//   (L / 2A) u_m  and  (s L T0 / 16) U_m + (what the push itself shifts the phase) u_m,
//   u_m = ((N + 1)/2 - m) / N,   U_m = m (N - m) / (2 N) less its mean,
// to first order in pi eps N (dynamics/intermittent.hpp). A push that runs through the vertical is
// under way at the N-th: that crossing comes early by what the push has done so far, and its
// amplitude is between the two. These shapes are sought (that of the N-th from N = 6 on); N and the
// swing of the push are those that explain most.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace goingrate {

struct TimingData;

/// Pushes that a log shows.
struct ImpulseCycle {
  struct Estimate {
    double value, sigma;
  };
  double periods;  ///< from one push to the next, in the mean
  bool is_regular; ///< every interval is this whole number
  double gain;     ///< of 2 log L, less the price of having searched
  double first;    ///< the first push comes in the period that begins with this cycle of the data
  std::vector<double> cycles{};             ///< all of them, where they are not regular
  std::optional<Estimate> amplitude_step{}; ///< how much a push raises the amplitude, rad
  Estimate lateness{0.0,
                    0.0};    ///< of the clock half-way between two pushes, by the circular error, s
  Estimate kick{0.0, 0.0};   ///< step of the tooth, with what the push does to its own period, s
  Estimate middle{0.0, 0.0}; ///< how late the crossing is in whose midst the push comes, s
  double amplitude_middle = 0.0; ///< how much the amplitude is above its low there, rad
  /// The friction if these pushes alone drive the clock: fall/(2 pi N A (1 + 11 A^2/96)); of pushes
  /// that are each seen by the slope of ln A between them. Nothing where it differs from one part
  /// of the log to another, as where pushes are regular for a while only. A strong tooth of a wheel
  /// that turns in N swings looks the same and shows less.
  std::optional<Estimate> epsilon{};
};

/// Finds the pushes. N is sought from 2 to 60; pushes that come at other intervals must each stand
/// out from the amplitudes by twelve standard deviations. A saw-tooth must explain more than a sine
/// of the same period, and its gain must pass 18 after the price: a false alarm in some thousand
/// logs (ImpulseCycleTest.NoiseShowsNoPushes). Intervals of a step and of epsilon hold as
/// tests/studies/impulses.sh prints.
std::optional<ImpulseCycle> find_impulse_cycle(const TimingData& data);

/// Takes the saw-tooth off times and amplitudes: what is left is the clock that gets a share of
/// each push in every swing, the same clock to first order.
void level_impulses(const ImpulseCycle& found, TimingData& data);

} // namespace goingrate
