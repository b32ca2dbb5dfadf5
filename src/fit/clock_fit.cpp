#include "goingrate/fit/clock_fit.hpp"

#include "fit_setup.hpp"
#include "inference.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <fmt/format.h>
#include <limits>

namespace goingrate {

namespace {

using namespace timing_model;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// Below this no time is taken at its word: the rounding of the model over a long log.
double least_jitter(const TimingData& data) {
  return 1e-12 * data.reference_period_s + 4e-16 * data.elapsed_s.back();
}
constexpr double least_amplitude_noise = 1e-9; // rad; finer than any sensor, coarser than rounding

Weights first_weights(const TimingData& data) {
  Weights weights;
  weights.timing.jitter_s = std::max(local_jitter(data.cycle, data.lateness_s), least_jitter(data));
  if (data.has_amplitude())
    weights.amplitude_rad = std::max(local_white_noise(data.amplitude_rad), least_amplitude_noise);
  return weights;
}

// The noise as the residuals show it, and how much wider what they leave unexplained makes a sigma.
Weights weights_from_residuals(const FitProblem& problem, const Prediction<double>& prediction) {
  const TimingData& data = problem.data;
  Weights weights = problem.weights;
  weights.timing = estimate_noise(data.cycle, prediction.residual_s);
  if (std::hypot(weights.timing.jitter_s, weights.timing.walk_s) < least_jitter(data))
    weights.timing = {least_jitter(data), 0.0};
  std::vector<double> white(data.size() - 1);
  Whitening(data.cycle, weights.timing).apply<double>(prediction.residual_s, white);
  weights.time_widening = std::sqrt(correlation_time(white));
  if (!data.has_amplitude()) return weights;
  std::vector<double> misfit;
  double sum = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (std::isnan(data.amplitude_rad[i])) continue;
    misfit.push_back(data.amplitude_rad[i] - prediction.amplitude[i]);
    sum += misfit.back() * misfit.back();
  }
  weights.amplitude_rad =
      std::max(std::sqrt(sum / static_cast<double>(misfit.size())), least_amplitude_noise);
  weights.amplitude_widening = std::sqrt(correlation_time(misfit));
  return weights;
}

// One model brought to its minimum.
struct Fitted {
  FitProblem problem;
  Minimum minimum;
  double bic = 0.0;
  Rivals rivals;
};

// Where the search came to rest on thinned data from different corners of the starting grid.
std::vector<Minimum> finalists_of(const FitProblem& problem, const FitOptions& options) {
  constexpr std::size_t thin = 240; // beats that tell which valley a start lies in
  constexpr int few = 12;           // iterations that tell which starts are worth finishing
  constexpr std::size_t finalists = 6;
  const TimingData data = thinned(problem.data, problem.parameters, thin);
  std::vector<Minimum> tried;
  for (const auto& point : starting_points(problem.parameters, data)) {
    FitProblem trial{data,
                     problem.parameters,
                     problem.weights,
                     {},
                     make_priors(options, problem.parameters, point)};
    Minimum minimum = minimise(trial, point, few);
    if (minimum.usable) tried.push_back(std::move(minimum));
    if (problem.parameters.free_count == 0) break;
  }
  const auto by_cost = [](const Minimum& a, const Minimum& b) { return a.cost < b.cost; };
  std::sort(tried.begin(), tried.end(), by_cost);
  if (tried.size() > finalists) tried.resize(finalists);
  for (Minimum& start : tried) {
    FitProblem trial{data,
                     problem.parameters,
                     problem.weights,
                     {},
                     make_priors(options, problem.parameters, start.x)};
    start = minimise(trial, start.x, 200);
  }
  std::erase_if(tried, [](const Minimum& minimum) { return !minimum.usable; });
  std::sort(tried.begin(), tried.end(), by_cost);
  return tried;
}

// Two and five sigma along the direction the data know least, as far as that is sane.
std::vector<std::vector<double>> along_the_valley(const Certainty& known,
                                                  std::span<const double> x) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(known.unwidened, Eigen::ComputeThinU);
  const Eigen::VectorXd weakest = svd.matrixU().col(0) * svd.singularValues()[0];
  const double longest = 3.0 / std::max(weakest.cwiseAbs().maxCoeff(), 1e-300); // a factor e^3
  std::vector<std::vector<double>> points;
  for (const double sigmas : {-5.0, -2.0, 2.0, 5.0}) {
    points.emplace_back(x.begin(), x.end());
    const double step = std::clamp(sigmas, -longest, longest);
    for (std::size_t k = 0; k < x.size(); ++k)
      points.back()[k] += step * weakest[static_cast<Eigen::Index>(k)];
  }
  return points;
}

// Searches again, from the finalists and from along the valley, on at most a few thousand beats;
// moves to a better minimum if there is one and keeps the others that are nearly as good.
void find_rivals(Fitted& fitted, const std::vector<Minimum>& finalists) {
  if (fitted.problem.parameters.free_count == 0) return;
  constexpr std::size_t enough = 3000; // beats: what is thinned away makes the check stricter
  constexpr int iterations = 60;
  const TimingData data = thinned(fitted.problem.data, fitted.problem.parameters, enough);
  const FitProblem check{
      data, fitted.problem.parameters, fitted.problem.weights, {}, fitted.problem.priors};
  Minimum best = minimise(check, fitted.minimum.x, iterations);
  if (!best.usable) return;
  std::vector<std::vector<double>> starts = along_the_valley(certainty(check, best.x), best.x);
  for (const Minimum& finalist : finalists)
    starts.push_back(finalist.x);
  std::vector<Minimum> found{best};
  for (const auto& start : starts) {
    found.push_back(minimise(check, start, iterations));
    if (found.back().usable && found.back().cost < best.cost) best = found.back();
  }
  if (best.cost < found.front().cost - 0.5) fitted.minimum.x = best.x;
  fitted.rivals.best = best.x;
  fitted.rivals.known = certainty(check, best.x);
  // Three sigma of cost, widened like the sigmas for what the noise leaves unexplained.
  const double widening = std::max(check.weights.time_widening, check.weights.amplitude_widening);
  for (const Minimum& other : found)
    if (other.usable && other.cost - best.cost < 4.5 * widening * widening)
      fitted.rivals.points.push_back(other.x);
}

// Alternates between the minimum and the size of the noise; three rounds settle both to a per cent
// of a sigma.
void settle(FitProblem& problem, Minimum& minimum, bool keep_noise) {
  constexpr int rounds = 3;
  constexpr int iterations = 60; // a dozen where the log determines the parameters
  for (int round = 0; round < rounds; ++round) {
    minimum = minimise(problem, minimum.x, iterations);
    const auto prediction = predict_at(problem, minimum.x);
    if (!minimum.usable || !prediction || (keep_noise && round > 0)) return;
    problem.weights = weights_from_residuals(problem, *prediction);
  }
  minimum = minimise(problem, minimum.x, iterations);
}

double bayes_criterion(const FitProblem& problem, const Minimum& minimum) {
  // -2 log likelihood of the whitened times and amplitudes + k log N; constants cancel between
  // models of one log.
  const auto times = static_cast<double>(problem.data.size()) - 1.0;
  double amplitudes = 0.0;
  for (const double a : problem.data.amplitude_rad)
    amplitudes += std::isnan(a) ? 0.0 : 1.0;
  double deviance = 2.0 * minimum.cost;
  deviance += Whitening(problem.data.cycle, problem.weights.timing).log_determinant();
  if (amplitudes > 0.0) deviance += 2.0 * amplitudes * std::log(problem.weights.amplitude_rad);
  return deviance +
         static_cast<double>(problem.parameters.free_count) * std::log(times + amplitudes);
}

Fitted fit_averaged(const TimingData& data, const Parameters& parameters,
                    const FitOptions& options) {
  Fitted fitted{{data, parameters, first_weights(data), {}, {}}, {}, 0.0, {}};
  const auto finalists = finalists_of(fitted.problem, options);
  if (finalists.empty()) return fitted;
  fitted.minimum = finalists.front();
  fitted.problem.priors = make_priors(options, parameters, fitted.minimum.x);
  settle(fitted.problem, fitted.minimum, false);
  if (!fitted.minimum.usable) return fitted;
  find_rivals(fitted, finalists);
  settle(fitted.problem, fitted.minimum, false);
  fitted.bic = bayes_criterion(fitted.problem, fitted.minimum);
  return fitted;
}

// Adds to the averaged model what the full equation adds, until that stands still.
bool refine_to_direct(Fitted& fitted) {
  constexpr int rounds = 8; // each gains two or three digits where the averaged model is near
  for (int round = 0; round < rounds; ++round) {
    fitted.problem.parameters.start_ratio =
        limit_cycle_ratio(fitted.problem.parameters, fitted.minimum.x);
    const auto correction = difference_to_direct(fitted.problem, fitted.minimum.x);
    if (!correction) return false;
    const std::vector<double> before = fitted.minimum.x;
    fitted.problem.correction = *correction;
    settle(fitted.problem, fitted.minimum, round > 1);
    if (!fitted.minimum.usable) return false;
    const Certainty known = certainty(fitted.problem, fitted.minimum.x);
    double largest = 0.0;
    for (std::size_t k = 0; k < before.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      largest = std::max(largest, std::abs(fitted.minimum.x[k] - before[k]) / known.sigma(i));
    }
    if (round > 0 && largest < 0.02) break; // a fiftieth of a sigma
  }
  fitted.bic = bayes_criterion(fitted.problem, fitted.minimum);
  return true;
}

// By how many sigma first order moves each coordinate; empty if the full pendulum would not run.
std::vector<double> model_shifts(const Fitted& fitted) {
  const auto correction = difference_to_direct(fitted.problem, fitted.minimum.x);
  if (!correction) return {};
  const Certainty known = certainty(fitted.problem, fitted.minimum.x);
  const Eigen::VectorXd shift = shift_by(fitted.problem, fitted.minimum.x, *correction);
  std::vector<double> in_sigma;
  for (Eigen::Index i = 0; i < shift.size(); ++i)
    in_sigma.push_back(shift[i] / known.sigma(i));
  return in_sigma;
}

void state_quality(const Fitted& fitted, FitSummary& summary) {
  const FitProblem& problem = fitted.problem;
  const TimingData& data = problem.data;
  const auto prediction = predict_at(problem, fitted.minimum.x);
  if (!prediction) return;
  FitQuality& quality = summary.quality;
  summary.residual_s = prediction->residual_s;
  summary.model_amplitude_rad = prediction->amplitude;
  const auto n = static_cast<double>(data.size());
  double sum = 0.0;
  for (const double r : summary.residual_s)
    sum += r * r;
  quality.rms_s = std::sqrt(sum / n);
  const double jitter = std::max(local_jitter(data.cycle, data.lateness_s), least_jitter(data));
  quality.chi2 = sum / (jitter * jitter);
  quality.dof = n - 1.0 - static_cast<double>(problem.parameters.free_count);
  // The jitter itself comes from third differences: variance of its square 4.6/N of its square.
  quality.p_value = unknown;
  if (quality.dof >= 1.0) {
    const boost::math::normal chance(1.0, std::sqrt(2.0 / quality.dof + 4.6 / n));
    quality.p_value = cdf(complement(chance, quality.chi2 / quality.dof));
  }
  std::vector<double> white(data.size() - 1);
  Whitening(data.cycle, problem.weights.timing).apply<double>(summary.residual_s, white);
  quality.whiteness_p = whiteness_p(white);
  quality.bic = fitted.bic;
  quality.aic =
      fitted.bic + static_cast<double>(problem.parameters.free_count) * (2.0 - std::log(n));
  quality.amplitude_rms_rad = unknown;
  if (!data.has_amplitude()) return;
  double amplitude_sum = 0.0;
  double seen = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    summary.amplitude_residual_rad.push_back(data.amplitude_rad[i] - prediction->amplitude[i]);
    if (std::isnan(data.amplitude_rad[i])) continue;
    amplitude_sum += std::pow(summary.amplitude_residual_rad.back(), 2);
    ++seen;
  }
  quality.amplitude_rms_rad = std::sqrt(amplitude_sum / seen);
}

std::string_view name_of(bool driven) { return driven ? "constant-torque" : "none"; }

bool determines_friction(const Fitted& fitted) {
  for (const Slot& slot : fitted.problem.parameters.slots) {
    if (slot.quantity != Quantity::epsilon || slot.event != 0 || !slot.free) continue;
    const Certainty known = certainty(fitted.problem, fitted.minimum.x);
    return known.sigma(static_cast<Eigen::Index>(slot.index)) < 1.0 / 3.0;
  }
  return true;
}

// A fit, which of its two kinds of clock it took, and why.
struct Choice {
  Fitted fitted;
  bool driven = true;
};

// A free pendulum is the simpler model; it is taken where it explains the log as well and its
// friction shows (a stationary log fits anything and says nothing).
Choice choose_escapement(const TimingData& data, const Parameters& with, const Parameters& without,
                         const FitOptions& options, FitSummary& summary) {
  const auto speaks_of_escapement = [](const auto& named) {
    return named == "mu" || named == "phi0";
  };
  bool may_be_free =
      options.events.empty(); // whoever speaks of the escapement means that there is one
  for (const auto& [name, value] : options.fixed)
    may_be_free = may_be_free && !speaks_of_escapement(name);
  for (const Prior& prior : options.priors)
    may_be_free = may_be_free && !speaks_of_escapement(prior.name);
  bool simpler = false;
  if (may_be_free) {
    constexpr std::size_t enough = 1000; // beats: whether a pendulum is driven shows in a few
    const TimingData thin = thinned(data, without, enough);
    Fitted driven = fit_averaged(thin, with, options);
    Fitted free = fit_averaged(thin, without, options);
    if (free.minimum.usable && determines_friction(free)) {
      // What first order lacks must not pass for a drive: both are compared in the full equation.
      refine_to_direct(free);
      if (driven.minimum.usable) refine_to_direct(driven);
      simpler = !driven.minimum.usable || free.bic < driven.bic;
    }
    summary.alternatives.push_back({"no escapement (thinned)", free.bic,
                                    simpler ? "explains the log with fewer parameters"
                                            : "no simpler explanation of this log"});
    summary.alternatives.push_back(
        {"constant-torque (thinned)", driven.bic, simpler ? "the drive is not needed" : "taken"});
  }
  return {fit_averaged(data, simpler ? without : with, options), !simpler};
}

double largest_determined_shift(const FitSummary& stated) {
  double largest = 0.0;
  for (const FittedParameter& p : stated.parameters)
    if (std::isfinite(p.model_shift) && std::isfinite(p.sigma))
      largest = std::max(largest, std::abs(p.model_shift));
  return largest;
}

void attach_shifts(const Parameters& parameters, const std::vector<double>& shifts,
                   FitSummary& summary) {
  if (shifts.empty()) return;
  for (const Slot& slot : parameters.slots)
    for (FittedParameter& p : summary.parameters)
      if (slot.free && p.name == timing_model::name_of(slot) && std::isfinite(p.sigma))
        p.model_shift = shifts[slot.index];
}

// Everything that follows from a settled fit.
void state(const Fitted& fitted, const FitOptions& options, double nominal_period_s,
           FitSummary& summary) {
  Certainty known = certainty(fitted.problem, fitted.minimum.x);
  distrust_ripples(fitted.problem, fitted.minimum.x, known);
  distrust_by_rivals(fitted.rivals, known);
  summary.status = FitStatus::converged;
  summary.termination = fitted.minimum.termination;
  if (!fitted.minimum.converged) { // it crept along a valley to the end of its patience
    known.distrusted.assign(known.distrusted.size(), true);
    summary.termination = "stopped on a flat valley: the log does not determine the parameters";
  }
  const NoiseEstimate noise = noise_with_sigmas(
      fitted.problem.data.cycle, predict_at(fitted.problem, fitted.minimum.x)->residual_s);
  summary.jitter_relative_sigma = noise.jitter_relative_sigma;
  summary.walk_relative_sigma = noise.walk_relative_sigma;
  summary.timing_noise = fitted.problem.weights.timing;
  summary.noise = summary.timing_noise.walk_s > 0.0 ? "jitter + random walk" : "jitter";
  summary.amplitude_noise_rad = fitted.problem.weights.amplitude_rad;
  summary.time_widening = fitted.problem.weights.time_widening;
  summary.amplitude_widening = fitted.problem.weights.amplitude_widening;
  summary.parameters.clear();
  summary.combinations.clear();
  summary.correlated.clear();
  summary.correlation.clear();
  state_results(fitted.problem, fitted.minimum.x, known, fitted.rivals, options, nominal_period_s,
                summary);
}

} // namespace

FitSummary fit_clock(const TimingData& data, double nominal_period_s, const FitOptions& options) {
  if (!(nominal_period_s > 0.0))
    throw ArgumentError("nominal_period", nominal_period_s, "a positive number of seconds");
  const Parameters with = make_parameters(options, data, true);
  const Parameters without = make_parameters(options, data, false);
  FitSummary summary;
  Choice choice = choose_escapement(data, with, without, options, summary);
  Fitted& fitted = choice.fitted;
  if (!fitted.minimum.usable) {
    summary.status = FitStatus::no_valid_model;
    summary.termination = "no start lies in the domain of the model (amplitude above phi0)";
    return summary;
  }
  summary.escapement = name_of(choice.driven);
  summary.dynamics = "averaged1";
  const auto shifts = model_shifts(fitted);
  state(fitted, options, nominal_period_s, summary);
  attach_shifts(fitted.problem.parameters, shifts, summary);
  const double shift = largest_determined_shift(summary);
  const bool wanted = options.dynamics == FitDynamics::direct ||
                      (options.dynamics == FitDynamics::automatic && shift > 0.2);
  if (options.dynamics == FitDynamics::averaged1)
    summary.chosen_by = "asked for";
  else
    summary.chosen_by =
        "first order is good enough: it shifts no determined parameter by more than 0.2 sigma";
  if (shifts.empty())
    summary.chosen_by =
        "the full equation of motion stops at these parameters; first order is all there is";
  if (wanted && !shifts.empty()) {
    const double first_order_bic = fitted.bic;
    if (refine_to_direct(fitted)) {
      summary.alternatives.push_back(
          {"averaged1", first_order_bic, fmt::format("off by up to {:.2g} sigma", shift)});
      summary.dynamics = "direct";
      summary.chosen_by = options.dynamics == FitDynamics::direct
                              ? "asked for"
                              : fmt::format("averaged1 is off by up to {:.2g} sigma", shift);
      state(fitted, options, nominal_period_s, summary);
      attach_shifts(fitted.problem.parameters, shifts, summary);
    }
  }
  summary.alternatives.push_back(
      {summary.dynamics + ", " + summary.escapement, fitted.bic, "chosen"});
  state_quality(fitted, summary);
  return summary;
}

std::optional<ClockParameters> fitted_clock(const FitSummary& fit) {
  if (fit.status != FitStatus::converged || fit.escapement == "none") return {};
  constexpr double well_enough = 0.1; // what hangs on the clock is then good to a tenth or so
  std::map<std::string, double> last; // later events overwrite earlier ones
  for (const FittedParameter& parameter : fit.parameters) {
    const bool vague = parameter.sigma > well_enough * std::abs(parameter.value);
    last[parameter.name.substr(0, parameter.name.find('@'))] =
        vague ? std::numeric_limits<double>::quiet_NaN() : parameter.value;
  }
  const ClockParameters clock{last["T0"], last["epsilon"], last["mu"], last["phi0"]};
  const bool known = std::isfinite(clock.nominal_period_s + clock.epsilon + clock.mu + clock.phi0);
  return known && clock.mu > 0.0 ? std::optional(clock) : std::nullopt;
}

} // namespace goingrate
