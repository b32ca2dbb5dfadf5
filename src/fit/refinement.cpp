#include "refinement.hpp"

#include "every_friction.hpp"
#include "reference_run.hpp"

#include "fit/timing_noise.hpp"

#include <algorithm>
#include <functional>
#include <limits>

namespace goingrate::timing_model {

void extend(FitProblem& problem, std::span<const double> x) {
  problem.parameters.start_ratio = limit_cycle_ratio(problem.parameters, x);
  auto correction = difference_to(FitDynamics::averaged2, problem, x);
  problem.correction = correction ? std::move(*correction) : Correction{};
}

namespace {

// The change by a step of scoring; the noise is left as it is, because the misfit may be large.
struct ClockStep {
  Eigen::VectorXd of_x;
  double gain = 0.0; ///< of L, that it promises
};
std::optional<ClockStep> clock_step(const FitProblem& problem, std::span<const double> x) {
  const auto at = evaluate(problem, x);
  if (!at) return {};
  Eigen::VectorXd step = -at->triangle.triangularView<Eigen::Upper>().solve(at->projected);
  for (const Slot& slot : problem.parameters.slots)
    if (slot.free && !is_of_clock(slot.quantity)) step[static_cast<Eigen::Index>(slot.index)] = 0.0;
  const Eigen::VectorXd seen = at->triangle.triangularView<Eigen::Upper>() * step;
  return ClockStep{std::move(step), 0.5 * seen.squaredNorm()};
}

// L of the clock at its minimum by these dynamics themselves, infinite if it has none; nullopt if
// they cannot follow that clock.
std::optional<double> by_its_own(FitDynamics dynamics, Fitted& fitted) {
  FitProblem& problem = fitted.problem;
  problem.parameters.start_ratio = limit_cycle_ratio(problem.parameters, fitted.minimum.x);
  auto correction = difference_to(dynamics, problem, fitted.minimum.x);
  if (!correction) return {};
  problem.correction = std::move(*correction);
  return minus_log_likelihood(problem, fitted.minimum.x)
      .value_or(std::numeric_limits<double>::infinity());
}

// The slopes of corrections, computed again if the search has moved: they are differences of many
// runs, and change no more than the parameters do. Also if a condensed log has given way to all
// beats, of which each has a slope.
class SlopesNearby {
public:
  void put_into(Fitted& fitted, FitDynamics dynamics) {
    constexpr double trusted_distance = 0.01; // of a coordinate: corrections are small themselves
    const std::vector<double>& x = fitted.minimum.x;
    const auto moves_far = [](double a, double b) { return std::abs(a - b) > trusted_distance; };
    const std::size_t places = fitted.problem.asked().size();
    if (!slopes_ || places != places_ ||
        !std::equal(x.begin(), x.end(), taken_at_.begin(), std::not_fn(moves_far))) {
      slopes_ = slopes_of_difference(dynamics, fitted.problem, x);
      taken_at_ = x;
      places_ = places;
    }
    if (!slopes_) return;
    fitted.problem.correction.slopes = *slopes_;
    fitted.problem.correction.slopes.at = x;
  }

private:
  std::vector<double> taken_at_;
  std::size_t places_ = 0;
  std::optional<Correction::Slopes> slopes_;
};

// The rms of the correction of the times, s, apart from a line, for which T0 makes up.
double bend_of(const FitProblem& problem) {
  const std::vector<double>&x = problem.asked().cycle, &y = problem.correction.late_s;
  const Eigen::Map<const Eigen::ArrayXd> cycle(x.data(), static_cast<Eigen::Index>(x.size())),
      late(y.data(), static_cast<Eigen::Index>(y.size()));
  const Eigen::ArrayXd along = cycle - cycle.mean(), bent = late - late.mean();
  const double slope = (along * bent).sum() / along.square().sum();
  return std::sqrt((bent - slope * along).square().mean());
}

// Whether a fit with no noise but jitter misses the times, beyond their scatter, by far more than
// the dynamics add to them. The derivatives of the correction, the most expensive part, are then
// not worth computing.
bool is_far_beyond(const Fitted& first_order, const FitProblem& corrected) {
  constexpr double hopeless_ratio = 10.0; // of the misfit to what the dynamics add
  constexpr double scatter_ratio = 1.5;   // of the misfit to the scatter of neighbouring beats
  const ModelChoice& model = first_order.model;
  if (model.walk || model.drive || model.slow) return false;
  const double misfit = rms(first_order.seen.late_s);
  return misfit > scatter_ratio * local_white_noise(first_order.seen.late_s) &&
         misfit > hopeless_ratio * bend_of(corrected);
}

// First order may stop a free swing before the log ends where the dynamics do not: begins with less
// friction there.
void begin_where_it_swings(Fitted& fitted, FitDynamics dynamics) {
  constexpr int most_steps = 8;
  constexpr double less = 0.9; // of each term
  if (fitted.problem.parameters.escapement != Escapement::none) return;
  for (int step = 0; step < most_steps && !by_its_own(dynamics, fitted); ++step)
    for (const Slot& slot : fitted.problem.parameters.slots) {
      const bool is_friction = std::find(friction_terms.begin(), friction_terms.end(),
                                         slot.quantity) != friction_terms.end();
      if (is_friction && slot.free)
        fitted.minimum.x[slot.index] =
            slot.coordinate_of(less * slot.value(std::span<const double>(fitted.minimum.x)));
    }
}

// Whether the innovations show that the fit at this point explains nothing.
bool is_lost(const Residuals& seen) {
  constexpr double beyond_chance = 1e-6;
  const auto coloured = [&](const std::vector<double>& innovations) {
    return innovations.size() >= 8 && whiteness_p(innovations) < beyond_chance;
  };
  return coloured(seen.white_time) || coloured(seen.white_amplitude);
}

// Whether the misfit remains with noise of every kind, so that the last digits are worth nothing.
bool is_lost_for_good(const Fitted& fitted) {
  const auto seen = fitted.model.drive || fitted.model.slow
                        ? residuals(fitted.problem, fitted.minimum.x)
                        : std::nullopt;
  return seen && is_lost(*seen);
}

// Whether a fit with noise of the drive explains so little that nothing of it can be stated.
bool explains_nothing(const Fitted& fitted) {
  return (fitted.model.drive || fitted.model.slow) && is_lost(fitted.seen) &&
         fitted.widening.largest() > largest_widening;
}

} // namespace

bool refine(Fitted& fitted, FitDynamics dynamics) {
  if (dynamics == FitDynamics::averaged1) return true;
  constexpr int rounds = 8; // each gains two or three digits where the averaged model is near
  constexpr double least_gain = 2e-4; // of L: 0.02 sigma of the best known combination
  Fitted refined = fitted;
  refined.dynamics = dynamics;
  Fitted best; // by the dynamics themselves: along a flat ridge a later round may be worse
  best.minimum.value = std::numeric_limits<double>::infinity();
  double before = std::numeric_limits<double>::infinity();
  SlopesNearby slopes;
  // Constant corrections would appear to be information where the log can hardly tell a change of
  // the clock from the change of its correction: along the flat ridge of times alone, in free
  // swings of more than a radian, and with a drive that varies according to the amplitudes. With
  // amplitudes and no noise but jitter, a driven clock is well determined.
  const bool with_slopes = refined.problem.parameters.escapement == Escapement::none ||
                           refined.problem.parameters.has(Quantity::drive_rms) ||
                           !refined.problem.data->has_amplitude();
  const bool was_lost = explains_nothing(fitted);
  begin_where_it_swings(refined, dynamics);
  for (int round = 0; round < rounds; ++round) {
    const auto here = by_its_own(dynamics, refined);
    if (!here) { // the search led to where the dynamics cannot follow
      if (!best.minimum.usable) return false;
      for (std::size_t k = 0; k < refined.minimum.x.size(); ++k)
        refined.minimum.x[k] = 0.5 * (refined.minimum.x[k] + best.minimum.x[k]);
      continue;
    }
    const bool is_far = is_far_beyond(fitted, refined.problem) ||
                        (was_lost && (round == 0 || is_lost_for_good(refined)));
    if (with_slopes && !is_far) slopes.put_into(refined, dynamics);
    if (*here < best.minimum.value) {
      best = refined;
      best.minimum.value = *here;
      best.minimum.usable = true; // the model holds there, whether or not a search has ended there
    }
    const auto step = clock_step(refined.problem, refined.minimum.x);
    if (!step) return false;
    // At a bound, a step keeps promising a gain that cannot be had.
    const bool stands = std::abs(before - *here) < least_gain;
    if ((round > 1 && (step->gain < least_gain || stands)) || (round > 0 && is_far)) break;
    if (round > 1 && is_lost_for_good(refined)) break;
    before = *here;
    std::vector<double> moved = refined.minimum.x;
    constexpr double longest_step = 0.3; // along a flat ridge a step of scoring may lead anywhere
    const double part =
        std::min(1.0, longest_step / std::max(longest_step, step->of_x.cwiseAbs().maxCoeff()));
    for (std::size_t k = 0; k < moved.size(); ++k) {
      const auto [low, high] = refined.problem.bounds[k];
      moved[k] = std::clamp(moved[k] + part * step->of_x[static_cast<Eigen::Index>(k)], low, high);
    }
    const auto there = minus_log_likelihood(refined.problem, moved);
    if (there && *there < *here) refined.minimum.x = moved;
    if (round == 0) continue; // first the difference at the new point is needed
    settle(refined.problem, refined.minimum, {});
    if (!refined.minimum.usable) return false;
  }
  if (!std::isfinite(best.minimum.value)) return false;
  refined = std::move(best);
  for (Rival& rival : refined.rivals)
    rival.x = moved_along(rival.x, fitted.minimum.x, refined.minimum.x);
  finish(refined);
  if (!refined.minimum.usable || (!is_lost(fitted.seen) && is_lost(refined.seen))) return false;
  fitted = std::move(refined);
  return true;
}

bool is_hopeless(const Fitted& fitted) {
  FitProblem corrected = fitted.problem;
  auto correction = difference_to(FitDynamics::averaged2, corrected, fitted.minimum.x);
  if (!correction) return false;
  corrected.correction = std::move(*correction);
  return is_far_beyond(fitted, corrected);
}

bool refine_every_end(Fitted& fitted, FitDynamics dynamics) {
  std::vector<Fitted> refined;
  const auto consider = [&](Fitted&& end) {
    end.ends.clear();
    if (end.minimum.usable && refine(end, dynamics)) refined.push_back(std::move(end));
  };
  consider(Fitted(fitted));
  std::vector<std::vector<double>> places = fitted.ends;
  for (const Rival& rival : fitted.rivals) // what explains the log in first order only is none
    if (std::none_of(places.begin(), places.end(),
                     [&](const auto& place) { return !fitted.known.tells_apart(place, rival.x); }))
      places.push_back(rival.x);
  for (const std::vector<double>& place : places) {
    Fitted end = fitted;
    end.rivals.clear();
    end.minimum.x = place;
    // With the corrections from another end, a search from here would lead to that end.
    if (fitted.dynamics != FitDynamics::averaged1 && !by_its_own(fitted.dynamics, end)) continue;
    settle(end.problem, end.minimum, {});
    if (end.minimum.usable) finish(end);
    consider(std::move(end));
  }
  if (refined.empty()) return false;
  std::stable_sort(refined.begin(), refined.end(),
                   [](const Fitted& a, const Fitted& b) { return by_value(a.minimum, b.minimum); });
  fitted = std::move(refined.front());
  if (!places.empty()) fitted.rivals.clear();
  constexpr double largest_deficit = 4.5; // of L: three sigma
  for (std::size_t k = 1; k < refined.size(); ++k) {
    const Minimum& other = refined[k].minimum;
    fitted.ends.push_back(other.x);
    if (other.value < fitted.minimum.value + largest_deficit &&
        fitted.known.tells_apart(other.x, fitted.minimum.x))
      fitted.rivals.push_back({other.x, other.value - fitted.minimum.value});
  }
  return true;
}

} // namespace goingrate::timing_model
