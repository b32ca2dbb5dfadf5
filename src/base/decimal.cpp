#include "base/decimal.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fmt/format.h>
#include <iterator>
#include <optional>

namespace goingrate {

namespace {

constexpr int last_exact_power = 22; // of ten, that a double holds exactly
constexpr int most_digits = 14;      // ten times a number of so many is still below 2^53

constexpr std::array<double, last_exact_power + 1> powers_of_ten = [] {
  std::array<double, last_exact_power + 1> powers{};
  double power = 1.0; // every product is exact
  for (double& entry : powers) {
    entry = power;
    power *= 10.0;
  }
  return powers;
}();

constexpr std::array<char, 200> digit_pairs = [] {
  std::array<char, 200> pairs{};
  for (std::size_t i = 0; i < 100; ++i) {
    pairs[2 * i] = static_cast<char>('0' + i / 10);
    pairs[2 * i + 1] = static_cast<char>('0' + i % 10);
  }
  return pairs;
}();

// size * 10^power rounded to the nearest whole number, from a tie to the even one, as if the
// product were exact; nothing from 10^15 on. The double nearest to the product lies on the same
// side of every tie, or on the tie itself.
std::optional<std::uint64_t> scaled(double size, int power) {
  const double factor = powers_of_ten[static_cast<std::size_t>(power)];
  const double product = size * factor;
  if (!(product < 1e15)) return {};
  const auto whole = static_cast<std::uint64_t>(product);
  const double rest = product - static_cast<double>(whole);
  if (rest != 0.5) return whole + (rest > 0.5 ? 1 : 0);
  const double rounded_off = std::fma(size, factor, -product);
  return whole + (rounded_off > 0.0 || (rounded_off == 0.0 && whole % 2 == 1) ? 1 : 0);
}

// d.ddd * 10^exponent, without the point.
struct Significant {
  std::uint64_t digits;
  int exponent;
};

// Rounded to `count` digits; nothing where that takes more than scaled() can do.
std::optional<Significant> significant(double size, int count) {
  if (size == 0.0) return Significant{0, 0};
  if (count > most_digits) return {};
  const int binary_exponent = static_cast<int>(std::bit_cast<std::uint64_t>(size) >> 52) - 1023;
  // The floor of binary_exponent * log10(2): the decimal exponent, or one less.
  for (int exponent = (binary_exponent * 78913) >> 18;; ++exponent) {
    const int power = count - 1 - exponent;
    if (power < 0 || power > last_exact_power) return {};
    const auto digits = scaled(size, power);
    if (!digits) return {};
    if (static_cast<double>(*digits) < powers_of_ten[static_cast<std::size_t>(count)])
      return Significant{*digits, exponent};
  }
}

// A number being written, from its last character to its first.
class Reversed {
public:
  void put(char c) { *--begin_ = c; }
  // The lowest digits of `value`, which loses them.
  void put_digits(std::uint64_t& value, int count) {
    for (; count >= 2; count -= 2, value /= 100)
      std::memcpy(begin_ -= 2, &digit_pairs[2 * (value % 100)], 2);
    if (count == 1) {
      put(static_cast<char>('0' + value % 10));
      value /= 10;
    }
  }
  // All digits of `value`, at least one.
  void put_whole(std::uint64_t value) {
    for (; value >= 100; value /= 100)
      std::memcpy(begin_ -= 2, &digit_pairs[2 * (value % 100)], 2);
    put_digits(value, value >= 10 ? 2 : 1);
  }
  // value / 10^decimals.
  void put_fixed(std::uint64_t value, int decimals) {
    if (decimals > 0) {
      put_digits(value, decimals);
      put('.');
    }
    put_whole(value);
  }
  void put_exponent(int exponent) {
    auto size = static_cast<std::uint64_t>(exponent < 0 ? -exponent : exponent);
    put_digits(size, 2); // not below 10^-22, nor from 10^15 on
    put(exponent < 0 ? '-' : '+');
    put('e');
  }
  void append_to(std::string& text) const {
    text.append(begin_, static_cast<std::size_t>(characters_.data() + characters_.size() - begin_));
  }

private:
  std::array<char, 48> characters_; // a sign, 20 digits, 22 decimals, a point
  char* begin_ = characters_.data() + characters_.size();
};

} // namespace

void append_integer(std::string& text, std::int64_t value) {
  Reversed number;
  const auto bits = static_cast<std::uint64_t>(value);
  number.put_whole(value < 0 ? 0 - bits : bits);
  if (value < 0) number.put('-');
  number.append_to(text);
}

void append_digits(std::string& text, std::uint64_t value, int digits) {
  Reversed number;
  number.put_digits(value, digits);
  number.append_to(text);
}

void append_fixed(std::string& text, double value, int decimals) {
  const auto size = decimals <= last_exact_power ? scaled(std::abs(value), decimals) : std::nullopt;
  if (!size) {
    fmt::format_to(std::back_inserter(text), "{:.{}f}", value, decimals);
    return;
  }
  Reversed number;
  number.put_fixed(*size, decimals);
  if (std::signbit(value)) number.put('-');
  number.append_to(text);
}

void append_scientific(std::string& text, double value, int decimals) {
  const auto size = significant(std::abs(value), decimals + 1);
  if (!size) {
    fmt::format_to(std::back_inserter(text), "{:.{}e}", value, decimals);
    return;
  }
  Reversed number;
  number.put_exponent(size->exponent);
  number.put_fixed(size->digits, decimals);
  if (std::signbit(value)) number.put('-');
  number.append_to(text);
}

void append_general(std::string& text, double value, int digits) {
  auto size = significant(std::abs(value), digits);
  if (!size) {
    fmt::format_to(std::back_inserter(text), "{:.{}g}", value, digits);
    return;
  }
  int decimals = digits - 1;
  while (decimals > 0 && size->digits % 10 == 0) {
    size->digits /= 10;
    --decimals;
  }
  Reversed number;
  if (size->exponent < -4 || size->exponent >= digits) {
    number.put_exponent(size->exponent);
    number.put_fixed(size->digits, decimals);
  } else {
    // An exponent of more than the digits left puts zeros between them and the point.
    for (; decimals < size->exponent; ++decimals)
      size->digits *= 10;
    number.put_fixed(size->digits, decimals - size->exponent);
  }
  if (std::signbit(value)) number.put('-');
  number.append_to(text);
}

} // namespace goingrate
