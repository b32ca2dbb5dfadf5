// What is read out of a stability table.
#include "spectra/stability_reading.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"

namespace goingrate {
namespace {

DeviationRow row(std::size_t m, double value, int alpha) {
  return {static_cast<double>(m), m, 1000, value, 0.9 * value, 1.1 * value, alpha, true};
}

TEST(StabilityReading, PartsATableByNoise) {
  DeviationTable table{DeviationKind::oadev, 1.0, {}};
  table.rows = {row(1, 8.0, 2),  row(2, 4.0, 2),   row(4, 2.0, 2),
                row(8, 2.0, -1), row(16, 2.8, -2), row(32, 4.0, -2)};
  table.rows[1].alpha = 2;
  const auto regions = slope_regions(table);
  ASSERT_EQ(regions.size(), 3u);
  EXPECT_EQ(regions[0].to_s, 4.0);
  EXPECT_NEAR(regions[0].slope, -1.0, 1e-12); // halves as tau doubles, but for roundings
  EXPECT_TRUE(std::isnan(regions[1].slope));
  EXPECT_EQ(regions[2].alpha, -2);
  table.rows[1].interval = false;
  EXPECT_EQ(slope_regions(table).size(), 4u);
}

TEST(StabilityReading, ASlopeThatIsNoNoises) {
  const auto region = [](double slope, int alpha) { return SlopeRegion{1.0, 2.0, slope, alpha}; };
  EXPECT_TRUE(may_be_noise(region(-0.55, 0), DeviationKind::oadev));
  EXPECT_FALSE(may_be_noise(region(0.38, 0), DeviationKind::oadev));
  EXPECT_FALSE(may_be_noise(region(-1.0, -1), DeviationKind::oadev));
  EXPECT_FALSE(may_be_noise(region(-1.0, 2), DeviationKind::mdev));
  EXPECT_TRUE(may_be_noise(region(-1.4, 2), DeviationKind::mdev));
  EXPECT_TRUE(may_be_noise(region(-0.4, 2), DeviationKind::tdev));
  EXPECT_TRUE(may_be_noise(region(0.9, -3), DeviationKind::hdev));
  EXPECT_TRUE(may_be_noise(region(1.0, 0), DeviationKind::mtie)) << "it has no slope of its own";
  EXPECT_TRUE(may_be_noise(region(NAN, 0), DeviationKind::oadev)) << "one row";
}

TEST(StabilityReading, FindsTheJitterPutIn) {
  RandomStream stream(5, StreamPurpose::jitter);
  std::vector<double> phase(20000);
  for (double& x : phase)
    x = 1e-6 * stream.normal();
  for (const DeviationKind kind : {DeviationKind::oadev, DeviationKind::ohdev, DeviationKind::mdev,
                                   DeviationKind::tdev, DeviationKind::totdev}) {
    const auto jitter = jitter_of(stability_table(kind, phase, 2.0, octave_factors(20000, kind)));
    ASSERT_TRUE(jitter);
    EXPECT_NEAR(*jitter, 1e-6, 3e-8); // three standard errors of an rms of 20000 correlated values
  }
  EXPECT_FALSE(jitter_of({DeviationKind::oadev, 1.0, {}}));
  EXPECT_FALSE(jitter_of({DeviationKind::oadev, 1.0, {row(1, 1.0, 0)}}));
}

TEST(StabilityReading, PredictsTheTimeErrorOfARandomWalk) {
  DeviationTable table{
      DeviationKind::oadev, 1.0, {row(1, 1.0, 0), row(4, 0.5, 0), row(16, 0.25, 0)}};
  // white rate of unit variance a second: the time error is a walk, sqrt of the time
  const auto within = predict_time_error(table, 9.0);
  ASSERT_TRUE(within);
  EXPECT_NEAR(within->error_s, 3.0, 1e-12); // roundings of logarithms, here and below
  EXPECT_FALSE(within->extrapolated);
  const auto beyond = predict_time_error(table, 100.0);
  EXPECT_NEAR(beyond->error_s, 10.0, 1e-11);
  EXPECT_TRUE(beyond->extrapolated);
  EXPECT_EQ(beyond->from_tau_s, 16.0);
  table.rows.back().n = 31; // less than two spans: not believed
  EXPECT_EQ(predict_time_error(table, 100.0)->from_tau_s, 4.0);
  EXPECT_FALSE(predict_time_error(table, 0.5));
  table.rows[1].alpha = -1;
  EXPECT_NEAR(predict_time_error(table, 100.0)->k, 1.2011224087864498, 1e-12); // 1/sqrt(ln 2)
  table.kind = DeviationKind::mtie;
  EXPECT_FALSE(predict_time_error(table, 9.0));
  EXPECT_THROW((void)predict_time_error(table, 0.0), ArgumentError);
}

} // namespace
} // namespace goingrate
