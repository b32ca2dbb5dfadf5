// The scenes of the paper and its figures. Private to the report room.
#pragma once

#include "palette.hpp"

#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/report/paper.hpp"

namespace goingrate::paper {

inline ClockParameters point_a() { return {2.0, 2.5e-4, 2e-5, 0.03}; }
inline ClockParameters point_b() { return {2.0, 2.5e-4, 4e-5, 0.03}; }
inline ClockParameters point_c() { return {2.0, 1.167245e-4, 1.5e-5, 0.03}; }

inline constexpr double drive_rms = 0.3; ///< rms of the paper's noise, relative to the torque

/// A secular difference, relative, before the noise begins and after.
struct Secular {
  double steady = 0.0, noisy = 0.0;
};

/// The run of fig. quasistat, in which the driving noise begins after a tenth of it.
struct NoisyRun {
  std::vector<double> periods;  ///< nominal periods since the start, every 500th
  std::vector<double> by_rk4;   ///< psi_p - t at these periods, scaled, by the paper's integrator
  std::vector<double> gained;   ///< the same by the return map
  std::vector<double> unsolved; ///< psi_p - psi_m, psi_m with the circular error -lambda^2/16
  std::vector<double> unsolved_by_rk4;    ///< the same, psi_p by the paper's integrator
  std::vector<double> unsolved_in_full;   ///< psi_m with the circular error of eq. ce3
  std::vector<double> unsolved_by_second; ///< psi_m by the averaged equations of second order
  Secular secular, secular_by_rk4, secular_in_full, secular_by_second; ///< slopes of these
  double rk4_s = 0.0, map_s = 0.0, model_s = 0.0;                      ///< CPU time of each
};
NoisyRun noisy_run(const PaperOptions& options);

/// A number with its standard deviation.
struct Estimate {
  double value = 0.0, sigma = 0.0;
};

/// Many short runs of the driving noise at C, started in stationary operation.
struct NoiseStatistics {
  std::vector<double> periods;  ///< lengths of run
  std::vector<double> variance; ///< of psi_p - t over the runs, rad^2
  std::vector<double> linear;   ///< the variance by the averaged equations, linear in the noise
  std::size_t runs = 0;
  Estimate growth;    ///< of the variance, rad^2 per period, once the start is forgotten
  Estimate mean_gain; ///< of the rate, due to the noise
  Estimate by_noise, by_half_the_noise; ///< contributions of noise to the secular psi_p - psi_m
};
NoiseStatistics noise_statistics(const PaperOptions& options);

std::vector<PaperFigure> jump_figures();
std::vector<PaperFigure> long_run_figures(const NoisyRun& noisy);
PaperFigure noise_figure(const NoiseStatistics& noise);
/// Figures of what the paper states in words.
std::vector<PaperFigure> statement_figures();
std::vector<PaperFigure> figures(const NoisyRun& noisy, const NoiseStatistics& noise);

} // namespace goingrate::paper
