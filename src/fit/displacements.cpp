#include "displacements.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace goingrate {

namespace timing_model {

namespace {

// A jump of the times before a beat, in seconds; `scaled` is smaller if missing beats raise its
// scatter, so that places with and without missing beats can be compared.
struct Jump {
  double size = 0.0, scaled = 0.0;
};

double mean_of(const std::vector<double>& values, std::size_t from, std::size_t count) {
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(from);
  return std::accumulate(first, first + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

// The jump at beat `at`, from means of `reach` beats: the mean just after it minus the mean just
// before, less the advance that the rate explains. The rate is taken from two further means on
// either side. Over missing beats it is extrapolated further, which adds scatter.
Jump jump_at(const TimingData& data, std::size_t at, std::size_t reach) {
  std::array<double, 4> late{}, cycle{};
  for (std::size_t k = 0; k < 4; ++k) {
    late[k] = mean_of(data.lateness_s, at + k * reach - 2 * reach, reach);
    cycle[k] = mean_of(data.cycle, at + k * reach - 2 * reach, reach);
  }
  const double across = cycle[2] - cycle[1];
  // The rate before and the rate after each account for half of the distance.
  const double a = 0.5 * across / (cycle[3] - cycle[2]);
  const double b = 0.5 * across / (cycle[1] - cycle[0]);
  const double size = late[2] - late[1] - a * (late[3] - late[2]) - b * (late[1] - late[0]);
  // Variances from jitter and from a random walk of the times, relative to a place without missing
  // beats, where a = b = 1/2.
  const double jitter = (std::pow(1.0 + a, 2) + a * a + std::pow(1.0 + b, 2) + b * b) / 5.0;
  const double walk = across / static_cast<double>(reach);
  return {size, size / std::sqrt(std::max(jitter, walk))};
}

// Residual sum of squares of the times around beat `at`: about two parallel lines with a jump at
// the beat, or, if `corner` is given, about a line with a corner there.
double squares_left(const TimingData& data, std::size_t at, std::size_t reach,
                    std::optional<std::size_t> corner) {
  const auto n = static_cast<Eigen::Index>(4 * reach);
  Eigen::MatrixXd design(n, 3);
  Eigen::VectorXd late(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t beat = at - 2 * reach + static_cast<std::size_t>(i);
    const double t = data.elapsed_s[beat] - data.elapsed_s[at];
    const double after =
        corner ? std::max(0.0, data.elapsed_s[beat] - data.elapsed_s[*corner]) : beat >= at;
    design.row(i) << 1.0, t, after;
    late[i] = data.lateness_s[beat] - data.lateness_s[at];
  }
  return (late - design * design.colPivHouseholderQr().solve(late)).squaredNorm();
}

// A displacement happens between two neighbouring beats. A slow walk of the times, or a change of
// rate nearby, does not count as one.
bool is_sudden(const TimingData& data, std::size_t at, std::size_t reach, double jump,
               double at_once) {
  const std::size_t seen = std::max<std::size_t>(reach, 8);
  if (at < 2 * seen || at + 2 * seen > data.size() || !(at_once / jump > 0.5)) return false;
  const double of_jump = squares_left(data, at, seen, std::nullopt);
  for (std::size_t corner = at - 2 * seen + 2; corner + 2 < at + 2 * seen; corner += 2)
    if (squares_left(data, at, seen, corner) <= of_jump) return false;
  return true;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The scatter of jumps, of all and of those of each eighth of the log: the times of a swing that
// dies away scatter the more the smaller it is.
class Scatter {
public:
  explicit Scatter(const std::vector<double>& sizes)
      : all_(of(sizes)), length_(std::max<std::size_t>(1, (sizes.size() + parts - 1) / parts)) {
    for (std::size_t begin = 0; begin < sizes.size(); begin += length_) {
      const auto first = sizes.begin() + static_cast<std::ptrdiff_t>(begin);
      const auto count = std::min(length_, sizes.size() - begin);
      of_part_.push_back(of({first, first + static_cast<std::ptrdiff_t>(count)}));
    }
  }
  [[nodiscard]] double all() const { return all_; }
  [[nodiscard]] double at(std::size_t i) const { return std::max(all_, of_part_[i / length_]); }

private:
  static constexpr std::size_t parts = 8;
  static double of(std::vector<double> sizes) {
    constexpr double sigma_per_median = 1.4826; // of the absolute values of a normal variable
    return sigma_per_median * median_of(std::move(sizes));
  }
  double all_;
  std::size_t length_;
  std::vector<double> of_part_;
};

// The largest displacement, judged by means over `reach` beats.
std::optional<Displacement> greatest(const TimingData& data, std::size_t reach, double price) {
  constexpr double least_gain = 6.0; // of 2 log L beyond the price: odds of 20 to 1
  if (data.size() < 16 * reach) return {};
  const std::size_t first = 2 * reach; // the first beat with two means before it
  std::vector<double> size;            // scaled, from that beat on
  size.reserve(data.size() - 4 * reach + 1);
  for (std::size_t at = first; at + 2 * reach <= data.size(); ++at)
    size.push_back(std::abs(jump_at(data, at, reach).scaled));
  const Scatter scatter(size);
  const double least = std::sqrt(price + least_gain);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < size.size(); ++i)
    if (size[i] > least * scatter.at(i)) places.push_back(i);
  constexpr std::size_t most_tried = 200; // with more jumps the log is noisy, not displaced
  if (!(scatter.all() > 0.0) || places.size() > most_tried) return {};
  std::sort(places.begin(), places.end(),
            [&](std::size_t a, std::size_t b) { return size[a] > size[b]; });
  for (const std::size_t place : places) {
    const std::size_t at = first + place;
    const double jump = jump_at(data, at, reach).size;
    if (is_sudden(data, at, reach, jump, jump_at(data, at, 1).size))
      return Displacement{at, jump, std::pow(size[place] / scatter.at(place), 2) - price};
  }
  return {};
}

} // namespace

std::optional<Displacement> greatest_displacement(const TimingData& data) {
  constexpr std::array<std::size_t, 3> reaches{1, 4, 16};
  // The price of looking at every beat with every reach.
  const double price = 2.0 * std::log(static_cast<double>(reaches.size() * data.size()));
  std::optional<Displacement> best;
  for (const std::size_t reach : reaches)
    if (const auto found = greatest(data, reach, price);
        found && (!best || found->gain > best->gain))
      best = found;
  return best;
}

void take_off(const Displacement& displacement, TimingData& data) {
  for (std::size_t i = displacement.beat; i < data.size(); ++i)
    data.lateness_s[i] -= displacement.late_s;
  data.displaced.push_back(displacement);
}

} // namespace timing_model

// Real noise has longer tails than a normal distribution, and displacements of all sizes down to
// that noise are a part of it. Those that are subtracted must be twice as large as all others.
void level_displacements(TimingData& data) {
  constexpr std::size_t most = 8;
  constexpr double least_gain = 100.0, most_gain_of_others = least_gain / 4.0;
  auto next = timing_model::greatest_displacement(data);
  if (!next || next->gain < least_gain) return;
  TimingData level = data;
  for (; next && next->gain >= least_gain; next = timing_model::greatest_displacement(level)) {
    if (level.displaced.size() == most) return;
    timing_model::take_off(*next, level);
  }
  if (!next || next->gain < most_gain_of_others) data = std::move(level);
}

} // namespace goingrate
