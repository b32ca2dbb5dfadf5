// What an analysis finds without being told: the moment of a change and what changed, a sensor off
// the vertical, impulses instead of a torque. No option is given except, where stated, T0.
#include "goingrate/analysis/analyse.hpp"
#include "goingrate/clock/scenario.hpp"
#include "goingrate/log/writing.hpp"
#include "support/simulated.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

Analysis analysed(const std::string& scenario, std::uint64_t seed,
                  const std::map<std::string, double>& fixed = {}) {
  const ClockLog log = test::simulated_log(parse_scenario(scenario, "noticed.toml"), seed);
  constexpr int decimals = 9;
  LoadRequest request;
  request.path = "noticed.csv";
  AnalysisRequest asked;
  asked.fit.fixed = fixed;
  asked.traces_profiles = false;
  return analyse(load_text(native_log_text(log, decimals), request), asked);
}

// Within four sigma: of a dozen parameters in three logs one in a thousand is beyond.
void expect_value(const FitSummary& fit, const std::string& name, double truth) {
  const FittedParameter* p = fit.find(name);
  ASSERT_NE(p, nullptr) << name;
  ASSERT_TRUE(std::isfinite(p->value)) << name;
  EXPECT_NEAR(p->value, truth, 4.0 * p->sigma) << name;
}

constexpr const char* clock_b = R"(
[clock]
nominal_period = 2.0
epsilon = 2.5e-4
mu = 4e-5
phi0 = 0.03
)";

constexpr const char* change_of_friction = R"(
[run]
periods = 3000
[[event]]
at_period = 900
epsilon = 3e-4
[sensor]
jitter_rms = 1e-5
)";

TEST(NoticedTest, AChangeOfFrictionAndItsDate) {
  for (const std::uint64_t seed : {5U, 6U}) {
    const FitSummary fit =
        analysed(std::string(clock_b) + change_of_friction, seed, {{"T0", 2.0}}).fit;
    ASSERT_EQ(fit.events.size(), 1U);
    EXPECT_EQ(fit.events[0].cycle, 900);
    EXPECT_FALSE(fit.model.drive) << "noise in place of a beat's error of the date";
    expect_value(fit, "epsilon", 2.5e-4);
    expect_value(fit, "epsilon@1", 3e-4);
  }
}

// In these two logs another change explains the times to within their jitter, of the impulse in one
// and of μ in the other, in a clock far from the true one. A date three beats off hides the right
// kind.
TEST(NoticedTest, AChangeOfFrictionThatAnotherExplainsToo) {
  constexpr const char* scenario = R"(
[run]
periods = 3000
[[event]]
at_period = 800
epsilon = 3.2e-4
[sensor]
jitter_rms = 1e-5
)";
  for (const std::uint64_t seed : {70270006U, 71270004U}) {
    const FitSummary fit = analysed(std::string(clock_b) + scenario, seed).fit;
    ASSERT_EQ(fit.events.size(), 1U) << seed;
    EXPECT_EQ(fit.events[0].cycle, 800) << seed;
    EXPECT_EQ(fit.model.name(), "constant-torque, friction linear, noise jitter") << seed;
    expect_value(fit, "epsilon", 2.5e-4);
    expect_value(fit, "epsilon@1", 3.2e-4);
  }
}

// The residuals of the first fail the test for white noise, as one log in a hundred does; in the
// second, chance folds the times into a saw-tooth.
TEST(NoticedTest, AFreePendulumWhateverTheTestsSay) {
  constexpr const char* scenario = R"(
[clock]
nominal_period = 1.0
epsilon = 1e-3
[start]
amplitude = 0.2
[run]
periods = 1500
[sensor]
jitter_rms = 1e-5
)";
  for (const std::uint64_t seed : {70270015U, 70270018U}) {
    const FitSummary fit = analysed(scenario, seed).fit;
    EXPECT_EQ(fit.model.escapement, Escapement::none) << seed;
    EXPECT_TRUE(fit.events.empty()) << seed;
    expect_value(fit, "T0", 1.0);
    expect_value(fit, "epsilon", 1e-3);
  }
}

// The course of the rate dates the change some beats off, in some logs twice: the fit tells that
// one date is enough. The true one is 1500.
TEST(NoticedTest, AChangeOfFrictionIsOneChange) {
  constexpr const char* scenario = R"(
[run]
periods = 4000
[[event]]
at_period = 1500
epsilon = 3.2e-4
[sensor]
jitter_rms = 2e-5
amplitude_rms = 5e-5
)";
  for (const std::uint64_t seed : {12U, 21U, 22U, 34U}) {
    const Analysis found = analysed(std::string(clock_b) + scenario, seed);
    ASSERT_EQ(found.fit.events.size(), 1U) << seed;
    EXPECT_EQ(found.fit.events[0].cycle, 1500) << seed;
    ASSERT_EQ(found.diary.changes.size(), 1U) << seed;
    EXPECT_EQ(found.diary.changes[0].kind, ChangeKind::friction) << seed;
    EXPECT_EQ(found.diary.changes[0].cycle, 1500) << seed;
    expect_value(found.fit, "epsilon", 2.5e-4);
    expect_value(found.fit, "epsilon@1", 3.2e-4);
  }
}

// Impulses then explain the log as well; what is stated must hold.
TEST(NoticedTest, AChangeOfFrictionWithTheLengthUnknown) {
  const FitSummary fit = analysed(std::string(clock_b) + change_of_friction, 5).fit;
  EXPECT_FALSE(fit.model.drive);
  const std::map<std::string, double> truth{
      {"T0", 2.0}, {"epsilon", 2.5e-4}, {"mu", 4e-5}, {"phi0", 0.03}, {"epsilon@1", 3e-4}};
  for (const auto& [name, value] : truth) {
    const FittedParameter* p = fit.find(name);
    if (p != nullptr && std::isfinite(p->value)) {
      EXPECT_NEAR(p->value, value, 4.0 * p->sigma) << name;
    }
  }
}

TEST(NoticedTest, AChangeOfTheEscapementsAngle) {
  const FitSummary fit = analysed(std::string(clock_b) + R"(
[run]
periods = 3000
[[event]]
at_period = 900
phi0 = 0.033
[sensor]
jitter_rms = 1e-5
)",
                                  5, {{"T0", 2.0}})
                             .fit;
  EXPECT_FALSE(fit.model.drive);
  expect_value(fit, "phi0", 0.03);
  expect_value(fit, "phi0@1", 0.033);
}

// The speed in rad/s is what a pendulum keeps when its length changes: lambda goes with T0.
TEST(NoticedTest, AChangeOfTheRegulation) {
  const FitSummary fit = analysed(std::string(clock_b) + R"(
[run]
periods = 3000
[[event]]
at_period = 900
nominal_period = 2.0001
[sensor]
jitter_rms = 1e-5
)",
                                  5, {{"T0", 2.0}})
                             .fit;
  EXPECT_FALSE(fit.model.drive);
  EXPECT_FALSE(fit.model.walk);
  expect_value(fit, "T0@1", 2.0001);
}

// Seven sigma of the jitter over the beats next to it, and hundreds over the log.
TEST(NoticedTest, AChangeThatOnlyTheWholeOfAShortLogShows) {
  constexpr const char* scenario = R"(
[clock]
nominal_period = 1.4142
epsilon = 3e-4
mu = 3e-5
phi0 = 0.03
[run]
periods = 1400
[[event]]
at_period = 800
nominal_period = 1.41424243
[sensor]
jitter_rms = 2e-4
missed = 0.01
)";
  for (const std::uint64_t seed : {2U, 4U}) {
    const Analysis found = analysed(scenario, seed);
    ASSERT_EQ(found.diary.changes.size(), 1U) << seed;
    const Change& change = found.diary.changes.front();
    EXPECT_EQ(change.kind, ChangeKind::regulation) << seed;
    EXPECT_NEAR(static_cast<double>(change.cycle), 800.0, 3.0); // 2e-4 s of 4e-5 s a beat
    EXPECT_NEAR(change.rate_change, -3e-5, 4.0 * change.rate_change_sigma) << seed;
    ASSERT_EQ(found.fit.events.size(), 1U) << seed;
    EXPECT_EQ(found.fit.model.noise(), "jitter") << seed;
    const DerivedQuantity* step = found.fit.combination("T0@1/T0 - 1");
    ASSERT_NE(step, nullptr) << seed;
    EXPECT_NEAR(step->value, 3e-5, 4.0 * step->sigma) << seed;
    ASSERT_FALSE(found.suspicions.empty());
    EXPECT_EQ(found.suspicions.front().cause, Cause::length_step) << seed;
  }
}

// Its courses look like changes here and there; none of them is worth its date to the fit.
TEST(NoticedTest, AWanderingDriveIsNoListOfChanges) {
  for (const std::uint64_t seed : {8000U, 8001U}) {
    const FitSummary fit = analysed(std::string(clock_b) + R"(
[run]
periods = 5000
[drive]
fast_rms = 0.02
slow_rms = 0.05
slow_time = 1200.0
[sensor]
jitter_rms = 2e-5
amplitude_rms = 5e-5
)",
                                    seed)
                               .fit;
    EXPECT_TRUE(fit.events.empty()) << seed;
    EXPECT_TRUE(fit.model.slow) << fit.model.noise();
  }
}

TEST(NoticedTest, TwoChangesOfDifferentKinds) {
  for (const std::uint64_t seed : {771U, 772U}) {
    const FitSummary fit = analysed(std::string(clock_b) + R"(
[run]
periods = 3000
[[event]]
at_period = 600
mu = 6e-5
[[event]]
at_period = 1800
epsilon = 3e-4
[sensor]
jitter_rms = 1e-5
amplitude_rms = 2e-5
)",
                                    seed)
                               .fit;
    EXPECT_FALSE(fit.model.drive);
    expect_value(fit, "epsilon", 2.5e-4);
    expect_value(fit, "mu", 4e-5);
    expect_value(fit, "mu@1", 6e-5);
    expect_value(fit, "epsilon@2", 3e-4);
  }
}

// All that any model could have is more than a search takes: only what is tried must not be.
TEST(NoticedTest, FourChangesInALogWithColumns) {
  std::string scenario = std::string(clock_b) + R"(
[run]
periods = 2500
[temperature]
sine = [{amplitude = 0.5, period = 2000.0}]
[sensor]
jitter_rms = 1e-5
amplitude_rms = 2e-5
temperature_rms = 0.01
)";
  for (const int change : {1, 2, 3, 4})
    scenario += fmt::format("[[event]]\nat_period = {}\nmu = {}\n", 500 * change,
                            change % 2 == 1 ? 6e-5 : 4e-5);
  const Analysis data = analysed(scenario, 9, {{"T0", 2.0}});
  ASSERT_EQ(data.fit.events.size(), 4U);
  EXPECT_FALSE(data.log.columns.temperature_c.empty());
  expect_value(data.fit, "mu@4", 4e-5);
}

// Without the temperature in it the model would give to the drive what the rod does: of such a log
// it took the friction for twice what it is.
constexpr const char* warm_and_cold = R"(
[clock]
nominal_period = 1.0
epsilon = 3e-4
mu = 2e-5
phi0 = 0.025
[run]
periods = 30000
[drive]
fast_rms = 0.05
[[event]]
at_period = 14000
mu = 1.9e-5
[temperature]
mean = 18
sine = [{amplitude = 2.0, period = 8640.0}]
[length]
temperature_coefficient = 1.2e-5
[sensor]
jitter_rms = 2e-5
amplitude_rms = 5e-5
temperature_rms = 0.05
)";

TEST(NoticedTest, ATemperatureThatTheRateFollows) {
  const Analysis data = analysed(warm_and_cold, 20261128);
  expect_value(data.fit, "temperature", -6e-6); // half of the rod's, and a longer rod is slower
  expect_value(data.fit, "T0", 1.0);
  expect_value(data.fit, "epsilon", 3e-4);
  expect_value(data.fit, "mu@1", 1.9e-5);
  // It is named among the causes, though the fit accounts for it.
  EXPECT_TRUE(std::any_of(data.suspicions.begin(), data.suspicions.end(),
                          [](const Suspicion& s) { return s.cause == Cause::temperature; }));
}

TEST(NoticedTest, ATemperatureThatTheRateDoesNotFollow) {
  std::string scenario = warm_and_cold;
  scenario.replace(scenario.find("1.2e-5"), 6, "0.0"); // a rod of Invar
  const Analysis data = analysed(scenario, 20261129);
  expect_value(data.fit, "temperature", 0.0);
  EXPECT_TRUE(std::none_of(data.suspicions.begin(), data.suspicions.end(),
                           [](const Suspicion& s) { return s.cause == Cause::temperature; }));
  scenario.erase(scenario.find("amplitude_rms")); // times alone
  const Analysis times = analysed(scenario + "temperature_rms = 0.05", 20261129);
  EXPECT_FALSE(times.log.columns.temperature_c.empty());
  expect_value(times.fit, "temperature", 0.0);
}

// The rate alone shows the temperature at one sigma, under a drive that wanders slowly; a fit that
// knows the drive from the amplitudes shows it at hundreds.
TEST(NoticedTest, ATemperatureThatTheDriveHides) {
  const Analysis data = analysed(R"(
[clock]
nominal_period = 1.0
epsilon = 3e-4
mu = 2e-5
phi0 = 0.025
[run]
periods = 12000
[drive]
fast_rms = 0.05
slow_rms = 0.04
slow_time = 1500.0
[temperature]
mean = 18
sine = [{amplitude = 2.0, period = 6000.0}]
[length]
temperature_coefficient = 4e-6
[sensor]
jitter_rms = 2e-5
amplitude_rms = 5e-5
temperature_rms = 0.05
)",
                                 20261130);
  ASSERT_EQ(data.covariates.size(), 1U);
  EXPECT_FALSE(data.covariates.front().significant());
  expect_value(data.fit, "temperature", -2e-6);
  expect_value(data.fit, "epsilon", 3e-4);
  const auto named = std::find_if(data.suspicions.begin(), data.suspicions.end(),
                                  [](const Suspicion& s) { return s.cause == Cause::temperature; });
  ASSERT_NE(named, data.suspicions.end());
  const FittedParameter* fitted = data.fit.find("temperature");
  EXPECT_EQ(named->numbers.size, fitted->value); // what the rate alone shows is not stated
  EXPECT_LT(fitted->sigma, 0.01 * std::abs(fitted->value));
  // What is left is the drive's, and nobody is sent to log the weather.
  EXPECT_TRUE(std::none_of(data.suspicions.begin(), data.suspicions.end(), [](const Suspicion& s) {
    return s.cause == Cause::unknown || s.cause == Cause::unlogged_weather;
  }));
}

// Every change is first taken for one of the drive. What it leaves unexplained looks like a drive
// that wanders, until the kind of the change is asked for under the drive that varies from beat to
// beat. The first guess of its date is then some beats off as well.
TEST(NoticedTest, AKindOfChangeThatTheDriveHides) {
  const std::string clock = R"(
[clock]
nominal_period = 1.2
epsilon = 6e-4
mu = 5e-5
phi0 = 0.02
[run]
periods = 2000
[drive]
fast_rms = 0.03
[sensor]
jitter_rms = 3e-5
amplitude_rms = 6e-5
[[event]]
at_period = 800
)";
  for (const auto& [name, value] : std::vector<std::pair<std::string, double>>{
           {"phi0", 0.0185}, {"epsilon", 7e-4}, {"mu", 5.8e-5}}) {
    SCOPED_TRACE(name);
    const Analysis data = analysed(clock + name + " = " + std::to_string(value) + "\n", 20261128);
    ASSERT_EQ(data.fit.events.size(), 1U);
    constexpr double beats_off = 3.0; // 3 sigma of a date in such logs
    EXPECT_NEAR(static_cast<double>(data.fit.events.front().cycle), 800.0, beats_off);
    expect_value(data.fit, name + "@1", value);
    expect_value(data.fit, "epsilon", 6e-4);
    expect_value(data.fit, "mu", 5e-5);
    expect_value(data.fit, "phi0", 0.02);
    EXPECT_EQ(data.fit.find("slow_rms"), nullptr);
  }
}

// A change of φ0 that is taken for one of the friction leaves a misfit, which a walk of the times
// would hide.
TEST(NoticedTest, AKindOfChangeThatAWalkWouldHide) {
  const std::string clock = R"(
[clock]
nominal_period = 1.0
epsilon = 7.4861e-4
mu = 9.0242e-5
phi0 = 0.010384
[run]
periods = 1360
[drive]
fast_rms = 0.03
[sensor]
jitter_rms = 1e-6
amplitude_rms = 6e-5
[[event]]
at_period = 354
phi0 = 0.0091447
)";
  for (const std::uint64_t seed : {93000002, 93000007}) {
    SCOPED_TRACE(seed);
    const Analysis data = analysed(clock, seed);
    ASSERT_EQ(data.fit.events.size(), 1U);
    EXPECT_EQ(data.fit.find("walk_rms"), nullptr);
    expect_value(data.fit, "phi0@1", 0.0091447);
    expect_value(data.fit, "epsilon", 7.4861e-4);
    expect_value(data.fit, "phi0", 0.010384);
  }
}

// Under a drive that varies, times alone leave hills between clocks that swing far and clocks that
// swing little. The end must be no worse than the one to which the true period leads.
TEST(NoticedTest, NoSizeOfTheSwingIsPassedBy) {
  const std::string clock = R"(
[clock]
nominal_period = 0.9947
epsilon = 0.00054385
mu = 1.2724e-05
phi0 = 0.01324
[run]
periods = 3735
[drive]
fast_rms = 0.055
[[event]]
at_period = 1427
phi0 = 0.01238
[sensor]
jitter_rms = 2e-5
)";
  const FitSummary bare = analysed(clock, 2).fit;
  const FitSummary told = analysed(clock, 2, {{"T0", 0.9947}}).fit;
  constexpr double one_parameter_more = 2.0, same_end = 1.0; // of 2 log L
  EXPECT_LT(bare.quality.aic, told.quality.aic + one_parameter_more + same_end);
  for (const auto& [name, truth] : {std::pair{"phi0", 0.01324}, {"mu", 1.2724e-5}}) {
    const FittedParameter* p = bare.find(name);
    if (std::isfinite(p->value)) {
      EXPECT_NEAR(p->value, truth, 4.0 * p->sigma) << name; // as expect_value
    }
  }
}

// A change of the escapement's angle in another clock explains this change of friction as well, to
// 0.2 of 2 log L. Nothing that the two contradict is stated, and the other change is told.
TEST(NoticedTest, TwoKindsOfChangeThatExplainALogAlike) {
  const FitSummary fit = analysed(R"(
[clock]
nominal_period = 3.0
epsilon = 0.000455515
mu = 0.000231292
phi0 = 0.047385
[run]
periods = 1768
[[event]]
at_period = 600
epsilon = 0.000398791
[sensor]
jitter_rms = 7.66e-6
)",
                                  20261134)
                             .fit;
  for (const char* name : {"T0", "epsilon", "mu", "phi0", "lambda0"})
    EXPECT_FALSE(std::isfinite(fit.find(name)->value)) << name;
  const std::string other = fit.find("epsilon@1") != nullptr ? "phi0" : "epsilon";
  EXPECT_TRUE(std::any_of(fit.notes.begin(), fit.notes.end(), [&](const FitNote& note) {
    return note.kind == NoteKind::change && note.text.find(other) != std::string::npos;
  }));
}

// What is asked for stands: the coefficient that is given, or none.
TEST(NoticedTest, ATemperatureThatIsSpokenOf) {
  const ClockLog log = test::simulated_log(parse_scenario(warm_and_cold, "noticed.toml"), 7);
  LoadRequest request;
  request.path = "noticed.csv";
  constexpr int decimals = 9;
  const NumberedLog loaded = load_text(native_log_text(log, decimals), request);
  EXPECT_EQ(with_seen_weather({}, loaded).freed, std::vector<std::string>{"temperature"});
  FitOptions fixed;
  fixed.fixed["temperature"] = 0.0;
  EXPECT_TRUE(with_seen_weather(fixed, loaded).freed.empty());
}

constexpr const char* impulses = R"(
[clock]
nominal_period = 1.5
epsilon = 2e-4
escapement = "single-impulse"
impulse = 1.5e-6
angle = 0.01
[run]
periods = 2000
[[event]]
at_period = 400
impulse = 2.5e-6
[sensor]
jitter_rms = 1e-5
)";

TEST(NoticedTest, SingleImpulses) {
  for (const bool knows_T0 : {false, true}) {
    const auto fixed =
        knows_T0 ? std::map<std::string, double>{{"T0", 1.5}} : std::map<std::string, double>{};
    const FitSummary fit = analysed(impulses, 771, fixed).fit;
    EXPECT_EQ(fit.model.escapement, Escapement::single_impulse);
    expect_value(fit, "epsilon", 2e-4);
    expect_value(fit, "impulse", 1.5e-6);
    expect_value(fit, "impulse@1", 2.5e-6);
  }
}

TEST(NoticedTest, ABeamOffTheVertical) {
  for (const bool knows_T0 : {false, true}) {
    const auto fixed =
        knows_T0 ? std::map<std::string, double>{{"T0", 2.0}} : std::map<std::string, double>{};
    const FitSummary fit = analysed(R"(
[clock]
nominal_period = 2.0
epsilon = 2.5e-4
mu = 2e-5
phi0 = 0.03
[run]
periods = 1500
[[event]]
at_period = 300
mu = 4e-5
[sensor]
edges = "both"
offset = 0.004
jitter_rms = 2e-5
)",
                                    771, fixed)
                               .fit;
    EXPECT_FALSE(fit.model.quadratic);
    expect_value(fit, "epsilon", 2.5e-4);
    expect_value(fit, "mu", 2e-5);
    expect_value(fit, "offset", 0.004);
  }
}

} // namespace
} // namespace goingrate
