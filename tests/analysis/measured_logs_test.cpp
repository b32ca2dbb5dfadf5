// The results that analyse() must give for logs measured by others.
#include "goingrate/analysis/analyse.hpp"
#include "support/real_data.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

std::optional<Analysis> analysed(const char* name) {
  const auto path = test::real_data(name);
  if (!path) return {};
  LoadRequest request;
  request.path = path->string();
  AnalysisRequest questions;
  questions.finds_events = true;
  return analyse(load(request), questions);
}

#define NEEDS(analysis)                                                                            \
  if (!(analysis)) GTEST_SKIP() << "needs the measured logs (CONTRIBUTING.md says where they are)"

bool is_determined(const FitSummary& fit, const char* name) {
  const FittedParameter* parameter = fit.find(name);
  return parameter != nullptr && std::isfinite(parameter->sigma);
}

// A quiet day of a going clock tells its rate and nothing of its pendulum.
TEST(MeasuredLogs, AQuietDayOfATurretClock) {
  const auto day = analysed("trinity-clock/clock2013-03-30.txt");
  NEEDS(day);
  EXPECT_EQ(day->numbered.missed + day->numbered.spurious, 0);
  EXPECT_NEAR(day->rate.rate_excess * 86400e3, 91.75, 0.005); // ms a day, the printed digits
  EXPECT_TRUE(day->diary.changes.empty());
  EXPECT_TRUE(day->diary.interruptions.empty());
  for (const char* name : {"T0", "epsilon", "mu", "phi0"})
    EXPECT_FALSE(is_determined(day->fit, name)) << name;
  EXPECT_FALSE(day->drive.split);
  // Each of the three legs of the escape wheel comes round every 9 s.
  ASSERT_FALSE(day->suspicions.empty());
  EXPECT_EQ(day->suspicions.front().cause, Cause::wheel);
  EXPECT_NE(day->suspicions.front().evidence.find("every 9.000"), std::string::npos);
}

TEST(MeasuredLogs, ADayWhoseDriveWasInterrupted) {
  const auto day = analysed("trinity-clock/clock2013-03-31.txt");
  NEEDS(day);
  EXPECT_EQ(day->diary.changes.size(), 2u); // its beginning and its end
  ASSERT_EQ(day->diary.interruptions.size(), 1u);
  const Interruption& told = day->diary.interruptions.front();
  EXPECT_NEAR(told.begin.at_s, 207.0, 9.0); // three beats
  EXPECT_NEAR(told.end.at_s, 405.0, 15.0);  // the drive came back unevenly
  EXPECT_NEAR(told.amplitude_before_rad, 46.11e-3, 0.05e-3);
  EXPECT_NEAR(told.amplitude_after_rad, 44.58e-3, 0.15e-3); // it lies at the edge of the fall
  ASSERT_TRUE(told.decay && told.recovery);
  EXPECT_NEAR(told.decay->time_constant_s, 6500.0, 3.0 * told.decay->sigma_s);
  // The squared amplitude comes back at twice the rate at which the amplitude falls.
  EXPECT_NEAR(told.recovery->time_constant_s, 0.5 * told.decay->time_constant_s,
              0.2 * told.decay->time_constant_s);
  // The line at 9 s is the turn of the escape wheel, not an impulse given once in several swings.
  EXPECT_FALSE(day->fit.impulses);
  ASSERT_FALSE(day->drive.lines.empty());
  EXPECT_NEAR(1.0 / day->drive.lines.front().frequency_hz, 9.0, 1e-3);
  for (const char* name : {"T0", "mu", "phi0"}) // no change of the clock is fitted to it
    EXPECT_FALSE(is_determined(day->fit, name)) << name;
  EXPECT_FALSE(day->drive.split);
}

// A student's ring-down, tracked on video.
TEST(MeasuredLogs, AVideoOfARingDown) {
  const auto video = analysed("video-ringdown/tyler_lab1_data.txt");
  NEEDS(video);
  const FitSummary& fit = video->fit;
  ASSERT_TRUE(fit.has_result());
  EXPECT_NE(fit.status, FitStatus::contradicts_log);
  EXPECT_EQ(fit.model.escapement, Escapement::none);
  EXPECT_TRUE(video->drive.swings_freely);
  EXPECT_TRUE(video->suspicions.empty());
  // The publisher's mean, whose weights are others.
  EXPECT_NEAR(video->rate.mean_period_s, 1.64991, 5e-3);
  ASSERT_FALSE(fit.model_amplitude_rad.empty());
  // The first angle of the log is 0.702 rad, near a turning point; the publisher's amplitude is the
  // mean of a decay that is not exponential.
  EXPECT_NEAR(fit.model_amplitude_rad.front(), 0.69, 0.03);
  constexpr double log_length_s = 114.0;
  const double decay_s =
      log_length_s / std::log(fit.model_amplitude_rad.front() / fit.model_amplitude_rad.back());
  EXPECT_NEAR(decay_s, 87.0, 10.0); // 80.5 s by the publisher's fit, 94 s by the logarithm's slope
}

// Its publisher states one Q, 142 +- 4, of an exponential over all amplitudes.
TEST(MeasuredLogs, TheVideosQDependsOnTheAmplitude) {
  const auto video = analysed("video-ringdown/tyler_lab1_data.txt");
  NEEDS(video);
  ASSERT_TRUE(video->fit.decay);
  const Decay& decay = *video->fit.decay;
  const auto& at = decay.q_at_amplitude;
  ASSERT_EQ(at.size(), 9u);
  for (const QAtAmplitude& row : at)
    ASSERT_GT(row.q.sigma, 0.0) << row.amplitude_rad;
  // Q crosses the publisher's value within the log and differs from it at both ends: no single Q
  // describes the pendulum.
  EXPECT_LT(at.back().q.high95, 142.0 - 4.0);
  EXPECT_GT(at.front().q.low95, 142.0 + 4.0);
  for (std::size_t k = 1; k < at.size(); ++k)
    EXPECT_LT(at[k].q.value, at[k - 1].q.value) << at[k].amplitude_rad;
  // The likeliest law: quadratic drag and dry friction, with or without a linear part.
  EXPECT_NE(decay.laws.front().friction.find("quadratic + dry"), std::string::npos);
  const auto linear = std::find_if(decay.laws.begin(), decay.laws.end(),
                                   [](const FrictionLaw& law) { return law.friction == "linear"; });
  ASSERT_NE(linear, decay.laws.end());
  EXPECT_GT(linear->behind, 100.0); // an exponential is out of the question
  // The period of small swings lies below every period of the log, the shortest of which is 1.635.
  const FittedParameter& T0 = video->fit["T0"];
  EXPECT_NEAR(T0.value, 1.633, 2e-3);
  EXPECT_LT(T0.sigma, 1e-3);
}

} // namespace
} // namespace goingrate
