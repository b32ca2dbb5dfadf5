#include "rounded.hpp"

#include "goingrate/report/tables.hpp"

#include "markup.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace goingrate {

namespace {

int place_of(double size) { return static_cast<int>(std::floor(std::log10(size))); }

// Numbers of other sizes are written in powers of ten.
bool is_plain(int place) { return place >= -3 && place <= 6; }

Rounded rounded_alone(double value, int digits) {
  if (const int place = value == 0.0 ? 0 : place_of(std::abs(value));
      place >= digits && is_plain(place))
    return {fmt::format("{:.0f}", value), "", 0}; // an extra digit is better than a power of ten
  const std::string text = fmt::format("{:.{}g}", value, digits);
  const std::size_t power = text.find('e');
  if (power == text.npos) return {text, "", 0};
  return {text.substr(0, power), "", std::stoi(text.substr(power + 1))};
}

} // namespace

Rounded rounded(double value, double sigma, int digits) {
  constexpr double resolution = std::numeric_limits<double>::epsilon(); // of a double
  if (!(sigma > resolution * std::abs(value)) || !std::isfinite(sigma))
    return rounded_alone(value, digits);
  const int first = place_of(sigma); // of sigma's first digit
  const int top = place_of(std::max(std::abs(value), sigma));
  const int power = is_plain(top) ? 0 : top;
  const int decimals = std::max(0, power + 1 - first);
  const double unit = std::pow(10.0, power);
  return {fmt::format("{:.{}f}", value / unit, decimals),
          fmt::format("{:.{}f}", sigma / unit, decimals), power};
}

std::string power_of_ten(int power) { return power == 0 ? "" : "10" + superscript(power); }

std::string to_the_digits_of(double value, double sigma) {
  const Rounded text = rounded(value, sigma, 6);
  return text.power == 0 ? text.value : text.value + "×" + power_of_ten(text.power);
}

std::string with_sigma(double value, double sigma, int digits) {
  if (!std::isfinite(value)) return "not known";
  if (value == 0.0) value = 0.0; // no minus before zero
  Rounded text = rounded(value, sigma, digits);
  if (text.value.find_first_of("123456789") == std::string::npos && text.value.starts_with('-'))
    text.value.erase(0, 1); // nor before what is rounded to zero
  const std::string power = text.power == 0 ? "" : "×" + power_of_ten(text.power);
  if (text.sigma.empty()) return text.value + power;
  const std::string both = text.value + " ± " + text.sigma;
  return power.empty() ? both : "(" + both + ")" + power;
}

} // namespace goingrate
