// Numbers in sentences and texts for people.
#pragma once

#include <string>

namespace goingrate {

/// As "%.{digits}g" of printf, but what that writes with a power of ten from 10^3 to 10^8 stands in
/// full, and from 10,000 on thousands are set apart: "1230", "19,700"
/// (ReadableTest.LargeNumbersStandInFull).
std::string readable(double value, int digits);

/// The same with a plus before what is not negative.
std::string readable_signed(double value, int digits);

} // namespace goingrate
