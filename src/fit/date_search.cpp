#include "date_search.hpp"

#include "model_fit.hpp"
#include "refinement.hpp"

#include <algorithm>
#include <initializer_list>
#include <optional>

namespace goingrate::timing_model {

namespace {

// The best result of one step of scoring, or its starting point.
Minimum after_one_step(const FitProblem& problem, const std::vector<double>& x) {
  Minimum there;
  there.x = x;
  const auto at = evaluate(problem, x);
  if (!at) return there;
  there.usable = true;
  there.value = at->value;
  const Eigen::VectorXd step = -at->triangle.triangularView<Eigen::Upper>().solve(at->projected);
  std::vector<double> moved = x;
  for (std::size_t k = 0; k < x.size(); ++k)
    moved[k] = std::clamp(x[k] + step[static_cast<Eigen::Index>(k)], problem.bounds[k][0],
                          problem.bounds[k][1]);
  const auto value = minus_log_likelihood(problem, moved);
  if (value && *value < there.value) {
    there.x = std::move(moved);
    there.value = *value;
  }
  return there;
}

// The options with one date moved; nullopt if that would change the order of the dates.
std::optional<FitOptions> with_moved_date(const FitOptions& options, std::size_t event,
                                          std::int64_t by, double last_cycle) {
  FitOptions moved = options;
  moved.events[event].cycle += by;
  const auto cycle = static_cast<double>(moved.events[event].cycle);
  const double before = event == 0 ? 0.0 : static_cast<double>(moved.events[event - 1].cycle);
  const double after = event + 1 < moved.events.size()
                           ? static_cast<double>(moved.events[event + 1].cycle)
                           : last_cycle;
  if (cycle <= before || cycle >= after) return {};
  return moved;
}

// Moves dates by steps as long as L gains, without a change in their order. A fit that is far from
// the log gains by any move, so the number of steps in one direction is limited.
class DateSearch {
public:
  using Search = Minimum (*)(const FitProblem&, const std::vector<double>&);

  DateSearch(const Fitted& fitted, const FitOptions& options, const TimingData& data)
      : problem_(fitted.problem.on(data)), model_(fitted.model), options_(options),
        here_(fitted.minimum) {}

  void move(std::initializer_list<std::int64_t> steps, Search search) {
    here_ = search(dated(options_), here_.x);
    for (std::size_t event = 0; event < options_.events.size(); ++event)
      for (const std::int64_t step : steps)
        for (const std::int64_t side : {-1, 1})
          for (int gone = 0; gone < most_steps && options_.events[event].movable &&
                             goes(event, side * step, search);)
            ++gone;
  }

  [[nodiscard]] const FitOptions& options() const { return options_; }
  [[nodiscard]] const std::vector<double>& place() const { return here_.x; }

private:
  static constexpr int most_steps = 16; // of 8 beats: farther than any date is off

  [[nodiscard]] FitProblem dated(const FitOptions& options) const {
    FitProblem problem = problem_;
    problem.parameters.event_cycles = make_parameters(options, *problem.data, model_).event_cycles;
    return problem;
  }

  bool goes(std::size_t event, std::int64_t by, Search search) {
    constexpr double least_gain = 0.05; // of L
    auto moved = with_moved_date(options_, event, by, problem_.data->cycle.back());
    if (!moved) return false;
    Minimum there = search(dated(*moved), here_.x);
    if (!there.usable || !(there.value < here_.value - least_gain)) return false;
    here_ = std::move(there);
    options_ = std::move(*moved);
    return true;
  }

  FitProblem problem_;
  ModelChoice model_;
  FitOptions options_;
  Minimum here_;
};

// Where ε changes, the valley is so flat and curved that 60 iterations end on its slope.
Minimum after_a_search(const FitProblem& problem, const std::vector<double>& x) {
  return minimise(problem, x, {250, 1e-2});
}

} // namespace

// One step of scoring predicts the gain from moving a date by some beats if the clock hardly
// changes with it. Along a valley the clock changes much, and the last beat needs a search.
void move_dates(Fitted& fitted, FitOptions& options) {
  const auto is_movable = [](const FitEvent& event) { return event.movable; };
  if (!fitted.minimum.usable ||
      std::none_of(options.events.begin(), options.events.end(), is_movable))
    return;
  const TimingData& data = *fitted.problem.data;
  constexpr std::size_t screening_beats = 30000,
                        trial_beats = 3000; // beats; those about the dates are kept
  const TimingData some = thinned(data, fitted.problem.parameters, screening_beats);
  DateSearch search(fitted, options, some);
  search.move({8, 4, 2, 1}, after_one_step);
  Fitted moved = fitted;
  moved.minimum.x = search.place();
  moved.problem.parameters.event_cycles =
      make_parameters(search.options(), data, fitted.model).event_cycles;
  const TimingData fewer = thinned(data, moved.problem.parameters, trial_beats);
  DateSearch last(moved, search.options(), fewer);
  last.move({1}, after_a_search);
  const auto same = [](const FitEvent& a, const FitEvent& b) { return a.cycle == b.cycle; };
  if (std::equal(options.events.begin(), options.events.end(), last.options().events.begin(), same))
    return;
  moved.minimum.x = last.place();
  moved = fit_from(moved, last.options(), fitted.model);
  if (!moved.minimum.usable || !refine(moved, fitted.dynamics) ||
      moved.minimum.value > fitted.minimum.value)
    return;
  fitted = std::move(moved);
  options = last.options();
}

} // namespace goingrate::timing_model
