#include "goingrate/log/amplitude.hpp"

#include "base/scaled_time.hpp"
#include "dynamics/passage.hpp"
#include "goingrate/clock/restoring.hpp"
#include "goingrate/log/reading.hpp"
#include "goingrate/log/writing.hpp"
#include "support/simulated.hpp"

#include <boost/math/special_functions/ellint_1.hpp>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

// The text a simulated sensor writes, read again.
ClockLog read_simulated(const Scenario& scenario, std::uint64_t seed = 1) {
  ClockRun run(scenario, seed);
  Sensor sensor(scenario, seed);
  const auto columns = native_columns(scenario.sensor, scenario.clock);
  std::string text = native_log_header(columns);
  sensor.see(run.last());
  while (const auto period = run.next())
    sensor.see(*period);
  for (const SensedEvent& event : sensor.take(true))
    append_native_line(text, event, columns);
  return read_log(text, "simulated");
}

Scenario flagged(SensorEdges edges) {
  Scenario scenario = test::at_point_a(300);
  scenario.sensor.edges = edges;
  scenario.sensor.flag_width_rad = 0.02;
  scenario.start_amplitude = 0.06;
  return scenario;
}

TEST(AmplitudeTest, WidthsGiveTheAmplitudeOfTheFullEquation) {
  ClockParameters free;
  free.escapement = Escapement::none;
  for (const double share : {1.0, 0.5, 0.0, -0.5})
    for (const double amplitude : {0.03, 0.3, 1.2}) {
      free.gravity_share = share;
      const double speed = velocity_of_turning_angle(share, amplitude);
      const double width = 2.0 * time_from_vertical(free, speed, true, 1.0, 0.012);
      // Rounding; at other shares than 1 the angle is a root, found by steps.
      EXPECT_NEAR(amplitude_from_width(width / two_pi * 2.0, 0.024, 2.0, share), amplitude, 1e-12)
          << share;
    }
  EXPECT_TRUE(std::isnan(amplitude_from_width(1.5, 0.024, 2.0)));
  EXPECT_TRUE(std::isnan(amplitude_from_width(1e-9, 0.024, 2.0)));
  EXPECT_TRUE(std::isnan(amplitude_from_width(NAN, 0.024, 2.0)));
}

TEST(AmplitudeTest, ItsSigmaIsTheSlope) {
  const double h = 1e-7;
  const double slope =
      (amplitude_from_width(0.15 + h, 0.024, 2.0) - amplitude_from_width(0.15 - h, 0.024, 2.0)) /
      (2.0 * h);
  const double amplitude = amplitude_from_width(0.15, 0.024, 2.0);
  // The formula is that of small swings: amplitude^2 off.
  EXPECT_NEAR(amplitude_sigma_from_width(0.15, 1e-6, amplitude, 2.0) / (-slope * 1e-6), 1.0,
              amplitude * amplitude);
}

TEST(AmplitudeTest, GateAndFourEdgesGiveTheTrueAmplitudeAndTime) {
  for (const SensorEdges edges : {SensorEdges::gate, SensorEdges::four}) {
    const Scenario scenario = flagged(edges);
    ClockLog log = read_simulated(scenario);
    ASSERT_EQ(log.flag_width_rad, 0.02);
    set_amplitudes_from_widths(log, 0.02, 2.0);
    EXPECT_TRUE(log.issues.empty());
    ASSERT_EQ(log.events.size(), 601u);
    ClockRun run(scenario, 1);
    for (std::size_t i = 2; i < log.events.size(); i += 2) {
      const Period truth = *run.next();
      // Friction and drive make the passage lopsided by mu/v and epsilon: 4e-4 of the amplitude.
      EXPECT_NEAR(log.events[i].amplitude_rad, truth.amplitude_rad, 4e-4 * truth.amplitude_rad);
      EXPECT_NEAR(log.events[i].time.to_double(), truth.time_s.value(), 2e-5);
    }
  }
}

TEST(AmplitudeTest, WithoutForcesTheyAreExact) {
  Scenario scenario = flagged(SensorEdges::gate);
  scenario.clock.escapement = Escapement::none;
  scenario.clock.epsilon = 0.0;
  ClockLog log = read_simulated(scenario);
  set_amplitudes_from_widths(log, 0.02, 2.0);
  for (const Beat& event : log.events)
    EXPECT_NEAR(event.amplitude_rad, 2.0 * std::asin(0.03), 1e-11); // 15 decimals of a width
}

// A free pendulum, from 0.1 rad until it hardly leaves its flag. The equations are those of small
// swings, good to amplitude^2/16, and of friction that changes little over a swing.
void expect_corrected(const ClockParameters& friction, std::int64_t periods, double late_s,
                      double larger) {
  Scenario scenario = flagged(SensorEdges::gate);
  scenario.clock.escapement = Escapement::none;
  scenario.clock.epsilon = friction.epsilon;
  scenario.clock.quadratic_drag = friction.quadratic_drag;
  scenario.clock.dry_friction = friction.dry_friction;
  scenario.start_amplitude = 0.1;
  scenario.periods = periods;
  ClockLog log = read_simulated(scenario);
  set_amplitudes_from_widths(log, 0.02, 2.0);
  correct_widths_for_friction(log, 0.02, 2.0);
  ClockRun run(scenario, 1);
  double share = 0.0, latest_s = 0.0, largest = 0.0;
  for (std::size_t i = 2; i < log.events.size(); i += 2) {
    const Period truth = *run.next();
    share = 0.01 / truth.amplitude_rad;
    latest_s = std::max(latest_s, std::abs(log.events[i].time.to_double() - truth.time_s.value()));
    largest = std::max(largest, std::abs(log.events[i].amplitude_rad / truth.amplitude_rad - 1.0));
  }
  EXPECT_GT(share, 0.7);
  EXPECT_LT(latest_s, late_s);
  EXPECT_LT(largest, larger);
}

// Linear friction makes times 5e-3 s late and amplitudes 5e-3 too large at the end.
TEST(AmplitudeTest, FrictionBetweenTheEdgesIsAccountedFor) {
  ClockParameters friction;
  friction.epsilon = 2.5e-3;
  expect_corrected(friction, 140, 5e-7, 5e-6);
}

// Where a dry swing nearly stops, it changes by some percent from one swing to the next. Taken for
// linear friction, all three would be 1e-3 s off.
TEST(AmplitudeTest, SoIsThatOfOtherLaws) {
  ClockParameters dry, quadratic, all;
  dry.epsilon = quadratic.epsilon = 0.0;
  dry.dry_friction = 1.5e-4;
  expect_corrected(dry, 144, 2e-5, 3e-5);
  quadratic.quadratic_drag = 0.1;
  expect_corrected(quadratic, 280, 5e-7, 1e-6);
  all.epsilon = 1e-3;
  all.dry_friction = 3e-5;
  all.quadratic_drag = 0.02;
  expect_corrected(all, 190, 2e-5, 3e-5);
}

TEST(AmplitudeTest, OffsetFromBothDirections) {
  Scenario scenario = test::at_point_a(2000);
  scenario.sensor.edges = SensorEdges::both;
  scenario.sensor.offset_rad = 4e-3;
  scenario.sensor.jitter_rms_s = 1e-5;
  scenario.sensor.amplitude_rms = 1e-5;
  const Beats beats = number_beats(read_simulated(scenario));
  const auto offset = sensor_offset(beats.beats, 2.0);
  ASSERT_TRUE(offset);
  // 1e-5 s of jitter are 1.2 urad of a swing of 39 mrad: sigma about 1.2 / sqrt(2000) * 0.6 urad.
  EXPECT_LT(offset->sigma, 1e-7);
  EXPECT_NEAR(offset->value, 4e-3, 4.0 * offset->sigma);
  const auto error = beat_error(beats.beats);
  ASSERT_TRUE(error);
  // The shift of the half-periods.
  EXPECT_NEAR(error->value, 4.0 * std::asin(4e-3 / 0.039086) * 2.0 / two_pi, 1e-4);
}

// Each half-period of a dying swing is shorter than the one before, here by 0.3 ms at first, whichever
// side of the vertical it lies on.
TEST(AmplitudeTest, ADyingSwingHasNoBeatError) {
  Scenario scenario;
  scenario.clock.escapement = Escapement::none;
  scenario.clock.epsilon = 1.5e-3;
  scenario.clock.quadratic_drag = 3e-3;
  scenario.start_amplitude = 0.95;
  scenario.periods = 60;
  scenario.sensor.edges = SensorEdges::both;
  scenario.sensor.jitter_rms_s = 1e-6;
  const Beats beats = number_beats(read_simulated(scenario));
  EXPECT_EQ(beats.spurious, 0); // the first swings are 3 % longer than the usual one
  const auto error = beat_error(beats.beats);
  ASSERT_TRUE(error);
  EXPECT_LT(error->sigma, 2e-6);
  EXPECT_NEAR(error->value, 0.0, 4.0 * error->sigma);
}

TEST(AmplitudeTest, HalfPeriodsGiveTheAmplitudeIfTheOffsetIsKnown) {
  Scenario scenario = test::jump_from_a_to_b(3000, 1e-6);
  scenario.sensor.edges = SensorEdges::both;
  scenario.sensor.offset_rad = -5e-3;
  Beats beats = number_beats(read_simulated(scenario));
  set_amplitudes_from_halves(beats.beats, -5e-3, 2.0);
  // 1e-6 s are 1e-4 of the delay of 0.08 s: 0.6 urad of 55 mrad would be white; forces 1e-3.
  EXPECT_NEAR(beats.beats[5900].amplitude_rad, 0.0552840, 2e-4);
  EXPECT_NEAR(beats.beats[10].amplitude_rad, 0.0390886, 2e-4);
}

TEST(AmplitudeTest, OffsetFromTheCorrelation) {
  // Swings that differ from beat to beat (a draught, a shaken pier) seen 6 mrad before the
  // vertical.
  int inside = 0;
  constexpr int logs = 200;
  for (std::uint64_t seed = 1; seed <= logs; ++seed) {
    RandomStream random(seed, StreamPurpose::jitter);
    ClockLog log;
    for (int i = 0; i < 1000; ++i) {
      const double amplitude = 0.045 * (1.0 + 5e-4 * random.normal());
      const double delay = std::asin(-6e-3 / amplitude) * 2.0 / two_pi + 1e-5 * random.normal();
      log.events.push_back(
          event_at(Instant::from_seconds(2.0001 * i) + delay, Edge::up, 0, amplitude));
    }
    const auto offset = sensor_offset(number_beats(log).beats, 2.0);
    ASSERT_TRUE(offset);
    EXPECT_NEAR(offset->value, -6e-3, 5.0 * offset->sigma);
    inside += std::abs(offset->value + 6e-3) < offset->sigma ? 1 : 0;
  }
  EXPECT_GE(inside, logs * 0.58); // 68 % within three standard errors, or more
}

TEST(AmplitudeTest, ADriveThatVariesIsNoOffset) {
  Scenario scenario = test::at_point_a(5000);
  scenario.sensor.jitter_rms_s = 1e-6;
  scenario.sensor.amplitude_rms = 1e-7;
  scenario.drive.fast_rms = 0.3;
  EXPECT_FALSE(sensor_offset(number_beats(read_simulated(scenario)).beats, 2.0));
}

TEST(AmplitudeTest, MovedToTheVerticalTheOffsetIsGone) {
  Scenario scenario = test::jump_from_a_to_b(1000, 0.0);
  const ClockLog centred = test::simulated_log(scenario, 1);
  scenario.sensor.offset_rad = 3e-3;
  scenario.sensor.amplitude_rms = 0.0;
  ClockLog log = test::simulated_log(scenario, 1);
  EXPECT_GT(log.events[900].time - centred.events[900].time, 0.015);
  move_to_vertical(log, 3e-3, 3e-3, 2.0);
  for (std::size_t i = 0; i < log.events.size(); ++i)
    EXPECT_NEAR(log.events[i].time - centred.events[i].time, 0.0, 3e-6) << i; // 1e-4 of 25 ms
}

TEST(AmplitudeTest, TheScatterOfAmplitudesIsThatOfTheSensor) {
  Scenario scenario = test::jump_from_a_to_b(5000, 1e-6);
  scenario.sensor.edges = SensorEdges::gate;
  scenario.sensor.flag_width_rad = 0.02;
  ClockLog log = read_simulated(scenario);
  set_amplitudes_from_widths(log, 0.02, 2.0);
  const auto good = number_beats(log).longest_segment();
  const auto summary = summarise_amplitudes(good);
  ASSERT_TRUE(summary);
  // Two edges of 1 us each; towards the end the swing is that of B: 55.3 mrad.
  const double width = amplitude_sigma_from_width(0.1158, std::sqrt(2.0) * 1e-6, 0.0553, 2.0);
  EXPECT_NEAR(summary->sigma_rad, width, 0.1 * width); // a few per cent are still those of A
  EXPECT_NEAR(summary->mean_rad, 0.0540, 1e-3);
  EXPECT_FALSE(summarise_amplitudes(std::span(good).first(4)));
}

TEST(AmplitudeTest, TheCircularErrorIsTakenOff) {
  const double amplitude = 0.1;
  const double period = boost::math::ellint_1(std::sin(0.05)) * 2.0 / std::numbers::pi;
  // Half a rounding of 1.
  EXPECT_NEAR(rate_without_circular_error(1.0 / period - 1.0, amplitude), 0.0, 1e-16);
  EXPECT_EQ(rate_without_circular_error(1e-4, 0.0), 1e-4);
  // Torsion has none; half of gravity at 1 rad has half of it to a tenth.
  EXPECT_EQ(rate_without_circular_error(1e-4, 1.0, 0.0), 1e-4);
  const double gravity = rate_without_circular_error(0.0, 1.0);
  EXPECT_NEAR(rate_without_circular_error(0.0, 1.0, 0.5) / gravity, 0.5, 0.05);
}

// A flag in front of a clock with and without gravity, swinging wide: amplitudes as they are, and a
// rate that does not follow them once the circular error is off.
TEST(AmplitudeTest, WidthsFollowTheRestoringTorque) {
  for (const double share : {0.5, 0.0}) {
    Scenario scenario = flagged(SensorEdges::gate);
    scenario.clock = {.epsilon = 1e-5};
    scenario.clock.escapement = Escapement::none;
    scenario.clock.gravity_share = share;
    scenario.start_amplitude = velocity_of_turning_angle(share, 1.0);
    ClockLog log = read_simulated(scenario);
    set_amplitudes_from_widths(log, 0.02, 2.0, share);
    // Friction turns the swing a quarter of a period later by pi eps/2, and the gate's two edges.
    EXPECT_NEAR(log.events[0].amplitude_rad, 1.0, 2e-5) << share;
    const double rate = 2.0 / (log.events[2].time - log.events[0].time) - 1.0;
    EXPECT_NEAR(rate_without_circular_error(rate, log.events[1].amplitude_rad, share), 0.0, 2e-6)
        << share;
    set_amplitudes_from_widths(log, 0.02, 2.0); // taken for a pendulum: 4 % too wide and more
    EXPECT_GT(std::abs(log.events[0].amplitude_rad - 1.0), 0.01) << share;
  }
}

TEST(AmplitudeTest, ATemperatureColumnFollowsTheScenario) {
  Scenario scenario = test::at_point_a(500);
  scenario.temperature.mean_c = 18.0;
  scenario.temperature.sines = {{2.0, 1000.0}};
  scenario.length.temperature_coefficient = 1e-5;
  scenario.sensor.temperature_rms = 0.0;
  const ClockLog log = read_simulated(scenario);
  ASSERT_EQ(log.columns.temperature_c.size(), 501u);
  // Half the fourth decimal.
  EXPECT_NEAR(log.columns.temperature_c[125], 18.0 + 2.0 * std::sin(two_pi * 0.25), 5e-5);
  // Two degrees warmer the pendulum is 2e-5 longer and 1e-5 slower than two degrees colder, twice.
  const auto period = [&](std::size_t i) { return log.events[i + 1].time - log.events[i].time; };
  EXPECT_NEAR(period(125) / period(375) - 1.0, 2e-5, 2e-7); // the amplitude is the same to 1e-2
}

} // namespace
} // namespace goingrate
