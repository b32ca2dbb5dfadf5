#include "causes/rate_step.hpp"
#include "goingrate/log/writing.hpp"
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
      EXPECT_EQ(suspicion.advice.find("amplitude"), std::string::npos) << suspicion.advice;
}

TEST(DiagnosisTest, FrictionThatGrewIsToldWhatHelps) {
  Change change{5000, 1e4};
  change.kind = ChangeKind::friction;
  const auto advice = [&](double slope) {
    change.amplitude_slope_change = slope;
    DiagnosisInput input;
    input.explained = {change};
    return diagnose(input).at(0).advice;
  };
  EXPECT_NE(advice(-1e-6).find("clean and oil it, and look for what rubs."), std::string::npos);
  for (const double slope : {1e-6, double(NAN)}) // it swings more freely; or nobody knows
    EXPECT_EQ(advice(slope), "What was done to the clock then?");
}

// A log of times in which beats are lost and the regulation changes; `swing` of the rate either way
// comes and goes as weather does.
std::string regulated(double period_s, double ppm, double jitter_s, double lost, std::uint64_t seed,
                      double swing = 0.0) {
  RandomStream jitter(seed, StreamPurpose::jitter), missed(seed, StreamPurpose::amplitude_noise);
  constexpr int beats = 3000, changed = 1800;
  std::string lines;
  double t = 12.0;
  for (int i = 0; i < beats; ++i) {
    if (!(missed.uniform() < lost))
      lines += fmt::format("{:.5f}\n", t + jitter_s * jitter.normal());
    const double weather = swing * std::sin(1.0 * i / beats + static_cast<double>(seed));
    t += period_s * (1.0 - weather - (i < changed ? 0.0 : 1e-6 * ppm));
  }
  return lines;
}

TEST(DiagnosisTest, DiaryAndCausesJudgeAChangeOnce) {
  for (const std::uint64_t seed : {31U, 32U, 33U, 34U}) {
    const double ppm = seed % 2 == 0 ? 40.0 : -40.0;
    LoadRequest request;
    request.path = "regulated.txt";
    const Analysis data =
        analyse(load_text(regulated(1.7321, ppm, 3e-5, 0.01, seed), request), AnalysisRequest{});
    ASSERT_EQ(data.diary.changes.size(), 1U) << seed;
    const Change& change = data.diary.changes[0];
    EXPECT_EQ(change.kind, ChangeKind::regulation) << seed;
    constexpr double most = 4.0; // sigma, of four logs
    EXPECT_NEAR(change.rate_change, 1e-6 * ppm, most * change.rate_change_sigma) << seed;
    EXPECT_LT(change.rate_change_sigma, 2e-8) << seed; // a thousand beats on either side of 3e-5 s
    ASSERT_EQ(data.suspicions.size(), 2U) << seed;     // what was done to it, and no other
    EXPECT_EQ(data.suspicions[0].cause, Cause::length_step) << seed;
    EXPECT_EQ(data.suspicions[1].cause, Cause::missed_beats) << seed;
  }
}

// With beats lost at random many are missing in pairs, and every one counts.
TEST(DiagnosisTest, TheShareOfMissedBeatsIsThatOfAllBeats) {
  for (const double lost : {0.04, 0.25, 0.38}) {
    LoadRequest request;
    request.path = "missed.txt";
    const Analysis data = analyse(load_text(regulated(1.9, 0.0, 3e-5, lost, 77U), request), {});
    const auto found =
        std::find_if(data.suspicions.begin(), data.suspicions.end(),
                     [](const Suspicion& one) { return one.cause == Cause::missed_beats; });
    ASSERT_NE(found, data.suspicions.end()) << lost;
    const auto missed = static_cast<double>(data.numbered.missed);
    const auto all = missed + static_cast<double>(data.rate.crossings);
    EXPECT_NEAR(found->numbers.size, missed / all, 1e-12) << "a quotient of whole numbers";
    EXPECT_NEAR(found->numbers.size, lost, 4.0 * std::sqrt(lost * (1.0 - lost) / all)); // 4 sigma
    EXPECT_LT(static_cast<double>(found->numbers.places), missed);
  }
}

// The mean rates before and after have the weather's part in them; the jump, known where it is one
// of the regulation, has not.
TEST(DiagnosisTest, AJumpIsToldWithoutTheWeathersPart) {
  double known = 0.0, off2 = 0.0, of_means2 = 0.0;
  for (const std::uint64_t seed : {51U, 52U, 53U, 54U, 55U, 56U}) {
    LoadRequest request;
    request.path = "regulated.txt";
    const NumberedLog log = load_text(regulated(1.3, 140.0, 3e-5, 0.0, seed, 3e-5), request);
    const Diary diary = diary_of(log, fit_data(log));
    ASSERT_EQ(diary.changes.size(), 1U) << seed;
    const Change& change = diary.changes[0];
    if (change.kind != ChangeKind::regulation) continue;
    const RateStep step = step_of(change);
    ++known;
    off2 += std::pow((step.rate - 140e-6) / step.sigma, 2);
    of_means2 += std::pow((change.rate_after - change.rate_before - 140e-6) / step.sigma, 2);
  }
  ASSERT_GE(known, 4.0);
  EXPECT_LT(off2 / known, 3.3);       // one in a hundred by chance, of four
  EXPECT_GT(of_means2 / known, 10.0); // or the scene would tell nothing
}

// Thirty beats on either side of it do not show it, the course of the whole log does.
TEST(DiagnosisTest, AChangeBelowTheJitterIsInTheDiary) {
  for (const std::uint64_t seed : {41U, 42U, 43U, 44U}) {
    LoadRequest request;
    request.path = "regulated.txt";
    const NumberedLog log = load_text(regulated(1.0043, 28.0, 4e-4, 0.0, seed), request);
    EXPECT_TRUE(keep_diary(log.good, log.nominal_period_s).changes.empty()) << seed;
    const Diary diary = diary_of(log, fit_data(log));
    ASSERT_EQ(diary.changes.size(), 1U) << seed;
    const Change& change = diary.changes[0];
    EXPECT_EQ(change.kind, ChangeKind::regulation) << seed;
    constexpr double most = 4.0; // sigma, of four logs
    EXPECT_NEAR(change.rate_change, 28e-6, most * change.rate_change_sigma) << seed;
    constexpr double sigma = 4e-4 / 28e-6; // beats over which it grows to the jitter
    EXPECT_NEAR(static_cast<double>(change.cycle), 1800.0, most * sigma) << seed;
  }
}

// Steady for half of the log, then slower and slower: when it began, and how fast it goes on.
TEST(DiagnosisTest, ADriftThatBeginsWithinTheLogIsDated) {
  for (const std::uint64_t seed : {51U, 53U}) {
    RandomStream random(seed, StreamPurpose::jitter);
    constexpr int beats = 20000, onset = 11000;
    constexpr double period_s = 2.0, slope = -2e-4 / beats; // of the rate, per beat
    std::string text;
    double late_s = 0.0;
    for (int i = 0; i < beats; ++i) {
      text += fmt::format("{:.6f}\n", period_s * i + late_s + 1e-4 * random.normal());
      late_s += period_s * (5e-5 - slope * std::max(0, i - onset)) + 3e-5 * random.normal();
    }
    LoadRequest request;
    request.path = "fading.txt";
    request.reading.nominal_period_s = period_s;
    const Analysis analysis = analyse(load_text(text, request), {});
    ASSERT_FALSE(analysis.suspicions.empty()) << seed;
    const Suspicion& first = analysis.suspicions.front();
    EXPECT_EQ(first.cause, Cause::growing_friction) << seed;
    EXPECT_NEAR(first.numbers.at_s, period_s * onset, 0.05 * period_s * beats) << seed;
    EXPECT_NEAR(first.numbers.size, slope * 86400.0 / period_s, 4.0 * first.numbers.sigma) << seed;
  }
}

// Within a day a lag and its memory follow any drift: the drift is an alternative.
TEST(DiagnosisTest, ALagOfADayIsNotToldFromADrift) {
  for (const std::uint64_t seed : {142000440U, 142000443U, 142000451U}) {
    const auto found = test::suspected({{Cause::length_drift}, 1.0, seed});
    EXPECT_TRUE(test::is_named(found, {Cause::length_drift}, false)) << seed;
  }
}

// A rod that is warm before its compensation: two days, a drive that is white.
TEST(DiagnosisTest, ACompensationThatLagsIsTemperature) {
  Scenario scenario;
  scenario.clock = {2.0, 1.2e-4, 1.5e-5, 0.03};
  scenario.periods = 86400;
  scenario.length.temperature_coefficient = 12e-6;
  scenario.length.compensation = 11e-6;
  scenario.length.compensation_lag_s = 7000.0;
  scenario.temperature.sines = {{1.5, 86400.0}, {1.5, 50000.0}};
  scenario.sensor.jitter_rms_s = 1e-4;
  scenario.drive.fast_rms = 0.05;
  scenario.sensor.temperature_rms = 0.05;
  for (const std::uint64_t seed : {51U, 52U, 53U}) {
    const auto found = test::suspected_in(native_log_text(test::simulated_log(scenario, seed), 6));
    ASSERT_EQ(found.size(), 1U) << seed;
    EXPECT_EQ(found[0].cause, Cause::temperature) << seed << ": " << found[0].evidence;
    EXPECT_NE(found[0].evidence.find("is immediate"), std::string::npos) << found[0].evidence;
  }
}

// The times leave their line in a bend over hundreds of beats, not in a jump.
TEST(DiagnosisTest, AStepOfTheDriveIsNoShiftOfTheSensor) {
  Scenario scenario;
  scenario.clock = {0.9, 1e-3, 1.5e-4, 0.03};
  scenario.periods = 1500;
  scenario.sensor.jitter_rms_s = 5e-5;
  ClockEvent event;
  event.at_period = 900;
  event.mu = 1.65e-4;
  scenario.events = {event};
  for (const std::uint64_t seed : {31U, 32U, 33U, 34U}) {
    const std::string text = native_log_text(test::simulated_log(scenario, seed), 6);
    const auto found = analyse(load_text(text, LoadRequest{}), AnalysisRequest{}).suspicions;
    ASSERT_FALSE(found.empty()) << seed;
    EXPECT_EQ(found[0].cause, Cause::drive_step) << seed;
    for (const Suspicion& suspicion : found)
      EXPECT_NE(suspicion.cause, Cause::sensor_shift) << seed << ": " << suspicion.evidence;
  }
}

TEST(DiagnosisTest, OneBreakOfTheLogIsNoFaultOfTheSensor) {
  for (const double jitter_s : {1e-5, 4e-4}) {
    std::string lines;
    RandomStream jitter(5, StreamPurpose::jitter);
    for (int i = 0; i < 6000; ++i)
      if (i < 3000 || i >= 3040) lines += fmt::format("{:.6f}\n", i + jitter_s * jitter.normal());
    LoadRequest request;
    request.path = "broken.txt";
    const Analysis data = analyse(load_text(lines, request), AnalysisRequest{});
    EXPECT_TRUE(data.suspicions.empty()) << jitter_s;
    EXPECT_TRUE(data.diary.changes.empty()) << jitter_s;
  }
}

TEST(DiagnosisTest, AShortLogHasNoDiagnosis) {
  test::SickClock clock;
  clock.days = 0.01;
  EXPECT_TRUE(test::diagnosed(clock).empty());
}

// Seeds with amplitudes (even), whose steady clock a fit must not take for a free pendulum, and
// without (odd), where the drive's least size tells.
TEST(DiagnosisTest, ARoughDriveIsToldOfASteadyClock) {
  for (const std::uint64_t seed : {9700044u, 9700047u}) {
    const auto found = test::diagnosed({{Cause::rough_drive}, 1.0, seed});
    ASSERT_FALSE(found.empty()) << seed;
    EXPECT_EQ(found.front().cause, Cause::rough_drive) << seed;
  }
}

} // namespace
} // namespace goingrate
