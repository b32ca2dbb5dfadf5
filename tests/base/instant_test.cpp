#include "goingrate/base/instant.hpp"

#include "goingrate/base/errors.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdio>
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

TEST(InstantTest, TwelveDecimalsSurviveReadingAndWriting) {
  for (int k = 0; k < 100000; ++k) {
    const std::string text = "1700000000." + std::to_string(100000000000 + 8999999LL * k);
    EXPECT_EQ(format_instant(*parse_instant(text), 12), text);
  }
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
  EXPECT_NEAR(residual_from_grid(t, origin, n, period), 1e-9, 1e-15);
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
