#include "experiments.hpp"

#include "clock_model.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate::timing_model {

namespace {

constexpr double photogate_amplitude_rms_rad = 1e-4; // from the width of a plain photogate's pulse
constexpr double least_relative_sigma = 1e-6;        // no real clock is steady to less

// At most a few thousand evenly spaced beats without lateness, over the cycles of the log.
TimingData regular_data(const Fitted& fitted, bool with_amplitudes) {
  constexpr double most_cycles = 4000.0;
  const TimingData& seen = *fitted.problem.data;
  TimingData data;
  data.reference_period_s = seen.reference_period_s;
  const double cycles = seen.cycle.back();
  const double stride = std::max(1.0, std::ceil(cycles / most_cycles));
  for (double n = 0.0; n <= cycles; n += stride) {
    data.cycle.push_back(n);
    data.elapsed_s.push_back(n * seen.reference_period_s);
    data.lateness_s.push_back(0.0);
  }
  if (with_amplitudes) data.amplitude_rad.assign(data.size(), 0.05);
  return data;
}

// Relative sigmas of epsilon, mu, phi0 at the fitted values in another setting.
Experiment predicted(const std::string& what, const Fitted& fitted, const FitOptions& options,
                     const TimingData& data, ModelChoice model) {
  Experiment experiment{what, {}};
  FitProblem problem;
  problem.data = &data;
  problem.parameters = make_parameters(options, data, model);
  std::vector<double> x(problem.parameters.free_count, 0.0);
  for (const Slot& slot : problem.parameters.slots) {
    if (!slot.free) continue;
    if (slot.quantity == Quantity::amplitude_rms)
      x[slot.index] = std::log(photogate_amplitude_rms_rad);
    if (slot.quantity == Quantity::mu && slot.event > 0) {
      const Slot* mu = fitted.problem.parameters.find(Quantity::mu);
      x[slot.index] =
          slot.coordinate_of(1.2 * mu->value(std::span<const double>(fitted.minimum.x)));
    }
  }
  x = carried_over(fitted.problem.parameters, fitted.minimum.x, problem.parameters, x);
  problem.priors = make_priors(options, problem.parameters, x);
  const auto at = evaluate(problem, x);
  if (!at) return experiment;
  const Certainty known = certainty(problem, x, *at, {});
  for (const Slot& slot : problem.parameters.slots)
    if (slot.free && slot.event == 0 && slot.quantity >= Quantity::epsilon &&
        slot.quantity <= Quantity::phi0 && known.sigma(slot.index) < 1.0 / 3.0)
      experiment.relative_sigma.emplace_back(
          problem.parameters.name_of(slot),
          std::max(known.sigma(slot.index), least_relative_sigma));
  return experiment;
}

} // namespace

std::vector<Experiment> suggest_experiments(const Fitted& fitted, const FitOptions& options) {
  std::vector<Experiment> found;
  if (fitted.model.escapement != Escapement::constant_torque) return found;
  const std::span<const double> x(fitted.minimum.x);
  FitOptions bare = options; // without the changes, which belong to the log at hand
  bare.events.clear();
  bare.freed.clear();
  std::erase_if(bare.fixed,
                [](const auto& item) { return item.first.find('@') != std::string::npos; });
  std::erase_if(bare.priors, [](const Prior& p) { return p.name.find('@') != std::string::npos; });
  const TimingData times = regular_data(fitted, false), both = regular_data(fitted, true);
  FitOptions known_T0 = bare;
  const Slot* T0 = fitted.problem.parameters.find(Quantity::T0);
  known_T0.fixed["T0"] = T0->value(x);
  FitOptions jump = bare;
  jump.events = {{static_cast<std::int64_t>(times.cycle.back() / 2.0), {"mu"}}};
  FitOptions jump_known = jump;
  jump_known.fixed["T0"] = T0->value(x);
  const ModelChoice& model = fitted.model;
  if (T0->free) found.push_back(predicted("T0 known", fitted, known_T0, times, model));
  if (!fitted.problem.data->has_amplitude())
    found.push_back(
        predicted("an amplitude with each beat, to 0.1 mrad", fitted, bare, both, model));
  if (options.events.empty()) {
    found.push_back(predicted("a fifth more drive from the middle of as long a log on", fitted,
                              jump, times, model));
    if (T0->free)
      found.push_back(
          predicted("the same change of drive, and T0 known", fitted, jump_known, times, model));
  }
  std::erase_if(found, [](const Experiment& e) { return e.relative_sigma.empty(); });
  return found;
}

} // namespace goingrate::timing_model
