// Fitting the amplitude-phase model to a log of crossings.
//
// What is fitted. Times and, where the log has them, amplitudes together: T0, friction (epsilon,
// and quadratic or dry terms), the escapement (mu and phi0, or an impulse and its angle), the
// amplitude at the start, changes of these at given cycles, a sensor off the vertical, and rates
// that follow the temperature, the pressure or time itself.
//
// Dynamics. The paper's first-order pair (eqs. dotl4, dotpsi4) carries the derivatives. `averaged2`
// and `map` (the full equation of motion) are fitted by adding what they differ by from first
// order, found by running them once at the fitted parameters, until that stands still: the result
// is the fit of those dynamics at the cost of a few runs. `auto` takes the first of the three that
// is off by less than a fifth of a sigma in every parameter the log determines.
//
// Noise. Jitter is white in time. Noise of the drive is white per period, enters amplitude and
// phase as the equations say, and so makes the times a random walk that remembers; slow drive is
// an Ornstein-Uhlenbeck process. Any subset may be present; sizes are estimated along with the
// rest. The likelihood is that of the state-space model, by a Kalman filter at O(N); without drive
// noise it is least squares. It is maximised by Ceres, several starts, and `auto` adds a noise
// only where BIC asks for it.
//
// What a sigma means: the curvature of the likelihood, widened by correlation left in the
// innovations if a test finds any. Intervals are of the profile likelihood where it is not a
// parabola. What no sigma can mean: a direction the log does not determine. Every parameter has a
// weak prior (a factor e^5 either way; T0 within 1 % of the mean period), and one whose relative
// sigma stays above a third, or whose 68 % interval does not close, is `undetermined`: its value is
// then not a result, and what the log does determine is listed as combinations.
#pragma once

#include "goingrate/clock/parameters.hpp"
#include "goingrate/fit/fit_event.hpp"
#include "goingrate/fit/decay.hpp"
#include "goingrate/fit/timing_data.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace goingrate {

/// A value known from elsewhere.
struct Prior {
  std::string name;
  double value = 0.0;
  double sigma = 0.0;
};

/// Which equations are fitted.
enum class FitDynamics {
  automatic, ///< the first of the others that shifts no determined parameter by more than a fifth
             ///< of its sigma
  averaged1, ///< the paper's first-order averaged equations
  averaged2, ///< second order (dynamics/averaged2.hpp)
  map,       ///< the full equation of motion
};
std::string_view name_of(FitDynamics dynamics);

/// Which noise is fitted, besides that of an amplitude column.
enum class FitNoise {
  automatic, ///< jitter, and what BIC asks for besides
  jitter,    ///< white in time
  drive,     ///< white per period, times without error
  both,      ///< jitter and white drive
  slow,      ///< these two and slow drive
};

/// What one model of the clock and its noise consists of.
struct ModelChoice {
  Escapement escapement = Escapement::constant_torque;
  bool quadratic = false, dry = false;
  bool amplitude_scale = false; ///< the amplitude column is off by a factor
  bool jitter = true, walk = false, drive = false, slow = false;
  /// What is known of the moment within a swing of an event that did not come at a crossing.
  enum class Moments { of_crossings, loose, fitted } moments = Moments::of_crossings;

  /// "constant-torque, friction linear, noise jitter + drive"
  [[nodiscard]] std::string name() const;
  [[nodiscard]] std::string friction() const; ///< "linear + dry"
  [[nodiscard]] std::string noise() const;    ///< "jitter + drive"
};

/// What a fit is to do; it finds out what is left empty.
struct FitOptions {
  FitDynamics dynamics = FitDynamics::automatic;
  FitNoise noise = FitNoise::automatic;
  std::optional<Escapement> escapement; ///< none: constant torque, or no escapement if that does
  std::vector<FitEvent> events;         ///< in order of cycle
  /// Taken, all or none, where BIC gains by them and by what their dates cost.
  std::vector<FitEvent> possible_events{};
  std::map<std::string, double> fixed; ///< by name: T0 (s), epsilon, mu, phi0, lambda0, mu@1 ...
  std::vector<Prior> priors;
  /// Parameters that are fitted only if named: quadratic_drag, dry_friction, gravity_share, offset,
  /// and the names of the data's terms; a name that is always fitted is taken out of `fixed`.
  std::vector<std::string> freed;
  /// Where to begin: every parameter of the clock that is fitted, or none for a search.
  std::map<std::string, double> start;
  bool profiles = false; ///< whether to trace FittedParameter::profile
};

/// Whether a parameter was fitted, held, fitted with knowledge from elsewhere, or cannot be told.
enum class ParameterStatus { free, fixed, prior, undetermined };

/// One point of a profile likelihood: the parameter is held there and all others are fitted again.
struct ProfilePoint {
  double value = 0.0; ///< of the parameter
  /// By how much 2 log L is below its maximum, over the square by which sigma was widened: 1 at the
  /// ends of the 68 % interval, 3.84 at those of 95 %. Good to 0.05 or 2 %
  /// (ClockFitTest.AProfileIsThatOfFitsWithTheParameterHeld).
  double fall = 0.0;
};

/// One parameter of the model.
struct FittedParameter {
  std::string name;
  std::string unit;
  ParameterStatus status = ParameterStatus::free;
  double value = 0.0; ///< NaN where undetermined
  double sigma = 0.0; ///< NaN where undetermined or fixed
  /// Ends of the intervals; infinite where the likelihood does not fall far enough on that side;
  /// NaN where undetermined or fixed.
  double low68 = 0.0, high68 = 0.0, low95 = 0.0, high95 = 0.0;
  /// What sigma would be if the law of friction were known to be that of the fit: smaller than
  /// sigma for T0 and lambda0 of a free pendulum where the log allows other laws
  /// (FrictionLaw::T0_s), else the same.
  double sigma_by_law = 0.0;
  bool at_bound = false;    ///< the search ended at the edge of the allowed
  double model_shift = 0.0; ///< what first-order averaging shifts it by, in sigma; NaN if not known
  /// Its profile likelihood from beyond one end of the 95 % interval to beyond the other, in order
  /// of value; empty unless asked for, and where undetermined or fixed.
  std::vector<ProfilePoint> profile{};
};

/// A quantity computed from the parameters, with its uncertainty from all of them.
struct DerivedQuantity {
  std::string name;
  std::string expression;
  std::string unit;
  double value = 0.0; ///< NaN if the log does not determine it
  double sigma = 0.0;
};

/// How well the model describes the log.
struct FitQuality {
  /// Chi-squared of the times against the jitter seen between neighbouring beats; where the model
  /// has a walk or noise of the drive, of the innovations against their variances.
  double chi2 = 0.0;
  double dof = 0.0;
  double p_value = 0.0; ///< of chi2, given that the jitter itself is known to some per cent only
  bool of_innovations = false;    ///< which of the two chi2 is
  double whiteness_p = 0.0;       ///< Ljung-Box on the innovations of the times; NaN if they
                                  ///< are rounding only
  double rms_s = 0.0;             ///< of the times about the undisturbed course
  double amplitude_rms_rad = 0.0; ///< NaN without amplitudes
  double aic = 0.0, bic = 0.0;
};

/// One of the models that were tried.
struct FitAlternative {
  std::string model;
  double bic = 0.0;
  std::string verdict;
};

/// Something that could be done, and the relative sigmas that would then be expected.
struct Experiment {
  std::string what;
  std::vector<std::pair<std::string, double>> relative_sigma; ///< by name of parameter
};

/// How the log was thinned for the fit.
struct Thinning {
  std::size_t beats = 0;         ///< used for the fit; 0: all
  double information_lost = 0.0; ///< largest relative loss of information on a parameter
};

/// How a fit ended.
enum class FitStatus {
  converged,      ///< a maximum was found, and the model describes the log
  stopped_early,  ///< the search crept along a flat ridge to its end: no parameter is determined
  no_valid_model, ///< no start lies in the domain of the model (amplitude above phi0)
  /// A maximum was found, and the log is not such a clock's: chi-squared is as large by chance in
  /// less than one log of a million, a stretch of the log scatters far more than the rest, or the
  /// best place is at the edge of where the equations hold (Q of 5, a swing of 140 degrees). No
  /// parameter is determined, and a note says why.
  contradicts_log,
};
/// "converged", "stopped-early", "no-valid-model" or "contradicts-log".
std::string_view name_of(FitStatus status);

/// What a note speaks of.
enum class NoteKind {
  prior,         ///< the log contradicts one
  twin,          ///< another clock explains the log as well
  rough_stretch, ///< a part of the log scatters far more than the rest
  dynamics,      ///< what equations could not be used
  domain,        ///< the best place is at the edge of where the equations hold
  misfit,        ///< the times stray from the best place by more than they scatter
  change,        ///< another change at the same date explains the log as well
  displacement,  ///< of the times from a beat on, taken off before the fit
  wheel,         ///< its turns in the times or the amplitudes, taken off before the fit
};

/// Something that must be said besides the numbers.
struct FitNote {
  NoteKind kind{};
  std::string text;
};

/// One of several clocks that explain the log about as well: its parameters that were free, without
/// noise.
struct ClockTwin {
  std::vector<std::pair<std::string, double>> parameters;
  /// Sigma of each, if it is this clock; NaN where even then the log does not determine it.
  std::vector<std::pair<std::string, double>> sigma;
  double delta_2logL = 0.0; ///< by how much its 2 log L is below that of the fit
};

/// The result of a fit.
struct FitSummary {
  FitStatus status = FitStatus::converged;
  std::string termination;                       ///< in words
  FitDynamics dynamics = FitDynamics::averaged1; ///< never automatic
  ModelChoice model{};
  std::string chosen_by;                        ///< why these dynamics, in words
  std::vector<FittedParameter> parameters;      ///< noise included
  std::vector<std::string> correlated;          ///< names of the free parameters, in order
  std::vector<std::vector<double>> correlation; ///< of those
  std::vector<DerivedQuantity> combinations;    ///< those that are determined
  /// Q and decay time are those of linear friction; with other friction in addition they depend on
  /// the amplitude and are NaN, and `decay` has them.
  DerivedQuantity q_factor, stationary_amplitude, rate_s_per_day, decay_time;
  std::optional<Decay> decay{};     ///< of a pendulum that swings freely
  double jitter_s = 0.0;            ///< NaN where the log does not determine it
  double amplitude_noise_rad = 0.0; ///< NaN without amplitudes
  double time_widening = 1.0; ///< sigma was multiplied by this for correlation left in the times
  double amplitude_widening = 1.0; ///< likewise for the amplitudes
  FitQuality quality;
  std::vector<FitAlternative> alternatives;
  std::vector<ClockTwin> twins;        ///< those more than 3.5 sigma away, the likeliest first
  std::optional<ClockTwin> likeliest_twin{}; ///< where there are any, the clock they compete with
  std::vector<Experiment> experiments; ///< where something is undetermined
  Thinning thinning;
  std::optional<ImpulseCycle> impulses{}; ///< of an escapement that rests: those of the data
  std::vector<FitEvent> events;           ///< as they were fitted
  std::vector<FitNote> notes;
  /// One per beat, mean removed; positive: late. They and the amplitude residuals contain what was
  /// subtracted for wheels of the train, unlike the rms values of `quality`.
  std::vector<double> residual_s;
  std::vector<double> model_amplitude_rad;    ///< one per beat: the turning angle
  std::vector<double> amplitude_residual_rad; ///< empty without amplitudes

  /// Whether there are parameters to show, determined or not.
  [[nodiscard]] bool has_result() const { return status != FitStatus::no_valid_model; }
  /// The parameter of that name, or nullptr where the model has none.
  [[nodiscard]] const FittedParameter* find(std::string_view name) const;
  /// The same, for a name the model has; throws ArgumentError for another.
  const FittedParameter& operator[](std::string_view name) const;
  /// The determined combination of that name, or nullptr.
  [[nodiscard]] const DerivedQuantity* combination(std::string_view name) const;
};

/// Told what a fit does from now on: "fitting the model, step 2 of 5: equations and noise".
using FitStage = std::function<void(std::string_view)>;

/// Fits `data`. `nominal_period_s` only serves to state the derived rate in s a day. The work is
/// shared among all processors; their number changes no bit of the result
/// (ClockFitTest.TheNumberOfThreadsChangesNothing). `now` is called by the caller's own thread.
///
/// Accuracy: truth lies in the 68 % and 95 % intervals as often as it should, and sigma is that of
/// the full simulator's Cramer-Rao bound (tests/studies/coverage.txt; HonestSigma in the tests is
/// its short form). Throws ArgumentError for data of fewer than three beats or of unequal lengths,
/// for names, values or events that make no sense, a start of some parameters only, or more than 20
/// free parameters.
FitSummary fit_clock(const TimingData& data, double nominal_period_s, const FitOptions& options,
                     const FitStage& now = {});

/// The clock as it goes after the last event; nullopt if one of its parameters is not known to a
/// tenth or there is no escapement of constant torque.
std::optional<ClockParameters> fitted_clock(const FitSummary& fit);

/// Reads "CYCLE:NAME[,NAME]"; throws ArgumentError.
FitEvent parse_fit_event(const std::string& text);

} // namespace goingrate
