#include "support/sick_clocks.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

std::vector<Suspicion> found_in(const std::vector<Cause>& faults, std::uint64_t seed) {
  return test::suspected({faults, 1.0, seed});
}

class NamesTheCause : public testing::TestWithParam<Cause> {};

// A day of a clock drawn by its seed, with one fault: the short form of tests/studies/diagnosis. An
// even seed: amplitudes are in the log.
TEST_P(NamesTheCause, First) {
  const auto found = found_in({GetParam()}, 12);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].cause, GetParam()) << name_of(found[0].cause) << ": " << found[0].evidence;
}

INSTANTIATE_TEST_SUITE_P(DiagnosisTest, NamesTheCause,
                         testing::Values(Cause::slow_drive, Cause::drive_step, Cause::friction_step,
                                         Cause::growing_friction, Cause::temperature,
                                         Cause::pressure, Cause::length_step, Cause::wheel,
                                         Cause::sensor_shift, Cause::missed_beats));

class OwnsThatItCannotTell : public testing::TestWithParam<Cause> {};

TEST_P(OwnsThatItCannotTell, AmongTheAlternatives) {
  const auto found = found_in({GetParam()}, 12);
  EXPECT_TRUE(test::is_named(found, {GetParam()}, false))
      << (found.empty() ? "healthy" : found[0].evidence);
}

INSTANTIATE_TEST_SUITE_P(DiagnosisTest, OwnsThatItCannotTell,
                         testing::Values(Cause::length_drift, Cause::log_clock,
                                         Cause::unlogged_weather, Cause::knock, Cause::magnet,
                                         Cause::stop));

TEST(DiagnosisTest, NamesTheCause) { // along the whole road, in words, on one scale
  const auto found = test::diagnosed({{Cause::temperature}, 0.3, 3});
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].cause, Cause::temperature);
  EXPECT_NE(found[0].evidence.find("per K"), std::string::npos);
  for (std::size_t k = 1; k < found.size(); ++k)
    EXPECT_LE(found[k].gain, found[k - 1].gain);
}

TEST(DiagnosisTest, AHealthyClockIsCalledSo) {
  for (const std::uint64_t seed : {21U, 22U}) // 0.98 each
    EXPECT_TRUE(found_in({}, seed).empty()) << seed;
}

TEST(DiagnosisTest, WithAmplitudesNobodyIsToldToLookAtThem) {
  for (const Cause cause : {Cause::length_step, Cause::drive_step, Cause::growing_friction})
    for (const Suspicion& suspicion : found_in({cause}, 32))
      EXPECT_EQ(suspicion.advice.find("amplitudes"), std::string::npos) << suspicion.advice;
}

TEST(DiagnosisTest, AShortLogHasNoDiagnosis) {
  test::SickClock clock;
  clock.days = 0.01;
  EXPECT_TRUE(test::diagnosed(clock).empty());
}

} // namespace
} // namespace goingrate
