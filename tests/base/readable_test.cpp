#include "base/readable.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace goingrate {
namespace {

TEST(ReadableTest, LargeNumbersStandInFull) {
  EXPECT_EQ(readable(1.97e4, 3), "19700");
  EXPECT_EQ(readable(19712.3, 3), "19700");
  EXPECT_EQ(readable(1234.0, 3), "1230");
  EXPECT_EQ(readable(9996.0, 3), "10000");
  EXPECT_EQ(readable(-1234567.0, 4), "-1235000");
  EXPECT_EQ(readable(100000.0, 3), "100000");
  EXPECT_EQ(readable(86399.5, 6), "86399.5");
  EXPECT_EQ(readable(9.99e8, 3), "999000000");
}

TEST(ReadableTest, OthersAreAsPrintfHasThem) {
  EXPECT_EQ(readable(0.0, 3), "0");
  EXPECT_EQ(readable(12.345, 3), "12.3");
  EXPECT_EQ(readable(1.5e-5, 3), "1.5e-05");
  EXPECT_EQ(readable(3e9, 3), "3e+09");
  EXPECT_EQ(readable(std::numeric_limits<double>::infinity(), 3), "inf");
  EXPECT_EQ(readable(std::nan(""), 3), "nan");
}

TEST(ReadableTest, ASignStandsBeforeEither) {
  EXPECT_EQ(readable_signed(2000.0, 3), "+2000");
  EXPECT_EQ(readable_signed(-25000.0, 3), "-25000");
  EXPECT_EQ(readable_signed(0.0, 3), "+0");
}

} // namespace
} // namespace goingrate
