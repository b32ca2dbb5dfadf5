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
  std::vector<double> gained;   ///< psi_p - t there, scaled
  std::vector<double> unsolved; ///< psi_p - psi_m there, psi_m with the circular error -lambda^2/16
  std::vector<double> unsolved_in_full; ///< psi_m with the circular error of eq. ce3
  double noisy_periods = 0.0;
  double rms_gain = 0.0;        ///< scatter of the mean rate by the noise, over several runs
  double mean_gain = 0.0;       ///< its mean
  double secular = 0.0;         ///< slope of psi_p - psi_m over time
  double secular_in_full = 0.0; ///< the same with the circular error of eq. ce3
};
NoisyRun noisy_run(const PaperOptions& options);

std::vector<PaperFigure> figures(const NoisyRun& noisy);

} // namespace goingrate::paper
