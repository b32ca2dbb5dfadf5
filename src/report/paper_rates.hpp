// Rates of the paper's clocks, and numbers that follow from them. Private to the report room.
#pragma once

#include "paper_figures.hpp"

#include "base/special_values.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/dynamics/stationary.hpp"
#include "goingrate/report/paper.hpp"

#include <cstdint>
#include <vector>

namespace goingrate::paper {

inline constexpr double step = 0.03; ///< the paper's dt

inline double exact_rate(const ClockParameters& clock) { return limit_cycle(clock)->rate_excess; }
inline double first_order_rate(const ClockParameters& clock) {
  return *stationary_rate_first_order(clock);
}

Scenario scenario_of(const ClockParameters& clock, std::int64_t periods, Method method);
/// The mean rate over a run from its period `settling` on.
double mean_rate(const Scenario& scenario, std::int64_t settling);
/// The rate of the paper's integrator, after it has settled to 1e-4 of its initial deviation.
double rk4_rate(const ClockParameters& clock, Rk4Torque torque);

void add_stationary(std::vector<PaperNumber>& numbers);
void add_jump(std::vector<PaperNumber>& numbers);
void add_long_run(const NoisyRun& noisy, std::vector<PaperNumber>& numbers);
void add_noise_statistics(const NoiseStatistics& noise, std::vector<PaperNumber>& numbers);
/// Numbers for the paper's numerical issues: how RK4 switches the torque, how crossings are found.
void add_numerics(std::vector<PaperNumber>& numbers);
/// Numbers for what the paper states in words or leaves to the reader.
void add_statements(std::vector<PaperNumber>& numbers);
/// The exact rate at C and the second-order parts that add up to it.
std::vector<BudgetPart> budget_at_c();

} // namespace goingrate::paper
