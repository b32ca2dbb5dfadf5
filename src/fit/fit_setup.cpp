#include "fit_setup.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
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

constexpr double untouchable_angle = 1e-9; // switching angle of a pendulum without an escapement
constexpr double typical_torque = 1e-5;    // scale of a changed torque where the first is zero

std::string_view base_name(Quantity quantity) {
  switch (quantity) {
  case Quantity::T0:
    return "T0";
  case Quantity::epsilon:
    return "epsilon";
  case Quantity::mu:
    return "mu";
  case Quantity::phi0:
    return "phi0";
  case Quantity::lambda0:
    break;
  }
  return "lambda0";
}

Quantity changing_quantity(const std::string& name) {
  if (name == "mu") return Quantity::mu;
  if (name == "epsilon") return Quantity::epsilon;
  if (name == "phi0") return Quantity::phi0;
  throw ArgumentError("event", name, "a change of mu, epsilon or phi0");
}

void check_fixed(const std::string& name, Quantity quantity, double value) {
  const bool zero_allowed = quantity == Quantity::mu;
  if (!(value > 0.0 || (zero_allowed && value == 0.0)) || !std::isfinite(value))
    throw ArgumentError(name, value, zero_allowed ? "not below 0" : "above 0");
}

} // namespace

std::string name_of(const Slot& slot) {
  const auto base = base_name(slot.quantity);
  return slot.event == 0 ? std::string(base) : fmt::format("{}@{}", base, slot.event);
}

Parameters make_parameters(const FitOptions& options, const TimingData& data, bool driven) {
  Parameters parameters;
  std::set<std::string> known;
  const auto add = [&](Quantity quantity, std::size_t event, Coordinate coordinate, double scale) {
    Slot slot{quantity, event, coordinate, scale, true, 0.0, 0};
    const std::string name = name_of(slot);
    known.insert(name);
    const bool escapement = quantity == Quantity::mu || quantity == Quantity::phi0;
    if (const auto fixed = options.fixed.find(name); fixed != options.fixed.end()) {
      check_fixed(name, quantity, fixed->second);
      slot.free = false;
      slot.fixed_value = fixed->second;
    } else if (!driven && escapement) {
      slot.free = false;
      slot.fixed_value = quantity == Quantity::mu ? 0.0 : untouchable_angle;
    }
    if (slot.free) slot.index = parameters.free_count++;
    parameters.slots.push_back(slot);
  };
  add(Quantity::T0, 0, Coordinate::stretch, data.reference_period_s);
  add(Quantity::epsilon, 0, Coordinate::logarithm, 1.0);
  add(Quantity::mu, 0, Coordinate::logarithm, 1.0);
  add(Quantity::phi0, 0, Coordinate::logarithm, 1.0);
  add(Quantity::lambda0, 0, Coordinate::logarithm, 1.0);
  double last = 0.0;
  for (const FitEvent& event : options.events) {
    const auto cycle = static_cast<double>(event.cycle);
    if (cycle <= last || cycle >= data.cycle.back())
      throw ArgumentError("event", cycle, "inside the log, after the event before it");
    parameters.event_cycles.push_back(last = cycle);
    for (const std::string& name : event.names) {
      if (std::count(event.names.begin(), event.names.end(), name) > 1)
        throw ArgumentError("event", name, "named once at each event");
      const Quantity quantity = changing_quantity(name);
      const bool torque = quantity == Quantity::mu;
      add(quantity, parameters.event_cycles.size(),
          torque ? Coordinate::multiple : Coordinate::logarithm, torque ? typical_torque : 1.0);
    }
  }
  for (const auto& [name, value] : options.fixed)
    if (!known.contains(name))
      throw ArgumentError("fix", name, fmt::format("{}", fmt::join(known, ", ")));
  for (const Prior& prior : options.priors) {
    if (!known.contains(prior.name))
      throw ArgumentError("prior", prior.name, fmt::format("{}", fmt::join(known, ", ")));
    if (options.fixed.contains(prior.name))
      throw ArgumentError("prior", prior.name, "a parameter that is not fixed");
    const bool zero_allowed = prior.name.starts_with("mu@");
    if (!(prior.sigma > 0.0) || !(prior.value > 0.0 || (zero_allowed && prior.value == 0.0)))
      throw ArgumentError("prior", prior.name, "VALUE+-SIGMA, both above 0");
  }
  if (parameters.free_count > most_parameters)
    throw ArgumentError("parameters", static_cast<double>(parameters.free_count),
                        fmt::format("at most {} free ones", most_parameters));
  return parameters;
}

std::vector<CoordinatePrior> make_priors(const FitOptions& options, const Parameters& parameters,
                                         std::span<const double> start) {
  std::vector<CoordinatePrior> priors;
  for (const Slot& slot : parameters.slots) {
    if (!slot.free) continue;
    const double centre = start[slot.index];
    switch (slot.coordinate) {
    case Coordinate::logarithm:
      priors.push_back({slot.index, centre, 5.0});
      break;
    case Coordinate::stretch:
      priors.push_back({slot.index, 0.0, 0.01});
      break;
    case Coordinate::multiple:
      priors.push_back({slot.index, centre, 5.0 * std::max(1.0, std::abs(centre))});
      break;
    }
    for (const Prior& stated : options.priors) {
      if (stated.name != name_of(slot)) continue;
      const double x = slot.coordinate_of(stated.value);
      const double relative = slot.coordinate == Coordinate::logarithm ? stated.value : slot.scale;
      priors.push_back({slot.index, x, stated.sigma / relative});
    }
  }
  return priors;
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

std::vector<double> coordinates(const Guess& guess, const Parameters& parameters,
                                const TimingData& data) {
  std::vector<double> x(parameters.free_count, 0.0);
  double epsilon = guess.epsilon;
  double phi0 = guess.lambda / guess.ratio;
  for (const Slot& slot : parameters.slots) { // what is fixed shapes the guess of the rest
    if (slot.free || slot.event != 0) continue;
    if (slot.quantity == Quantity::epsilon) epsilon = slot.fixed_value;
    if (slot.quantity == Quantity::phi0) phi0 = slot.fixed_value;
  }
  double mu = std::numbers::pi * epsilon * guess.lambda * guess.lambda / (2.0 * phi0);
  const double fast_gain = 2.0 / (std::numbers::pi * guess.lambda) *
                           std::sqrt(std::max(0.05, 1.0 - std::pow(phi0 / guess.lambda, 2)));
  for (const Slot& slot : parameters.slots) {
    double value = 0.0;
    switch (slot.quantity) {
    case Quantity::T0:
      value = data.reference_period_s;
      break;
    case Quantity::epsilon:
      value = epsilon;
      break;
    case Quantity::phi0:
      value = phi0;
      break;
    case Quantity::lambda0:
      value = guess.lambda * guess.start_ratio;
      break;
    case Quantity::mu:
      if (slot.event > 0)
        mu = std::max(0.02 * mu, mu + rate_jump(data, parameters, slot.event) / fast_gain);
      if (!slot.free) mu = slot.fixed_value;
      value = mu;
      break;
    }
    if (slot.free) x[slot.index] = slot.coordinate_of(value);
  }
  return x;
}

} // namespace

std::vector<std::vector<double>> starting_points(const Parameters& parameters,
                                                 const TimingData& data) {
  const double seen_first = known_amplitude(data, false);
  const double seen_last = known_amplitude(data, true);
  const std::vector<double> lambdas =
      seen_last > 0.0 ? std::vector{seen_last} : std::vector{0.025, 0.05, 0.1, 0.2};
  const std::vector<double> start_ratios =
      seen_first > 0.0 ? std::vector{seen_first / seen_last} : std::vector{1.0, 0.6, 1.5};
  std::vector<std::vector<double>> points;
  for (const double epsilon : {1e-5, 5e-5, 2e-4, 8e-4, 3e-3})
    for (const double lambda : lambdas)
      for (const double ratio : {1.15, 1.6, 4.0})
        for (const double start_ratio : start_ratios)
          points.push_back(coordinates({epsilon, lambda, ratio, start_ratio}, parameters, data));
  return points;
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

} // namespace timing_model
} // namespace goingrate
