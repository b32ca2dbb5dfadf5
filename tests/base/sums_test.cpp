#include "goingrate/base/sums.hpp"

#include "goingrate/base/random.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(SumsTest, MillionTermsAgreeWithWiderArithmetic) {
  RandomStream random(1, StreamPurpose::jitter);
  TwoPart<double> sum;
  boost::multiprecision::cpp_bin_float_quad wide = 0;
  double plain = 0.0;
  for (int i = 0; i < 1000000; ++i) {
    const double term = 6.283185 + 1e-3 * random.normal();
    sum += term;
    wide += term;
    plain += term;
  }
  const auto error = static_cast<double>(sum.hi + (sum.lo - wide));
  EXPECT_LT(std::abs(error), 1e-18);                            // 1e6 roundings of 2^-106 of 6e6
  EXPECT_GT(std::abs(static_cast<double>(plain - wide)), 1e-9); // what the plain sum loses
}

TEST(SumsTest, ACancelledSumKeepsTheSmallPart) {
  TwoPart<double> sum{1e16, 0.0};
  sum += 1.25;
  sum += -1e16;
  EXPECT_EQ(sum.value(), 1.25);
}

} // namespace
} // namespace goingrate
