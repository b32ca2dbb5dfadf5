// First-order lags of a series. Private to the causes room.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace goingrate::timing_model {

/// A series of block means after a first-order lag, settled at the first value; unchanged for a lag
/// of 0. Values are taken at the centres of the blocks. Means may be lagged like values, since the
/// lag of a mean is the mean of the lag, and the rate is given in means as well.
std::vector<double> lagged(std::span<const double> value, double block_s, double lag_s);

/// The decay with which unknown values before the log still act through a lag.
std::vector<double> memory(std::size_t blocks, double block_s, double lag_s);

/// The lags to try, in a geometric series from one block to three tenths of the log. A longer lag
/// cannot be distinguished from a drift.
std::vector<double> lags_to_try(std::size_t blocks, double block_s);

/// The lag near `coarse_s` that minimises the deviance, to a few thousandths.
double refined_lag(double coarse_s, const std::function<double(double)>& deviance);

} // namespace goingrate::timing_model
