// Fast and slow variations of the drive, from the spectrum of the rate.
//
// The pendulum responds to a relative change of the torque, mu(t) = mu (1 + d(t)), with a rate
// change
//   H(f) = g_fast + (g_slow - g_fast) / (1 + i f / f_c),   f_c = 2 epsilon / T0 (Hz),
// since lambda^2 relaxes at rate 2 epsilon (Hoyng, eq. dotl4): above the corner f_c the amplitude
// stands still, below it the amplitude follows. The model of the rate's one-sided density is
//   S(f) = |H|^2 [D_fast + D_slow(f)] + 8 j^2 sin^2(pi f T) / T,
// with a drive that is white from period to period, one that wanders with a memory (an
// Ornstein-Uhlenbeck process), and jitter j of the sensor. Their sizes maximise the Whittle
// likelihood after strictly periodic lines are removed; an interval ends where the logarithm of the
// likelihood has fallen by 1/2.
//
// A slow drive that moves the amplitude changes the gains as well. The sizes of the drive, the
// memory and the shares above and below a frequency are then found from rates corrected for that.
// Near a stall and where g_slow is almost zero this is not possible, and the note says so.
// Densities, costs and the jitter always describe the uncorrected rates.
//
// Limits: a drift through the whole log counts as slow drive with a memory of half the log; jitter
// larger than the effect of the drive hides the fast part, which then has an upper limit only.
#pragma once

#include "goingrate/dynamics/stationary.hpp"
#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/spectra/lines.hpp"
#include "goingrate/spectra/spectrum.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace goingrate {

/// An rms value with its 68 % interval; NaN where the log cannot tell. The low end is 0 where the
/// value is an upper limit, the high end infinite where nothing bounds it.
struct RmsEstimate {
  double rms;
  double low68;
  double high68;
};

/// The rms time error, s, that each part of the drive causes after a time t: the square root of
///   integral over f of S(f) (sin(pi f t) / (pi f))^2.
struct DriveCost {
  double after_s = 0.0;
  RmsEstimate fast_s{}, slow_s{};
};

/// The sizes of fast drive, slow drive and jitter, and the time errors that the drive causes.
struct DriveSplit {
  double split_hz = 0.0;        ///< the frequency asked for, or the corner
  bool at_frequency = false;    ///< true: fast and slow are what lies above and below split_hz
  RmsEstimate fast{};           ///< of the relative drive: white from period to period
  RmsEstimate slow{};           ///< of the relative drive: the part with a memory
  RmsEstimate jitter_s{};       ///< of the sensor, s
  double slow_time_s = 0.0;     ///< the memory of the slow part; NaN if there is none
  double slow_gain = 0.0;       ///< by how much log L is greater with the slow part than without
  std::vector<DriveCost> costs; ///< after a day, a week, a year
  std::vector<double> jitter_density; ///< parts of the fitted S, 1/Hz, at the given frequencies
  std::vector<double> fast_density;
  std::vector<double> slow_density;
  std::string note; ///< the limits of these sizes, in words; empty if there are none
};

/// The series whose spectrum is taken: the rate of each cycle less that of the fitted model, so
/// that the changes in the model do not count as variation; without a fit the rate itself. One
/// value per cycle, or where nine in ten beats are equally many cycles apart, one for so many; its
/// mean is not removed.
std::vector<double> rate_about_fit(std::span<const Beat> beats, double nominal_period_s,
                                   const FitSummary& fit);

/// Splits the drive of a rate series: 64 finite values or more, not all equal, one every
/// `period_s`, with lines removed. With `split_hz` above 0, fast and slow are the rms of the fitted
/// drive above and below it. The parts of the density are given at `frequency_hz`. The coverage of
/// the intervals is in tests/studies/drive_split.txt; DriveSplitTest.RecoversBothParts checks a
/// part of it. Throws ArgumentError outside the domain.
DriveSplit split_drive(std::span<const double> rates, double period_s,
                       const DriveResponse& response, double split_hz = 0.0,
                       std::span<const double> frequency_hz = {});

/// The drive of a clock, as far as its rate shows it.
struct DriveAnalysis {
  std::vector<double> rates;             ///< rate_about_fit
  double interval_s = 0.0;               ///< from one of them to the next
  std::optional<Spectrum> rate_spectrum; ///< of `rates`, in one segment; nothing below nine beats
  std::vector<SpectralLine> lines;       ///< of the rate; nothing below 64 beats
  std::optional<DriveResponse> response; ///< if epsilon, mu and phi0 are known to a tenth
  std::optional<DriveSplit> split;
  bool swings_freely = false;  ///< no escapement: there is no drive
  bool sees_amplitude = false; ///< the log has amplitudes
};

/// The relative sigma of |H| at a frequency, from the sigmas and correlations of T0, epsilon, mu
/// and phi0 in a fit whose clock this is; infinite where the clock may stall.
/// (DriveSplitTest.WhatTheFitDoesNotKnowWidensTheIntervals)
double relative_gain_sigma(const FitSummary& fit, const ClockParameters& clock,
                           double frequency_hz);

/// Spectrum and lines of the rate about a fit, and the split of the part after the fit's last event
/// has settled. The gains are those of the fitted clock. Its mean drive is taken from the logged
/// amplitudes, if there are any, since a fit may confuse a mean drive with a slow one. The
/// intervals of fast and slow include the uncertainty of the gains
/// (tests/studies/drive_split.txt: with fitted clocks). There is no split where a gain may be 0.
DriveAnalysis analyse_drive(std::span<const Beat> beats, double nominal_period_s,
                            const FitSummary& fit, double split_hz = 0.0);

/// The relative amplitude of the drive at a line: that of the rate, divided by |H| there.
double drive_of(const SpectralLine& line, const DriveResponse& response);

} // namespace goingrate
