#include "goingrate/base/instant.hpp"

#include "goingrate/base/errors.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <string>

namespace goingrate {
namespace {

TEST(InstantTest, ReadsUnixTimeToTheLastDigit) {
  const auto t = parse_instant("1361605080.2279906");
  ASSERT_TRUE(t);
  EXPECT_EQ(t->seconds, 1361605080);
  EXPECT_EQ(t->fraction,
            0.2279906); // the double nearest the text, which Unix time in one double is not
  EXPECT_EQ(format_instant(*t, 7), "1361605080.2279906");
}

TEST(InstantTest, ReadsWhatPeopleWrite) {
  for (const auto& [text, seconds, fraction] :
       std::initializer_list<std::tuple<const char*, std::int64_t, double>>{{"-1.25", -2, 0.75},
                                                                            {"+3", 3, 0.0},
                                                                            {"-4", -4, 0.0},
                                                                            {".5", 0, 0.5},
                                                                            {"7.", 7, 0.0},
                                                                            {"1.5e1", 15, 0.0},
                                                                            {"-2.5E-001", -1, 0.75},
                                                                            {"0", 0, 0.0},
                                                                            {"-0.0", 0, 0.0}}) {
    const auto t = parse_instant(text);
    ASSERT_TRUE(t) << text;
    EXPECT_EQ(t->seconds, seconds) << text;
    EXPECT_EQ(t->fraction, fraction) << text;
  }
}

TEST(InstantTest, RefusesWhatIsNoNumber) {
  for (const char* text : {"", "-", "+", ".", "1.2.3", "1,5", "12s", "nan", "inf", "--1", "1e400",
                           "0x10", "99999999999999999999", "1 2"})
    EXPECT_FALSE(parse_instant(text)) << text;
}

TEST(InstantTest, MillionTimesComeBack) {
  // Unix times with 12 decimals, read, written, subtracted from the one before and written: against
  // whole numbers of picoseconds.
  std::uint64_t state = 1;
  std::int64_t last_ps = 0;
  Instant last;
  for (int k = 0; k < 1000000; ++k) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    const auto step_ps = static_cast<std::int64_t>(state >> 22); // 0 to 4.4 s
    const std::int64_t now_ps = last_ps + step_ps;
    const auto text = [](std::int64_t ps, std::int64_t epoch) {
      return fmt::format("{}.{:012d}", epoch + ps / 1000000000000, ps % 1000000000000);
    };
    const std::string written = text(now_ps, 1361605080);
    const Instant now = *parse_instant(written);
    ASSERT_EQ(format_instant(now, 12), written);
    if (k > 0) {
      ASSERT_EQ(format_instant(Instant::from_seconds(now - last), 12), text(step_ps, 0)) << written;
    }
    last = now;
    last_ps = now_ps;
  }
}

TEST(InstantTest, ReadsEveryUnitExactly) {
  struct Case {
    const char* text;
    TimeUnit unit;
    char point;
    std::int64_t seconds;
    double fraction;
  };
  for (const Case& c : std::initializer_list<Case>{
           {"56345.9847248610", in_days, '.', 4868293080, 0.2279904}, // 0.9847248610 d
           {"56345,5", in_days, ',', 4868251200, 0.0},
           {"4294967296", in_microseconds, '.', 4294, 0.967296},
           {"1361605080227.9906", in_milliseconds, '.', 1361605080, 0.2279906},
           {"1361605080227990601", in_nanoseconds, '.', 1361605080, 0.227990601},
           {"2.5", in_minutes, '.', 150, 0.0},
           {"-0.25", in_hours, '.', -900, 0.0},
           {"12,25", in_seconds, ',', 12, 0.25},
           {"0.12345678901234567", in_seconds, '.', 0, 0.12345678901234567},
           {"1361605080.12345678901234567", in_seconds, '.', 1361605080, 0.12345678901234567},
           {"9.99999999999999999999", in_seconds, '.', 10, 0.0},
           {"1.361605080227990600e+09", in_seconds, '.', 1361605080, 0.2279906},
           {"1e-30", in_seconds, '.', 0, 1e-30},
           {"-1e-30", in_seconds, '.', 0, 0.0}}) {
    const auto t = parse_instant(c.text, c.unit, c.point);
    ASSERT_TRUE(t) << c.text;
    EXPECT_EQ(t->seconds, c.seconds) << c.text;
    EXPECT_EQ(t->fraction, c.fraction) << c.text;
  }
  EXPECT_FALSE(parse_instant("1.5", in_seconds, ','));
  EXPECT_FALSE(parse_instant("9e18", in_days));
}

TEST(InstantTest, NegativeTimesAreWrittenAsTheyWereRead) {
  for (const char* text : {"-0.000000800", "-1.999999999", "-5.000000000", "0.000000001"})
    EXPECT_EQ(format_instant(*parse_instant(text), 9), text);
}

TEST(InstantTest, RoundingCarriesIntoTheSeconds) {
  EXPECT_EQ(format_instant({41, 0.9999999}, 3), "42.000");
  EXPECT_EQ(format_instant({41, 0.6}, 0), "42");
}

TEST(InstantTest, DifferencesFarFromTheEpochKeepNanoseconds) {
  const Instant a = *parse_instant("1361605080.000000001");
  const Instant b = *parse_instant("1361605081.000000003");
  EXPECT_NEAR(b - a, 1.000000002, 1e-15); // two roundings of a number near one
}

TEST(InstantTest, ResidualKeepsDigits) {
  // After 1e8 periods of 2.000123 s a residual of 1e-9 s is still there to a part in 1e6.
  const double period = 2.000123;
  const std::int64_t n = 100000000;
  const boost::multiprecision::cpp_bin_float_quad exact =
      n * boost::multiprecision::cpp_bin_float_quad(period);
  const auto whole = static_cast<std::int64_t>(exact);
  const Instant origin{1700000000, 0.25};
  const Instant t =
      Instant{origin.seconds + whole, origin.fraction} + static_cast<double>(exact - whole) + 1e-9;
  // Two roundings of a fraction of a second.
  EXPECT_NEAR(residual_from_grid(t, origin, n, period), 1e-9, 2e-16);
}

TEST(InstantTest, AskingForTooManyDecimalsIsAnError) {
  EXPECT_THROW((void)format_instant({}, 18), ArgumentError);
}

TEST(InstantTest, DigitsAreThoseOfTheExactDecimalExpansion) {
  // Against the C library, which rounds the exact value of a double correctly.
  double fraction = 0.123456789;
  for (int i = 0; i < 20000; ++i) {
    fraction = std::fmod(fraction * 1103.515245 + 0.12345, 1.0);
    const double value = i % 5 == 0 ? std::ldexp(fraction, -(i % 70)) : fraction;
    for (const int decimals : {1, 6, 12, 15}) {
      char expected[40];
      std::snprintf(expected, sizeof expected, "%.*f", decimals, value);
      const bool carries = expected[0] == '1';
      const std::string text = format_instant(Instant{41, value}, decimals);
      ASSERT_EQ(text, (carries ? "42" : "41") + std::string(expected + 1)) << value;
    }
  }
  EXPECT_EQ(format_instant(Instant{7, 0.5}, 1), "7.5");
  EXPECT_EQ(format_instant(Instant{7, 0.125}, 2), "7.12"); // a tie, to even
  EXPECT_EQ(format_instant(Instant{7, 0.375}, 2), "7.38");
}

} // namespace
} // namespace goingrate
