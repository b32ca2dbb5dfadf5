#include "base/decimal.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>

namespace goingrate {
namespace {

std::string printed(const char* format, int digits, double value) {
  std::array<char, 512> text{}; // 309 digits, 17 decimals
  std::snprintf(text.data(), text.size(), format, digits, value);
  return text.data();
}

void expect_as_printf(double value) {
  for (int digits = 0; digits <= 17; ++digits) {
    DecimalText fixed, scientific, general;
    append_fixed(fixed, value, digits);
    append_scientific(scientific, value, digits);
    append_general(general, value, digits + 1);
    ASSERT_EQ(fixed.view(), printed("%.*f", digits, value));
    ASSERT_EQ(scientific.view(), printed("%.*e", digits, value));
    ASSERT_EQ(general.view(), printed("%.*g", digits + 1, value));
  }
}

TEST(DecimalTest, IsWhatPrintfWrites) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-24.0, 24.0);
  for (int i = 0; i < 20000; ++i) {
    const double value = (i % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, exponent(random));
    expect_as_printf(value);
    expect_as_printf(std::bit_cast<double>(random())); // of any size, NaN and infinities too
  }
}

// A tie, and its two neighbours, which must not be taken for it.
TEST(DecimalTest, TiesGoToTheEvenDigit) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::mt19937_64 random(2);
  for (int i = 0; i < 5000; ++i) {
    const double units = std::ldexp(1.0, -static_cast<int>(random() % 12));
    const double tie = (static_cast<double>(random() % 100000) + 0.5) * units;
    for (const double value : {tie, std::nextafter(tie, 0.0), std::nextafter(tie, infinity)})
      expect_as_printf(value);
  }
}

TEST(DecimalTest, RoundingMayAddADigit) {
  for (const double value : {0.0, -0.0, 9.5, 99.5, 999999.5, 0.99999999999999, 9999999999999.9,
                             99999999999999.5, 1e14, 1e15, 1e22, 1e-22, 5e-324})
    expect_as_printf(value);
}

TEST(DecimalTest, WholeNumbers) {
  const auto written = [](std::int64_t value) {
    DecimalText text;
    append_integer(text, value);
    return std::string(text.view());
  };
  EXPECT_EQ(written(std::numeric_limits<std::int64_t>::min()), "-9223372036854775808");
  EXPECT_EQ(written(std::numeric_limits<std::int64_t>::max()), "9223372036854775807");
  std::int64_t power = 1;
  for (int digits = 0; digits < 18; ++digits, power *= 10)
    for (const std::int64_t value : {power - 1, power, -power, 7 * power + 5})
      EXPECT_EQ(written(value), std::to_string(value));
  DecimalText text;
  append_digits(text, 1234, 7);
  append_digits(text, 12345678901234567, 19);
  EXPECT_EQ(text.view(), "00012340012345678901234567");
}

} // namespace
} // namespace goingrate
