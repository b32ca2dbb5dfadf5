#include "fit_setup.hpp"

#include "clock_model.hpp"

#include "base/scaled_time.hpp"
#include "base/special_values.hpp"
#include "base/spelling.hpp"
#include "fit/timing_noise.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/clock/restoring.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace goingrate {

FitEvent parse_fit_event(const std::string& text) {
  const std::size_t colon = text.find(':');
  FitEvent event;
  event.at_crossing = !text.starts_with('~');
  const char* digits = text.data() + (event.at_crossing ? 0 : 1);
  const char* end = text.data() + std::min(colon, text.size());
  const auto [stop, error] = std::from_chars(digits, end, event.cycle);
  if (colon == std::string::npos || error != std::errc() || stop != end)
    throw ArgumentError("event", text, "CYCLE:NAME[,NAME], for instance 150:mu, or ~150:mu");
  for (std::size_t begin = colon + 1; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    event.names.push_back(text.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return event;
}

namespace timing_model {

namespace {

constexpr double typical_torque = 1e-5; // scale of a changed torque where the first is zero
// Cycles. A given date means any moment of that swing, all equally likely: 1/sqrt 12. A date that
// was found is seldom further off than this.
constexpr double told_date_sigma = 0.289, found_date_sigma = 1.0;
// In units of the leaps' scales: the leap from half a cycle of a drive with 4 mu/lambda = 1 %.
constexpr double leap_sigma = 2.0;

// The value of a parameter about which nothing is said.
struct Kind {
  Quantity quantity;
  Coordinate coordinate;
  double scale;
};

// Sizes that occur in practice, so that a step of one unit is moderate.
constexpr Kind drag_kind{Quantity::quadratic_drag, Coordinate::multiple, 1e-3};
constexpr Kind dry_kind{Quantity::dry_friction, Coordinate::multiple, 1e-6};
constexpr Kind gravity_kind{Quantity::gravity_share, Coordinate::stretch, 1.0};
constexpr Kind offset_kind{Quantity::offset, Coordinate::multiple, 1e-3};
constexpr Kind term_kind{Quantity::term, Coordinate::multiple, 1e-6};
constexpr Kind moment_kind{Quantity::moment, Coordinate::multiple, 1.0};
constexpr Kind amplitude_leap_kind{Quantity::amplitude_leap, Coordinate::multiple, 1e-3};

Kind changing_kind(const std::string& name, const TimingData& data) {
  if (name == "mu" || name == "impulse")
    return {Quantity::mu, Coordinate::multiple, typical_torque};
  if (name == "epsilon") return {Quantity::epsilon, Coordinate::logarithm, 1.0};
  if (name == "phi0") return {Quantity::phi0, Coordinate::logarithm, 1.0};
  if (name == "impulse_angle") return {Quantity::phi0, Coordinate::multiple, 0.01};
  if (name == "T0") return {Quantity::T0, Coordinate::stretch, data.reference_period_s};
  static const std::vector<std::string> known{"mu", "epsilon", "phi0", "T0"};
  throw ArgumentError("event", name,
                      "a change of mu, epsilon, phi0 or T0" + meant_instead(name, known));
}

bool may_be_zero(Quantity quantity) {
  return quantity == Quantity::mu || quantity == Quantity::quadratic_drag ||
         quantity == Quantity::dry_friction;
}
bool may_be_negative(const Slot& slot) {
  return slot.quantity == Quantity::offset || slot.quantity == Quantity::gravity_share ||
         slot.quantity == Quantity::term || is_of_moment(slot.quantity) ||
         (slot.quantity == Quantity::phi0 && slot.coordinate == Coordinate::multiple);
}

void check_value(const std::string& name, const Slot& slot, double value) {
  const bool legal = std::isfinite(value) && (may_be_negative(slot) || value > 0.0 ||
                                              (may_be_zero(slot.quantity) && value == 0.0));
  if (!legal)
    throw ArgumentError(name, value, may_be_zero(slot.quantity) ? "not below 0" : "above 0");
  if (slot.quantity == Quantity::gravity_share) {
    ClockParameters clock;
    clock.gravity_share = value;
    check(clock);
  }
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Collects the slots of a model.
class SlotList {
public:
  SlotList(const FitOptions& options, const TimingData& data, const ModelChoice& model)
      : options_(options), data_(data), model_(model) {
    parameters_.escapement = model.escapement;
    for (const RateTerm& term : data.terms)
      parameters_.term_names.push_back(term.name);
  }

  // Of a free swing that also loses by other friction, this part may be none at all.
  [[nodiscard]] Kind linear_friction() const {
    const bool may_be_none = model_.escapement == Escapement::none &&
                             (model_.quadratic || names(options_, "quadratic_drag") || model_.dry ||
                              names(options_, "dry_friction"));
    return may_be_none ? Kind{Quantity::epsilon, Coordinate::multiple, 1e-4}
                       : Kind{Quantity::epsilon, Coordinate::logarithm, 1.0};
  }

  Parameters collect() {
    add({Quantity::T0, Coordinate::stretch, data_.reference_period_s});
    add(linear_friction());
    if (model_.escapement == Escapement::single_impulse) {
      add({Quantity::mu, Coordinate::logarithm, 1.0});
      add({Quantity::phi0, Coordinate::multiple, 0.01});
    } else if (model_.escapement != Escapement::none) {
      add({Quantity::mu, Coordinate::logarithm, 1.0});
      add({Quantity::phi0, Coordinate::logarithm, 1.0});
    }
    if (model_.quadratic || names(options_, "quadratic_drag")) add(drag_kind);
    if (model_.dry || names(options_, "dry_friction")) add(dry_kind);
    if (names(options_, "gravity_share")) add(gravity_kind);
    add({Quantity::lambda0, Coordinate::logarithm, 1.0});
    if (names(options_, "offset")) add(offset_kind);
    if (data_.has_amplitude() && (model_.amplitude_scale || names(options_, "amplitude_scale")))
      add({Quantity::amplitude_scale, Coordinate::logarithm, 1.0});
    for (std::size_t k = 0; k < data_.terms.size(); ++k)
      if (names(options_, data_.terms[k].name)) add(term_kind, 0, k);
    add_changes();
    add_noise();
    return parameters_;
  }

private:
  void add(const Kind& kind, std::size_t event = 0, std::size_t term = 0) {
    Slot slot{kind.quantity, event, kind.coordinate, kind.scale};
    slot.term = term;
    const std::string name = parameters_.name_of(slot);
    const auto fixed = options_.fixed.find(name);
    if (fixed != options_.fixed.end() && !contains(options_.freed, name)) {
      check_value(name, slot, fixed->second);
      slot.free = false;
      slot.fixed_value = fixed->second;
    }
    parameters_.add(slot);
  }

  void add_changes() {
    double last = 0.0;
    for (const FitEvent& event : options_.events) {
      const auto cycle = static_cast<double>(event.cycle);
      if (cycle <= last || cycle >= data_.cycle.back())
        throw ArgumentError("event", cycle, "inside the log, after the event before it");
      parameters_.event_cycles.push_back(last = cycle);
      for (const std::string& name : event.names) {
        if (std::count(event.names.begin(), event.names.end(), name) > 1)
          throw ArgumentError("event", name, "named once at each event");
        add(changing_kind(name, data_), parameters_.event_cycles.size());
      }
      if (!event.has_known_moment()) add_moment(parameters_.event_cycles.size());
    }
  }

  void add_moment(std::size_t event) {
    if (model_.moments == ModelChoice::Moments::of_crossings) return;
    if (model_.moments == ModelChoice::Moments::fitted) add(moment_kind, event);
    add({Quantity::late_leap, Coordinate::multiple, 1e-3 * data_.reference_period_s}, event);
    add(amplitude_leap_kind, event);
  }

  void add_noise() {
    const auto size = [](Quantity q) { return Kind{q, Coordinate::logarithm, 1.0}; };
    if (model_.jitter || names(options_, "jitter_rms")) {
      add(size(Quantity::jitter_rms));
    } else {
      Slot slot{Quantity::jitter_rms};
      slot.free = false;
      slot.fixed_value = least_jitter(data_);
      parameters_.add(slot);
    }
    if (model_.walk) add(size(Quantity::walk_rms));
    if (model_.drive) add(size(Quantity::drive_rms));
    if (model_.slow) {
      add(size(Quantity::slow_rms));
      add(size(Quantity::slow_time));
    }
    if (data_.has_amplitude()) add(size(Quantity::amplitude_rms));
  }

  const FitOptions& options_;
  const TimingData& data_;
  const ModelChoice& model_;
  Parameters parameters_;
};

} // namespace

Parameters make_parameters(const FitOptions& options, const TimingData& data,
                           const ModelChoice& model) {
  return SlotList(options, data, model).collect();
}

std::string_view as_torque(std::string_view name) {
  if (name == "impulse") return "mu";
  if (name == "impulse_angle") return "phi0";
  return name;
}

std::vector<std::string> names_without_start(const FitOptions& options) {
  const Escapement escapement = options.escapement.value_or(Escapement::constant_torque);
  const auto own_name = [&](std::string_view name) {
    const std::string_view torque = as_torque(name);
    if (escapement != Escapement::single_impulse) return std::string(torque);
    return std::string(torque == "mu" ? "impulse" : torque == "phi0" ? "impulse_angle" : torque);
  };
  std::vector<std::string> needed{"T0", "epsilon", "lambda0"};
  if (escapement != Escapement::none)
    needed.insert(needed.end(), {own_name("mu"), own_name("phi0")});
  for (std::size_t k = 0; k < options.events.size(); ++k)
    for (const std::string& name : options.events[k].names)
      needed.push_back(fmt::format("{}@{}", own_name(name), k + 1));
  std::erase_if(needed, [&](const std::string& name) {
    return options.start.contains(name) || options.fixed.contains(name);
  });
  return needed;
}

namespace {

void check_known(std::string_view role, const std::string& name,
                 const std::vector<std::string>& known) {
  if (contains(known, name)) return;
  throw ArgumentError(role, name,
                      fmt::format("{}{}", fmt::join(known, ", "), meant_instead(name, known)));
}

// A given T0 must be compatible with the mean period: it may not be so far above it that no
// escapement could speed the swing up to it, or so far below it that not even the widest swing is
// slow enough.
void check_period(const FitOptions& options, const TimingData& data) {
  const auto given = options.fixed.find("T0");
  const auto share = options.fixed.find("gravity_share");
  const bool is_gravity = !contains(options.freed, "gravity_share") &&
                          (share == options.fixed.end() || share->second == 1.0);
  if (given == options.fixed.end() || !is_gravity) return;
  constexpr double widest_rad = 2.44; // of the model
  constexpr double margin = 1.1;      // over the amplitudes logged
  double most_rad = 0.0;
  for (const double a : data.amplitude_rad)
    if (!std::isnan(a)) most_rad = std::max(most_rad, margin * a);
  if (most_rad == 0.0) most_rad = widest_rad;
  const double slowest = free_period_ratio(1.0, std::min(most_rad, widest_rad));
  constexpr double largest_drift = 0.02, largest_advance = 0.1; // of the period
  const double ratio = data.reference_period_s / given->second;
  if (ratio > slowest + largest_drift || ratio < 1.0 - largest_advance)
    throw ArgumentError("T0", given->second,
                        fmt::format("the period of small swings of a pendulum whose mean period is "
                                    "{:.6g} s",
                                    data.reference_period_s));
}

} // namespace

void check_names(const FitOptions& options, const TimingData& data) {
  if (const auto missing = names_without_start(options); !options.start.empty() && !missing.empty())
    throw ArgumentError("start", fmt::format("none of {}", fmt::join(missing, ", ")),
                        "a place for every parameter of the clock, or none");
  std::vector<std::string> known;
  ModelChoice everything;
  everything.amplitude_scale = everything.quadratic = everything.dry = everything.walk =
      everything.drive = everything.slow = true;
  if (options.escapement) everything.escapement = *options.escapement;
  FitOptions all = options;
  all.freed = {"offset", "gravity_share"};
  for (const RateTerm& term : data.terms)
    all.freed.push_back(term.name);
  all.fixed.clear();
  all.priors.clear();
  const Parameters parameters = make_parameters(all, data, everything);
  for (const Slot& slot : parameters.slots)
    known.push_back(parameters.name_of(slot));
  for (const auto& [name, value] : options.fixed)
    check_known("fix", name, known);
  for (const std::string& name : options.freed)
    check_known("free", name, known);
  for (const Prior& prior : options.priors) {
    // The angle found from the pushes stays in the options when a torque is tried.
    const bool is_told_by_pushes =
        prior.name == "impulse_angle" && data.impulses && prior.sigma > 0.0;
    if (is_told_by_pushes && std::find(known.begin(), known.end(), prior.name) == known.end())
      continue;
    check_known("prior", prior.name, known);
    if (options.fixed.contains(prior.name))
      throw ArgumentError("prior", prior.name, "a parameter that is not fixed");
    const auto slot =
        std::find_if(parameters.slots.begin(), parameters.slots.end(),
                     [&](const Slot& s) { return parameters.name_of(s) == prior.name; });
    if (!(prior.sigma > 0.0) || !std::isfinite(prior.sigma))
      throw ArgumentError("prior", prior.name, "VALUE+-SIGMA, with SIGMA above 0");
    check_value("prior", *slot, prior.value);
  }
  check_period(options, data);
}

bool names(const FitOptions& options, const std::string& parameter) {
  return options.fixed.contains(parameter) ||
         std::find(options.freed.begin(), options.freed.end(), parameter) != options.freed.end() ||
         std::any_of(options.priors.begin(), options.priors.end(),
                     [&](const Prior& prior) { return prior.name == parameter; });
}

void include_named_noise(FitOptions& options) {
  const bool slow = names(options, "slow_rms") || names(options, "slow_time");
  const bool drive = slow || names(options, "drive_rms");
  if (!drive) return;
  if (options.escapement == Escapement::none)
    throw ArgumentError("escapement", "none", "one, since noise of its drive is named");
  switch (options.noise) {
  case FitNoise::automatic:
    options.noise = slow ? FitNoise::slow : FitNoise::both;
    return;
  case FitNoise::jitter:
    throw ArgumentError("noise", "jitter", "one that has the drive_rms or slow_rms that is named");
  case FitNoise::drive:
  case FitNoise::both:
    if (slow) throw ArgumentError("noise", "without slow drive", "slow, since slow_rms is named");
    return;
  case FitNoise::slow:
    return;
  }
}

namespace {

double weak_sigma(const Slot& slot, double centre) {
  constexpr double factor = 5.0; // e^5 = 148 either way
  switch (slot.coordinate) {
  case Coordinate::logarithm:
    return factor;
  case Coordinate::stretch: // of T0 a hundredth; a share of gravity may be anything
    return slot.quantity == Quantity::T0 ? 0.01 : factor;
  case Coordinate::multiple:
    break;
  }
  const bool torque = slot.quantity == Quantity::mu;
  return torque ? factor * std::max(1.0, std::abs(centre)) : 1e4;
}

// The prior that a parameter changed at an event as planned.
std::optional<CoordinatePrior> planned_prior(const FitOptions& options,
                                             const Parameters& parameters, const Slot& slot,
                                             std::span<const double> x) {
  if (slot.event == 0 || slot.event > options.events.size()) return {};
  const FitEvent& event = options.events[slot.event - 1];
  if (!event.planned ||
      parameters.name_of(slot) != fmt::format("{}@{}", event.names.front(), slot.event))
    return {};
  const Slot* before = nullptr;
  for (const Slot& other : parameters.slots)
    if (other.quantity == slot.quantity && other.event < slot.event) before = &other;
  if (before == nullptr) return {};
  const double sigma = event.planned->sigma * std::abs(before->value(x));
  return CoordinatePrior{slot.index, 0.0, sigma, true,
                         RatioOfSlots{slot, *before, event.planned->ratio}};
}

// The largest possible leaps at an event: the difference between half a cycle under the laws before
// and under those after it, relative to the amplitude, or in rad of the phase.
double size_of_leaps(const Parameters& parameters, std::size_t event, std::span<const double> x) {
  Going<double> before;
  for (std::size_t k = 0; k < event; ++k)
    apply_changes(parameters, x, k, before);
  Going<double> after = before;
  apply_changes(parameters, x, event, after);
  const double lambda = std::sqrt(before.amplitude2_start);
  const AveragedLaws<double>&a = before.laws, &b = after.laws;
  return 2.0 * std::abs(a.mu - b.mu) / lambda +
         2.0 * a.mu * std::abs(a.phi0 - b.phi0) / (lambda * lambda) +
         2.0 * std::abs(a.epsilon - b.epsilon) + std::abs(after.T0 / before.T0 - 1.0);
}

// All moments are equally likely, so the prior is centred on the starting point and does not pull.
CoordinatePrior prior_of_moment(const FitOptions& options, const Parameters& parameters,
                                const Slot& slot, std::span<const double> start) {
  if (slot.quantity == Quantity::moment) {
    const bool found = options.events[slot.event - 1].movable;
    return {slot.index, start[slot.index], found ? found_date_sigma : told_date_sigma, true};
  }
  if (parameters.find(Quantity::moment, slot.event) == nullptr)
    return {slot.index, 0.0, leap_sigma, true};
  // WithinCycleTest.AChangeInASwingLeapsAsTheIntegratedClockDoes
  constexpr double error_of_first_order = 0.005;
  const double size = error_of_first_order * size_of_leaps(parameters, slot.event, start);
  const double unit = slot.quantity == Quantity::late_leap
                          ? slot.scale * two_pi / parameters.find(Quantity::T0)->value(start)
                          : slot.scale;
  return {slot.index, 0.0, std::max(size, 1e-12) / unit, true};
}

} // namespace

std::vector<CoordinatePrior> make_priors(const FitOptions& options, const Parameters& parameters,
                                         std::span<const double> start) {
  std::vector<CoordinatePrior> priors;
  for (const Slot& slot : parameters.slots) {
    if (!slot.free) continue;
    if (is_of_moment(slot.quantity)) {
      priors.push_back(prior_of_moment(options, parameters, slot, start));
      continue;
    }
    const bool about_start = slot.coordinate == Coordinate::logarithm ||
                             (slot.coordinate == Coordinate::multiple && slot.event > 0);
    const double centre = about_start ? start[slot.index] : 0.0;
    priors.push_back({slot.index, centre, weak_sigma(slot, centre)});
    if (const auto planned = planned_prior(options, parameters, slot, start))
      priors.push_back(*planned);
    for (const Prior& stated : options.priors) {
      if (stated.name != parameters.name_of(slot)) continue;
      priors.push_back({slot.index, slot.coordinate_of(stated.value),
                        stated.sigma / slot.slope_at(stated.value), true});
    }
  }
  return priors;
}

namespace {

// A hundredth of the scatter of neighbouring beats adds nothing visible; without a lower bound the
// search would go down for ever.
double least_visible_jitter(const TimingData& data) {
  constexpr double smallest_jitter_share = 0.01;
  const NoiseGuess noise = guess_noise(data);
  return std::max(least_jitter(data),
                  smallest_jitter_share * std::hypot(noise.jitter_s, noise.walk_s));
}

// With more friction, Q below 5, no averaged equation holds.
constexpr double largest_epsilon = 0.1;
// Q of 5 million. Pendulums in vacuum reach some 1e5. Without a bound, a misfit that looks like a
// rate that never stops changing would be attributed to a clock that never settles.
constexpr double least_epsilon = 1e-7;

// The widest swing that is tried, as a part of the swing to the top. If gravity's share is free,
// torsion pendulums may swing by any angle.
double largest_lambda(const Parameters& parameters) {
  constexpr double part_of_top = 0.94; // 140 degrees under gravity
  const Slot* share = parameters.find(Quantity::gravity_share);
  const double gravity = share == nullptr ? 1.0 : share->free ? 0.0 : share->fixed_value;
  return part_of_top * top_velocity(gravity);
}

} // namespace

std::vector<std::array<double, 2>> make_bounds(const Parameters& parameters,
                                               const TimingData& data) {
  std::vector<std::array<double, 2>> bounds(parameters.free_count, {-infinite, infinite});
  for (const Slot& slot : parameters.slots) {
    if (!slot.free) continue;
    auto& [low, high] = bounds[slot.index];
    if (slot.coordinate == Coordinate::multiple && !may_be_negative(slot)) low = 0.0;
    if (slot.quantity == Quantity::epsilon) high = slot.coordinate_of(largest_epsilon);
    if (slot.quantity == Quantity::epsilon && slot.coordinate == Coordinate::logarithm)
      low = slot.coordinate_of(least_epsilon);
    if (slot.quantity == Quantity::moment)
      low = -8.0, high = 8.0; // cycles: beyond, the date would have moved
    if (slot.quantity == Quantity::lambda0) high = std::log(largest_lambda(parameters));
    if (slot.quantity == Quantity::jitter_rms) low = std::log(least_visible_jitter(data));
    if (slot.quantity == Quantity::amplitude_rms) low = std::log(1e-9); // rad; finer than sensors
    if (slot.quantity == Quantity::drive_rms || slot.quantity == Quantity::slow_rms)
      high = 0.0; // 1: at this size the drive changes its sign, and no response is linear
    if (slot.quantity == Quantity::slow_time) {
      low = std::log(2.0 * data.reference_period_s);
      high = std::log(10.0 * data.elapsed_s.back());
    }
  }
  return bounds;
}

} // namespace timing_model
} // namespace goingrate
