// Rates of the paper's clocks, and what is made of them. Private to the report room.
#pragma once

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
/// The mean rate over a run without its first tenth.
double mean_rate(const Scenario& scenario);
/// The rate over 4000 periods of the paper's integrator.
double rk4_rate(const ClockParameters& clock, Rk4Torque torque);

/// What the paper states in words or leaves to the reader.
void add_statements(std::vector<PaperNumber>& numbers);
/// Exact rate at C and the parts that make it, each of runs of its own.
std::vector<BudgetPart> budget_at_c();

} // namespace goingrate::paper
