#include "goingrate/dynamics/stationary.hpp"

#include "base/scaled_time.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

// Exact values: 128-bit arithmetic, switching angles located exactly (two independent programs).
struct Point {
  const char* name;
  double epsilon, mu;
  double rate, rate_first_order, period, velocity;
  double fast_gain, slow_gain;
};

constexpr Point A{"A",
                  2.5e-4,
                  2e-5,
                  1.133264436573979e-04,
                  1.133210552128862e-04,
                  6.28247333681895235959,
                  0.0390886300401325117257,
                  2.08814e-4,
                  1.58569e-4};
constexpr Point B{"B",
                  2.5e-4,
                  4e-5,
                  1.960046634308295e-04,
                  1.959334278327624e-04,
                  6.28195401489720860185,
                  0.0552840336990741440991,
                  3.86919e-4,
                  8.32399e-5};
constexpr Point C{"C",
                  1.167245e-4,
                  1.5e-5,
                  1.844068077230375e-08,
                  -3.468305925583591e-11,
                  6.28318519131337413068,
                  0.0495414393471760923604,
                  1.53395e-4,
                  -3.22871e-5};

ClockParameters clock_at(const Point& p) { return {two_pi, p.epsilon, p.mu, 0.03}; }

class StationaryTest : public testing::TestWithParam<Point> {};

TEST_P(StationaryTest, LimitCycleMatchesExactValues) {
  const auto cycle = limit_cycle(clock_at(GetParam()));
  ASSERT_TRUE(cycle);
  EXPECT_NEAR(cycle->rate_excess, GetParam().rate, 1e-15);  // a few roundings of the period
  EXPECT_NEAR(cycle->period, GetParam().period, 4e-15);     // likewise
  EXPECT_NEAR(cycle->velocity, GetParam().velocity, 2e-17); // three roundings of 0.05
}

TEST_P(StationaryTest, FirstOrderRateDiffersFromTheExactOneAsTabulated) {
  const auto rate = stationary_rate_first_order(clock_at(GetParam()));
  ASSERT_TRUE(rate);
  EXPECT_NEAR(*rate, GetParam().rate_first_order, 1e-18); // the table's last digit
}

TEST_P(StationaryTest, DriveResponseMatchesExactGains) {
  const auto response = drive_response(clock_at(GetParam()));
  ASSERT_TRUE(response);
  EXPECT_NEAR(response->fast_gain, GetParam().fast_gain, 1e-3 * GetParam().fast_gain);
  EXPECT_NEAR(response->slow_gain, GetParam().slow_gain, 1e-3 * std::abs(GetParam().slow_gain));
}

TEST_P(StationaryTest, SlowGainIsTheDerivativeOfTheStationaryRate) {
  ClockParameters clock = clock_at(GetParam());
  constexpr double h = 1e-4;
  clock.mu = GetParam().mu * (1 + h);
  const double up = *stationary_rate_first_order(clock);
  clock.mu = GetParam().mu * (1 - h);
  const double down = *stationary_rate_first_order(clock);
  EXPECT_NEAR(drive_response(clock_at(GetParam()))->slow_gain, (up - down) / (2 * h), 1e-11); // h^2
}

TEST_P(StationaryTest, ResponseGoesFromSlowToFastThroughTheCorner) {
  const auto r = *drive_response(clock_at(GetParam()));
  EXPECT_NEAR(r.at(0.0).real(), r.slow_gain, 1e-19); // a few roundings of 1.6e-4
  // The slow part is 1e-12 of 3e-4 there.
  EXPECT_NEAR(r.at(1e6 * r.corner_hz).real(), r.fast_gain, 1e-15);
  // A few roundings.
  EXPECT_NEAR(r.at(r.corner_hz).real(), 0.5 * (r.fast_gain + r.slow_gain), 1e-19);
}

INSTANTIATE_TEST_SUITE_P(Points, StationaryTest, testing::Values(A, B, C),
                         [](const auto& scene) { return scene.param.name; });

TEST(StallLineTest, BelowItThereIsNoStationarySwing) {
  ClockParameters clock{2.0, 2.5e-4, 0.0, 0.03};
  const double stall = 0.5 * std::numbers::pi * clock.epsilon * clock.phi0; // sec. statop
  clock.mu = stall * 0.999;
  EXPECT_FALSE(stationary_amplitude(clock));
  EXPECT_FALSE(limit_cycle(clock));
  EXPECT_FALSE(drive_response(clock));
  clock.mu = stall * 1.05;
  EXPECT_TRUE(stationary_amplitude(clock));
  EXPECT_TRUE(limit_cycle(clock));
}

TEST(StallLineTest, AFreePendulumHasNone) {
  EXPECT_FALSE(limit_cycle({2.0, 2.5e-4, 2e-5, 0.03, Escapement::none}));
  EXPECT_FALSE(limit_cycle({2.0, 0.0, 2e-5, 0.03}));
}

TEST(StationaryTest, ADriveThatFrictionNeverBalancesHasNoRest) {
  ClockParameters clock{2.0, 1e-12, 1e-3, 0.03};
  clock.quadratic_drag = 1e-9;
  EXPECT_FALSE(stationary_amplitude(clock));
}

} // namespace
} // namespace goingrate
