#include "support/scratch_folder.hpp"
#include "support/weathered_logs.hpp"

namespace goingrate {
namespace {

using WeatherStudy = test::ScratchFolderTest;

TEST_F(WeatherStudy, ShortForm) {
  for (const test::Thermometer& thermometer : test::thermometers) {
    test::WeatherScore score;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      test::WeatheredLog log(thermometer, seed);
      score.add(log, path("w.csv"));
    }
    // 95 % of 20 less three standard deviations; the long form has the figures.
    EXPECT_GE(score.within95, 16) << thermometer.name;
    EXPECT_LT(score.z2 / score.logs, 2.0) << thermometer.name; // 1 and three standard deviations
  }
}

// Weather that is smooth between readings, as the simulator's is.
TEST_F(WeatherStudy, TenMinutesTellWhatEveryBeatTells) {
  constexpr test::Thermometer smooth{.name = "smooth", .wander_k = 0.0};
  test::WeatherScore score;
  for (std::uint64_t seed = 101; seed <= 115; ++seed) {
    test::WeatheredLog log(smooth, seed);
    score.add(log, path("w.csv"));
  }
  EXPECT_LT(score.worst_shift, 0.2); // sigma
}

} // namespace
} // namespace goingrate
