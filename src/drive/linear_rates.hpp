// The rate that a clock would show if its response were the same at every amplitude. Private to the
// drive room.
//
// In terms of x = lambda^2, y = sqrt(x - phi0^2) and the drive's relative variation d, the averaged
// equations (Hoyng, eqs. dotl4, dotpsi4) are, with x0, y0 in stationary operation and tau_r the
// relaxation,
//   tau_r x' = x0 (1 + d) - x,     rate = c (1 + d) y/x - x/16 + constant,     c = g_fast x0/y0:
// the amplitude answers in proportion, the rate does not. Solved for d these are a recursion over
// the beats that gives drive and amplitude, and from them the rate of the linear response,
//   g_fast d + (g_slow - g_fast) (x/x0 - 1).
// Errors of the amplitude die out as exp(-t g_slow/(g_fast tau_r)) from the first beat on, or,
// where g_slow is negative (the circular error outweighs the escapement's), from the last beat
// back.
//
// The constant is not known, as the mean of the drive is not. But the drive's white
// part is equally large at all amplitudes only with the right one: the constant is that of the
// greatest likelihood. Where jitter covers the white part, or the gains hardly differ, it is the
// one that makes the mean drive zero.
#pragma once

#include "rate_components.hpp"

#include <optional>
#include <span>
#include <vector>

namespace goingrate::timing_model {

struct LinearRates {
  std::vector<double> rates; ///< of mean 0
  double mean_drive_rms = 0; ///< how well the mean drive of the log, and with it x0, is known
};

/// Whether g_slow is far enough from 0 for the recursion.
bool forgets_its_start(const DriveResponse& response);

/// `drive`: a first estimate of the components. Nothing where the amplitude hardly varies, so that
/// the rates are linear as they are; where the response is not known or g_slow is near 0; or where
/// the clock stalls or would have to, so that the equations do not hold. Exact for rates made by
/// the equations above (LinearRatesTest.UndoesTheBendOfTheResponse).
std::optional<LinearRates> linear_rates(std::span<const double> rates, double period_s,
                                        const DriveResponse& response, const RateComponents& drive);

} // namespace goingrate::timing_model
