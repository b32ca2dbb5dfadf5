// The scenes of the paper and its figures. Private to the report room.
#pragma once

#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/report/paper.hpp"

namespace goingrate::paper {

inline ClockParameters point_a() { return {2.0, 2.5e-4, 2e-5, 0.03}; }
inline ClockParameters point_b() { return {2.0, 2.5e-4, 4e-5, 0.03}; }
inline ClockParameters point_c() { return {2.0, 1.167245e-4, 1.5e-5, 0.03}; }

/// From A to B at cycle 150.
Scenario jump_scenario(std::int64_t periods, Method method);

/// The run of fig. quasistat: 30 % driving noise from a tenth of it on.
struct NoisyRun {
  std::vector<double> periods;  ///< nominal periods since the start, every 500th
  std::vector<double> by_rk4;   ///< psi_p - t there, scaled, by the paper's integrator
  std::vector<double> gained;   ///< the same by the return map
  std::vector<double> unsolved; ///< psi_p - psi_m, psi_m with the circular error -lambda^2/16
  std::vector<double> unsolved_by_rk4;  ///< the same, psi_p by the paper's integrator
  std::vector<double> unsolved_in_full; ///< psi_m with the circular error of eq. ce3
  double secular = 0.0;                 ///< slope of psi_p - psi_m over time
  double secular_by_rk4 = 0.0;          ///< the same, psi_p by the paper's integrator
  double secular_in_full = 0.0;         ///< the same with the circular error of eq. ce3
  double rk4_s = 0.0, map_s = 0.0, model_s = 0.0; ///< CPU time of each
};
NoisyRun noisy_run(const PaperOptions& options);

std::vector<PaperFigure> figures(const NoisyRun& noisy);

} // namespace goingrate::paper
