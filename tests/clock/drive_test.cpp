#include "goingrate/clock/drive.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace goingrate {
namespace {

struct Moments {
  double mean = 0.0, rms = 0.0, lag = 0.0; // lag: autocorrelation at the asked distance
};

Moments measure(const DriveVariability& drive, std::size_t n, std::size_t lag) {
  DriveSequence sequence(drive, 2.0, 42);
  std::vector<double> d(n);
  for (double& x : d)
    x = sequence.next(0.0) - 1.0;
  Moments m;
  for (const double x : d)
    m.mean += x / static_cast<double>(n);
  for (const double x : d)
    m.rms += x * x / static_cast<double>(n);
  for (std::size_t i = lag; i < n; ++i)
    m.lag += d[i] * d[i - lag] / static_cast<double>(n);
  m.lag /= m.rms;
  m.rms = std::sqrt(m.rms);
  return m;
}

TEST(DriveTest, WithoutVariabilityTheFactorIsOne) {
  DriveSequence sequence({}, 2.0, 1);
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(sequence.next(0.0), 1.0);
}

TEST(DriveTest, FastDriveIsWhiteWithItsRms) {
  const Moments m = measure({0.3, 0.0, 0.0}, 200000, 1);
  EXPECT_NEAR(m.mean, 0.0, 4 * 0.3 / std::sqrt(2e5)); // four standard errors, here and below
  EXPECT_NEAR(m.rms, 0.3, 4 * 0.3 / std::sqrt(4e5));
  EXPECT_NEAR(m.lag, 0.0, 4 / std::sqrt(2e5));
}

TEST(DriveTest, SlowDriveHasItsRmsAndItsTime) {
  // 50 periods of 2 s in a correlation time of 100 s: some 2000 independent values.
  const Moments m = measure({0.0, 0.1, 100.0}, 200000, 50);
  EXPECT_NEAR(m.rms, 0.1, 4 * 0.1 / std::sqrt(2.0 * 2000));
  EXPECT_NEAR(m.lag, std::exp(-1.0), 4 / std::sqrt(2000.0));
}

TEST(DriveTest, ASeedGivesTheSameDrawsAlwaysAndAnotherSeedOthers) {
  DriveSequence a({0.3, 0.1, 50.0}, 2.0, 7), b({0.3, 0.1, 50.0}, 2.0, 7),
      c({0.3, 0.1, 50.0}, 2.0, 8);
  int equal = 0;
  for (int i = 0; i < 100; ++i) {
    const double x = a.next(0.0);
    EXPECT_EQ(x, b.next(0.0));
    equal += x == c.next(0.0) ? 1 : 0;
  }
  EXPECT_EQ(equal, 0);
}

TEST(DriveTest, FirstDrawsArePinnedSoThatLogsStayReproducible) {
  RandomStream random(1, StreamPurpose::fast_drive);
  const double first = random.normal();
  RandomStream again(1, StreamPurpose::fast_drive);
  EXPECT_EQ(first, again.normal());
  EXPECT_NEAR(first, 2.9263274551075198,
              1e-15); // recorded; Boost promises the same on any compiler
}

TEST(DriveTest, RefusesValuesOutOfRange) {
  EXPECT_THROW(check(DriveVariability{-0.1, 0.0, 0.0}), ArgumentError);
  EXPECT_THROW(check(DriveVariability{0.0, 0.1, 0.0}), ArgumentError);
  EXPECT_THROW(check(DriveVariability{NAN, 0.0, 0.0}), ArgumentError);
}

} // namespace
} // namespace goingrate
