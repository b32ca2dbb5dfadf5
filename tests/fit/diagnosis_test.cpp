#include "support/sick_clocks.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

class NamesTheCause : public testing::TestWithParam<Cause> {};

// Two days of a clock with one fault: the short form of tests/studies/diagnosis.
TEST_P(NamesTheCause, First) {
  test::SickClock clock;
  clock.cause = GetParam();
  clock.periods = 86400;
  clock.seed = 3;
  const auto found = test::diagnosed(clock);
  ASSERT_FALSE(found.empty());
  const bool among_two =
      found[0].cause == clock.cause || (found.size() > 1 && found[1].cause == clock.cause);
  EXPECT_TRUE(among_two) << name_of(found[0].cause) << ": " << found[0].evidence;
}

INSTANTIATE_TEST_SUITE_P(DiagnosisTest, NamesTheCause,
                         testing::Values(Cause::slow_drive, Cause::drive_step,
                                         Cause::growing_friction, Cause::temperature,
                                         Cause::pressure, Cause::length_step, Cause::wheel,
                                         Cause::sensor_shift, Cause::missed_beats,
                                         Cause::rough_drive));

TEST(DiagnosisTest, NamesTheCause) { // the strongest first, and in words
  test::SickClock clock;
  clock.cause = Cause::temperature;
  clock.periods = 86400;
  const auto found = test::diagnosed(clock);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].cause, Cause::temperature);
  EXPECT_NE(found[0].evidence.find("per K"), std::string::npos);
}

TEST(DiagnosisTest, AHealthyClockIsCalledSo) {
  int healthy = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    test::SickClock clock;
    clock.periods = 86400;
    clock.seed = seed;
    healthy += test::diagnosed(clock).empty() ? 1 : 0;
  }
  EXPECT_GE(healthy, 4); // 0.95 each
}

TEST(DiagnosisTest, AShortLogHasNoDiagnosis) {
  test::SickClock clock;
  clock.periods = 1500;
  EXPECT_TRUE(test::diagnosed(clock).empty());
}

} // namespace
} // namespace goingrate
