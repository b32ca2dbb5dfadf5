// Estimates starting values of a search from the data alone.
#include "amplitude_clock.hpp"
#include "fit_setup.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace goingrate::timing_model {

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
  constexpr std::size_t reach =
      50; // beats: short compared with the relaxation, long enough to average the jitter
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

// The growth of lambda^2 from just after an event to the end of its stretch, on the assumption that
// only the circular error changes the rate: a single impulse hardly shifts the phase.
double growth_by_rate(const TimingData& data, const Parameters& parameters, std::size_t event) {
  constexpr std::size_t first = 50; // beats: short compared with the relaxation
  const std::size_t begin = first_beat_at(data, parameters.event_cycles.front());
  const std::size_t from = first_beat_at(data, parameters.event_cycles[event - 1]);
  const std::size_t to = event < parameters.event_cycles.size()
                             ? first_beat_at(data, parameters.event_cycles[event])
                             : data.size() - 1;
  const double before = mean_rate(data, 0, std::min(first, begin) + 1);
  return -16.0 * (mean_rate(data, to - std::max<std::size_t>(1, (to - from) / 8), to + 1) - before);
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

// The guess as coordinates. Fixed parameters enter the guess of the others.
std::vector<double> coordinates(const Guess& guess, const Parameters& parameters,
                                const TimingData& data, const NoiseGuess& noise) {
  using std::numbers::pi;
  std::vector<double> x(parameters.free_count, 0.0);
  const bool impulse = parameters.escapement == Escapement::single_impulse;
  double epsilon = guess.epsilon;
  double phi0 = guess.lambda / guess.ratio;
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
      if (slot.event > 0 && impulse)
        mu = 2.0 * pi * epsilon *
             std::max(0.02 * lambda2, lambda2 + growth_by_rate(data, parameters, slot.event));
      if (!slot.free) mu = slot.fixed_value;
      value = mu;
    }
    if (slot.free) x[slot.index] = slot.coordinate_of(value);
  }
  return x;
}

// Where T0 is known, the mean rate of the last part of the log gives the stationary amplitude,
// lambda^2 = 16 (eps sqrt(q^2 - 1) - rate), q = lambda/phi0 (eq. statrate). A single impulse leaves
// the circular error, -lambda^2/16; then the first part is used, which gives the start.
double amplitude_from_rate(double epsilon, double ratio, double T0, const TimingData& data,
                           bool impulse) {
  const std::size_t last = data.size() - 1;
  const std::size_t from = impulse ? 0 : last - std::max<std::size_t>(1, last / 4);
  const std::size_t to =
      impulse ? std::max<std::size_t>(1, std::min<std::size_t>(last / 4, 50)) : last;
  const double rate = T0 / data.reference_period_s * (1.0 + mean_rate(data, from, to + 1)) - 1.0;
  const double push = impulse ? 0.0 : epsilon * std::sqrt(ratio * ratio - 1.0);
  const double lambda2 = 16.0 * (push - rate);
  return lambda2 > 0.0 ? std::sqrt(lambda2) : 0.0;
}

} // namespace

std::vector<std::vector<double>> starting_points(const Parameters& parameters,
                                                 const TimingData& data, const NoiseGuess& noise) {
  const double seen_first = known_amplitude(data, false);
  const double seen_last = known_amplitude(data, true);
  const bool driven = parameters.escapement != Escapement::none;
  const bool impulse = parameters.escapement == Escapement::single_impulse;
  const Slot& T0 = *parameters.find(Quantity::T0);
  const bool by_rate = !T0.free && driven && seen_last == 0.0;
  const std::vector<double> lambdas =
      seen_last > 0.0 ? std::vector{seen_last} : std::vector{0.025, 0.05, 0.1, 0.2};
  // With a change in the log, ε and μ show in the response to it. Without one they show only in how
  // the amplitude goes from its start to its stationary value, so more start values are tried.
  const bool changes = !parameters.event_cycles.empty();
  const std::vector<double> start_ratios = seen_first > 0.0 ? std::vector{seen_first / seen_last}
                                           : changes        ? std::vector{1.0, 0.6, 1.5}
                                                     : std::vector{1.0, 0.9, 0.75, 0.6, 1.15, 1.5};
  const std::vector<double> ratios = !driven   ? std::vector{1.0}
                                     : impulse ? std::vector{2.0, 4.0, 10.0}
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
          by_rate ? amplitude_from_rate(epsilon, ratio, T0.fixed_value, data, impulse) : 0.0;
      if (by_mean > 0.005 && by_mean < 0.6)
        amplitudes = {by_mean}; // the range of amplitudes of clocks
      for (const double lambda : amplitudes)
        for (const double start_ratio : start_ratios)
          points.push_back(
              coordinates({epsilon, lambda, ratio, start_ratio}, parameters, data, noise));
    }
  return points;
}

std::optional<std::vector<double>>
start_by_amplitudes(const Parameters& parameters, const TimingData& data, const NoiseGuess& noise) {
  const auto clock = amplitude_clock(data, parameters);
  if (!clock) return {};
  const double lambda = std::sqrt(clock->amplitude2);
  auto start =
      coordinates({clock->epsilon, lambda, lambda / clock->phi0, 1.0}, parameters, data, noise);
  const Slot& T0 = *parameters.find(Quantity::T0);
  if (T0.free) start[T0.index] = T0.coordinate_of(clock->T0);
  return start;
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

} // namespace goingrate::timing_model
