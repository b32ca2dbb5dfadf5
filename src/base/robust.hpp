// Statistics on which outliers have little effect.
#pragma once

#include <span>
#include <vector>

namespace goingrate {

/// The median of `values`, which are reordered; they must not be empty.
double median(std::span<double> values);
/// The same of values that are kept as they are.
inline double median_of(std::vector<double> values) { return median(values); }

/// 1.4826 times the median absolute deviation from the median: the standard deviation of normal
/// values. `values` are changed; they must not be empty.
double robust_sigma(std::span<double> values);

/// The mean without a tenth of the values at either end. `values` are reordered; they must not be
/// empty.
double trimmed_mean(std::span<double> values);

} // namespace goingrate
