// The rate that a clock would show if its response were the same at every amplitude. Private to the
// drive room.
//
// In terms of x = lambda^2, y = sqrt(x - phi0^2) and the drive's relative variation d, the averaged
// equations (Hoyng, eqs. dotl4, dotpsi4) are, with x0, y0 in stationary operation and tau_r the
// relaxation,
//   tau_r x' = x0 (1 + d) - x,     rate = c (1 + d) y/x - x/16 + constant,     c = g_fast x0/y0:
// the amplitude responds in proportion, the rate does not. Solved for d these are a recursion over
// the beats that gives drive and amplitude, and from them the rate of the linear response,
//   g_fast d + (g_slow - g_fast) (x/x0 - 1).
// Errors of the amplitude die out as exp(-t g_slow/(g_fast tau_r)) from the first beat on, or,
// where g_slow is negative (the circular error outweighs the escapement's), from the last beat
// back.
//
// The constant is not known, since the mean of the drive is not. But only with the correct constant
// is the white part of the drive equally large at all amplitudes, so it is found by maximum
// likelihood. If jitter hides the white part, or the gains hardly differ, the constant is the one
// that makes the mean drive zero.
#pragma once

#include "rate_components.hpp"

#include <optional>
#include <span>
#include <vector>

namespace goingrate::timing_model {

struct LinearRates {
  std::vector<double> rates; ///< of mean 0
  double mean_drive_rms = 0; ///< uncertainty of the mean drive of the log, and thus of x0
};

/// Whether g_slow is far enough from 0 for the recursion.
bool forgets_its_start(const DriveResponse& response);

/// `drive`: a first estimate of the components. Nothing if the amplitude hardly varies, so that the
/// rates need no correction; if the response is not known or g_slow is near 0; or if the clock
/// stalls, or would according to the equations, which then do not hold. Exact for rates made by the
/// equations above (LinearRatesTest.UndoesTheBendOfTheResponse).
std::optional<LinearRates> linear_rates(std::span<const double> rates, double period_s,
                                        const DriveResponse& response, const RateComponents& drive);

} // namespace goingrate::timing_model
