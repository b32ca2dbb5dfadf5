#include "goingrate/base/instant.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fast_float/fast_float.h>
#include <fmt/format.h>

namespace goingrate {

Instant operator+(const Instant& t, double duration) {
  const double whole = std::floor(duration);
  Instant sum{t.seconds + static_cast<std::int64_t>(whole), t.fraction + (duration - whole)};
  if (sum.fraction >= 1.0) {
    sum.fraction -= 1.0;
    ++sum.seconds;
  }
  return sum;
}

double residual_from_grid(const Instant& t, const Instant& origin, std::int64_t n, double period) {
  const auto count = static_cast<double>(n);
  const double product = count * period;
  const double product_low = std::fma(count, period, -product);
  const double whole = std::floor(product);
  const auto whole_seconds = t.seconds - origin.seconds - static_cast<std::int64_t>(whole);
  const double fractions = (t.fraction - origin.fraction) - (product - whole);
  return (static_cast<double>(whole_seconds) + fractions) - product_low;
}

namespace {

bool all_digits(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::optional<double> parse_double(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = fast_float::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

// Digits of both sides of the point, without sign or exponent.
std::optional<Instant> parse_plain(std::string_view whole, std::string_view fraction) {
  Instant t;
  if (!whole.empty()) {
    const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), t.seconds);
    if (error != std::errc() || end != whole.data() + whole.size()) return {};
  }
  if (!fraction.empty()) {
    const auto value = parse_double(fmt::format("0.{}", fraction));
    if (!value) return {};
    t.fraction = *value;
    if (t.fraction >= 1.0) { // 0.99999999999999999 rounds up to one
      t.fraction = 0.0;
      ++t.seconds;
    }
  }
  return t;
}

} // namespace

std::optional<Instant> parse_instant(std::string_view text) {
  const bool negative = !text.empty() && text.front() == '-';
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  if (text.empty()) return {};
  const std::size_t point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  const std::string_view fraction =
      point == std::string_view::npos ? std::string_view{} : text.substr(point + 1);
  if (whole.empty() && fraction.empty()) return {};
  if (!all_digits(whole) || !all_digits(fraction)) { // an exponent, or no number at all
    if (text.front() == '+' || text.front() == '-') return {};
    const auto value = parse_double(text);
    if (!value || std::abs(*value) >= 9.2e18) return {};
    return Instant::from_seconds(negative ? -*value : *value);
  }
  auto t = parse_plain(whole, fraction);
  if (!t || !negative) return t;
  if (t->fraction == 0.0) return Instant{-t->seconds, 0.0};
  return Instant{-t->seconds - 1, 1.0 - t->fraction};
}

namespace {

__extension__ typedef unsigned __int128 Wide; // 53 bits times 10^15 need 103

// The digits of a fraction in [0, 1), rounded exactly (a tie to even): fraction * 10^decimals.
std::uint64_t fraction_digits(double fraction, std::uint64_t power) {
  int exponent = 0;
  const double mantissa = std::frexp(fraction, &exponent);
  const auto whole = static_cast<std::uint64_t>(std::ldexp(mantissa, 53));
  const int shift = 53 - exponent;               // fraction = whole * 2^-shift, shift >= 53
  if (fraction == 0.0 || shift >= 120) return 0; // below half of the last digit
  const Wide product = static_cast<Wide>(whole) * power;
  const Wide half = static_cast<Wide>(1) << (shift - 1);
  const Wide rest = product & ((half << 1) - 1);
  const auto digits = static_cast<std::uint64_t>(product >> shift);
  return digits + (rest > half || (rest == half && digits % 2 == 1) ? 1 : 0);
}

// The usual case, fast: logs are written by the hundred million.
std::string format_positive(std::int64_t seconds, double fraction, int decimals) {
  std::uint64_t power = 1;
  for (int i = 0; i < decimals; ++i)
    power *= 10;
  std::uint64_t digits = fraction_digits(fraction, power);
  if (digits == power) {
    ++seconds;
    digits = 0;
  }
  std::string text = fmt::format_int(seconds).str();
  text.push_back('.');
  const std::size_t point = text.size();
  text.resize(point + static_cast<std::size_t>(decimals));
  for (std::size_t i = text.size(); i-- > point; digits /= 10)
    text[i] = static_cast<char>('0' + digits % 10);
  return text;
}

} // namespace

std::string format_instant(const Instant& t, int decimals) {
  if (decimals < 0 || decimals > 17) throw ArgumentError("decimals", decimals, "between 0 and 17");
  if (t.seconds >= 0 && decimals >= 1 && decimals <= 15)
    return format_positive(t.seconds, t.fraction, decimals);
  Instant magnitude = t;
  const bool negative = t.seconds < 0;
  if (negative) {
    magnitude.seconds = t.fraction == 0.0 ? -t.seconds : -t.seconds - 1;
    magnitude.fraction = t.fraction == 0.0 ? 0.0 : 1.0 - t.fraction;
  }
  std::string fraction = fmt::format("{:.{}f}", magnitude.fraction, decimals);
  if (fraction.front() == '1') ++magnitude.seconds; // the fraction rounded up to one
  return fmt::format("{}{}{}", negative ? "-" : "", magnitude.seconds, fraction.substr(1));
}

} // namespace goingrate
