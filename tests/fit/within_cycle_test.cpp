// A change in the middle of a swing: the averaged clock against an integrator.
#include "fit/clock_model.hpp"
#include "support/changed_in_a_swing.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

using timing_model::Coordinate;
using timing_model::Quantity;

constexpr double period_s = 1.5, amplitude = 0.08;
constexpr std::int64_t change_cycle = 40;
constexpr std::size_t crossings = 400;
const ClockParameters before{period_s, 4e-4, 5e-5, 0.03};

struct Changed {
  std::string name;
  ClockParameters after;
};
const std::vector<Changed> changes{{"mu", {period_s, 4e-4, 9e-5, 0.03}},
                                   {"epsilon", {period_s, 8e-4, 5e-5, 0.03}},
                                   {"phi0", {period_s, 4e-4, 5e-5, 0.015}},
                                   {"T0", {period_s * 1.0002, 4e-4, 5e-5, 0.03}}};

std::vector<double> integrated(const ClockParameters& after, double moment) {
  return test::crossings_of_a_changed_clock(before, after, amplitude, change_cycle + moment,
                                            crossings, 0.0, 1);
}

// How late the averaged clock makes the times of a log.
std::vector<double> lateness(const TimingData& data, const ClockParameters& after, double moment) {
  timing_model::Parameters parameters;
  parameters.event_cycles = {static_cast<double>(change_cycle)};
  const auto add = [&](Quantity quantity, double value, std::size_t event) {
    timing_model::Slot slot{quantity, event, Coordinate::multiple};
    slot.free = false;
    slot.fixed_value = value;
    parameters.add(slot);
  };
  for (const std::size_t event : {0, 1}) {
    const ClockParameters& clock = event == 0 ? before : after;
    add(Quantity::T0, clock.nominal_period_s, event);
    add(Quantity::epsilon, clock.epsilon, event);
    add(Quantity::mu, clock.mu, event);
    add(Quantity::phi0, clock.phi0, event);
  }
  add(Quantity::lambda0, amplitude, 0);
  add(Quantity::moment, moment, 1);
  std::vector<double> late;
  timing_model::Follower<double>(parameters, {}, data).run([&](std::size_t, const auto& sight) {
    late.push_back(sight.late_s);
  });
  return late;
}

TimingData as_data(const std::vector<double>& times) {
  std::vector<Beat> beats;
  for (const double time : times) {
    beats.push_back(event_at(Instant::from_seconds(time)));
    beats.back().cycle = static_cast<std::int64_t>(beats.size()) - 1;
  }
  return timing_data(beats);
}

// What a change in the middle of a swing adds to the times, over one at the crossing, to 1 %: the
// averaged equations hold to first order, and the next is epsilon, mu/lambda and lambda^2/16.
TEST(WithinCycleTest, AChangeInASwingLeapsAsTheIntegratedClockDoes) {
  for (const Changed& change : changes) {
    const auto at_crossing = integrated(change.after, 0.0);
    const TimingData data = as_data(at_crossing);
    const auto late = lateness(data, change.after, 0.0);
    for (const double moment : {0.02, 0.2, 0.3, 0.45, 0.52, 0.6, 0.8, 0.95}) {
      const auto within = integrated(change.after, moment);
      const auto moved = lateness(data, change.after, moment);
      double worst = 0.0, largest = 0.0;
      for (std::size_t i = change_cycle + 2; i < crossings; ++i) {
        const double seen = within[i] - at_crossing[i], said = late[i] - moved[i];
        worst = std::max(worst, std::abs(said - seen));
        largest = std::max(largest, std::abs(seen));
      }
      EXPECT_LT(worst, 0.01 * largest + 1e-9) << change.name << " changed at " << moment << " of a swing";
    }
  }
}

} // namespace
} // namespace goingrate
