// Numbers rounded to the digits that are known. Private to the report.
#pragma once

#include <string>

namespace goingrate {

/// value ± sigma, both in units of 10^power; `sigma` is empty if it is not known.
struct Rounded {
  std::string value, sigma;
  int power = 0;
};

/// The value to two digits of sigma; without a sigma above 0, or with one below the resolution of a
/// double, to `digits` digits of the value, which is finite.
Rounded rounded(double value, double sigma, int digits);

/// The value alone, with as many digits as it has with its standard deviation; for the end of an
/// interval.
std::string to_the_digits_of(double value, double sigma);

/// "10⁻⁴"; empty for a power of 0.
std::string power_of_ten(int power);

} // namespace goingrate
