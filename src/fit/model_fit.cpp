#include "model_fit.hpp"

#include "date_search.hpp"
#include "fit_starts.hpp"
#include "refinement.hpp"
#include "rivals.hpp"
#include "swing_sizes.hpp"

#include "base/workers.hpp"
#include "fit/timing_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace goingrate::timing_model {

namespace {

// Models with more parameters than the search can handle are not tried.
bool has_too_many(const FitProblem& problem) {
  return problem.parameters.free_count > most_parameters;
}

constexpr std::size_t beats_to_screen = 2500; // beats, enough to distinguish starts
constexpr std::size_t beats_to_rank = 1000;   // beats, enough to rank many starts

// A change that is held fixed may separate every start from the best minimum. The minimum of the
// same model with the change free is a start beyond that barrier.
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

bool is_likelier(const FitProblem& problem, std::span<const double> x,
                 std::span<const double> than) {
  const auto there = minus_log_likelihood(problem, x), here = minus_log_likelihood(problem, than);
  return there && !(here && *here < *there);
}

// Times alone show the swing only by its circular error, which depends on the product of gravity's
// share and the squared amplitude. The fits with the share held are starts on the resulting ridge,
// for periods that grow and for periods that fall with the swing.
std::vector<std::vector<double>>
starts_at_shares_of_gravity(const TimingData& data, const FitOptions& options,
                            const ModelChoice& model, const NoiseGuess& noise,
                            const Parameters& parameters, std::span<const double> otherwise) {
  const Slot* share = parameters.find(Quantity::gravity_share);
  if (share == nullptr || !share->free || data.has_amplitude()) return {};
  std::vector<std::vector<double>> starts;
  for (const double held : {1.0, -1.0}) {
    FitOptions narrower = options;
    std::erase(narrower.freed, parameters.name_of(*share));
    narrower.fixed[parameters.name_of(*share)] = held;
    const Fitted there = fit_from_scratch(data, narrower, model, noise);
    if (!there.minimum.usable) continue;
    starts.push_back(
        carried_over(there.problem.parameters, there.minimum.x, parameters, otherwise));
    starts.back()[share->index] = share->coordinate_of(held);
  }
  return starts;
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
    constexpr double largest_deficit = 30.0; // of L on few beats
    if (end.value > best + largest_deficit) break;
    std::vector<double> start = points.front(); // its noise parameters serve all starts
    std::copy(end.x.begin(), end.x.end(), start.begin());
    starts.push_back(std::move(start));
  }
  if (auto start = start_from_free_changes(data, options, model, noise, parameters, points.front()))
    starts.insert(starts.begin(), std::move(*start));
  for (auto& start :
       starts_at_shares_of_gravity(data, options, model, noise, parameters, points.front()))
    starts.insert(is_likelier(fitted.problem, start, starts.front()) ? starts.begin()
                                                                     : starts.end(),
                  std::move(start));
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

// The first clock, and the best of the others under the guessed noise. Only these are then tried
// with other noise models.
std::vector<std::vector<double>> likeliest(std::vector<std::vector<double>> clocks,
                                           const FitProblem& problem) {
  constexpr std::size_t most_clocks =
      60; // of some 500 clocks on a grid whose neighbours differ by a factor of two
  if (clocks.size() <= most_clocks) return clocks;
  const TimingData few = at_one_stride(*problem.data, beats_to_rank);
  std::vector<Minimum> ranked = screened(problem.on(few), clocks);
  ranked.resize(std::min(ranked.size(), most_clocks));
  clocks.resize(1);
  for (Minimum& clock : ranked)
    clocks.push_back(std::move(clock.x));
  return clocks;
}

// Starts of a richer model: the minimum of the simpler one and, if that does not determine its
// clock, every clock from which a stationary log could come. If the times walk, what seems to
// determine the clock may be an effect of the drive.
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
  for (const Slot& slot : parameters.slots) // new terms start small
    if (slot.free && is_of_clock(slot.quantity) && !before.has(slot.quantity) &&
        slot.coordinate == Coordinate::multiple)
      points.front()[slot.index] = 0.1;
  const bool drive_is_new = model.drive && !before.has(Quantity::drive_rms);
  const bool slow_is_new = model.slow && !before.has(Quantity::slow_rms);
  if (auto start = drive_is_new ? start_by_amplitudes(parameters, data, noise) : std::nullopt)
    points.push_back(std::move(*start));
  else if (drive_is_new && (simpler.model.walk || !knows_its_clock(simpler)))
    points.insert(points.end(), grid.begin(), grid.end());
  if (!drive_is_new && !slow_is_new) return points;
  return noise_variants(likeliest(std::move(points), problem), parameters, data);
}

// A slow drive changes the amplitude, and with it the gains. This shows in a log with amplitudes,
// and first order would attribute it to a wrong clock.
bool sees_second_order(const FitProblem& problem, const FitOptions& options) {
  return problem.parameters.has(Quantity::slow_rms) && problem.data->has_amplitude() &&
         options.dynamics != FitDynamics::averaged1;
}

// A search that begins with far too little noise spends its steps on finding the noise.
std::vector<double> with_likelier_noise(const FitProblem& problem, const std::vector<double>& x) {
  std::vector<double> rescaled = x;
  rescale_noise(problem, rescaled);
  const auto before = minus_log_likelihood(problem, x);
  const auto after = minus_log_likelihood(problem, rescaled);
  return after && before && *after < *before ? rescaled : x;
}

// How unusual a clock is, in units of 2 log L. If noise hides the swing's memory, clocks of any
// friction may explain a log equally well; the likeliest of them is one with usual friction.
double unusualness(const FitProblem& problem, std::span<const double> x) {
  constexpr double usual_epsilon = 3e-4; // Q of 1700
  constexpr double spread = 2.0;         // of its logarithm: Q of 230 to 12000 within one sigma
  const Slot* epsilon = problem.parameters.find(Quantity::epsilon);
  return std::pow(std::log(epsilon->value(x) / usual_epsilon) / spread, 2);
}

} // namespace

bool worth_trying(const Fitted& simpler, const Fitted& best, const FitOptions& options,
                  const ModelChoice& model) {
  const TimingData thin = at_one_stride(*simpler.problem.data, beats_to_screen);
  FitProblem plain =
      best.problem.on(thin); // the choice of noise hardly affects the choice of dynamics
  FitProblem richer = make_problem(thin, options, model);
  if (has_too_many(richer)) return false;
  plain.priors.clear();
  const auto here = minus_log_likelihood(plain, best.minimum.x);
  constexpr double least_gain =
      1.0; // of L: with less, no search would make up for two more parameters
  for (const auto& point : richer_starts(simpler, richer, model)) {
    if (sees_second_order(richer, options)) extend(richer, point);
    const auto there = minus_log_likelihood(richer, point);
    if (here && there && *there < *here - least_gain) return true;
  }
  return false;
}

Fitted fit_from(const Fitted& simpler, const FitOptions& options, const ModelChoice& model,
                const TimingData* data) {
  Fitted fitted;
  fitted.model = model;
  fitted.problem = make_problem(data != nullptr ? *data : *simpler.problem.data, options, model);
  if (has_too_many(fitted.problem)) return fitted;
  const bool is_extended = sees_second_order(fitted.problem, options);
  const auto points = richer_starts(simpler, fitted.problem, model);
  std::vector<Minimum> tried(1);
  tried.front().x = points.front();
  if (points.size() > 1) {
    FitProblem few = fitted.problem;
    const TimingData thin = at_one_stride(*few.data, beats_to_screen);
    few.data = &thin;
    const TimingData fewer = at_one_stride(thin, beats_to_rank);
    FitProblem fewest = few.on(fewer);
    if (is_extended) extend(fewest, points.front()); // the starts differ in their noise only
    tried = screened(fewest, points);
    constexpr std::size_t to_score = 4;
    if (tried.size() > to_score) tried.resize(to_score);
    const auto search = [&](std::size_t i) {
      FitProblem own = few;
      own.priors = make_priors(options, own.parameters, tried[i].x);
      if (is_extended) extend(own, tried[i].x);
      tried[i] = minimise(own, with_likelier_noise(own, tried[i].x), {40, 1e-2});
    };
    // Second order is expensive, and starts that differ in their noise mostly lead to the same
    // point.
    const std::size_t first = is_extended ? std::min<std::size_t>(2, tried.size()) : tried.size();
    share(first, search);
    constexpr double same_place = 0.5; // of L
    if (first == 2 && std::abs(tried[0].value - tried[1].value) < same_place)
      tried.resize(2);
    else
      share(tried.size() - first, [&](std::size_t i) { search(first + i); });
    std::sort(tried.begin(), tried.end(), by_value);
    for (Minimum& end : ends_of_every_size(few, tried.front()))
      tried.push_back(std::move(end));
    const auto cost = [&](const Minimum& end) {
      return end.usable ? end.value + 0.5 * unusualness(few, end.x) : end.value;
    };
    std::stable_sort(tried.begin(), tried.end(),
                     [&](const Minimum& a, const Minimum& b) { return cost(a) < cost(b); });
  }
  if (tried.empty()) return fitted;
  fitted.minimum.x = tried.front().x;
  fitted.problem.priors = make_priors(options, fitted.problem.parameters, fitted.minimum.x);
  condense(fitted.problem, fitted.minimum.x);
  if (is_extended) finish(fitted); // refinement must not lose what the start explains
  if (!is_extended || !refine(fitted, std::max(FitDynamics::averaged2, simpler.dynamics)))
    settle(fitted.problem, fitted.minimum, {});
  if (!fitted.minimum.usable) return fitted;
  for (const Minimum& other : tried) {
    constexpr double largest_deficit = 4.5; // three sigma
    if (!other.usable || other.value > tried.front().value + largest_deficit) continue;
    fitted.rivals.push_back({moved_along(other.x, tried.front().x, fitted.minimum.x),
                             std::max(0.0, other.value - tried.front().value)});
  }
  look_at_the_twins(fitted);
  finish(fitted);
  return fitted;
}

namespace {

// First on few beats: they locate the minimum roughly, show which start is the best, and whether
// the model is worth fitting to all beats.
Fitted fit_in_two_steps(std::span<const Fitted* const> simpler, FitOptions& options,
                        const ModelChoice& model, const TimingData& data) {
  constexpr double largest_deficit =
      10.0; // of L, odds of 20000 to 1: more beats will not reverse that
  const FewBeats few =
      few_beats(data, simpler.front()->problem.parameters.event_cycles, beats_to_screen);
  Fitted rough;
  double best = std::numeric_limits<double>::infinity();
  for (const Fitted* start : simpler) {
    const Fitted plain = on_few_beats(*start, few);
    if (!plain.minimum.usable) continue;
    Fitted end = fit_from(plain, options, model, &few.data);
    if (!end.minimum.usable) continue;
    const double value = value_without_weak_priors(end.problem, end.minimum);
    if (value > value_without_weak_priors(plain.problem, plain.minimum) + largest_deficit ||
        !(value < best))
      continue;
    best = value;
    rough = std::move(end);
    if (white(rough)) break; // nothing calls for a better minimum
  }
  if (!rough.minimum.usable) return {};
  move_dates(rough, options); // all beats would explain a wrong date by a slow drive
  if (rough.widening.largest() > largest_widening) return {}; // more beats contradict it more
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

Fitted fit_from_any(std::span<const Fitted* const> simpler, FitOptions& options,
                    const ModelChoice& model) {
  const TimingData& data = *simpler.front()->problem.data;
  const FitProblem problem = make_problem(data, options, model);
  if (sees_second_order(problem, options) && data.size() > 2 * beats_to_screen)
    return fit_in_two_steps(simpler, options, model, data);
  Fitted likeliest;
  for (const Fitted* start : simpler) {
    Fitted end = fit_from(*start, options, model);
    const auto cost = [](const Fitted& fit) {
      return fit.bic + unusualness(fit.problem, fit.minimum.x);
    };
    if (end.minimum.usable && (!likeliest.minimum.usable || cost(end) < cost(likeliest)))
      likeliest = std::move(end);
  }
  return likeliest;
}

} // namespace goingrate::timing_model
