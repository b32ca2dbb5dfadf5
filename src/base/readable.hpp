// Numbers in sentences and texts for people.
#pragma once

#include <string>

namespace goingrate {

/// As "%.{digits}g" of printf, but what that writes with a power of ten from 10^3 to 10^8 stands in
/// full: "1230", "19700". Digits are not grouped: to who reads logs with decimal commas, 19,700 is
/// below 20 (ReadableTest.LargeNumbersStandInFull).
std::string readable(double value, int digits);

/// The same with a plus before what is not negative.
std::string readable_signed(double value, int digits);

} // namespace goingrate
