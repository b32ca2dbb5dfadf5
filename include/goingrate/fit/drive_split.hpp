// Fast and slow variations of the drive, from the spectrum of the rate.
//
// The pendulum answers a relative change of the torque, mu(t) = mu (1 + d(t)), with a rate change
//   H(f) = g_fast + (g_slow - g_fast) / (1 + i f / f_c),   f_c = 2 epsilon / T0 (Hz),
// since lambda^2 relaxes at rate 2 epsilon (Hoyng, eq. dotl4): above the corner f_c the amplitude
// stands still, below it the amplitude follows. The rate's one-sided density is taken as
//   S(f) = |H|^2 D_fast + 8 j^2 sin^2(pi f T) / T + |H|^2 D_slow(f),
// white drive, jitter j of the sensor, and slow drive. D_fast and j are fitted above ten times the
// split, with weights 1/S^2 as in Whittle's likelihood, to medians over blocks of frequencies, so
// that lines do not count; what is left below it, divided by |H|^2, is the slow drive.
#pragma once

#include "goingrate/dynamics/stationary.hpp"
#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/spectra/spectrum.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace goingrate {

/// An rms value with its 68 % interval; NaN where the log cannot tell.
struct RmsEstimate {
  double rms;
  double low68;
  double high68;
};

struct DriveSplit {
  double split_hz = 0.0;  ///< where fast and slow were parted
  RmsEstimate fast{};     ///< of the relative drive: white from period to period
  RmsEstimate slow{};     ///< of the relative drive below the split, the white part removed
  RmsEstimate jitter_s{}; ///< of the sensor, s
  std::vector<double> jitter_density; ///< on the spectrum's frequencies: the parts of the fitted S
  std::vector<double> fast_density;
  std::string note; ///< what the log could not tell, in words; empty if all is well
};

/// The series to take the spectrum of: the rate per cycle about the fitted model, so that the
/// changes the fit knows do not count as variation; without a fit the rate itself. One value a
/// cycle; its mean is not removed.
std::vector<double> rate_about_fit(std::span<const Beat> beats, double nominal_period_s,
                                   const FitSummary& fit);

/// Splits the drive. `rate_spectrum` is of the rate per period (dimensionless, one value each
/// `period_s`), as one segment for the longest reach; `split_hz` = 0 takes the corner.
/// The slow rms needs three frequencies below the split: a log of three times its inverse.
/// DriveSplitTest.RecoversBothParts holds both against simulated logs.
DriveSplit split_drive(const Spectrum& rate_spectrum, double period_s,
                       const DriveResponse& response, double split_hz = 0.0);

/// The spectrum of the rate and, where the fit determines the clock, its drive.
struct DriveAnalysis {
  std::optional<Spectrum> rate_spectrum; ///< nothing below nine beats
  std::optional<DriveResponse> response; ///< if epsilon, mu and phi0 are known to a tenth
  std::optional<DriveSplit> split;
};

/// rate_about_fit, its spectrum in one segment without its mean, and split_drive.
DriveAnalysis analyse_drive(std::span<const Beat> beats, double nominal_period_s,
                            const FitSummary& fit, double split_hz = 0.0);

} // namespace goingrate
