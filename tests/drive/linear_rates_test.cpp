#include "drive/linear_rates.hpp"

#include "drive/gain_spread.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/clock/parameters.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

namespace goingrate::timing_model {
namespace {

constexpr double period_s = 2.0;
constexpr ClockParameters point_b{2.0, 2.5e-4, 4e-5, 0.03};       // g_slow > 0
constexpr ClockParameters short_swing{2.0, 2.5e-4, 3.5e-5, 0.01}; // g_slow > 0
constexpr ClockParameters wide_swing{2.0, 5e-5, 1.41e-5, 0.02};   // g_slow < 0

struct Rates {
  std::vector<double> bent, linear;
};

// A drive for each period: white, and with a memory.
std::vector<double> made_drive(const RateComponents& drive, std::size_t periods,
                               std::uint64_t seed) {
  RandomStream stream(seed, StreamPurpose::jitter);
  const double memory = std::exp(-period_s / drive.memory_s);
  double slow = std::sqrt(drive.slow2) * stream.normal();
  std::vector<double> made;
  for (std::size_t k = 0; k < periods; ++k) {
    made.push_back(slow + std::sqrt(drive.fast2) * stream.normal());
    slow = memory * slow + std::sqrt((1.0 - memory * memory) * drive.slow2) * stream.normal();
  }
  return made;
}

void take_mean_away(std::vector<double>& values) {
  const double mean =
      std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (double& value : values)
    value -= mean;
}

// The averaged equations with a drive that is constant through each period, integrated in steps of
// a sixteenth of it: the rate as it is, and that of the linear response, each less its mean.
Rates made_by_the_equations(const DriveResponse& response, const std::vector<double>& drive) {
  const double x0 = response.amplitude2, phi2 = std::pow(response.switching_angle, 2);
  const double c = response.fast_gain * x0 / std::sqrt(x0 - phi2);
  constexpr int steps = 16;
  const double left = std::exp(-period_s / steps / relaxation_s(response));
  double x = x0;
  Rates rates;
  for (const double d : drive) {
    double bent = 0.0, linear = 0.0;
    for (int i = 0; i < steps; ++i) {
      const double goal = x0 * (1.0 + d), middle = goal + (x - goal) * std::sqrt(left);
      bent += (c * (1.0 + d) * std::sqrt(middle - phi2) / middle - middle / 16.0) / steps;
      linear += (response.fast_gain * d +
                 (response.slow_gain - response.fast_gain) * (middle / x0 - 1.0)) /
                steps;
      x = goal + (x - goal) * left;
    }
    rates.bent.push_back(bent);
    rates.linear.push_back(linear);
  }
  take_mean_away(rates.bent);
  take_mean_away(rates.linear);
  return rates;
}

double rms(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values)
    sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double rms_of_difference(std::span<const double> a, std::span<const double> b) {
  std::vector<double> difference(a.begin(), a.end());
  for (std::size_t i = 0; i < b.size(); ++i)
    difference[i] -= b[i];
  return rms(difference);
}

TEST(LinearRatesTest, UndoesTheBendOfTheResponse) {
  for (const ClockParameters& clock : {short_swing, wide_swing}) {
    const DriveResponse response = *drive_response(clock);
    // So far from the switching angle the white part tells nothing of the mean drive: it is taken
    // to be zero, which here it is.
    const RateComponents drive{0.09, 0.04, 0.0, 0.3 * relaxation_s(response)};
    std::vector<double> made = made_drive(drive, 200000, 1);
    take_mean_away(made);
    const Rates rates = made_by_the_equations(response, made);
    const auto found = linear_rates(rates.bent, period_s, response, drive);
    ASSERT_TRUE(found);
    // The amplitude at the ends is not known; what it spoils has died out ten relaxations inside.
    const auto inside = [&](const std::vector<double>& all) {
      const auto ends = static_cast<std::ptrdiff_t>(10.0 * relaxation_s(response) / period_s);
      std::vector<double> some(all.begin() + ends, all.end() - ends);
      take_mean_away(some);
      return some;
    };
    const auto bent = inside(rates.bent), linear = inside(rates.linear),
               undone = inside(found->rates);
    EXPECT_GT(rms_of_difference(bent, linear), 0.02 * rms(linear));
    // The mean amplitude of a log is that of its mean drive but for its ends, 1e-3 of it.
    EXPECT_LT(rms_of_difference(undone, linear), 1e-3 * rms(linear));
  }
}

std::vector<double> means_of_blocks(std::span<const double> values, std::size_t length) {
  std::vector<double> means;
  for (std::size_t i = 0; i + length <= values.size(); i += length)
    means.push_back(std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(i),
                                    values.begin() + static_cast<std::ptrdiff_t>(i + length), 0.0) /
                    static_cast<double>(length));
  return means;
}

void add_jitter(std::vector<double>& rates, double rms_s, std::uint64_t seed) {
  RandomStream stream(seed, StreamPurpose::spurious);
  double before = rms_s * stream.normal();
  for (double& rate : rates) {
    const double now = rms_s * stream.normal();
    rate += (now - before) / period_s;
    before = now;
  }
}

struct Spread {
  double sum = 0.0, squares = 0.0;
  int n = 0;

  void add(double z) { sum += z, squares += z * z, ++n; }
  // 1, and three standard errors of 20; the equations' own error is part of what z is measured in,
  // and is not made here, so it may be less.
  void expect_as_said() const {
    EXPECT_NEAR(sum / n, 0.0, 0.7);
    EXPECT_LT(std::sqrt(squares / n), 1.5);
    EXPECT_GT(std::sqrt(squares / n), 0.4);
  }
};

TEST(LinearRatesTest, KnowsTheMeanDriveAsWellAsItSays) {
  const DriveResponse response = *drive_response(point_b);
  for (const RateComponents& drive :
       {RateComponents{0.09, 0.01, 0.0, 6370.0}, RateComponents{9e-4, 0.01, 0.0, 6370.0},
        RateComponents{0.09, 0.01, 2.5e-9, 6370.0}}) {
    Spread fast, slow;
    constexpr int logs = 20;
    for (std::uint64_t seed = 1; seed <= logs; ++seed) {
      Rates rates = made_by_the_equations(response, made_drive(drive, 100000, seed));
      add_jitter(rates.bent, std::sqrt(drive.jitter2), seed);
      const auto found = linear_rates(rates.bent, period_s, response, drive);
      ASSERT_TRUE(found);
      const GainDoubt doubt = gain_doubt(response, found->mean_drive_rms, drive.memory_s);
      const double slow_error =
          rms(means_of_blocks(found->rates, 2500)) / rms(means_of_blocks(rates.linear, 2500)) - 1.0;
      slow.add(slow_error / doubt.slow);
      const double fast_error = rms(found->rates) / rms(rates.linear) - 1.0; // fast, nearly all
      if (drive.jitter2 == 0.0 && drive.fast2 > drive.slow2) fast.add(fast_error / doubt.fast);
    }
    SCOPED_TRACE(std::to_string(drive.fast2) + " " + std::to_string(drive.jitter2));
    slow.expect_as_said();
    if (fast.n > 0) fast.expect_as_said();
  }
}

TEST(LinearRatesTest, NothingWhereTheResponseIsLinearOrTheEquationsDoNotHold) {
  const DriveResponse response = *drive_response(point_b);
  const RateComponents small{0.09, 1e-6, 0.0, 637.0};
  const Rates rates = made_by_the_equations(response, made_drive(small, 2000, 1));
  EXPECT_FALSE(linear_rates(rates.bent, period_s, response, small));
  const RateComponents drive{0.09, 0.01, 0.0, 637.0};
  EXPECT_TRUE(linear_rates(rates.bent, period_s, response, drive));
  std::vector<double> stopping = rates.bent;
  for (std::size_t i = stopping.size() - 10; i < stopping.size(); ++i)
    stopping[i] = 3e-3 * static_cast<double>(i % 2); // as of swings that miss the switching angle
  EXPECT_FALSE(linear_rates(stopping, period_s, response, drive));
  std::vector<double> other = rates.bent; // slower for half of the log than any drive can make it
  for (std::size_t i = 0; i < other.size() / 2; ++i)
    other[i] -= 1e-3;
  EXPECT_FALSE(linear_rates(other, period_s, response, drive));
  DriveResponse flat = response;
  flat.slow_gain = 0.0;
  EXPECT_FALSE(linear_rates(rates.bent, period_s, flat, drive));
  DriveResponse unknown = response;
  unknown.amplitude2 = 0.0;
  EXPECT_FALSE(linear_rates(rates.bent, period_s, unknown, drive));
}

} // namespace
} // namespace goingrate::timing_model
