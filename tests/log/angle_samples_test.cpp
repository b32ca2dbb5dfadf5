#include "log/angle_samples.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/log/beats.hpp"
#include "goingrate/log/reading.hpp"
#include "support/real_data.hpp"
#include "support/swinging.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

// A ring-down about a rest angle, sampled at `rate` Hz with white noise.
std::vector<AngleSample> ring_down(double rate, double noise, double seconds, std::uint64_t seed) {
  RandomStream random(seed, StreamPurpose::jitter);
  std::vector<AngleSample> samples;
  for (int i = 0; i < static_cast<int>(rate * seconds); ++i) {
    const double t = i / rate;
    const double angle = 0.02 + 0.3 * std::exp(-t / 80.0) * std::sin(two_pi * t / 1.6 + 0.3) +
                         noise * random.normal();
    samples.push_back(
        {Instant::from_seconds(1000.0) + t, angle, static_cast<std::uint32_t>(i + 1)});
  }
  return samples;
}

// Passage k of the vertical: the phase is a multiple of pi.
double passage_time(std::size_t k) {
  return (static_cast<double>(k + 1) * std::numbers::pi - 0.3) / two_pi * 1.6;
}

TEST(AngleSamplesTest, SigmasCover) {
  for (const double rate : {20.0, 200.0}) {
    double inside = 0.0, all = 0.0, pull = 0.0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const auto swings = crossings_of_samples(ring_down(rate, 2e-3, 60.0, seed), 0.02);
      ASSERT_GE(swings.crossings.size(), 74u) << rate; // the 75th is 0.08 s before the end
      for (std::size_t k = 0; k < swings.crossings.size(); ++k) {
        const double error =
            swings.crossings[k].time - Instant::from_seconds(1000.0) - passage_time(k);
        inside += std::abs(error) < swings.crossings[k].sigma_s ? 1.0 : 0.0;
        pull += error / swings.crossings[k].sigma_s * (k % 2 ? 1.0 : -1.0);
        ++all;
      }
      EXPECT_NEAR(swings.noise, 2e-3,
                  3.3e-4); // four standard errors of 75 fits with four free each
    }
    EXPECT_NEAR(inside / all, 0.683, 4.0 * std::sqrt(0.683 * 0.317 / all)) << rate;
    EXPECT_NEAR(pull / all, 0.0, 4.0 / std::sqrt(all)) << "no bias of either direction";
  }
}

// Of a swing under a drag that grows as the square of the speed, a sine that decays evenly would
// miss the passages by 24 us, and the beat error with them.
TEST(AngleSamplesTest, ADragWithTheSquareOfTheSpeedMovesNoPassage) {
  constexpr int steps = 1000, steps_a_sample = 20; // of a period
  constexpr double h = two_pi / steps;
  const Friction drag{.quadratic = 0.125};
  std::vector<AngleSample> samples;
  std::vector<double> passages_s;
  test::Swinging swing{.angle = 0.1};
  for (int i = 0; i < 12 * steps; ++i) {
    const double t = static_cast<double>(i) / steps; // T0 is a second
    if (i % steps_a_sample == 0)
      samples.push_back({Instant::from_seconds(t), swing.angle, static_cast<std::uint32_t>(i + 1)});
    const double before = swing.angle;
    swing.go_on(drag, h);
    if ((before < 0.0) != (swing.angle < 0.0)) // the way there is straight to some 1e-6 of a step
      passages_s.push_back(t + before / (before - swing.angle) / steps);
  }
  const auto swings = crossings_of_samples(samples, 0.0);
  ASSERT_EQ(swings.crossings.size(), passages_s.size());
  for (std::size_t k = 2; k + 2 < passages_s.size(); ++k) // the swings at the ends are not whole
    EXPECT_NEAR(swings.crossings[k].time.to_double(), passages_s[k], 2e-6) << k;
}

TEST(AngleSamplesTest, AFewSamplesAPeriodWillDo) {
  for (const double a_period : {2.6, 3.0, 4.0, 5.3, 8.0, 15.0}) {
    double inside = 0.0, all = 0.0, pull = 0.0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const auto swings = crossings_of_samples(ring_down(a_period / 1.6, 2e-3, 60.0, seed), 0.02);
      EXPECT_NEAR(swings.samples_per_period, a_period, 0.05 * a_period);
      ASSERT_GE(swings.crossings.size(), 70u) << a_period; // two at each end may lack samples
      for (const SampledCrossing& crossing : swings.crossings) {
        const double time = crossing.time - Instant::from_seconds(1000.0);
        const double k = std::round((time / 1.6 * two_pi + 0.3) / std::numbers::pi) - 1.0;
        const double error = time - passage_time(static_cast<std::size_t>(k));
        inside += std::abs(error) < crossing.sigma_s ? 1.0 : 0.0;
        pull += error / crossing.sigma_s * (crossing.edge == Edge::up ? 1.0 : -1.0);
        ++all;
      }
      EXPECT_NEAR(swings.noise, 2e-3, 6e-4) << a_period;
    }
    // Neighbouring crossings share samples, so they count for half as many.
    EXPECT_NEAR(inside / all, 0.683, 4.0 * std::sqrt(2.0 * 0.683 * 0.317 / all)) << a_period;
    EXPECT_NEAR(pull / all, 0.0, 4.0 * std::sqrt(2.0 / all)) << "no bias of either direction";
  }
  EXPECT_TRUE(crossings_of_samples(ring_down(2.2 / 1.6, 0.0, 60.0, 1)).crossings.empty());
}

TEST(AngleSamplesTest, TheNewestSampleMayBeFirst) {
  std::string text = "Time (s),Angle (rad)\n";
  auto samples = ring_down(50.0, 1e-3, 60.0, 5);
  std::reverse(samples.begin(), samples.end());
  for (const AngleSample& sample : samples)
    text +=
        fmt::format("{:.4f},{:.6f}\n", sample.time - Instant::from_seconds(1000.0), sample.angle);
  EXPECT_EQ(read_log(text, "x").events.size(), 75u);
}

TEST(AngleSamplesTest, TooFewSamplesAPeriodAreRefusedByTheirNumber) {
  std::string text = "Time (s),Angle (rad)\n";
  for (const AngleSample& sample : ring_down(2.2 / 1.6, 0.0, 60.0, 1))
    text +=
        fmt::format("{:.4f},{:.6f}\n", sample.time - Instant::from_seconds(1000.0), sample.angle);
  try {
    (void)read_log(text, "x");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string_view(error.what()).find("sampled too coarsely"), std::string::npos);
  }
}

TEST(AngleSamplesTest, TheRestAngleAndAmplitudesAreFound) {
  const auto swings = crossings_of_samples(ring_down(200.0, 1e-4, 60.0, 1));
  EXPECT_NEAR(swings.rest_angle, 0.02, 2e-5); // the decay within a swing is 1e-2 of the amplitude
  EXPECT_NEAR(swings.period_s, 1.6, 1e-2);    // to a sample
  for (std::size_t k = 1; k + 1 < swings.crossings.size(); ++k)
    EXPECT_NEAR(swings.crossings[k].amplitude, 0.3 * std::exp(-passage_time(k) / 80.0), 3e-4) << k;
  EXPECT_EQ(swings.crossings[0].edge, Edge::down);
  EXPECT_EQ(swings.crossings[1].edge, Edge::up);
}

// Samples of a pendulum that swings down from `first` rad with the friction given.
std::vector<AngleSample> pendulum(double first, const Friction& friction, double rate, double noise,
                                  double seconds, std::uint64_t seed) {
  RandomStream random(seed, StreamPurpose::jitter);
  const double dt = two_pi / (1.6 * rate); // scaled: T0 is 1.6 s
  std::vector<AngleSample> samples;
  test::Swinging motion{first, 0.0};
  for (int i = 0; i < static_cast<int>(rate * seconds); ++i) {
    samples.push_back({Instant::from_seconds(1000.0) + i / rate,
                       motion.angle + noise * random.normal(), static_cast<std::uint32_t>(i + 1)});
    motion.go_on(friction, dt);
  }
  return samples;
}

// The mean error of an amplitude, and how much the errors of neighbours go together, against what
// independent errors give.
TEST(AngleSamplesTest, AmplitudesAreWithoutBias) {
  struct Case {
    const char* name;
    double first;
    Friction friction;
    double rate;
  };
  for (const Case& scene :
       {Case{"linear", 0.3, {2e-3, 0.0, 0.0}, 20.0},
        Case{"linear, wide", 1.0, {1e-3, 0.0, 0.0}, 60.0},
        Case{"quadratic", 0.3, {0.0, 1e-2, 0.0}, 60.0}, Case{"dry", 0.1, {0.0, 0.0, 2e-4}, 20.0}}) {
    // From many samples without noise, which TheAmplitudeIsTheTurningAngle checks.
    const auto exact =
        crossings_of_samples(pendulum(scene.first, scene.friction, 4000.0, 0.0, 60.0, 1), 0.0);
    double bias = 0.0, together = 0.0, spread = 0.0, count = 0.0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      constexpr double noise = 1e-3;
      const auto swings = crossings_of_samples(
          pendulum(scene.first, scene.friction, scene.rate, noise, 60.0, seed), 0.0);
      ASSERT_EQ(swings.crossings.size(), exact.crossings.size()) << scene.name;
      double last = 0.0;
      for (std::size_t k = 1; k + 1 < swings.crossings.size(); ++k) {
        const double error = swings.crossings[k].amplitude - exact.crossings[k].amplitude;
        EXPECT_NEAR(swings.crossings[k].time - exact.crossings[k].time, 0.0,
                    5.0 * swings.crossings[k].sigma_s);
        bias += error;
        together += error * last;
        spread += error * error;
        count += 1.0;
        last = error;
      }
    }
    EXPECT_NEAR(bias, 0.0, 4.0 * std::sqrt(spread)) << scene.name; // four standard errors
    EXPECT_NEAR(together / spread, 0.0, 4.0 / std::sqrt(count)) << scene.name;
  }
}

// The amplitude against the speed at the passage, which the equation of motion gives.
TEST(AngleSamplesTest, TheAmplitudeIsTheTurningAngle) {
  for (const double first : {0.05, 0.5, 1.0, 2.0}) {
    const auto swings = crossings_of_samples(pendulum(first, {}, 100.0, 0.0, 30.0, 1), 0.0);
    ASSERT_GE(swings.crossings.size(), 20u);
    for (std::size_t k = 1; k + 1 < swings.crossings.size(); ++k)
      // Harmonics left out and 40 samples per swing: a part in 1e5 up to 1 rad, five at 2.
      EXPECT_NEAR(swings.crossings[k].amplitude / first, 1.0, first < 1.5 ? 1e-5 : 5e-5) << first;
  }
}

TEST(AngleSamplesTest, NoiseAboutTheVerticalIsNotCounted) {
  const auto swings = crossings_of_samples(ring_down(1000.0, 0.01, 60.0, 3));
  EXPECT_EQ(swings.crossings.size(), 75u);
}

TEST(AngleSamplesTest, AGapInTheSamplesIsAGapInTheCrossings) {
  auto samples = ring_down(100.0, 1e-3, 60.0, 4);
  samples.erase(samples.begin() + 2000, samples.begin() + 2400); // 4 s
  const auto swings = crossings_of_samples(samples);
  EXPECT_GE(swings.crossings.size(), 68u);
  EXPECT_LE(swings.crossings.size(), 70u);
  for (const SampledCrossing& crossing : swings.crossings) {
    const double phase = (crossing.time - Instant::from_seconds(1000.0)) * two_pi / 1.6 + 0.3;
    EXPECT_NEAR(std::sin(phase), 0.0, 0.02); // three times the noise over the last amplitude
  }
}

TEST(AngleSamplesTest, TooLittleGivesNothing) {
  EXPECT_TRUE(crossings_of_samples({}).crossings.empty());
  EXPECT_TRUE(crossings_of_samples(ring_down(5.0, 0.0, 1.4, 1)).crossings.empty());
  std::vector<AngleSample> still(100);
  EXPECT_TRUE(crossings_of_samples(still).crossings.empty());
}

struct SampledText {
  const char* name;
  std::string text;
};

std::vector<SampledText> sampled_texts() {
  std::vector<SampledText> texts{
      {"PhyphoxCommas", "\"Time (s)\",\"Angle (rad)\"\n"},
      {"PhyphoxDegrees", "\"Time (s)\";\"Angle (deg)\"\n"},
      {"TrackerPositions", "mass_A\nt\tx\ty\n"},
      {"Encoder", "Time/s,Angle/rad,AngVel/rad/s\n"},
      {"VernierAngles", "Vernier Format 3\nUntitled\nRun 1\nTime\tAngle\nt\tA\ns\tdeg\n\n"},
      {"Bare", ""}};
  for (const AngleSample& sample : ring_down(50.0, 1e-3, 60.0, 5)) {
    const double t = sample.time - Instant::from_seconds(1000.0);
    const double degrees = sample.angle * 180.0 / std::numbers::pi;
    texts[0].text += fmt::format("{:.4E},{:.6E}\n", t, sample.angle);
    std::string comma = fmt::format("{:.4f};{:.6f}\n", t, degrees);
    std::replace(comma.begin(), comma.end(), '.', ',');
    texts[1].text += comma;
    texts[2].text += fmt::format("{:.4f}\t{:.6f}\t{:.6f}\n", t, 0.9 * std::sin(sample.angle),
                                 -0.9 * std::cos(sample.angle));
    texts[3].text += fmt::format("{:.4f},{:.6f},0\n", t, sample.angle);
    texts[4].text += fmt::format("{:.4f}\t{:.5f}\n", t, degrees);
    texts[5].text += fmt::format("{:.4f} {:.6f} 0.001\n", t, sample.angle);
  }
  return texts;
}

TEST(AngleSamplesTest, EveryKindOfSamplesIsRead) {
  for (const SampledText& sampled : sampled_texts()) {
    const ClockLog log = read_log(sampled.text, sampled.name);
    EXPECT_EQ(log.format, LogFormat::angle) << sampled.name;
    ASSERT_EQ(log.events.size(), 75u) << sampled.name;
    EXPECT_TRUE(log.issues.empty()) << sampled.name;
    for (std::size_t k = 0; k < 75; ++k) // five sigma, and the rest angle's own error
      EXPECT_NEAR(log.events[k].time.to_double(), passage_time(k),
                  5.0 * log.columns.sigma_s[k] + 5e-4)
          << sampled.name;
    EXPECT_NEAR(log.events[40].amplitude_rad, 0.3 * std::exp(-passage_time(40) / 80.0), 2e-3)
        << sampled.name;
  }
}

TEST(AngleSamplesTest, PlacesOfTheBobAreAnglesAboutTheCentre) {
  // Pixels from the corner of a picture, downwards, a tilted camera, and noise of half a pixel.
  const auto text = [](double swing, double noise_px) {
    RandomStream noise(11, StreamPurpose::amplitude_noise);
    std::string lines = "t,x,y\n";
    for (int i = 0; i < 3000; ++i) {
      const double t = i / 60.0;
      const double angle = 0.03 + swing * std::exp(-t / 200.0) * std::cos(2.0 * std::numbers::pi * t);
      lines += fmt::format("{:.4f},{:.2f},{:.2f}\n", t,
                           640.0 + 500.0 * std::sin(angle) + noise_px * noise.normal(),
                           -40.0 + 500.0 * std::cos(angle) + noise_px * noise.normal());
    }
    return lines;
  };
  const ClockLog log = read_log(text(0.3, 0.5), "video");
  EXPECT_EQ(log.format, LogFormat::angle);
  const double t = log.events[40].time.to_double();
  EXPECT_NEAR(log.events[40].amplitude_rad, 0.3 * std::exp(-t / 200.0), 3e-3); // length to 0.3 %
  bool told = false;
  for (const Assumption& assumption : log.assumptions)
    told = told || assumption.text.find("a pendulum 5") != std::string::npos ||
           assumption.text.find("a pendulum 49") != std::string::npos;
  EXPECT_TRUE(told);
  const ClockLog flat = read_log(text(0.004, 0.5), "video");
  EXPECT_TRUE(std::isnan(flat.events[40].amplitude_rad)) << "an arc of two pixels, bent by none";
  ReadingOptions forced;
  forced.format = LogFormat::xy;
  const std::string bare = text(0.3, 0.5).substr(6);
  EXPECT_EQ(read_log(bare, "bare", forced).events.size(), log.events.size());
}

TEST(AngleSamplesTest, AVideoOfARingDown) {
  const auto path = test::real_data("video-ringdown/tyler_lab1_data.txt");
  if (!path) GTEST_SKIP() << "video-ringdown is not there";
  const ClockLog log = read_log_file(path->string());
  ASSERT_EQ(log.events.size(), 141u);
  // The publisher's fit: 1.64991 s on average; the circular error shortens it as the swing fades.
  EXPECT_NEAR((log.events[140].time - log.events[0].time) / 70.0, 1.64991, 5e-3);
  EXPECT_NEAR(log.events[1].amplitude_rad, 0.6, 0.1);
  for (const double sigma : log.columns.sigma_s)
    EXPECT_LT(sigma, 5e-3);
  // The period falls by 2.5 % with the amplitude; no beat is lost over it.
  const Beats beats = number_beats(log);
  EXPECT_EQ(beats.spurious, 0);
  EXPECT_EQ(beats.longest_segment().size(), 70u); // of 141 crossings, the first falling
}

} // namespace
} // namespace goingrate
