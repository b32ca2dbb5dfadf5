#include "possible_changes.hpp"

#include "date_search.hpp"
#include "fit_setup.hpp"
#include "fit_starts.hpp"
#include "reference_run.hpp"
#include "rivals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace goingrate::timing_model {

namespace {

double cycle_of(const Parameters& parameters, const Slot& slot) {
  return slot.event == 0 ? 0.0 : parameters.event_cycles[slot.event - 1];
}

// The point, in a model with more changes, at which only the earlier changes happen.
std::vector<double> same_place(const Parameters& from, std::span<const double> x,
                               const Parameters& to) {
  std::vector<double> place(to.free_count, 0.0);
  for (const Slot& slot : to.slots) {
    if (!slot.free) continue;
    for (const Slot& before : from.slots) // in order of events: the last is in force
      if (before.quantity == slot.quantity && before.term == slot.term &&
          (is_of_moment(slot.quantity) ? cycle_of(from, before) == cycle_of(to, slot)
                                       : cycle_of(from, before) <= cycle_of(to, slot)))
        place[slot.index] = slot.coordinate_of(before.value(x));
  }
  return place;
}

} // namespace

std::vector<FitEvent> joined(const std::vector<FitEvent>& events,
                             const std::vector<FitEvent>& more) {
  std::vector<FitEvent> all = events;
  for (const FitEvent& event : more)
    if (std::none_of(events.begin(), events.end(),
                     [&](const FitEvent& other) { return other.cycle == event.cycle; }))
      all.push_back(event);
  std::sort(all.begin(), all.end(),
            [](const FitEvent& a, const FitEvent& b) { return a.cycle < b.cycle; });
  return all;
}

double promised_gain(const Fitted& fitted, const FitOptions& wider) {
  FitProblem problem = make_problem(*fitted.problem.data, wider, fitted.model);
  if (problem.parameters.free_count > most_parameters) return 0.0;
  problem.parameters.start_ratio = fitted.problem.parameters.start_ratio;
  problem.correction = on_every_beat(fitted.problem).correction; // of the same data
  const auto x = same_place(fitted.problem.parameters, fitted.minimum.x, problem.parameters);
  problem.priors = make_priors(wider, problem.parameters, x);
  const auto there = evaluate(problem, x);
  return there ? 0.5 * there->projected.squaredNorm() : 0.0;
}

namespace {

// The slot of the same quantity that is in force before an event.
const Slot* before(const Parameters& parameters, const Slot& changed) {
  const Slot* last = nullptr;
  for (const Slot& slot : parameters.slots)
    if (slot.quantity == changed.quantity && slot.term == changed.term &&
        slot.event < changed.event && (last == nullptr || slot.event > last->event))
      last = &slot;
  return last;
}

// A change as a constraint: the difference of each of its parameters from the value in force
// before, in coordinates, with its derivatives.
struct Difference {
  Eigen::VectorXd size;
  Eigen::MatrixXd gradient; // a row for each parameter
};

Difference difference_at(const Fitted& fitted, std::size_t event) {
  const std::span<const double> x = fitted.minimum.x;
  std::vector<double> sizes;
  std::vector<Eigen::RowVectorXd> rows;
  for (const Slot& slot : fitted.problem.parameters.slots) {
    if (slot.event != event || !slot.free || is_of_moment(slot.quantity)) continue;
    const Slot* other = before(fitted.problem.parameters, slot);
    if (other == nullptr) continue;
    const double value = other->value(x);
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(x.size()));
    row[static_cast<Eigen::Index>(slot.index)] = 1.0;
    if (other->free)
      row[static_cast<Eigen::Index>(other->index)] = -other->slope(x) / slot.slope_at(value);
    sizes.push_back(x[slot.index] - slot.coordinate_of(value));
    rows.push_back(std::move(row));
  }
  Difference difference{Eigen::VectorXd(static_cast<Eigen::Index>(sizes.size())),
                        Eigen::MatrixXd(static_cast<Eigen::Index>(sizes.size()),
                                        static_cast<Eigen::Index>(x.size()))};
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    difference.size[static_cast<Eigen::Index>(k)] = sizes[k];
    difference.gradient.row(static_cast<Eigen::Index>(k)) = rows[k];
  }
  return difference;
}

// The minimum without a change, and its cost in 2 log L, both by the curvature at the minimum of
// the fit.
struct WithoutChange {
  std::vector<double> x;
  double cost = 0.0;
};

WithoutChange foreseen_without(const Fitted& fitted, std::size_t event) {
  const Difference difference = difference_at(fitted, event);
  const Eigen::MatrixXd spread =
      difference.gradient * fitted.known.unwidened; // a root of its covariance
  const Eigen::VectorXd weighted = (spread * spread.transpose()).ldlt().solve(difference.size);
  const Eigen::VectorXd step = fitted.known.unwidened * (spread.transpose() * weighted);
  WithoutChange there{fitted.minimum.x, difference.size.dot(weighted)};
  for (std::size_t k = 0; k < there.x.size(); ++k)
    there.x[k] = std::clamp(there.x[k] - step[static_cast<Eigen::Index>(k)],
                            fitted.problem.bounds[k][0], fitted.problem.bounds[k][1]);
  return there;
}

// Cycles in which a swing responds to a change: 1/(2 pi epsilon), or 0 without linear friction.
double answer_cycles(const Fitted& fitted) {
  const Slot* friction = fitted.problem.parameters.find(Quantity::epsilon);
  const double epsilon =
      friction == nullptr ? 0.0 : friction->value(std::span<const double>(fitted.minimum.x));
  return epsilon > 0.0 ? 1.0 / (2.0 * std::numbers::pi * epsilon) : 0.0;
}

bool is_near_its_like(const std::vector<FitEvent>& events, std::size_t event, double cycles) {
  return std::any_of(events.begin(), events.end(), [&](const FitEvent& other) {
    return &other != &events[event] && other.movable && other.names == events[event].names &&
           std::abs(static_cast<double>(other.cycle - events[event].cycle)) < cycles;
  });
}

// Fits the same model without an event, starting from its predicted minimum; the dates of the
// others may move.
Fitted fitted_without(const Fitted& fitted, std::size_t event, FitOptions& fewer) {
  Fitted there = fitted;
  there.rivals.clear();
  there.ends.clear();
  there.problem = make_problem(*fitted.problem.data, fewer, fitted.model);
  there.problem.parameters.start_ratio = fitted.problem.parameters.start_ratio;
  const auto x = same_place(fitted.problem.parameters, foreseen_without(fitted, event).x,
                            there.problem.parameters);
  there.problem.priors = make_priors(fewer, there.problem.parameters, x);
  if (fitted.dynamics != FitDynamics::averaged1)
    if (auto correction = difference_to(fitted.dynamics, there.problem, x))
      there.problem.correction = std::move(*correction);
  there.minimum = minimise(there.problem, x, {100});
  if (!there.minimum.usable) return there;
  finish(there);
  if (there.minimum.usable) move_dates(there, fewer);
  return there;
}

} // namespace

std::optional<FitOptions> without_needless_change(const Fitted& fitted, const FitOptions& options) {
  constexpr std::size_t beats_looked_at = 3000;
  const TimingData& data = *fitted.problem.data;
  const double date = std::log(static_cast<double>(data.size())); // BIC counts sizes only
  const auto without_event = [&](std::size_t event) {
    FitOptions fewer = options;
    fewer.events.erase(fewer.events.begin() + static_cast<std::ptrdiff_t>(event));
    return fewer;
  };
  // A date that the search has moved onto another one, or to the end, is not a change of its own.
  const std::vector<FitEvent>& events = options.events;
  for (std::size_t event = 0; event < events.size(); ++event) {
    const FitEvent& change = events[event];
    const bool is_on_another =
        (event > 0 && change.cycle <= events[event - 1].cycle) ||
        (event + 1 < events.size() && change.cycle >= events[event + 1].cycle);
    const bool is_at_end = static_cast<double>(change.cycle) >= data.cycle.back();
    if (change.movable && !change.planned && (is_on_another || is_at_end))
      return without_event(event);
  }
  std::optional<Fitted> beside; // the fit on the beats that are used
  FewBeats few;
  for (std::size_t event = 0; event < options.events.size(); ++event) {
    const FitEvent& change = options.events[event];
    if (!change.movable || change.planned) continue;
    const double price = date * static_cast<double>(1 + change.names.size());
    if (foreseen_without(fitted, event + 1).cost > price &&
        !is_near_its_like(options.events, event, answer_cycles(fitted)))
      continue;
    if (!beside) {
      few = few_beats(data, fitted.problem.parameters.event_cycles, beats_looked_at);
      beside = few.data.size() < data.size() ? on_few_beats(fitted, few) : fitted;
    }
    if (!beside->minimum.usable) return {};
    FitOptions fewer = without_event(event);
    const Fitted without = fitted_without(*beside, event + 1, fewer);
    if (without.minimum.usable && without.bic < beside->bic + date) return fewer;
  }
  return {};
}

} // namespace goingrate::timing_model
