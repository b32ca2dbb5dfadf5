// Decimal text: numbers written as printf rounds them, and digits read, by the hundred million.
#pragma once

#include "goingrate/base/instant.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <string_view>

namespace goingrate {

/// A line of a table while it is written.
class DecimalText {
public:
  void put(char mark) { characters_.push_back(mark); }
  void put(std::string_view words) {
    characters_.append(words.data(), words.data() + words.size());
  }
  [[nodiscard]] std::string_view view() const { return {characters_.data(), characters_.size()}; }
  [[nodiscard]] fmt::memory_buffer& characters() { return characters_; }

private:
  fmt::memory_buffer characters_;
};

/// Appends a whole number, as "%lld" of printf.
void append_integer(DecimalText& text, std::int64_t value);

/// Appends a whole number of at most `digits` digits, with zeros in front to make `digits` (at most
/// 19).
void append_digits(DecimalText& text, std::uint64_t value, int digits);

/// Appends a number as "%.{decimals}f" of printf; as with printf, any double is legal
/// (DecimalTest.IsWhatPrintfWrites).
void append_fixed(DecimalText& text, double value, int decimals);

/// Appends a number as "%.{decimals}e" of printf.
void append_scientific(DecimalText& text, double value, int decimals);

/// Appends a number as "%.{digits}g" of printf, `digits` from 1.
void append_general(DecimalText& text, double value, int digits);

/// Appends what format_instant() returns.
void append_instant(DecimalText& text, const Instant& t, int decimals);

/// The powers of ten that 64 bits hold.
inline constexpr std::array<std::uint64_t, 20> whole_powers_of_ten = [] {
  std::array<std::uint64_t, 20> powers{};
  std::uint64_t power = 1;
  for (std::uint64_t& entry : powers) {
    entry = power;
    power *= 10;
  }
  return powers;
}();

/// Eight bytes of a text that begin with the digits of a number.
struct EightBytes {
  std::uint64_t value = 0;
  int digits = 0; ///< before the first byte that is not one

  /// The digits at `c`, by three multiplications that join neighbours: two digits, four, eight.
  static EightBytes at(const char* c) {
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, c, sizeof bytes);
    if constexpr (std::endian::native == std::endian::big) bytes = __builtin_bswap64(bytes);
    bytes ^= 0x3030303030303030; // a digit is now its value, any other byte more than 9
    // A carry reaches only bytes after the first that is not a digit.
    const std::uint64_t others = (bytes | (bytes + 0x7676767676767676)) & 0x8080808080808080;
    const int digits = others == 0 ? 8 : std::countr_zero(others) / 8;
    if (digits == 0) return {};
    bytes <<= 64 - 8 * digits; // zeros in front
    bytes = (bytes & 0x0f0f0f0f0f0f0f0f) * 2561 >> 8;
    bytes = (bytes & 0x00ff00ff00ff00ff) * 6553601 >> 16;
    bytes = (bytes & 0x0000ffff0000ffff) * 42949672960001 >> 32;
    return {bytes, digits};
  }
};

/// The number made by the digits at `c`, which moves past them. Wraps beyond 19 digits.
inline std::uint64_t take_digits(const char*& c, const char* end) {
  std::uint64_t value = 0;
  while (end - c >= 8) {
    const EightBytes next = EightBytes::at(c);
    value = value * whole_powers_of_ten[static_cast<std::size_t>(next.digits)] + next.value;
    c += next.digits;
    if (next.digits < 8) return value;
  }
  for (; c != end && *c >= '0' && *c <= '9'; ++c)
    value = value * 10 + static_cast<std::uint64_t>(*c - '0');
  return value;
}

/// Reads seconds with digits on both sides of the point, and no more after it than a double holds,
/// as in nearly every line of every log; a single division rounds once. `c` moves past them. False
/// for any other text, with `c` at any place.
inline bool take_plain_seconds(const char*& c, const char* end, char point, Instant& time) {
  constexpr std::ptrdiff_t most_whole = 18, most_decimals = 15;
  const char* const begin = c;
  const std::uint64_t whole = take_digits(c, end);
  const auto whole_digits = c - begin;
  std::uint64_t part = 0;
  std::ptrdiff_t decimals = 0;
  if (c != end && *c == point) {
    const char* const after = ++c;
    part = take_digits(c, end);
    decimals = c - after;
  }
  if (whole_digits > most_whole || decimals > most_decimals || whole_digits + decimals == 0)
    return false;
  time = {static_cast<std::int64_t>(whole),
          static_cast<double>(part) /
              static_cast<double>(whole_powers_of_ten[static_cast<std::size_t>(decimals)])};
  return true;
}

} // namespace goingrate
