// Long series of numbers in few bytes of text.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace goingrate {

/// How many values share an offset and a step.
inline constexpr std::size_t packed_block = 1024;

/// `values` as base64. For each block of up to `packed_block` values: its least value and its step
/// as two 64-bit floats, then a 16-bit number for each value = least + step * number; 65535 stands
/// for one that is not finite. All little-endian. A value is right within half a step, that is the
/// span of its block / 131068 (PackedReportTest.KeepsEveryValueWithinHalfAStep).
std::string packed(std::span<const double> values);

/// Two values for each stretch of `stretch`: its lowest and its highest, in the order they come in.
/// A stretch without finite values gives two NaN.
std::vector<double> extremes(std::span<const double> values, std::size_t stretch);

/// Where those two are drawn: at a quarter and three quarters of the stretch.
std::vector<double> quarters(std::span<const double> places, std::size_t stretch);

} // namespace goingrate
