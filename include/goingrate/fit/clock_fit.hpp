// Fitting the averaged amplitude-phase model to a log of crossings.
//
// What is fitted: T0, epsilon, mu, phi0, lambda0 and changes of mu, epsilon or phi0 at given
// cycles, to times and, where the log has them, amplitudes together. The model is the paper's
// first-order pair (eqs. dotl4, dotpsi4) in closed form (dynamics/averaged.hpp). Its residual at a
// crossing is
//   r_i = (psi(t_i) - 2 pi n_i) T0 / (2 pi psi'(t_i)),
// whitened for jitter and random walk (timing_noise.hpp) and minimised by Ceres.
//
// What the first order lacks is measured, not hoped for: the full equation of motion is run once at
// the fitted parameters, and the difference between its crossings and the averaged ones says how
// far each parameter is off. Dynamics `direct` adds that difference to the model and fits again
// until it stands still; the result is then the fit of the full equation, at the cost of a few
// runs.
//
// What a sigma means: the curvature of the likelihood, widened by the correlation that is left in
// the residuals. What no sigma can mean: a direction the log does not determine. Every parameter
// has a weak prior (a factor e^5 either way; T0 within 1 % of the mean period), and one whose
// relative sigma stays above a third is `undetermined`: its value is then not a result. So is one
// whose curvature proves false: the search is repeated from other starts and from along the least
// known direction, and where it comes to rest elsewhere at nearly the same cost, what differs is
// undetermined.
#pragma once

#include "goingrate/clock/parameters.hpp"
#include "goingrate/fit/timing_data.hpp"
#include "goingrate/fit/timing_noise.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace goingrate {

/// Parameters that change at a cycle.
struct FitEvent {
  std::int64_t cycle = 0;         ///< counted from the first beat of the data
  std::vector<std::string> names; ///< of "mu", "epsilon", "phi0"
};

/// A value known from elsewhere.
struct Prior {
  std::string name;
  double value = 0.0;
  double sigma = 0.0;
};

/// Which equations are fitted.
enum class FitDynamics {
  automatic, ///< averaged1 unless that shifts a determined parameter by more than a fifth of its
             ///< sigma
  averaged1, ///< the paper's first-order averaged equations
  direct,    ///< the full equation of motion
};

struct FitOptions {
  FitDynamics dynamics = FitDynamics::automatic;
  std::vector<FitEvent> events;        ///< in order of cycle
  std::map<std::string, double> fixed; ///< by name: T0 (s), epsilon, mu, phi0, lambda0, mu@1, ...
  std::vector<Prior> priors;
};

enum class ParameterStatus { free, fixed, prior, undetermined };

struct FittedParameter {
  std::string name;
  std::string unit;
  ParameterStatus status = ParameterStatus::free;
  double value = 0.0;       ///< NaN where undetermined
  double sigma = 0.0;       ///< NaN where undetermined or fixed
  double model_shift = 0.0; ///< what first-order averaging shifts it by, in sigma; NaN if not known
};

/// A quantity computed from the parameters, with its uncertainty from all of them.
struct DerivedQuantity {
  std::string name;
  std::string expression;
  std::string unit;
  double value = 0.0; ///< NaN if the log does not determine it
  double sigma = 0.0;
};

struct FitQuality {
  double chi2 = 0.0; ///< of the times against the jitter seen between neighbouring beats
  double dof = 0.0;
  double p_value = 0.0; ///< of chi2, given that the jitter itself is known to some per cent only
  double whiteness_p = 0.0;       ///< Ljung-Box on the whitened residuals
  double rms_s = 0.0;             ///< of the residuals of time
  double amplitude_rms_rad = 0.0; ///< NaN without amplitudes
  double aic = 0.0, bic = 0.0;
};

/// One of the models that were tried.
struct FitAlternative {
  std::string model;
  double bic = 0.0;
  std::string verdict;
};

enum class FitStatus {
  converged,      ///< a minimum was found, or a flat valley on which no parameter is determined
  no_valid_model, ///< no start lies in the domain of the model (amplitude above phi0)
};

struct FitSummary {
  FitStatus status = FitStatus::converged;
  std::string termination; ///< in words
  std::string dynamics;    ///< "averaged1" or "direct"
  std::string escapement;  ///< "constant-torque" or "none"
  std::string noise;       ///< "jitter" or "jitter + random walk"
  std::string chosen_by;
  std::vector<FittedParameter> parameters;
  std::vector<std::string> correlated;          ///< names of the free parameters, in order
  std::vector<std::vector<double>> correlation; ///< of those
  std::vector<DerivedQuantity> combinations;    ///< those that are determined
  DerivedQuantity q_factor, stationary_amplitude, rate_s_per_day, decay_time;
  TimingNoise timing_noise;
  double jitter_relative_sigma = 0.0; ///< infinite where the log does not determine the jitter
  double walk_relative_sigma = 0.0;
  double amplitude_noise_rad = 0.0;
  double time_widening = 1.0; ///< sigma was multiplied by this for correlation left in the times
  double amplitude_widening = 1.0; ///< likewise for the amplitudes
  FitQuality quality;
  std::vector<FitAlternative> alternatives;
  std::vector<double> residual_s;             ///< one a beat, mean removed; positive: early
  std::vector<double> model_amplitude_rad;    ///< one a beat: the turning angle
  std::vector<double> amplitude_residual_rad; ///< empty without amplitudes
};

/// Fits `data`. `nominal_period_s` only serves to state the derived rate in s a day.
///
/// Accuracy: over ten seeds of the A to B jump (2000 periods of 2 s, jitter 1e-5 s, T0 fixed) all
/// parameters lie within 3.3 sigma of the truth (ClockFitTest.JumpOverTenSeeds), likewise T0,
/// epsilon and lambda0 of a ring-down (ClockFitTest.RingDownOverTenSeeds); what is called
/// determined in start-ups and in steady and noisy clocks holds too
/// (HonestSigma.WhatIsCalledDeterminedIsRight). Limits: noise of the drive is modelled in the
/// times, not in the amplitudes, so that a log with amplitudes and a noisy drive can give sigmas
/// several times too small, as can a slow drive of some per cent; near the stall line, where
/// nothing but epsilon is determined, epsilon keeps the bias of first order (up to four sigma).
/// Cost: about 0.25 s for 2000 beats, mostly the search for other minima. Throws ArgumentError for
/// names, values or events that make no sense, or more than 16 free parameters.
FitSummary fit_clock(const TimingData& data, double nominal_period_s, const FitOptions& options);

/// The clock as it goes after the last event; nothing if one of its parameters is not known to a
/// tenth or there is no escapement.
std::optional<ClockParameters> fitted_clock(const FitSummary& fit);

/// Reads "CYCLE:NAME[,NAME]"; throws ArgumentError.
FitEvent parse_fit_event(const std::string& text);

} // namespace goingrate
