// Numbers in sentences and texts for people.
#pragma once

#include <string>

namespace goingrate {

/// As "%.{digits}g" of printf, but a number that printf would write with a power of ten from 10^3
/// to 10^8 is written in full: "1230", "19700". Digits are not grouped: to a reader of logs with
/// decimal commas, 19,700 is below 20 (ReadableTest.LargeNumbersStandInFull).
std::string readable(double value, int digits);

/// The same with a plus sign unless the number is negative.
std::string readable_signed(double value, int digits);

} // namespace goingrate
