#include "fit/twin.hpp"

#include "fit/fit_starts.hpp"
#include "goingrate/fit/timing_data.hpp"
#include "support/simulated.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>

namespace goingrate::timing_model {
namespace {

// A steady log whose drive varies both from beat to beat and slowly, and its true parameters as
// coordinates of the fit. What twins are: fit/twin.hpp.
class TwinTest : public testing::Test {
protected:
  TwinTest() {
    Scenario scenario;
    scenario.clock = {2.0, 2.5e-4, 2e-5, 0.03};
    scenario.periods = 12'000;
    scenario.drive.fast_rms = 0.05;
    scenario.drive.slow_rms = 0.03;
    scenario.drive.slow_time_s = 3000.0;
    scenario.sensor.jitter_rms_s = 2e-5;
    const auto beats = test::simulated_beats(scenario, 1);
    data_ = timing_data(beats);
    ModelChoice model;
    model.drive = model.slow = true;
    problem_ = make_problem(data_, {}, model);
    const double stationary = std::sqrt(2.0 * 2e-5 * 0.03 / (std::numbers::pi * 2.5e-4));
    const std::map<std::string, double> truth{
        {"T0", 2.0},         {"epsilon", 2.5e-4},     {"mu", 2e-5},
        {"phi0", 0.03},      {"lambda0", stationary}, {"jitter_rms", 2e-5},
        {"drive_rms", 0.05}, {"slow_rms", 0.03},      {"slow_time", 3000.0}};
    truth_.resize(problem_.parameters.free_count);
    for (const Slot& slot : problem_.parameters.slots)
      if (slot.free)
        truth_[slot.index] = slot.coordinate_of(truth.at(problem_.parameters.name_of(slot)));
  }

  [[nodiscard]] double behind(const std::vector<double>& x) const {
    return minus_log_likelihood(problem_, x).value_or(1e9) -
           *minus_log_likelihood(problem_, truth_);
  }
  [[nodiscard]] double value(Quantity quantity, const std::vector<double>& x) const {
    return problem_.parameters.find(quantity)->value(std::span<const double>(x));
  }

  TimingData data_;
  FitProblem problem_;
  std::vector<double> truth_;
};

TEST_F(TwinTest, EachExplainsTheLogEquallyWell) {
  const auto twins = twins_of(problem_, truth_);
  ASSERT_EQ(twins.size(), 7U); // two poles, two zeros, two signs, less the clock itself
  std::size_t found = 0;
  for (const auto& twin : twins) {
    if (!twin) continue;
    ++found;
    // Of log L: the state at the start and a density of continuous time cost this much.
    EXPECT_LT(behind(*twin), 60.0);
  }
  EXPECT_GE(found, 3U);
  std::vector<double> other = truth_;
  other[problem_.parameters.find(Quantity::drive_rms)->index] -= std::log(2.0);
  EXPECT_GT(behind(other), 600.0); // half of the drive and nothing else: some 2000
}

TEST_F(TwinTest, ATwinSwapsTheRelaxationTimes) {
  const double relaxation_s = 2.0 / (4.0 * std::numbers::pi * 2.5e-4);
  bool swapped = false;
  for (const auto& twin : twins_of(problem_, truth_)) {
    if (!twin || std::abs(value(Quantity::slow_time, *twin) / relaxation_s - 1.0) > 1e-9) continue;
    swapped = true;
    EXPECT_NEAR(value(Quantity::epsilon, *twin), 2.0 / (4.0 * std::numbers::pi * 3000.0), 1e-12);
  }
  EXPECT_TRUE(swapped);
}

TEST_F(TwinTest, AChangeOfTheSwingLeavesNoTwins) {
  FitOptions options;
  ModelChoice model;
  model.drive = true;
  options.events = {{.cycle = 6000, .names = {"T0"}}};
  FitProblem problem = make_problem(data_, options, model);
  std::vector<double> x(problem.parameters.free_count);
  for (const Slot& slot : problem.parameters.slots)
    if (slot.free)
      for (const Slot& other : problem_.parameters.slots)
        if (other.quantity == slot.quantity)
          x[slot.index] = slot.coordinate_of(other.value(std::span<const double>(truth_)));
  EXPECT_FALSE(twins_of(problem, x).empty()); // another length does not change the swing
  options.events.front().names = {"mu"};
  problem = make_problem(data_, options, model);
  EXPECT_TRUE(twins_of(problem, x).empty());
}

} // namespace
} // namespace goingrate::timing_model
