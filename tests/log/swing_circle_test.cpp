#include "log/swing_circle.hpp"

#include "goingrate/base/random.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace goingrate {
namespace {

struct Arc {
  std::vector<double> x, y;
};

Arc arc(double swing, double noise, std::uint64_t seed) {
  RandomStream error(seed, StreamPurpose::amplitude_noise);
  Arc result;
  for (int i = 0; i < 400; ++i) {
    const double angle = swing * std::sin(0.1 * i);
    result.x.push_back(3.0 + 0.8 * std::sin(angle) + noise * error.normal());
    result.y.push_back(5.0 - 0.8 * std::cos(angle) + noise * error.normal());
  }
  return result;
}

TEST(SwingCircleTest, FindsLengthAndCentre) {
  const Arc exact = arc(0.3, 0.0, 1);
  const auto circle = circle_through(exact.x, exact.y);
  ASSERT_TRUE(circle);
  // An arc of 0.3 rad tells its circle a hundred times worse than a rounding.
  EXPECT_NEAR(circle->radius, 0.8, 1e-13);
  EXPECT_NEAR(circle->x, 3.0, 1e-13); // likewise
  EXPECT_NEAR(circle->y, 5.0, 1e-13); // likewise
  // Likewise.
  EXPECT_NEAR(circle->angle_of(3.0 + 0.8 * std::sin(0.2), 5.0 - 0.8 * std::cos(0.2)), 0.2, 1e-13);
}

TEST(SwingCircleTest, SigmaCoversAndIsWithoutBias) {
  double z = 0.0, z2 = 0.0;
  constexpr int draws = 200;
  for (std::uint64_t seed = 1; seed <= draws; ++seed) {
    const Arc noisy = arc(0.3, 1e-3, seed);
    const auto circle = circle_through(noisy.x, noisy.y);
    ASSERT_TRUE(circle);
    z += (circle->radius - 0.8) / circle->radius_sigma / draws;
    z2 += std::pow((circle->radius - 0.8) / circle->radius_sigma, 2) / draws;
  }
  EXPECT_LT(std::abs(z), 0.3); // four standard deviations of a mean of 200
  EXPECT_NEAR(z2, 1.0, 0.4);   // four, of a mean of 200 squares: sqrt(2/200) each
}

TEST(SwingCircleTest, AFlatArcTellsNothing) {
  const Arc flat = arc(0.01, 1e-3, 1);
  EXPECT_FALSE(circle_through(flat.x, flat.y));
  EXPECT_FALSE(circle_through(std::vector<double>(20, 1.0), std::vector<double>(20, 2.0)));
}

} // namespace
} // namespace goingrate
