// The short form of tests/studies/ring_down: ring-downs as users' files.
#include "goingrate/log/writing.hpp"
#include "support/ring_down_score.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

using namespace test;

// A short ring-down of a high Q, whose rate drifts along with the swing.
TEST(RingDownTest, ASwingWithoutADriveIsNotToBeOiled) {
  Scenario scenario;
  scenario.clock = {2.0, 1e-5, 0.0, 0.0};
  scenario.clock.escapement = Escapement::none;
  scenario.start_amplitude = 0.05;
  scenario.periods = 700;
  scenario.sensor.jitter_rms_s = 1e-4;
  scenario.sensor.amplitude_rms = 1e-4;
  for (const std::uint64_t seed : {11U, 12U}) {
    LoadRequest request;
    request.path = "swing.csv";
    const Analysis analysis =
        analyse(load_text(native_log_text(simulated_log(scenario, seed), 6), request), {});
    EXPECT_EQ(analysis.fit.model.escapement, Escapement::none) << seed;
    for (const Suspicion& suspicion : analysis.suspicions)
      EXPECT_TRUE(suspicion.cause != Cause::growing_friction &&
                  suspicion.cause != Cause::length_drift)
          << seed;
  }
}

// Logs of the study's prior, four of each law and sensor.
TEST(RingDownStudy, ShortForm) {
  constexpr std::array laws{"linear", "quadratic", "dry", "linear + dry"};
  constexpr int logs = 4; // a law and a sensor
  std::uint64_t seed = 4000;
  int all = 0, described = 0, wrong = 0;
  int stated = 0, in95 = 0;       // Q halfway
  int T0_stated = 0, T0_in95 = 0; // with crossings alone, too
  for (const WatchedBy watched_by :
       {WatchedBy::samples, WatchedBy::photogate, WatchedBy::crossings})
    for (const char* law : laws)
      for (int k = 0; k < logs; ++k) {
        const RingDownOutcome o = outcome_of(RingDownPrior(++seed).draw(law, watched_by));
        T0_stated += o.T0.is_stated;
        T0_in95 += o.T0.in95;
        if (watched_by == WatchedBy::crossings) continue; // few of these tell Q
        ++all;
        described += o.described;
        wrong += o.described && !o.law_is_open && o.behind > 6.0;
        stated += o.q[2].is_stated;
        in95 += o.q[2].in95;
      }
  EXPECT_GE(described, all * 9 / 10);
  EXPECT_GE(stated, all * 7 / 10);
  // 95 % less three standard deviations of so many.
  const auto least = [](int of) { return 0.95 * of - 3.0 * std::sqrt(0.95 * 0.05 * of); };
  EXPECT_GE(in95, least(stated)) << stated;
  EXPECT_GE(T0_in95, least(T0_stated)) << T0_stated;
  EXPECT_LE(wrong, 2);
}

// Before the friction is known to be quadratic and dry, its misfit looks like times that walk.
TEST(RingDownStudy, TimesDoNotWalkOnceTheFrictionIsKnown) {
  for (const std::uint64_t seed : {4000, 4001, 4015}) {
    const test::RingDown drawn =
        test::RingDownPrior(seed).draw("quadratic + dry", test::WatchedBy::samples);
    const Analysis data = analyse(load_text(drawn.text, drawn.request), {});
    EXPECT_EQ(data.fit.model.noise(), "jitter") << seed;
    EXPECT_TRUE(data.fit.model.quadratic) << seed;
  }
}

// The period of a free pendulum changes as its swing dies away; that is not a change of the clock.
TEST(RingDownStudy, ItsCourseIsNoChange) {
  for (const std::uint64_t seed : {9122u, 9127u}) {
    RingDown drawn = RingDownPrior(seed).draw("linear", WatchedBy::photogate);
    drawn.request.path = "ring-down.csv";
    AnalysisRequest road;
    road.traces_profiles = false;
    const Analysis data = analyse(load_text(drawn.text, drawn.request), road);
    EXPECT_EQ(data.fit.model.escapement, Escapement::none) << seed;
    EXPECT_TRUE(data.fit.events.empty()) << seed;
    EXPECT_NEAR(data.fit["T0"].value, drawn.T0, 4.0 * data.fit["T0"].sigma) << seed; // 4 sigma
    EXPECT_TRUE(data.fit.decay.has_value()) << seed;
  }
}

} // namespace
} // namespace goingrate
