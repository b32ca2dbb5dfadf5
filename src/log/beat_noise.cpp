#include "beat_noise.hpp"

#include "base/time_grain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace goingrate {

namespace {

constexpr std::size_t most_per_octave = 4000; // a variance good to 2 %

// The good beat of `cycle` in `run`, or null. In a log without faults it is `hint` places on.
const Beat* find_cycle(std::span<const Beat> run, std::int64_t cycle, std::size_t hint) {
  const auto is_it = [&](const Beat& b) { return b.cycle == cycle && b.flag == BeatFlag::good; };
  if (hint < run.size() && is_it(run[hint])) return &run[hint];
  auto it = std::lower_bound(run.begin(), run.end(), cycle,
                             [](const Beat& beat, std::int64_t c) { return beat.cycle < c; });
  for (; it != run.end() && it->cycle == cycle; ++it)
    if (is_it(*it)) return &*it;
  return nullptr;
}

std::array<double, 3> shares_at(double lag) {
  return {6.0, 2.0 * lag, (2.0 * lag * lag * lag + lag) / 3.0};
}

} // namespace

double trimmed_mean_square(std::span<double> values) {
  // The mean square of a standard normal deviate within +-1.96, 95 % of it: 1 - 2 z phi(z) / 0.95.
  constexpr double kept_share = 0.95, kept_mean_square = 0.75881;
  const auto count =
      static_cast<std::size_t>(std::ceil(kept_share * static_cast<double>(values.size())));
  const auto edge = values.begin() + static_cast<std::ptrdiff_t>(count);
  if (edge != values.end())
    std::nth_element(values.begin(), edge, values.end(),
                     [](double a, double b) { return std::abs(a) < std::abs(b); });
  double sum = 0.0;
  std::for_each(values.begin(), edge, [&](double value) { sum += value * value; });
  return sum / (static_cast<double>(count) * kept_mean_square);
}

BeatNoise rough_noise(const TypicalPeriod& typical) {
  // As if all of it were jitter, half of it a walk as well, and a little a walk of the rate: rather
  // too much than too little of each.
  const double v = typical.second_s2;
  return at_least_finest({v / 6.0, v / 4.0, v / 100.0}, typical);
}

BeatNoise at_least_finest(BeatNoise noise, const TypicalPeriod& typical) {
  const double finest = std::max(1e-9 * typical.mean_s, rounding_sigma(typical.grain_s));
  noise.jitter2 = std::max(noise.jitter2, finest * finest);
  return noise;
}

void SecondDifferences::add(std::span<const Beat> run) {
  if (run.size() < 3) return;
  const double cycles = static_cast<double>(run.back().cycle - run.front().cycle);
  std::size_t octave = 0;
  for (std::int64_t lag = 1; 2.0 * static_cast<double>(lag) <= cycles; lag *= 2, ++octave) {
    if (octave == octaves_.size()) octaves_.emplace_back();
    auto& [differences, independent] = octaves_[octave];
    const std::size_t stride = std::max<std::size_t>(1, run.size() / most_per_octave);
    const std::size_t had = differences.size();
    for (std::size_t i = 0; i < run.size(); i += stride) {
      const Beat& a = run[i];
      if (a.flag != BeatFlag::good) continue;
      const auto step = static_cast<std::size_t>(lag);
      const Beat* c = find_cycle(run, a.cycle + 2 * lag, i + 2 * step);
      if (c == nullptr) continue;
      const Beat* b = find_cycle(run, a.cycle + lag, i + step);
      if (b != nullptr) differences.push_back((c->time - b->time) - (b->time - a.time));
    }
    independent += std::min(static_cast<double>(differences.size() - had),
                            cycles / (2.0 * static_cast<double>(lag)));
  }
}

std::vector<SecondDifferences::Row> SecondDifferences::rows() const {
  std::vector<Row> rows;
  double lag = 1.0;
  for (const Octave& octave : octaves_) {
    auto values = octave.differences;
    if (values.size() >= 2 && octave.independent >= 1.0)
      rows.push_back({shares_at(lag), trimmed_mean_square(values), octave.independent});
    lag *= 2.0;
  }
  return rows;
}

SecondDifferences::Fit SecondDifferences::maximise_likelihood() const {
  const auto rows = this->rows();
  Fit fit{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  double unit = 0.0;
  for (const Row& row : rows)
    unit = std::max(unit, row.variance / row.shares[0]);
  if (!(unit > 0.0)) return fit;
  auto& v = fit.variances;
  // Each kind starts at the size with which it would explain everything alone; the updates raise
  // the likelihood, the sum of -f/2 (log M + V/M), and keep every variance positive
  // (majorise-minimise).
  for (std::size_t k = 0; k < 3; ++k) {
    double least = std::numeric_limits<double>::infinity();
    for (const Row& row : rows)
      least = std::min(least, row.variance / row.shares[k]);
    v[k] = std::max(least, 1e-30 * unit);
  }
  const auto model = [&](const Row& row) {
    return v[0] * row.shares[0] + v[1] * row.shares[1] + v[2] * row.shares[2];
  };
  constexpr int rounds = 400; // more moved no estimate of the tests by a tenth of its error
  for (int round = 0; round < rounds; ++round) {
    std::array<double, 3> seen{}, expected{};
    for (const Row& row : rows) {
      const double m = model(row);
      for (std::size_t k = 0; k < 3; ++k) {
        seen[k] += row.freedom * row.shares[k] * row.variance / (m * m);
        expected[k] += row.freedom * row.shares[k] / m;
      }
    }
    for (std::size_t k = 0; k < 3; ++k)
      v[k] *= std::sqrt(seen[k] / expected[k]);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    double information = 0.0;
    for (const Row& row : rows)
      information += 0.5 * row.freedom * std::pow(row.shares[k] / model(row), 2);
    fit.errors[k] = 1.0 / std::sqrt(information);
  }
  return fit;
}

BeatNoise SecondDifferences::fit() const {
  const auto v = maximise_likelihood().variances;
  return {v[0], v[1], v[2]};
}

BeatNoise SecondDifferences::cautious_fit() const {
  const auto [v, errors] = maximise_likelihood();
  return {v[0] + errors[0], v[1] + errors[1], v[2] + errors[2]};
}

} // namespace goingrate
