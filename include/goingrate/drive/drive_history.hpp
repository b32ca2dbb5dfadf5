// The drive as a function of time: mu(t)/mu0 from amplitudes, from the rate, or from both.
//
// In blocks short compared with the relaxation, the deviation x = lambda^2/X - 1 from the
// stationary amplitude and the relative drive d follow (Hoyng, eq. dotl4)
//   x' = E x + (1 - E)(d + d')/2,   E = exp(-4 pi epsilon n),   n cycles per block,
//   d' = d + (steps of rms q),
// and the observations of a block are
//   its mean amplitude:  lambda = sqrt(X) (1 + x/2),
//   its mean rate:       r = r0 + s x + g d,   s = slow gain - fast gain, g = fast gain,
// each with its noise. In effect d(lambda^2)/dt + 2 epsilon lambda^2 is solved for the drive,
// smoothed as the noise requires: q maximises the likelihood, and a Kalman filter with a backward
// smoother (Rauch, Tung, Striebel) gives d and its sigma in every block.
#pragma once

#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/fit/timing_data.hpp"

#include <optional>
#include <vector>

namespace goingrate {

/// The properties of the clock that are needed.
struct DriveModel {
  double T0_s = 0.0;
  double epsilon = 0.0;
  double amplitude_rad = 0.0;        ///< stationary amplitude under the drive that counts as 1
  std::optional<double> fast_gain{}; ///< without gains the rate is not used
  std::optional<double> slow_gain{};
};

/// One block.
struct DrivePoint {
  double at_s = 0.0;     ///< its middle, after the first beat
  double relative = 1.0; ///< mu(t)/mu0
  double sigma = 0.0;    ///< of `relative`; the model's parameters count as exact
};

/// The drive as a function of time.
struct DriveHistory {
  std::vector<DrivePoint> points;
  double step_rms = 0.0; ///< q
  double block_s = 0.0;
  bool from_amplitude = false, from_rate = false;
};

/// The history of `data`. `block_s` = 0 takes a hundredth of the relaxation time T0/(4 pi eps), at
/// least four periods. Nothing with fewer than ten blocks, or with neither amplitudes nor gains.
/// DriveHistoryTest compares it with the simulator's own drive: the truth lies within one sigma in
/// more than half of the blocks (0.68 are expected; neighbouring blocks are correlated).
std::optional<DriveHistory> drive_history(const TimingData& data, const DriveModel& model,
                                          double block_s = 0.0);

/// The model from a fit; nothing unless its epsilon is above 0 and determined or fixed, and either
/// it has the gains or `data` has amplitudes. If the fit has no stationary amplitude, the mean of
/// the log is used.
std::optional<DriveModel> drive_model(const FitSummary& fit, const TimingData& data);

} // namespace goingrate
