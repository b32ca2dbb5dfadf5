#include "base/decimal.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
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

// Rounded to `count` digits; nullopt if that is more than scaled() can do.
std::optional<Significant> significant(double size, int count) {
  if (count > most_digits) return {};
  if (size == 0.0) return Significant{0, 0};
  const int binary_exponent = static_cast<int>(std::bit_cast<std::uint64_t>(size) >> 52) - 1023;
  // The floor of binary_exponent * log10(2): the decimal exponent, or one less.
  for (int exponent = (binary_exponent * 78913) >> 18;; ++exponent) {
    const int power = count - 1 - exponent;
    if (power < 0 || power > last_exact_power) return {};
    const auto digits = scaled(size, power);
    if (!digits) return {};
    if (*digits < whole_powers_of_ten[static_cast<std::size_t>(count)])
      return Significant{*digits, exponent};
  }
}

int digits_of(std::uint64_t value) {
  const int power = static_cast<int>(std::bit_width(value | 1)) * 1233 >> 12; // log10(2) is nearly 1233 / 4096
  return power + ((value | 1) < whole_powers_of_ten[static_cast<std::size_t>(power)] ? 0 : 1);
}

// ---- characters, sixteen at a time in a register, the first lowest

__extension__ typedef unsigned __int128 Characters;

// Up to eight digits, zeros in front: split into halves of four digits, of two, of one, each time
// by one multiplication for all.
std::uint64_t text_of_eight(std::uint64_t value) {
  const std::uint64_t fours = value / 10000 | value % 10000 << 32;
  const std::uint64_t hundreds = fours * 10486 >> 20 & 0x0000007f0000007f;
  const std::uint64_t twos = hundreds | (fours - 100 * hundreds) << 16;
  const std::uint64_t tens = twos * 103 >> 10 & 0x000f000f000f000f;
  return (tens | (twos - 10 * tens) << 8) + 0x3030303030303030;
}

constexpr std::uint64_t ten_to_8 = 100'000'000, ten_to_16 = ten_to_8 * ten_to_8;

// Exactly `count` digits, 1 to 16, of a number that has no more.
Characters text_of(std::uint64_t value, int count) {
  if (count <= 8) return text_of_eight(value) >> (64 - 8 * count);
  const Characters all = static_cast<Characters>(text_of_eight(value % ten_to_8)) << 64 |
                         text_of_eight(value / ten_to_8);
  return all >> (128 - 8 * count);
}

// The characters with a point after the first `whole`, 1 to 14.
Characters with_point(Characters text, int whole) {
  const int bits = 8 * whole;
  const Characters before = text & ((static_cast<Characters>(1) << bits) - 1);
  return before | static_cast<Characters>('.') << bits | text >> bits << (bits + 8);
}

// Zeros at the end of `count` characters.
int zeros_behind(Characters text, int count) {
  constexpr std::uint64_t zeros = 0x3030303030303030;
  const Characters others = (text ^ (static_cast<Characters>(zeros) << 64 | zeros))
                            << (128 - 8 * count);
  const auto high = static_cast<std::uint64_t>(others >> 64);
  const auto low = static_cast<std::uint64_t>(others);
  return (high != 0 ? std::countl_zero(high) : 64 + std::countl_zero(low)) / 8;
}

// Appends one number to the text.
class Pen {
public:
  explicit Pen(DecimalText& text) : text_(text.characters()) {
    constexpr std::size_t room = 64; // a sign, twenty digits, and what is copied beyond the last
    text_.reserve(text_.size() + room);
    at_ = text_.data() + text_.size();
  }
  ~Pen() { text_.resize(static_cast<std::size_t>(at_ - text_.data())); }
  Pen(const Pen&) = delete;
  Pen& operator=(const Pen&) = delete;

  // Writes the first `count` characters, at most sixteen.
  void put(Characters text, int count) {
    if constexpr (std::endian::native == std::endian::little)
      std::memcpy(at_, &text, sizeof text);
    else
      for (int i = 0; i < count; ++i)
        at_[i] = static_cast<char>(text >> 8 * i);
    at_ += count;
  }
  void put_sign_of(double value) {
    *at_ = '-';
    at_ += std::signbit(value) ? 1 : 0;
  }
  void put_digits(std::uint64_t value, int count) {
    if (count > 16) {
      put(text_of(value / ten_to_16, count - 16), count - 16);
      value %= ten_to_16;
      count = 16;
    }
    put(text_of(value, count), count);
  }
  void put_exponent(int exponent) {
    const Characters sign = exponent < 0 ? '-' : '+';
    put('e' | sign << 8 | text_of(static_cast<std::uint64_t>(std::abs(exponent)), 2) << 16, 4);
  }

private:
  fmt::memory_buffer& text_;
  char* at_;
};

} // namespace

void append_integer(DecimalText& text, std::int64_t value) {
  Pen pen(text);
  if (value < 0) pen.put('-', 1);
  const auto bits = static_cast<std::uint64_t>(value);
  const std::uint64_t size = value < 0 ? 0 - bits : bits;
  pen.put_digits(size, digits_of(size));
}

void append_digits(DecimalText& text, std::uint64_t value, int digits) {
  Pen(text).put_digits(value, digits);
}

void append_fixed(DecimalText& text, double value, int decimals) {
  const auto size = decimals <= most_digits ? scaled(std::abs(value), decimals) : std::nullopt;
  if (!size) {
    fmt::format_to(fmt::appender(text.characters()), "{:.{}f}", value, decimals);
    return;
  }
  const int count = std::max(digits_of(*size), decimals + 1);
  Pen pen(text);
  pen.put_sign_of(value);
  const Characters digits = text_of(*size, count);
  if (decimals > 0)
    pen.put(with_point(digits, count - decimals), count + 1);
  else
    pen.put(digits, count);
}

void append_scientific(DecimalText& text, double value, int decimals) {
  const auto size = significant(std::abs(value), decimals + 1);
  if (!size) {
    fmt::format_to(fmt::appender(text.characters()), "{:.{}e}", value, decimals);
    return;
  }
  Pen pen(text);
  pen.put_sign_of(value);
  const Characters digits = text_of(size->digits, decimals + 1);
  pen.put(decimals > 0 ? with_point(digits, 1) : digits, decimals > 0 ? decimals + 2 : 1);
  pen.put_exponent(size->exponent);
}

void append_general(DecimalText& text, double value, int digits) {
  const auto size = significant(std::abs(value), digits);
  const bool with_exponent = size && (size->exponent < -4 || size->exponent >= digits);
  const int places = !size || with_exponent ? 0 : size->exponent; // from first digit to last whole
  const int count = digits + std::max(0, -places);                // 0.00012 has zeros in front
  if (!size || count >= 16) {
    fmt::format_to(fmt::appender(text.characters()), "{:.{}g}", value, digits);
    return;
  }
  const Characters all = text_of(size->digits, count);
  const int whole = 1 + std::max(0, places);
  const int kept = std::max(whole, count - zeros_behind(all, count));
  Pen pen(text);
  pen.put_sign_of(value);
  pen.put(kept > whole ? with_point(all, whole) : all, kept > whole ? kept + 1 : kept);
  if (with_exponent) pen.put_exponent(size->exponent);
}

} // namespace goingrate
