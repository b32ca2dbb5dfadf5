#include "model_fit.hpp"

#include "final_clock.hpp"
#include "fit_starts.hpp"
#include "reference_run.hpp"
#include "twin.hpp"

#include "base/scaled_time.hpp"
#include "fit/timing_noise.hpp"

#include <algorithm>
#include <array>

namespace goingrate::timing_model {

namespace {

// A place beside one that has moved: what thinned beats or other dynamics move, both are moved by.
std::vector<double> moved_along(std::vector<double> place, std::span<const double> from,
                                std::span<const double> to) {
  for (std::size_t k = 0; k < place.size(); ++k)
    place[k] += to[k] - from[k];
  return place;
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

bool all_but_known(const FitProblem& problem, const Certainty& known, std::span<const double> x) {
  constexpr double well = 0.1; // of what would be too vague
  return std::all_of(problem.parameters.slots.begin(), problem.parameters.slots.end(),
                     [&](const Slot& slot) {
                       return !slot.free || is_noise(slot.quantity) ||
                              known.sigma(slot.index) < well * tolerable_sigma(problem, slot, x);
                     });
}

// Whether the fit knows the clock well enough to be the only place to look from.
bool knows_its_clock(const Fitted& fitted) {
  return all_but_known(fitted.problem, fitted.known, fitted.minimum.x);
}

// Lets a few beats stand for all where nothing but jitter disturbs them.
void condense(FitProblem& problem, std::span<const double> x) {
  const Parameters& parameters = problem.parameters;
  for (const Quantity quantity : {Quantity::walk_rms, Quantity::drive_rms, Quantity::term})
    if (parameters.has(quantity)) return;
  if (problem.data->has_amplitude()) return;
  double epsilon = 0.0; // the largest
  for (const Slot& slot : parameters.slots)
    if (slot.quantity == Quantity::epsilon) epsilon = std::max(epsilon, slot.value(x));
  problem.condensed =
      CondensedLog::of(*problem.data, parameters.event_cycles, 1.0 / (2.0 * two_pi * epsilon));
}

// Whether the few beats say what all say.
bool condensed_well(const FitProblem& problem, std::span<const double> x) {
  constexpr double enough = 1e-3; // of L: 0.05 sigma
  const auto few = minus_log_likelihood(problem, x);
  const auto all = minus_log_likelihood(on_every_beat(problem), x);
  return few && all && std::abs(*few - *all) < enough;
}

// Searches again on at most a few thousand beats, from the other finalists and, where something is
// known badly, from along the valley; moves to a better minimum if there is one and keeps the
// others that are nearly as good.
// True if it moved.
bool find_rivals(Fitted& fitted, const std::vector<std::vector<double>>& others) {
  if (others.empty() && knows_its_clock(fitted)) return false;
  constexpr std::size_t enough = 3000; // beats: what is thinned away makes the check stricter
  const TimingData data = thinned(*fitted.problem.data, fitted.problem.parameters, enough);
  const FitProblem check = fitted.problem.on(data); // condensed beats hold near one end only
  const Minimum home = minimise(check, fitted.minimum.x, {60, 1e-3});
  if (!home.usable) return false;
  const auto there = evaluate(check, home.x);
  if (!there) return false;
  const Certainty known = certainty(check, *there, {});
  std::vector<std::vector<double>> starts = others;
  if (!all_but_known(check, known, home.x))
    for (auto& point : along_the_valley(known, home.x))
      starts.push_back(std::move(point));
  std::vector<Minimum> found{home};
  Minimum best = home;
  constexpr double near = 4.5;       // of L: three sigma
  constexpr double farthest = 100.0; // of L: what first order is off by, 14 sigma
  for (const auto& start : starts) {
    Minimum end = minimise(check, start, {60, 1e-3});
    // What still creeps may be on its way to the best place.
    if (end.usable && !end.converged && end.value < best.value + farthest)
      end = minimise(check, end.x, {200, 1e-3});
    if (end.usable && end.value < best.value) best = end;
    found.push_back(std::move(end));
  }
  constexpr double better = 0.5; // of L
  const bool moved = best.value < home.value - better;
  if (moved) fitted.minimum.x = best.x;
  const std::vector<double>& here = moved ? best.x : home.x;
  for (const Minimum& other : found)
    if (other.usable && other.converged && other.value < best.value + near)
      fitted.rivals.push_back({other.x, other.value - best.value});
  // Without a change the ends lie in one flat valley, which first order knows as well.
  for (const Minimum& other : found)
    if (other.usable && other.converged && other.value < best.value + farthest &&
        known.tells_apart(other.x, here) && !check.parameters.event_cycles.empty())
      fitted.ends.push_back(other.x);
  for (Rival& rival : fitted.rivals)
    rival.x = moved_along(rival.x, here, fitted.minimum.x);
  return moved;
}

// Makes the noise as large as the innovations say it is.
void rescale_noise(const FitProblem& problem, std::vector<double>& x) {
  const auto seen = residuals(problem, x);
  if (!seen) return;
  for (const Slot& slot : problem.parameters.slots) {
    if (!slot.free || !is_noise(slot.quantity) || slot.quantity == Quantity::slow_time) continue;
    const bool of_amplitude = slot.quantity == Quantity::amplitude_rms;
    const auto& white = of_amplitude ? seen->white_amplitude : seen->white_time;
    if (white.empty()) continue;
    const auto [low, high] = problem.bounds[slot.index];
    x[slot.index] = std::clamp(x[slot.index] + std::log(rms(white)), low, high);
  }
}

// Where the misfit says nothing of the noise yet, the clock is moved first, with the noise held.
void settle_clock(const FitProblem& problem, std::vector<double>& x, const SearchLimits& limits) {
  const auto seen = residuals(problem, x);
  if (!seen) return;
  constexpr double far = 2.0;
  if (rms(seen->white_time) < far && rms(seen->white_amplitude) < far) return;
  FitProblem held = with_noise_held(problem, x);
  const std::size_t clock = held.parameters.free_count;
  std::erase_if(held.priors, [&](const CoordinatePrior& p) { return p.index >= clock; });
  const Minimum moved =
      minimise(held, {x.begin(), x.begin() + static_cast<std::ptrdiff_t>(clock)}, limits);
  if (moved.usable) std::copy(moved.x.begin(), moved.x.end(), x.begin());
  rescale_noise(problem, x);
}

void settle(FitProblem& problem, Minimum& minimum, const SearchLimits& limits) {
  settle_clock(problem, minimum.x, limits);
  minimum = minimise(problem, minimum.x, limits);
  // The first search counts from a bad start, whose misfit may drown what is left to gain.
  if (minimum.usable && !minimum.converged) minimum = minimise(problem, minimum.x, limits);
  if (!minimum.usable || problem.condensed == nullptr || condensed_well(problem, minimum.x)) return;
  problem = on_every_beat(problem);
  minimum = minimise(problem, minimum.x, limits);
}

Widening widening_of(const Fitted& fitted) {
  Widening widening;
  if (is_rounding(fitted)) return widening;
  constexpr double surely = 1e-3;
  const auto of = [&](const std::vector<double>& innovations) {
    const bool doubtful = innovations.size() >= 8 && whiteness_p(innovations) < surely;
    return doubtful ? std::sqrt(correlation_time(innovations)) : 1.0;
  };
  widening.time = of(fitted.seen.white_time);
  widening.amplitude = of(fitted.seen.white_amplitude);
  const auto n =
      static_cast<double>(fitted.seen.white_time.size() + fitted.seen.white_amplitude.size());
  const auto p = static_cast<double>(fitted.problem.parameters.free_count);
  const double taken = std::sqrt(n / std::max(1.0, n - p));
  widening.time *= taken;
  widening.amplitude *= taken;
  return widening;
}

// What hangs on the place where the search ended.
void finish(Fitted& fitted) {
  fitted.bic = bayes_criterion(fitted.problem, fitted.minimum);
  auto seen = residuals(fitted.problem, fitted.minimum.x);
  const auto at = evaluate(fitted.problem, fitted.minimum.x);
  if (!seen || !at) {
    fitted.minimum.usable = false;
    return;
  }
  fitted.seen = std::move(*seen);
  fitted.widening = widening_of(fitted);
  fitted.known = certainty(fitted.problem, *at, fitted.widening);
}

// A richer model than can be searched for is not tried.
bool has_too_many(const FitProblem& problem) {
  return problem.parameters.free_count > most_parameters;
}

constexpr std::size_t enough_to_screen = 2500; // beats that tell starts apart,
constexpr std::size_t enough_to_rank = 1000;   // that say which of many to look at

} // namespace

bool is_rounding(const Fitted& fitted) {
  return rms(fitted.seen.late_s) < least_jitter(*fitted.problem.data);
}

double bayes_criterion(const FitProblem& problem, const Minimum& minimum) {
  double weak = 0.0;
  for (const CoordinatePrior& prior : problem.priors)
    if (!prior.stated)
      weak += 0.5 * std::pow((minimum.x[prior.index] - prior.centre) / prior.sigma, 2);
  double seen = static_cast<double>(problem.data->size()) - 1.0;
  for (const double a : problem.data->amplitude_rad)
    seen += std::isnan(a) ? 0.0 : 1.0;
  return 2.0 * (minimum.value - weak) +
         static_cast<double>(problem.parameters.free_count) * std::log(seen);
}

namespace {

// A change that is held may close the way from every start to the best place; where the same model
// comes to rest with it free is a start on the far side.
std::optional<std::vector<double>>
start_from_free_changes(const TimingData& data, const FitOptions& options, const ModelChoice& model,
                        const NoiseGuess& noise, const Parameters& parameters,
                        std::span<const double> otherwise) {
  FitOptions wider = options;
  std::erase_if(wider.fixed,
                [](const auto& item) { return item.first.find('@') != std::string::npos; });
  if (wider.fixed.size() == options.fixed.size()) return {};
  const Fitted there = fit_from_scratch(data, wider, model, noise);
  if (!there.minimum.usable) return {};
  return carried_over(there.problem.parameters, there.minimum.x, parameters, otherwise);
}

} // namespace

Fitted fit_from_scratch(const TimingData& data, const FitOptions& options, const ModelChoice& model,
                        const NoiseGuess& noise) {
  Fitted fitted;
  fitted.model = model;
  fitted.problem = make_problem(data, options, model);
  if (has_too_many(fitted.problem)) return fitted;
  auto ends = finalists(fitted.problem, options, noise);
  if (ends.empty()) return fitted;
  const Parameters& parameters = fitted.problem.parameters;
  const auto points = starting_points(parameters, data, noise);
  std::vector<std::vector<double>> starts;
  const double best = ends.front().value;
  for (const Minimum& end : ends) {
    constexpr double hopeless = 30.0; // of L on few beats
    if (end.value > best + hopeless) break;
    std::vector<double> start = points.front(); // for the noise
    std::copy(end.x.begin(), end.x.end(), start.begin());
    starts.push_back(std::move(start));
  }
  if (auto start = start_from_free_changes(data, options, model, noise, parameters, points.front()))
    starts.insert(starts.begin(), std::move(*start));
  fitted.problem.priors = make_priors(options, parameters, starts.front());
  fitted.minimum.x = starts.front();
  starts.erase(starts.begin());
  condense(fitted.problem, fitted.minimum.x);
  settle(fitted.problem, fitted.minimum, {100});
  if (!fitted.minimum.usable) return fitted;
  finish(fitted);
  if (fitted.minimum.usable && find_rivals(fitted, starts)) {
    settle(fitted.problem, fitted.minimum, {});
    if (fitted.minimum.usable) finish(fitted);
  }
  return fitted;
}

namespace {

// Where a richer model may start: from the simpler one's end, and if that does not know its clock
// from every clock a stationary log could come from.
std::vector<std::vector<double>> richer_starts(const Fitted& simpler, const FitProblem& problem,
                                               const ModelChoice& model) {
  const TimingData& data = *problem.data;
  NoiseGuess noise = guess_noise(data);
  if (model.noise() != simpler.model.noise()) {
    const TimingNoise timing = estimate_noise(simpler.problem.data->cycle, simpler.seen.late_s);
    noise.jitter_s = std::max(timing.jitter_s, least_jitter(data));
    noise.walk_s = timing.walk_s;
  }
  const Parameters &parameters = problem.parameters, &before = simpler.problem.parameters;
  const auto grid = starting_points(parameters, data, noise);
  std::vector<std::vector<double>> points{
      carried_over(before, simpler.minimum.x, parameters, grid.front())};
  for (const Slot& slot : parameters.slots) // what is new starts small
    if (slot.free && !before.has(slot.quantity) && slot.coordinate == Coordinate::multiple)
      points.front()[slot.index] = 0.1;
  const bool drive_is_new = model.drive && !before.has(Quantity::drive_rms);
  const bool slow_is_new = model.slow && !before.has(Quantity::slow_rms);
  if (auto start = drive_is_new ? start_by_amplitudes(parameters, data, noise) : std::nullopt)
    points.push_back(std::move(*start));
  else if (drive_is_new && !knows_its_clock(simpler))
    points.insert(points.end(), grid.begin(), grid.end());
  return drive_is_new || slow_is_new ? noise_variants(points, parameters, data) : points;
}

// Amplitudes tell where a slow drive has led the clock, and there the gains are others: first order
// would look for such a drive among the wrong clocks.
bool sees_second_order(const FitProblem& problem, const FitOptions& options) {
  return problem.parameters.has(Quantity::slow_rms) && problem.data->has_amplitude() &&
         options.dynamics != FitDynamics::averaged1;
}

// Makes the problem one of second order about a place.
void extend(FitProblem& problem, std::span<const double> x) {
  problem.parameters.start_ratio = limit_cycle_ratio(problem.parameters, x);
  auto correction = difference_to(FitDynamics::averaged2, problem, x);
  problem.correction = correction ? std::move(*correction) : Correction{};
}

} // namespace

bool worth_trying(const Fitted& simpler, const FitOptions& options, const ModelChoice& model) {
  const TimingData thin = at_one_stride(*simpler.problem.data, enough_to_screen);
  FitProblem plain = simpler.problem.on(thin); // the dynamics change little between noises
  FitProblem richer = make_problem(thin, options, model);
  if (has_too_many(richer)) return false;
  plain.priors.clear();
  const auto here = minus_log_likelihood(plain, simpler.minimum.x);
  constexpr double some = 1.0; // of L: below that no search would make it worth two parameters
  for (const auto& point : richer_starts(simpler, richer, model)) {
    if (sees_second_order(richer, options)) extend(richer, point);
    const auto there = minus_log_likelihood(richer, point);
    if (here && there && *there < *here - some) return true;
  }
  return false;
}

namespace {

// The noise of single beats that blocks of them stand for, or the reverse.
std::vector<double> with_noise_of_blocks(const Parameters& parameters, std::vector<double> x,
                                         double together) {
  for (const Slot& slot : parameters.slots)
    if (slot.free &&
        (slot.quantity == Quantity::jitter_rms || slot.quantity == Quantity::amplitude_rms))
      x[slot.index] -= 0.5 * std::log(together);
  return x;
}

} // namespace

std::vector<double> with_jitter_of(const TimingData& data, const Parameters& parameters,
                                   std::vector<double> x) {
  const Slot* jitter = parameters.find(Quantity::jitter_rms);
  if (jitter != nullptr && jitter->free)
    x[jitter->index] =
        std::max(x[jitter->index], jitter->coordinate_of(guess_noise(data).jitter_s));
  return x;
}

Fitted on_few_beats(const Fitted& fitted, const FewBeats& few) {
  Fitted there = fitted;
  there.problem = fitted.problem.on(few.data);
  there.rivals.clear();
  there.ends.clear();
  const auto start = with_noise_of_blocks(there.problem.parameters, fitted.minimum.x, few.together);
  if (fitted.dynamics != FitDynamics::averaged1) {
    auto correction = difference_to(fitted.dynamics, there.problem, start);
    there.problem.correction = correction ? std::move(*correction) : Correction{};
  }
  there.minimum = minimise(there.problem, start, {100});
  if (there.minimum.usable) finish(there);
  return there;
}

namespace {

// The fit brought to rest from the twin of its place, by its own dynamics; not usable if that is no
// other place, or nothing like as good.
Fitted twin_fit(const Fitted& home) {
  const auto start = twin_of(home.problem, home.minimum.x);
  if (!start) return {};
  Fitted twin = home;
  twin.minimum.x = *start;
  if (home.dynamics != FitDynamics::averaged1) extend(twin.problem, *start);
  constexpr double far = 12.0; // of L: what only a stated prior brings about, and no search undoes
  const auto there = minus_log_likelihood(twin.problem, *start);
  if (!there || *there > home.minimum.value + far) return {};
  settle(twin.problem, twin.minimum, {});
  if (!twin.minimum.usable || !refine(twin, home.dynamics)) return {};
  constexpr double near = 4.5; // of L: three sigma
  const bool is_near = twin.minimum.value < home.minimum.value + near;
  const auto at = evaluate(home.problem, home.minimum.x);
  const bool is_other =
      at && certainty(home.problem, *at, {}).tells_apart(twin.minimum.x, home.minimum.x);
  return is_near && is_other ? twin : Fitted{};
}

// The twin as a rival; takes its place if it is better. A long log is looked at by few beats first:
// where they tell the two apart so do all.
void look_at_the_twin(Fitted& fitted) {
  constexpr std::size_t enough = 3000;
  const TimingData& data = *fitted.problem.data;
  if (fitted.problem.condensed == nullptr && data.size() > 3 * enough) {
    const FewBeats few = few_beats(data, fitted.problem.parameters.event_cycles, enough);
    const Fitted home = on_few_beats(fitted, few);
    if (!home.minimum.usable || !twin_fit(home).minimum.usable) return;
  }
  Fitted twin = twin_fit(fitted);
  if (!twin.minimum.usable) return;
  if (by_value(twin.minimum, fitted.minimum)) {
    twin.rivals = fitted.rivals;
    std::swap(twin, fitted);
  }
  fitted.rivals.push_back({twin.minimum.x, twin.minimum.value - fitted.minimum.value});
}

// On few beats first, which tell the place nearly, which start is the best, and whether the model
// is worth all beats.
Fitted fit_in_two_steps(std::span<const Fitted* const> simpler, const FitOptions& options,
                        const ModelChoice& model, const TimingData& data) {
  constexpr double hopeless = 10.0; // of L: odds of 20000 to 1, which more beats will not turn
  const FewBeats few =
      few_beats(data, simpler.front()->problem.parameters.event_cycles, enough_to_screen);
  Fitted rough;
  for (const Fitted* start : simpler) {
    const Fitted plain = on_few_beats(*start, few);
    if (!plain.minimum.usable) continue;
    Fitted end = fit_from(plain, options, model, &few.data);
    const double best = std::min(plain.minimum.value + hopeless, rough.minimum.value);
    if (end.minimum.usable && end.minimum.value < best) rough = std::move(end);
  }
  if (!rough.minimum.usable) return {};
  const auto on_all = [&](const std::vector<double>& x) {
    return with_jitter_of(data, rough.problem.parameters,
                          with_noise_of_blocks(rough.problem.parameters, x, 1.0 / few.together));
  };
  rough.minimum.x = on_all(rough.minimum.x);
  Fitted fitted = fit_from(rough, options, model, &data);
  for (const Rival& rival : rough.rivals)
    fitted.rivals.push_back(
        {moved_along(on_all(rival.x), rough.minimum.x, fitted.minimum.x), rival.behind});
  return fitted;
}

} // namespace

Fitted fit_from(const Fitted& simpler, const FitOptions& options, const ModelChoice& model,
                const TimingData* data) {
  Fitted fitted;
  fitted.model = model;
  fitted.problem = make_problem(data != nullptr ? *data : *simpler.problem.data, options, model);
  if (has_too_many(fitted.problem)) return fitted;
  const bool is_extended = sees_second_order(fitted.problem, options);
  const bool is_new = model.name() != simpler.model.name();
  if (is_extended && is_new && fitted.problem.data->size() > 2 * enough_to_screen)
    return fit_in_two_steps(std::array{&simpler}, options, model, *fitted.problem.data);
  const auto points = richer_starts(simpler, fitted.problem, model);
  std::vector<Minimum> tried(1);
  tried.front().x = points.front();
  if (points.size() > 1) {
    FitProblem few = fitted.problem;
    const TimingData thin = at_one_stride(*few.data, enough_to_screen);
    few.data = &thin;
    const TimingData fewer = at_one_stride(thin, enough_to_rank);
    FitProblem fewest = few.on(fewer);
    if (is_extended) extend(fewest, points.front()); // they differ in their noise alone
    tried = screened(fewest, points);
    constexpr std::size_t to_score = 4;
    if (tried.size() > to_score) tried.resize(to_score);
    for (Minimum& start : tried) {
      few.priors = make_priors(options, few.parameters, start.x);
      if (is_extended) extend(few, start.x);
      start = minimise(few, start.x, {40, 1e-2});
    }
    std::sort(tried.begin(), tried.end(), by_value);
  }
  if (tried.empty()) return fitted;
  fitted.minimum.x = tried.front().x;
  fitted.problem.priors = make_priors(options, fitted.problem.parameters, fitted.minimum.x);
  condense(fitted.problem, fitted.minimum.x);
  if (is_extended) finish(fitted); // what the start explains, refinement must not lose
  if (!is_extended || !refine(fitted, std::max(FitDynamics::averaged2, simpler.dynamics)))
    settle(fitted.problem, fitted.minimum, {});
  if (!fitted.minimum.usable) return fitted;
  for (const Minimum& other : tried) {
    constexpr double near = 4.5; // three sigma
    if (!other.usable || other.value > tried.front().value + near) continue;
    fitted.rivals.push_back({moved_along(other.x, tried.front().x, fitted.minimum.x),
                             other.value - tried.front().value});
  }
  look_at_the_twin(fitted);
  finish(fitted);
  return fitted;
}

Fitted fit_from_either(const Fitted& one, const Fitted& other, const FitOptions& options,
                       const ModelChoice& model) {
  const TimingData& data = *one.problem.data;
  const FitProblem problem = make_problem(data, options, model);
  if (sees_second_order(problem, options) && data.size() > 2 * enough_to_screen)
    return fit_in_two_steps(std::array{&one, &other}, options, model, data);
  Fitted first = fit_from(one, options, model), second = fit_from(other, options, model);
  return second.minimum.usable && by_value(second.minimum, first.minimum) ? second : first;
}

std::optional<NoiseShape> noise_shape(const Fitted& fitted) {
  const Slot* drive = fitted.problem.parameters.find(Quantity::drive_rms);
  if (drive == nullptr) return {};
  const std::span<const double> x(fitted.minimum.x);
  const FinalClock clock = final_clock(fitted.problem.parameters, x);
  const double jitter = fitted.problem.parameters.find(Quantity::jitter_rms)->value(x);
  return NoiseShape{std::pow(clock.T0 * clock.fast_gain() * drive->value(x), 2), jitter * jitter,
                    -clock.laws.growth_slope(clock.amplitude2),
                    clock.slow_gain() / clock.fast_gain()};
}

namespace {

// What a step of scoring would change; the noise is left as it is, for the misfit may be large.
struct ClockStep {
  Eigen::VectorXd of_x;
  double gain = 0.0; ///< of L, that it hopes for
};
std::optional<ClockStep> clock_step(const FitProblem& problem, std::span<const double> x) {
  const auto at = evaluate(problem, x);
  if (!at) return {};
  Eigen::VectorXd step = -at->triangle.triangularView<Eigen::Upper>().solve(at->projected);
  for (const Slot& slot : problem.parameters.slots)
    if (slot.free && is_noise(slot.quantity)) step[static_cast<Eigen::Index>(slot.index)] = 0.0;
  const Eigen::VectorXd seen = at->triangle.triangularView<Eigen::Upper>() * step;
  return ClockStep{std::move(step), 0.5 * seen.squaredNorm()};
}

// Whether the innovations show that the place explains nothing.
bool is_lost(const Fitted& fitted) {
  constexpr double beyond_chance = 1e-6;
  const auto coloured = [&](const std::vector<double>& innovations) {
    return innovations.size() >= 8 && whiteness_p(innovations) < beyond_chance;
  };
  return coloured(fitted.seen.white_time) || coloured(fitted.seen.white_amplitude);
}

} // namespace

bool refine(Fitted& fitted, FitDynamics dynamics) {
  if (dynamics == FitDynamics::averaged1) return true;
  constexpr int rounds = 8;      // each gains two or three digits where the averaged model is near
  constexpr double still = 2e-4; // of L: 0.02 sigma of the best known combination
  Fitted refined = fitted;
  refined.dynamics = dynamics;
  Fitted best; // by the dynamics themselves: along a flat ridge a later round may be a worse one
  best.minimum.value = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    refined.problem.parameters.start_ratio =
        limit_cycle_ratio(refined.problem.parameters, refined.minimum.x);
    auto correction = difference_to(dynamics, refined.problem, refined.minimum.x);
    if (!correction) return false;
    refined.problem.correction = std::move(*correction);
    const auto here = minus_log_likelihood(refined.problem, refined.minimum.x);
    if (here && *here < best.minimum.value) {
      best = refined;
      best.minimum.value = *here;
    }
    const auto step = clock_step(refined.problem, refined.minimum.x);
    if (!step) return false;
    if (round > 1 && step->gain < still) break;
    std::vector<double> moved = refined.minimum.x;
    constexpr double longest = 0.3; // along a flat ridge a step of scoring may lead anywhere
    const double part =
        std::min(1.0, longest / std::max(longest, step->of_x.cwiseAbs().maxCoeff()));
    for (std::size_t k = 0; k < moved.size(); ++k) {
      const auto [low, high] = refined.problem.bounds[k];
      moved[k] = std::clamp(moved[k] + part * step->of_x[static_cast<Eigen::Index>(k)], low, high);
    }
    const auto there = minus_log_likelihood(refined.problem, moved);
    if (there && (!here || *there < *here)) refined.minimum.x = moved;
    if (round == 0) continue; // the difference at the new place is worth more than its minimum here
    settle(refined.problem, refined.minimum, {});
    if (refined.minimum.usable) finish(refined); // the sigmas of the wrong model were too wide
    if (!refined.minimum.usable) return false;
  }
  if (!std::isfinite(best.minimum.value)) return false;
  refined = std::move(best);
  for (Rival& rival : refined.rivals)
    rival.x = moved_along(rival.x, fitted.minimum.x, refined.minimum.x);
  finish(refined);
  if (!refined.minimum.usable || (!is_lost(fitted) && is_lost(refined))) return false;
  fitted = std::move(refined);
  return true;
}

bool refine_every_end(Fitted& fitted, FitDynamics dynamics) {
  std::vector<Fitted> refined;
  const auto consider = [&](Fitted&& end) {
    end.ends.clear();
    if (end.minimum.usable && refine(end, dynamics)) refined.push_back(std::move(end));
  };
  consider(Fitted(fitted));
  for (const std::vector<double>& place : fitted.ends) {
    Fitted end = fitted;
    end.rivals.clear();
    end.minimum.x = place;
    settle(end.problem, end.minimum, {});
    if (end.minimum.usable) finish(end);
    consider(std::move(end));
  }
  if (refined.empty()) return false;
  std::stable_sort(refined.begin(), refined.end(),
                   [](const Fitted& a, const Fitted& b) { return by_value(a.minimum, b.minimum); });
  fitted = std::move(refined.front());
  if (refined.size() > 1) fitted.rivals.clear();
  constexpr double near = 4.5; // of L: three sigma
  for (std::size_t k = 1; k < refined.size(); ++k) {
    const Minimum& other = refined[k].minimum;
    fitted.ends.push_back(other.x);
    if (other.value < fitted.minimum.value + near &&
        fitted.known.tells_apart(other.x, fitted.minimum.x))
      fitted.rivals.push_back({other.x, other.value - fitted.minimum.value});
  }
  return true;
}

} // namespace goingrate::timing_model
