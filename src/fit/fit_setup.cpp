#include "fit_setup.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/fit/timing_noise.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <set>

namespace goingrate {

FitEvent parse_fit_event(const std::string& text) {
  const std::size_t colon = text.find(':');
  FitEvent event;
  const char* end = text.data() + std::min(colon, text.size());
  const auto [stop, error] = std::from_chars(text.data(), end, event.cycle);
  if (colon == std::string::npos || error != std::errc() || stop != end)
    throw ArgumentError("event", text, "CYCLE:NAME[,NAME], for instance 150:mu");
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
constexpr double infinite = std::numeric_limits<double>::infinity();

// A parameter as it is when nothing is said about it.
struct Kind {
  Quantity quantity;
  Coordinate coordinate;
  double scale;
};

// Sizes that people meet, so that a step of one is a moderate one.
constexpr Kind drag_kind{Quantity::quadratic_drag, Coordinate::multiple, 1e-3};
constexpr Kind dry_kind{Quantity::dry_friction, Coordinate::multiple, 1e-6};
constexpr Kind offset_kind{Quantity::offset, Coordinate::multiple, 1e-3};
constexpr Kind term_kind{Quantity::term, Coordinate::multiple, 1e-6};

Kind changing_kind(const std::string& name, const TimingData& data) {
  if (name == "mu" || name == "impulse")
    return {Quantity::mu, Coordinate::multiple, typical_torque};
  if (name == "epsilon") return {Quantity::epsilon, Coordinate::logarithm, 1.0};
  if (name == "phi0") return {Quantity::phi0, Coordinate::logarithm, 1.0};
  if (name == "impulse_angle") return {Quantity::phi0, Coordinate::multiple, 0.01};
  if (name == "T0") return {Quantity::T0, Coordinate::stretch, data.reference_period_s};
  throw ArgumentError("event", name, "a change of mu, epsilon, phi0 or T0");
}

bool may_be_zero(Quantity quantity) {
  return quantity == Quantity::mu || quantity == Quantity::quadratic_drag ||
         quantity == Quantity::dry_friction;
}
bool may_be_negative(const Slot& slot) {
  return slot.quantity == Quantity::offset || slot.quantity == Quantity::term ||
         (slot.quantity == Quantity::phi0 && slot.coordinate == Coordinate::multiple);
}

void check_value(const std::string& name, const Slot& slot, double value) {
  const bool legal = std::isfinite(value) && (may_be_negative(slot) || value > 0.0 ||
                                              (may_be_zero(slot.quantity) && value == 0.0));
  if (!legal)
    throw ArgumentError(name, value, may_be_zero(slot.quantity) ? "not below 0" : "above 0");
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

  Parameters collect() {
    add({Quantity::T0, Coordinate::stretch, data_.reference_period_s});
    add({Quantity::epsilon, Coordinate::logarithm, 1.0});
    if (model_.escapement == Escapement::single_impulse) {
      add({Quantity::mu, Coordinate::logarithm, 1.0});
      add({Quantity::phi0, Coordinate::multiple, 0.01});
    } else if (model_.escapement != Escapement::none) {
      add({Quantity::mu, Coordinate::logarithm, 1.0});
      add({Quantity::phi0, Coordinate::logarithm, 1.0});
    }
    if (model_.quadratic || names(options_, "quadratic_drag")) add(drag_kind);
    if (model_.dry || names(options_, "dry_friction")) add(dry_kind);
    add({Quantity::lambda0, Coordinate::logarithm, 1.0});
    if (names(options_, "offset")) add(offset_kind);
    if (data_.has_amplitude() && (model_.amplitude_scale || names(options_, "amplitude_scale")))
      add({Quantity::amplitude_scale, Coordinate::logarithm, 1.0});
    for (std::size_t k = 0; k < data_.terms.size(); ++k)
      if (names(options_, data_.terms[k].name)) add(term_kind, 0, k);
    add_changes();
    add_noise();
    if (parameters_.free_count > most_parameters)
      throw ArgumentError("parameters", static_cast<double>(parameters_.free_count),
                          fmt::format("at most {} free ones", most_parameters));
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
    }
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

std::string ModelChoice::friction() const {
  return std::string("linear") + (quadratic ? " + quadratic" : "") + (dry ? " + dry" : "");
}

std::string ModelChoice::noise() const {
  std::vector<std::string> parts;
  if (jitter) parts.emplace_back("jitter");
  if (walk) parts.emplace_back("random walk");
  if (drive) parts.emplace_back("drive");
  if (slow) parts.emplace_back("slow drive");
  return fmt::format("{}", fmt::join(parts, " + "));
}

std::string ModelChoice::name() const {
  return fmt::format("{}, friction {}, noise {}{}", name_of(escapement), friction(), noise(),
                     amplitude_scale ? ", amplitude scale" : "");
}

double least_jitter(const TimingData& data) {
  return 1e-12 * data.reference_period_s + 4e-16 * data.elapsed_s.back();
}

Parameters make_parameters(const FitOptions& options, const TimingData& data,
                           const ModelChoice& model) {
  return SlotList(options, data, model).collect();
}

void check_names(const FitOptions& options, const TimingData& data) {
  std::set<std::string> known;
  ModelChoice everything;
  everything.amplitude_scale = everything.quadratic = everything.dry = everything.walk =
      everything.drive = everything.slow = true;
  if (options.escapement) everything.escapement = *options.escapement;
  FitOptions all = options;
  all.freed = {"offset"};
  for (const RateTerm& term : data.terms)
    all.freed.push_back(term.name);
  all.fixed.clear();
  all.priors.clear();
  const Parameters parameters = make_parameters(all, data, everything);
  for (const Slot& slot : parameters.slots)
    known.insert(parameters.name_of(slot));
  const std::string legal = fmt::format("{}", fmt::join(known, ", "));
  for (const auto& [name, value] : options.fixed)
    if (!known.contains(name)) throw ArgumentError("fix", name, legal);
  for (const std::string& name : options.freed)
    if (!known.contains(name)) throw ArgumentError("free", name, legal);
  for (const Prior& prior : options.priors) {
    if (!known.contains(prior.name)) throw ArgumentError("prior", prior.name, legal);
    if (options.fixed.contains(prior.name))
      throw ArgumentError("prior", prior.name, "a parameter that is not fixed");
    const auto slot =
        std::find_if(parameters.slots.begin(), parameters.slots.end(),
                     [&](const Slot& s) { return parameters.name_of(s) == prior.name; });
    if (!(prior.sigma > 0.0) || !std::isfinite(prior.sigma))
      throw ArgumentError("prior", prior.name, "VALUE+-SIGMA, with SIGMA above 0");
    check_value("prior", *slot, prior.value);
  }
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
  const bool walk = names(options, "walk_rms");
  if (drive && walk)
    throw ArgumentError("walk_rms", "named beside noise of the drive",
                        "one or the other: the drive's noise is what makes the times walk");
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
  case Coordinate::stretch:
    return 0.01;
  case Coordinate::multiple:
    break;
  }
  const bool torque = slot.quantity == Quantity::mu;
  return torque ? factor * std::max(1.0, std::abs(centre)) : 1e4;
}

} // namespace

std::vector<CoordinatePrior> make_priors(const FitOptions& options, const Parameters& parameters,
                                         std::span<const double> start) {
  std::vector<CoordinatePrior> priors;
  for (const Slot& slot : parameters.slots) {
    if (!slot.free) continue;
    const bool about_start = slot.coordinate == Coordinate::logarithm ||
                             (slot.coordinate == Coordinate::multiple && slot.event > 0);
    const double centre = about_start ? start[slot.index] : 0.0;
    priors.push_back({slot.index, centre, weak_sigma(slot, centre)});
    for (const Prior& stated : options.priors) {
      if (stated.name != parameters.name_of(slot)) continue;
      priors.push_back({slot.index, slot.coordinate_of(stated.value),
                        stated.sigma / slot.slope_at(stated.value), true});
    }
  }
  return priors;
}

namespace {

// A hundredth of what neighbouring beats scatter by adds nothing that could be seen; without a
// floor the search would follow it down for ever.
double least_visible_jitter(const TimingData& data) {
  constexpr double invisible = 0.01;
  const NoiseGuess noise = guess_noise(data);
  return std::max(least_jitter(data), invisible * std::hypot(noise.jitter_s, noise.walk_s));
}

} // namespace

std::vector<std::array<double, 2>> make_bounds(const Parameters& parameters,
                                               const TimingData& data) {
  std::vector<std::array<double, 2>> bounds(parameters.free_count, {-infinite, infinite});
  for (const Slot& slot : parameters.slots) {
    if (!slot.free) continue;
    auto& [low, high] = bounds[slot.index];
    if (slot.coordinate == Coordinate::multiple && !may_be_negative(slot)) low = 0.0;
    if (slot.quantity == Quantity::jitter_rms) low = std::log(least_visible_jitter(data));
    if (slot.quantity == Quantity::amplitude_rms) low = std::log(1e-9); // rad; finer than sensors
    if (slot.quantity == Quantity::drive_rms || slot.quantity == Quantity::slow_rms)
      high = std::log(10.0); // a drive that turns round every other beat drives nothing
    if (slot.quantity == Quantity::slow_time) {
      low = std::log(2.0 * data.reference_period_s);
      high = std::log(10.0 * data.elapsed_s.back());
    }
  }
  return bounds;
}

namespace {

// Robust mean square of the third differences at a stride: of jitter j and a walk w it is
// 20 j^2 + 6 stride w^2, of anything smooth over three strides nearly nothing.
double third_differences(const TimingData& data, std::span<const double> series,
                         std::size_t stride) {
  constexpr std::size_t enough = 20000; // known to a per cent
  std::vector<double> size;
  for (std::size_t i = 0; i + 3 * stride < series.size() && size.size() < enough; ++i) {
    if (data.cycle[i + 3 * stride] - data.cycle[i] != 3.0 * static_cast<double>(stride)) continue;
    const double d = series[i + 3 * stride] - 3.0 * series[i + 2 * stride] +
                     3.0 * series[i + stride] - series[i];
    if (std::isfinite(d)) size.push_back(std::abs(d));
  }
  if (size.empty()) return 0.0;
  const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  constexpr double normal = 1.4826; // standard deviation over median of the size
  return std::pow(normal * *middle, 2);
}

} // namespace

NoiseGuess guess_noise(const TimingData& data) {
  NoiseGuess guess;
  constexpr std::size_t stride = 8;
  const double near = third_differences(data, data.lateness_s, 1);
  const double far = third_differences(data, data.lateness_s, stride);
  const double walk2 = std::clamp((far - near) / (6.0 * (stride - 1)), 0.0, near / 6.0);
  guess.walk_s = std::sqrt(walk2);
  // Relative standard deviation of a mean square from the median of m independent sizes: 2.3/sqrt
  // m; third differences over 8 beats are independent every 24.
  const double scatter = 2.3 * std::sqrt(3.0 * stride / static_cast<double>(data.size()));
  guess.walks = far > near * (1.0 + 4.0 * scatter);
  guess.jitter_s =
      std::max(std::sqrt(std::max(0.0, near - 6.0 * walk2) / 20.0), least_jitter(data));
  constexpr double finest = 1e-8; // rad
  if (data.has_amplitude())
    guess.amplitude_rad =
        std::max(std::sqrt(third_differences(data, data.amplitude_rad, 1) / 20.0), finest);
  return guess;
}

namespace {

// Rate excess of the data (relative to the mean period) over beats [from, to), by end points.
double mean_rate(const TimingData& data, std::size_t from, std::size_t to) {
  if (to <= from + 1) return 0.0;
  return -(data.lateness_s[to - 1] - data.lateness_s[from]) /
         (data.elapsed_s[to - 1] - data.elapsed_s[from]);
}

std::size_t first_beat_at(const TimingData& data, double cycle) {
  const auto at = std::lower_bound(data.cycle.begin(), data.cycle.end(), cycle);
  return static_cast<std::size_t>(at - data.cycle.begin());
}

// The jump of the rate at an event, from up to fifty beats on each side.
double rate_jump(const TimingData& data, const Parameters& parameters, std::size_t event) {
  constexpr std::size_t reach = 50; // short beside the relaxation, long beside the jitter
  const std::size_t at = first_beat_at(data, parameters.event_cycles[event - 1]);
  const std::size_t earliest =
      event >= 2 ? first_beat_at(data, parameters.event_cycles[event - 2]) : 0;
  const std::size_t latest = event < parameters.event_cycles.size()
                                 ? first_beat_at(data, parameters.event_cycles[event])
                                 : data.size() - 1;
  const std::size_t from = at > earliest + reach ? at - reach : earliest;
  const std::size_t to = std::min(at + reach, latest);
  return mean_rate(data, at, to + 1) - mean_rate(data, from, at + 1);
}

double known_amplitude(const TimingData& data, bool last) {
  std::vector<double> seen;
  for (const double a : data.amplitude_rad)
    if (a > 0.0) seen.push_back(a);
  if (seen.empty()) return 0.0;
  const std::size_t take = std::min<std::size_t>(seen.size(), 20);
  const auto begin = last ? seen.end() - static_cast<std::ptrdiff_t>(take) : seen.begin();
  double sum = 0.0;
  for (auto it = begin; it != begin + static_cast<std::ptrdiff_t>(take); ++it)
    sum += *it;
  return sum / static_cast<double>(take);
}

struct Guess {
  double epsilon, lambda, ratio, start_ratio;
};

double noise_value(const Slot& slot, const NoiseGuess& noise, double fast_gain,
                   const TimingData& data) {
  const double drive = std::clamp(noise.walk_s / (data.reference_period_s * fast_gain), 1e-4, 3.0);
  switch (slot.quantity) {
  case Quantity::jitter_rms:
    return noise.jitter_s;
  case Quantity::walk_rms:
    return std::max(noise.walk_s, 0.01 * noise.jitter_s);
  case Quantity::drive_rms:
    return drive;
  case Quantity::slow_rms:
    return 0.1 * drive;
  case Quantity::slow_time:
    return 0.1 * data.elapsed_s.back();
  default:
    return std::max(noise.amplitude_rad, 1e-9);
  }
}

// The guess as coordinates; what is fixed shapes the guess of the rest.
std::vector<double> coordinates(const Guess& guess, const Parameters& parameters,
                                const TimingData& data, const NoiseGuess& noise) {
  using std::numbers::pi;
  std::vector<double> x(parameters.free_count, 0.0);
  const bool impulse = parameters.escapement == Escapement::single_impulse;
  double epsilon = guess.epsilon;
  double phi0 = impulse ? 0.1 * guess.lambda : guess.lambda / guess.ratio;
  for (const Slot& slot : parameters.slots) {
    if (slot.free || slot.event != 0) continue;
    if (slot.quantity == Quantity::epsilon) epsilon = slot.fixed_value;
    if (slot.quantity == Quantity::phi0) phi0 = slot.fixed_value;
  }
  const double lambda2 = guess.lambda * guess.lambda;
  double mu = impulse ? 2.0 * pi * epsilon * lambda2 : pi * epsilon * lambda2 / (2.0 * phi0);
  const double fast_gain =
      2.0 / (pi * guess.lambda) * std::sqrt(std::max(0.05, 1.0 - phi0 * phi0 / lambda2));
  for (const Slot& slot : parameters.slots) {
    double value = slot.quantity == Quantity::T0 ? data.reference_period_s : 0.0;
    if (slot.quantity == Quantity::epsilon) value = epsilon;
    if (slot.quantity == Quantity::phi0) value = phi0;
    if (slot.quantity == Quantity::amplitude_scale) value = 1.0;
    if (slot.quantity == Quantity::lambda0) value = guess.lambda * guess.start_ratio;
    if (is_noise(slot.quantity)) value = noise_value(slot, noise, mu * fast_gain, data);
    if (slot.quantity == Quantity::mu) {
      if (slot.event > 0 && !impulse)
        mu = std::max(0.02 * mu, mu + rate_jump(data, parameters, slot.event) / fast_gain);
      if (!slot.free) mu = slot.fixed_value;
      value = mu;
    }
    if (slot.free) x[slot.index] = slot.coordinate_of(value);
  }
  return x;
}

// Where T0 is known the mean rate of the last part of the log fixes the amplitude of a clock at
// rest, lambda^2 = 16 (eps sqrt(q^2 - 1) - rate), q = lambda/phi0 (eq. statrate).
double amplitude_from_rate(double epsilon, double ratio, double T0, const TimingData& data) {
  const std::size_t last = data.size() - 1;
  const std::size_t from = last - std::max<std::size_t>(1, last / 4);
  const double rate = T0 / data.reference_period_s * (1.0 + mean_rate(data, from, last + 1)) - 1.0;
  const double lambda2 = 16.0 * (epsilon * std::sqrt(ratio * ratio - 1.0) - rate);
  return lambda2 > 0.0 ? std::sqrt(lambda2) : 0.0;
}

} // namespace

std::vector<std::vector<double>> starting_points(const Parameters& parameters,
                                                 const TimingData& data, const NoiseGuess& noise) {
  const double seen_first = known_amplitude(data, false);
  const double seen_last = known_amplitude(data, true);
  const bool driven = parameters.escapement != Escapement::none;
  const Slot& T0 = *parameters.find(Quantity::T0);
  const bool by_rate = !T0.free && driven && seen_last == 0.0;
  const std::vector<double> lambdas =
      seen_last > 0.0 ? std::vector{seen_last} : std::vector{0.025, 0.05, 0.1, 0.2};
  // A change speaks of itself; without one all is in the way from the start to rest.
  const bool changes = !parameters.event_cycles.empty();
  const std::vector<double> start_ratios = seen_first > 0.0 ? std::vector{seen_first / seen_last}
                                           : changes        ? std::vector{1.0, 0.6, 1.5}
                                                     : std::vector{1.0, 0.9, 0.75, 0.6, 1.15, 1.5};
  const std::vector<double> ratios = !driven   ? std::vector{1.0}
                                     : changes ? std::vector{1.15, 1.6, 4.0}
                                               : std::vector{1.1, 1.3, 1.8, 3.0, 6.0};
  const std::vector<double> epsilons = changes
                                           ? std::vector{1e-5, 5e-5, 2e-4, 8e-4, 3e-3}
                                           : std::vector{1e-5, 3e-5, 8e-5, 2e-4, 4e-4, 1e-3, 3e-3};
  std::vector<std::vector<double>> points;
  for (const double epsilon : epsilons)
    for (const double ratio : ratios) {
      std::vector<double> amplitudes = lambdas;
      const double by_mean =
          by_rate ? amplitude_from_rate(epsilon, ratio, T0.fixed_value, data) : 0.0;
      if (by_mean > 0.005 && by_mean < 0.6) amplitudes = {by_mean}; // what clocks swing
      for (const double lambda : amplitudes)
        for (const double start_ratio : start_ratios)
          points.push_back(
              coordinates({epsilon, lambda, ratio, start_ratio}, parameters, data, noise));
    }
  return points;
}

std::vector<double> carried_over(const Parameters& from, std::span<const double> x,
                                 const Parameters& to, std::span<const double> otherwise) {
  std::vector<double> result(otherwise.begin(), otherwise.end());
  for (const Slot& slot : to.slots) {
    if (!slot.free) continue;
    for (const Slot& other : from.slots)
      if (other.quantity == slot.quantity && other.event == slot.event && other.term == slot.term &&
          other.coordinate == slot.coordinate)
        result[slot.index] = slot.coordinate_of(other.value(x));
  }
  return result;
}

TimingData thinned(const TimingData& data, const Parameters& parameters, std::size_t count) {
  if (data.size() <= count) return data;
  std::set<std::size_t> chosen;
  const std::size_t last = data.size() - 1;
  const std::size_t even = count / (parameters.event_cycles.size() + 2);
  for (std::size_t k = 0; k <= even; ++k)
    chosen.insert(k * last / even);
  std::vector<std::size_t> starts{0};
  for (const double cycle : parameters.event_cycles)
    starts.push_back(first_beat_at(data, cycle));
  for (const std::size_t start : starts) // geometric spacing after each event
    for (double step = 1.0; start + static_cast<std::size_t>(step) < last && step < 1e7;
         step *= std::pow(static_cast<double>(last), 1.5 / static_cast<double>(even)))
      chosen.insert(start + static_cast<std::size_t>(step));
  const std::vector<std::size_t> indices(chosen.begin(), chosen.end());
  return subset(data, indices);
}

TimingData at_one_stride(const TimingData& data, std::size_t count) {
  std::vector<std::size_t> kept;
  const std::size_t stride = std::max<std::size_t>(1, data.size() / count);
  for (std::size_t i = 0; i < data.size(); i += stride)
    kept.push_back(i);
  return subset(data, kept);
}

} // namespace timing_model
} // namespace goingrate
