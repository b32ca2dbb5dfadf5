#include "listed_twins.hpp"

#include "base/special_values.hpp"
#include "held.hpp"
#include "valley.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate::timing_model {

namespace {

// One of the clocks, in the coordinates of the search.
struct Listed {
  Rival place;
  double value = 0.0;          // L
  std::vector<double> sigma{}; // of each coordinate
};

// The point with sigmas from the likelihood's curvature there; NaN if the model does not hold.
Listed listed(const FitProblem& problem, Rival place, const Widening& widening) {
  std::vector<double> sigma(place.x.size(), not_known);
  const auto there = evaluate(problem, place.x);
  if (!there) return {std::move(place), not_known, sigma};
  const Certainty known = certainty(problem, place.x, *there, widening);
  for (std::size_t k = 0; k < sigma.size(); ++k)
    sigma[k] = known.sigma(k);
  return {std::move(place), there->value, sigma};
}

std::size_t coordinate_that_differs_most(const Rival& a, const Rival& b) {
  std::size_t most = 0;
  for (std::size_t k = 0; k < a.x.size(); ++k)
    if (std::abs(a.x[k] - b.x[k]) > std::abs(a.x[most] - b.x[most])) most = k;
  return most;
}

// Whether L rises between the two by as much as one sigma from a minimum, so that their 68 %
// intervals do not overlap.
bool are_separated(const FitProblem& problem, const Listed& a, const Listed& b) {
  const std::size_t k = coordinate_that_differs_most(a.place, b.place);
  const Valley valley(problem, a.place.x, k);
  std::vector<double> u = valley.u_of(a.place.x), other = valley.u_of(b.place.x);
  for (std::size_t i = 0; i < u.size(); ++i)
    u[i] = 0.5 * (u[i] + other[i]);
  std::vector<double> midway = valley.x_of(u);
  const double held = 0.5 * (a.place.x[k] + b.place.x[k]);
  midway.erase(midway.begin() + static_cast<std::ptrdiff_t>(k));
  const Minimum pass = minimise(with_held(problem, k, held), midway, {20, 1e-2});
  constexpr double rise_at_a_sigma = 0.5; // of L
  return pass.usable && pass.value - std::max(a.value, b.value) > rise_at_a_sigma;
}

// Between clocks that are not separated the truth may be anywhere, so the sigma of each is made to
// reach the other.
void reach_one_another(const FitProblem& problem, std::vector<Listed>& clocks) {
  const std::vector<Listed> before = clocks;
  for (std::size_t i = 0; i < clocks.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (are_separated(problem, before[i], before[j])) continue;
      for (std::size_t k = 0; k < clocks[i].sigma.size(); ++k) {
        const double apart = std::abs(before[i].place.x[k] - before[j].place.x[k]);
        clocks[i].sigma[k] = std::max(clocks[i].sigma[k], apart);
        clocks[j].sigma[k] = std::max(clocks[j].sigma[k], apart);
      }
    }
}

// A parameter that is not determined even if this clock is the right one has no sigma.
ClockTwin as_twin(const FitProblem& problem, const Listed& clock) {
  ClockTwin twin{{}, {}, 2.0 * clock.place.behind};
  const std::span<const double> x = clock.place.x;
  for (const Slot& slot : problem.parameters.slots) {
    if (!slot.free || !is_of_clock(slot.quantity)) continue;
    const std::string name = problem.parameters.name_of(slot);
    const double sigma = clock.sigma[slot.index];
    const bool is_determined = sigma <= tolerable_sigma(problem, slot, x);
    twin.parameters.emplace_back(name, slot.value(x));
    twin.sigma.emplace_back(name, is_determined ? sigma * std::abs(slot.slope(x)) : not_known);
  }
  return twin;
}

// Whether the second lies within the sigmas of the first in every coordinate; then both are one
// clock.
bool is_within(const Listed& one, const Listed& other) {
  for (std::size_t k = 0; k < one.sigma.size(); ++k)
    if (!(std::abs(one.place.x[k] - other.place.x[k]) <= one.sigma[k])) return false;
  return true;
}

bool is_another_clock(const Fitted& fitted, std::span<const double> x) {
  const auto& slots = fitted.problem.parameters.slots;
  return std::any_of(slots.begin(), slots.end(), [&](const Slot& slot) {
    return slot.free && is_of_clock(slot.quantity) && slot.quantity != Quantity::T0 &&
           std::abs(x[slot.index] - fitted.minimum.x[slot.index]) >=
               rivals_apart * fitted.known.curvature_sigma(slot.index);
  });
}

std::string words_for(const ClockTwin& clock) {
  std::vector<std::string> parts;
  for (const auto& [name, value] : clock.parameters)
    if (name != "T0") parts.push_back(fmt::format("{} {:.3g}", name, value));
  return fmt::format("{}", fmt::join(parts, ", "));
}

} // namespace

void list_twins(const Fitted& fitted, FitSummary& summary) {
  Rivals others;
  for (const Rival& rival : fitted.rivals) {
    const bool is_new = std::all_of(others.begin(), others.end(), [&](const Rival& other) {
      return fitted.known.tells_apart(rival.x, other.x);
    });
    if (is_new && is_another_clock(fitted, rival.x)) others.push_back(rival);
  }
  if (others.empty()) return;
  std::stable_sort(others.begin(), others.end(),
                   [](const Rival& a, const Rival& b) { return a.behind < b.behind; });
  const FitProblem all = on_every_beat(fitted.problem);
  std::vector<Listed> clocks{listed(all, {fitted.minimum.x, 0.0}, fitted.widening)};
  for (const Rival& rival : others) {
    Listed clock = listed(all, rival, fitted.widening);
    const auto holds_it = [&](const Listed& one) { return is_within(one, clock); };
    if (std::none_of(clocks.begin() + 1, clocks.end(), holds_it)) clocks.push_back(std::move(clock));
  }
  reach_one_another(all, clocks);
  summary.likeliest_twin = as_twin(all, clocks.front());
  for (std::size_t i = 1; i < clocks.size(); ++i)
    summary.twins.push_back(as_twin(all, clocks[i]));
  summary.notes.push_back(
      {NoteKind::twin,
       fmt::format(
           "{} clocks explain this log: {}; or, {:.2g} times less likely, {}. {}",
           clocks.size() == 2 ? "two" : "several", words_for(*summary.likeliest_twin),
           std::exp(others.front().behind), words_for(summary.twins.front()),
           fitted.problem.data->has_amplitude()
               ? "A ring-down, or T0 from elsewhere, would tell which"
               : "A rough measurement of the amplitude decides which: a prior on lambda0")});
}

} // namespace goingrate::timing_model
