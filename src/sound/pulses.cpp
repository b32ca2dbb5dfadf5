#include "pulses.hpp"

#include "base/robust.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace goingrate {

namespace {

/// A line through pulses: place against second.
struct Line {
  double seconds = 0.0, place = 0.0, slope = 1.0; // means, and samples per second
};

Line line_through(std::span<const double> seconds, std::span<const double> places) {
  Line line;
  const auto count = static_cast<double>(seconds.size());
  for (std::size_t i = 0; i < seconds.size(); ++i)
    line.seconds += seconds[i] / count, line.place += places[i] / count;
  double products = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    products += (seconds[i] - line.seconds) * (places[i] - line.place);
    squares += (seconds[i] - line.seconds) * (seconds[i] - line.seconds);
  }
  line.slope = products / squares;
  return line;
}

/// The largest step from one sample to the next in each second, of one sign.
struct Steps {
  std::vector<std::int64_t> places; // of the sample after the step
  std::vector<double> sizes;
};

Steps largest_steps(const SoundSamples& samples, float sign) {
  Steps steps;
  const auto second = static_cast<std::int64_t>(samples.rate_hz);
  std::vector<float> x(static_cast<std::size_t>(second) + 1);
  for (std::int64_t first = 0; first < samples.count; first += second) {
    samples.read(first - 1, x);
    std::size_t best = 1;
    for (std::size_t i = 1; i < x.size(); ++i)
      if (sign * (x[i] - x[i - 1]) > sign * (x[best] - x[best - 1])) best = i;
    steps.places.push_back(first - 1 + static_cast<std::int64_t>(best));
    steps.sizes.push_back(static_cast<double>(sign * (x[best] - x[best - 1])));
  }
  return steps;
}

// The place at which the rise from the level before a step to the one after it is half complete.
double half_way(const SoundSamples& samples, std::int64_t step, float sign) {
  constexpr std::int64_t reach = 16; // samples: the edge of a pulse is sharper
  std::vector<float> x(2 * reach + 1);
  samples.read(step - reach, x);
  std::vector<double> before(x.begin(), x.begin() + reach - 4);
  const double base = median(before);
  double top = base;
  for (const float value : x)
    if (static_cast<double>(sign) * (static_cast<double>(value) - top) > 0.0)
      top = static_cast<double>(value);
  const double half = 0.5 * (base + top);
  for (std::size_t i = 1; i < x.size(); ++i) {
    const auto low = static_cast<double>(x[i - 1]), high = static_cast<double>(x[i]);
    if ((low - half) * static_cast<double>(sign) < 0.0 &&
        (high - half) * static_cast<double>(sign) >= 0.0)
      return static_cast<double>(step - reach) + static_cast<double>(i) - 1.0 +
             (half - low) / (high - low);
  }
  return static_cast<double>(step);
}

} // namespace

SecondPulses::SecondPulses(const SoundSamples& samples) : nominal_hz_(samples.rate_hz) {
  const Steps up = largest_steps(samples, 1.0F), down = largest_steps(samples, -1.0F);
  std::vector<double> up_sizes = up.sizes, down_sizes = down.sizes;
  if (up_sizes.empty()) return;
  const bool rises = median(up_sizes) >= median(down_sizes);
  const float sign = rises ? 1.0F : -1.0F;
  const Steps& steps = rises ? up : down;
  std::vector<double> sizes = steps.sizes;
  const double usual = median(sizes);
  std::vector<double> places;
  for (std::size_t i = 0; i < steps.places.size(); ++i) {
    const bool again = !places.empty() &&
                       static_cast<double>(steps.places[i]) - places.back() < 0.5 * samples.rate_hz;
    if (steps.sizes[i] > 0.5 * usual && !again)
      places.push_back(half_way(samples, steps.places[i], sign));
  }
  if (!places.empty()) count_from(places, 0);
  // A false first pulse leaves all others out.
  if (places.size() > 2 && 2 * places_.size() < places.size()) count_from(places, 1);
}

void SecondPulses::count_from(const std::vector<double>& places, std::size_t first) {
  constexpr double largest_error = 1e-3; // of a sampling rate: 86 s a day
  places_.assign(1, places[first]);
  seconds_.assign(1, 0.0);
  for (std::size_t i = first + 1; i < places.size(); ++i) {
    const double since = (places[i] - places_.back()) / nominal_hz_;
    const double whole = std::round(since);
    if (whole < 1.0 || std::abs(since / whole - 1.0) > largest_error) continue;
    seconds_.push_back(seconds_.back() + whole);
    places_.push_back(places[i]);
  }
}

double SecondPulses::time_at(double place) const {
  constexpr std::size_t line_pulses = 8;
  const auto after = static_cast<std::size_t>(
      std::lower_bound(places_.begin(), places_.end(), place) - places_.begin());
  const std::size_t count = std::min(line_pulses, places_.size());
  const std::size_t first =
      std::min(after < line_pulses / 2 ? 0 : after - line_pulses / 2, places_.size() - count);
  const Line line = line_through(std::span(seconds_).subspan(first, count),
                                 std::span(places_).subspan(first, count));
  return line.seconds + (place - line.place) / line.slope;
}

double SecondPulses::rate_hz() const { return line_through(seconds_, places_).slope; }

bool SecondPulses::covers(double place) const {
  constexpr double reach_s = 2.0;
  const auto after = std::lower_bound(places_.begin(), places_.end(), place);
  const double reach = reach_s * nominal_hz_;
  const bool later = after != places_.end() && *after - place < reach;
  const bool earlier = after != places_.begin() && place - *(after - 1) < reach;
  return later || earlier;
}

// The scatter of one pulse about the line through its neighbours, in samples, from second
// differences, which a drift of the sampling rate does not affect.
double SecondPulses::scatter() const {
  std::vector<double> squares;
  for (std::size_t i = 1; i + 1 < places_.size(); ++i)
    if (seconds_[i + 1] - seconds_[i - 1] == 2.0)
      squares.push_back(std::pow(places_[i + 1] - 2.0 * places_[i] + places_[i - 1], 2) / 6.0);
  return squares.empty() ? 1.0 : std::sqrt(trimmed_mean(squares));
}

// The end of a line through eight points is known to 0.65 of the scatter of one, its middle to
// 0.35.
double SecondPulses::rate_sigma() const {
  constexpr double end_factor = 0.65;
  return std::sqrt(2.0) * end_factor * scatter() / (places_.back() - places_.front());
}

double SecondPulses::time_sigma_s() const {
  constexpr double middle_factor = 0.35;
  return middle_factor * scatter() / nominal_hz_;
}

} // namespace goingrate
