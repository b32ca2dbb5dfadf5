// Packs long series of numbers into few bytes of text.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace goingrate {

/// How many values share an offset and a step.
inline constexpr std::size_t packed_block = 1024;

/// `values` as base64. For each block of up to `packed_block` values: its least value and its step
/// as two 64-bit floats, then a 16-bit number for each value = least + step * number; 65535 stands
/// for one that is not finite. All little-endian. A value is right to within half a step, which is
/// the span of its block / 131068 (PackedReportTest.KeepsEveryValueWithinHalfAStep).
std::string packed(std::span<const double> values);

/// Two values for each stretch of `stretch` values: its lowest and its highest, in the order in
/// which they come. A stretch without finite values gives two NaN.
std::vector<double> extremes(std::span<const double> values, std::size_t stretch);

/// The places at which the two extremes of each stretch are drawn: a quarter and three quarters of
/// the way through it.
std::vector<double> quarters(std::span<const double> places, std::size_t stretch);

} // namespace goingrate
