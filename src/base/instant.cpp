#include "goingrate/base/instant.hpp"

#include "base/decimal.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <fast_float/fast_float.h>
#include <fmt/format.h>
#include <limits>

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

namespace {

__extension__ typedef unsigned __int128 Wide; // 53 bits times 10^15 need 103

constexpr int held_digits = 19; // of a number that a 64-bit integer always holds

// A decimal number as it is written: digits * 10^exponent. Zeros in front are not counted.
struct Decimal {
  std::uint64_t digits = 0;
  int count = 0; // of digits held
  int exponent = 0;

  void add(char digit, bool after_point) {
    if (count < held_digits) {
      digits = digits * 10 + static_cast<std::uint64_t>(digit - '0');
      count += digits != 0 ? 1 : 0;
      exponent -= after_point ? 1 : 0;
    } else {
      exponent += after_point ? 0 : 1; // too many digits: this one only counts the place
    }
  }
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Reads "[eE][+-]digits" up to the end; nullopt if it is anything else.
std::optional<int> parse_exponent(std::string_view text) {
  if (text.size() < 2 || (text.front() != 'e' && text.front() != 'E')) return {};
  text.remove_prefix(1);
  const bool negative = text.front() == '-';
  if (text.front() == '-' || text.front() == '+') text.remove_prefix(1);
  if (text.empty()) return {};
  int exponent = 0;
  for (const char c : text) {
    if (!is_digit(c)) return {};
    exponent = std::min(exponent * 10 + (c - '0'), 100000); // beyond, all are alike
  }
  return negative ? -exponent : exponent;
}

// An unsigned decimal number that is the whole text.
std::optional<Decimal> parse_decimal(std::string_view text, char point) {
  Decimal number;
  bool after_point = false, any = false;
  std::size_t i = 0;
  for (; i < text.size(); ++i) {
    if (is_digit(text[i])) {
      number.add(text[i], after_point);
      any = true;
    } else if (text[i] == point && !after_point) {
      after_point = true;
    } else {
      break;
    }
  }
  if (!any) return {};
  if (i == text.size()) return number;
  const auto exponent = parse_exponent(text.substr(i));
  if (!exponent) return {};
  number.exponent += *exponent;
  return number;
}

// digits * seconds * 10^exponent, split at the point by whole-number division.
std::optional<Instant> scaled(const Decimal& number, std::uint32_t seconds, int power) {
  const int exponent = number.exponent + power;
  Wide value = static_cast<Wide>(number.digits) * seconds;
  constexpr Wide limit = std::numeric_limits<std::int64_t>::max();
  if (value == 0) return Instant{};
  if (exponent >= 0) {
    for (int i = 0; i < exponent; ++i)
      if ((value *= 10) > limit) return {};
    if (value > limit) return {};
    return Instant{static_cast<std::int64_t>(value), 0.0};
  }
  if (exponent < -37) { // 10^38 is more than 128 bits hold; below 1e-18 s nothing is left anyway
    const long double tiny = static_cast<long double>(value) * std::pow(10.0L, exponent);
    return Instant{0, static_cast<double>(tiny)};
  }
  Wide unit = 1;
  for (int i = 0; i < -exponent; ++i)
    unit *= 10;
  const Wide whole = value / unit;
  if (whole > limit) return {};
  const Wide rest = value % unit;
  const auto fraction =
      static_cast<double>(static_cast<long double>(rest) / static_cast<long double>(unit));
  const auto units = static_cast<std::int64_t>(whole);
  return fraction < 1.0 ? Instant{units, fraction} : Instant{units + 1, 0.0};
}

bool parse_plain_seconds(std::string_view text, char point, Instant& time) {
  const char* c = text.data();
  const char* const end = c + text.size();
  return take_plain_seconds(c, end, point, time) && c == end;
}

// Seconds with more than 15 decimals: the fraction is rounded to the nearest double all the same.
std::optional<Instant> parse_long_seconds(std::string_view text, char point) {
  const std::size_t at = text.find(point);
  if (at == std::string_view::npos || at > 18) return {};
  const std::string_view decimals = text.substr(at + 1);
  if (!std::all_of(decimals.begin(), decimals.end(), is_digit)) return {};
  std::array<char, 42> digits{'0', '.'};
  const std::string_view fraction = decimals.substr(0, digits.size() - 2);
  std::copy(fraction.begin(), fraction.end(), digits.begin() + 2);
  double value = 0.0;
  const char* const end = digits.data() + 2 + fraction.size();
  const auto [stop, error] = fast_float::from_chars(digits.data(), end, value);
  Instant whole;
  const bool good = parse_plain_seconds(text.substr(0, at + 1), point, whole);
  if (!good || error != std::errc() || stop != end) return {};
  return value < 1.0 ? Instant{whole.seconds, value} : Instant{whole.seconds + 1, 0.0};
}

std::optional<Instant> parse_unsigned(std::string_view text, TimeUnit unit, char point) {
  if (unit == in_seconds) {
    Instant plain;
    if (parse_plain_seconds(text, point, plain)) return plain;
    if (const auto precise = parse_long_seconds(text, point)) return precise;
  }
  const auto number = parse_decimal(text, point);
  if (!number) return {};
  return scaled(*number, unit.seconds, unit.power);
}

} // namespace

std::optional<Instant> parse_instant(std::string_view text, TimeUnit unit, char point) {
  if (text.empty()) return {};
  const bool negative = text.front() == '-';
  if (negative || text.front() == '+') text.remove_prefix(1);
  auto t = parse_unsigned(text, unit, point);
  if (!t || !negative) return t;
  const double complement = 1.0 - t->fraction; // one if the fraction is none, or below all digits
  if (complement == 1.0) return Instant{-t->seconds, 0.0};
  return Instant{-t->seconds - 1, complement};
}

std::optional<Instant> whole_units(std::int64_t count, TimeUnit unit) {
  if (count < 0) throw ArgumentError("count", static_cast<double>(count), "at least 0");
  return scaled({static_cast<std::uint64_t>(count), 0, 0}, unit.seconds, unit.power);
}

namespace {

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

// The usual case, which must be fast: logs have up to a hundred million lines.
void append_positive(DecimalText& text, const Instant& t, int decimals) {
  const std::uint64_t power = whole_powers_of_ten[static_cast<std::size_t>(decimals)];
  const std::uint64_t digits = fraction_digits(t.fraction, power);
  append_integer(text, digits < power ? t.seconds : t.seconds + 1);
  text.put('.');
  append_digits(text, digits < power ? digits : 0, decimals);
}

} // namespace

std::string format_instant(const Instant& t, int decimals) {
  DecimalText text;
  append_instant(text, t, decimals);
  return std::string(text.view());
}

void append_instant(DecimalText& text, const Instant& t, int decimals) {
  if (decimals < 0 || decimals > 17) throw ArgumentError("decimals", decimals, "between 0 and 17");
  if (t.seconds >= 0 && decimals >= 1 && decimals <= 15) return append_positive(text, t, decimals);
  Instant magnitude = t;
  const bool negative = t.seconds < 0;
  if (negative) {
    magnitude.seconds = t.fraction == 0.0 ? -t.seconds : -t.seconds - 1;
    magnitude.fraction = t.fraction == 0.0 ? 0.0 : 1.0 - t.fraction;
  }
  const std::string fraction = fmt::format("{:.{}f}", magnitude.fraction, decimals);
  if (fraction.front() == '1') ++magnitude.seconds; // the fraction rounded up to one
  if (negative) text.put('-');
  append_integer(text, magnitude.seconds);
  text.put(std::string_view(fraction).substr(1));
}

} // namespace goingrate
