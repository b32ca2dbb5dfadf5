// What a course becomes through a lag of first order. Private to the causes room.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace goingrate::timing_model {

/// A course of block means through a first-order lag, from centre to centre of the blocks, which
/// had settled at the first of them; the course itself for a lag of 0. That the values are means
/// over blocks does no harm: the rate is a mean as well, and the lag of a mean is the mean of the
/// lag.
std::vector<double> lagged(std::span<const double> value, double block_s, double lag_s);

/// What a lag still remembers of the time before the log, which nobody knows.
std::vector<double> memory(std::size_t blocks, double block_s, double lag_s);

/// The lags to try, each a factor above the last: from one block to three tenths of the log, beyond
/// which a lag cannot be told from a drift.
std::vector<double> lags_to_try(std::size_t blocks, double block_s);

/// The lag nearest to one of lags_to_try() at which a deviance is least, to a few thousandths.
double refined_lag(double coarse_s, const std::function<double(double)>& deviance);

} // namespace goingrate::timing_model
