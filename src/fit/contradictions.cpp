#include "contradictions.hpp"

#include "base/readable.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <span>

namespace goingrate::timing_model {

namespace {

// Whether the clock is at the limit of the equations' validity: the log comes from something else.
bool leaves_the_domain(const Fitted& fitted) {
  constexpr double bound_margin = 1e-6; // of a logarithm
  const Parameters& parameters = fitted.problem.parameters;
  return std::any_of(parameters.slots.begin(), parameters.slots.end(), [&](const Slot& slot) {
    return slot.free && is_of_clock(slot.quantity) &&
           fitted.minimum.x[slot.index] > fitted.problem.bounds[slot.index][1] - bound_margin;
  });
}

// Finds a stretch whose innovations are far larger than elsewhere, by medians over blocks.
struct RoughStretch {
  double from_s, to_s, times; ///< how much larger
};
std::optional<RoughStretch> rough_stretch(const Fitted& fitted) {
  constexpr std::size_t least_block_beats = 30; // beats a block
  constexpr double largest_ratio = 2.5;         // the median of 30 is good to a fifth
  const std::vector<double>& white = fitted.seen.white_time;
  const std::size_t block = std::max(least_block_beats, white.size() / 50);
  const auto size_of = [&](std::size_t first, std::size_t end) {
    std::vector<double> size;
    for (std::size_t i = first; i < end; ++i)
      size.push_back(std::abs(white[i]));
    std::nth_element(size.begin(), size.begin() + size.size() / 2, size.end());
    return size[size.size() / 2];
  };
  if (white.size() < 4 * block) return {};
  const double typical = size_of(0, white.size());
  std::optional<RoughStretch> rough;
  for (std::size_t first = 0; first + block <= white.size(); first += block) {
    const double times = size_of(first, first + block) / typical;
    if (!(times > largest_ratio)) continue;
    const std::vector<double>& at = fitted.problem.data->elapsed_s;
    if (!rough) rough = RoughStretch{at[first], at[first + block], times};
    rough->to_s = at[first + block];
    rough->times = std::max(rough->times, times);
  }
  return rough;
}

// A drive that waits for the swing to fall regulates the amplitude, and a fit with a mean drive
// mistakes the memory of that regulation for friction.
std::optional<FitNote> regulated_swing(const Fitted& fitted) {
  const auto& pushes = fitted.problem.data->impulses;
  if (!pushes || pushes->is_regular || fitted.model.escapement == Escapement::none) return {};
  return FitNote{NoteKind::misfit,
                 "the clock waits with its push until the swing has fallen, which holds the "
                 "amplitude as no steady drive does: what is fitted with the mean drive is not "
                 "that of this clock"};
}

// Between two pushes the swing is free and shows its friction, whatever the pushes give.
// A fit that leaves the friction open contradicts nothing.
std::optional<FitNote> other_friction_between_pushes(const Fitted& fitted,
                                                     const std::vector<Interval>& ends) {
  const auto& pushes = fitted.problem.data->impulses;
  const Slot& slot = *fitted.problem.parameters.find(Quantity::epsilon);
  const bool is_linear = fitted.model.friction() == "linear";
  if (!pushes || !pushes->epsilon || !slot.free || !is_linear) return {};
  const double seen = pushes->epsilon->value;
  if (!(seen > 0.0)) return {};
  const double best = fitted.minimum.x[slot.index], off = slot.coordinate_of(seen) - best;
  const Interval& own = ends[slot.index];
  const double sigma = (off < 0.0 ? best - own.low95 : own.high95 - best) / z95;
  constexpr double largest_difference_sigma = 4.0;
  if (!(std::abs(off) >
        largest_difference_sigma * std::hypot(sigma, pushes->epsilon->sigma / seen)))
    return {};
  const double found = slot.value(std::span<const double>(fitted.minimum.x));
  return FitNote{NoteKind::misfit,
                 fmt::format("between two pushes the swing dies away by ε = {}, in the best fit by "
                             "{}: the pushes are not those of a steady drive",
                             readable(seen, 3), readable(found, 3))};
}

} // namespace

bool scatters_unevenly(const Fitted& fitted) {
  return fitted.widening.largest() > largest_widening && rough_stretch(fitted);
}

std::vector<FitNote> model_contradictions(const Fitted& fitted, const FitQuality& quality,
                                          const std::vector<Interval>& ends) {
  std::vector<FitNote> found;
  if (const auto rough = rough_stretch(fitted);
      rough && fitted.widening.largest() > largest_widening)
    found.push_back(
        {NoteKind::rough_stretch,
         fmt::format("from {:.0f} to {:.0f} s the beats scatter up to {} times as much as "
                     "elsewhere, and the model does not follow: no one clock explains this log; "
                     "leave that stretch out",
                     rough->from_s, rough->to_s, readable(rough->times, 2))});
  if (leaves_the_domain(fitted))
    found.push_back({NoteKind::domain,
                     "the best fit swings or loses more than any pendulum of this model: "
                     "something else rules the times"});
  if (const auto regulated = regulated_swing(fitted))
    found.push_back(*regulated);
  else if (const auto other = other_friction_between_pushes(fitted, ends))
    found.push_back(*other);
  constexpr double least_p_value = 1e-6;
  if (found.empty() && fitted.minimum.converged && quality.p_value < least_p_value)
    found.push_back({NoteKind::misfit,
                     fmt::format("the times stray from the best fit by {} times the "
                                 "scatter of neighbouring beats: no clock of this model explains "
                                 "this log",
                                 readable(std::sqrt(quality.chi2 / quality.dof), 3))});
  return found;
}

void note_contradicted_priors(const Fitted& fitted, FitSummary& summary) {
  for (const CoordinatePrior& prior : fitted.problem.priors) {
    if (!prior.stated) continue;
    const double off = prior.pull(fitted.minimum.x);
    constexpr double largest_pull_sigma = 4.0; // sigma of the prior alone
    if (std::abs(off) < largest_pull_sigma) continue;
    for (const Slot& slot : fitted.problem.parameters.slots)
      if (slot.free && slot.index == prior.index)
        summary.notes.push_back(
            {NoteKind::prior, fmt::format("the log contradicts the prior on {}: it ends {:.3g} "
                                          "of the prior's sigmas away",
                                          fitted.problem.parameters.name_of(slot), off)});
  }
}

} // namespace goingrate::timing_model
