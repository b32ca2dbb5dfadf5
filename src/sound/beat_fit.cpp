#include "beat_fit.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {

BeatPlace BeatFit::operator()(const BeatSnippet& snippet) {
  double strength = strength_at(snippet, grid_.reach);
  std::ptrdiff_t best = grid_.reach;
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round) {
    take_logs(snippet, strength);
    predict(strength);
    best = best_shift();
    const double now = strength_at(snippet, best);
    constexpr double settled_change = 0.05; // relative: the logarithms hardly change
    if (std::abs(now - strength) < settled_change * strength) break;
    strength = now;
  }
  return placed(best, strength);
}

double BeatFit::strength_at(const BeatSnippet& snippet, std::ptrdiff_t shift) const {
  double sum = 0.0, weight = 0.0;
  for (std::size_t k = 0; k < grid_.size; ++k) {
    const double power = static_cast<double>(snippet.powers[k + static_cast<std::size_t>(shift)]) /
                         snippet.background;
    sum += kind_.shape[k] * (power - 1.0);
    weight += kind_.shape[k] * kind_.shape[k];
  }
  return std::max(sum / weight, 1e-3);
}

void BeatFit::take_logs(const BeatSnippet& snippet, double strength) {
  logs_.resize(snippet.powers.size());
  for (std::size_t i = 0; i < logs_.size(); ++i)
    logs_[i] = std::log(snippet.powers[i] / static_cast<float>(snippet.background) +
                        static_cast<float>(foot_share * strength));
}

void BeatFit::predict(double strength) {
  expected_.resize(grid_.size);
  weights_.resize(grid_.size);
  noise_.resize(grid_.size);
  own_.resize(grid_.size);
  for (std::size_t k = 0; k < grid_.size; ++k) {
    const double sound = strength * kind_.shape[k];
    const double all = 1.0 + sound + foot_share * strength;
    const double noise = grid_.log_variance(sound, foot_share * strength);
    expected_[k] = std::log(all) - 0.5 * noise; // the mean of a logarithm
    noise_[k] = std::sqrt(noise);
    own_[k] = std::sqrt(kind_.variance[k]) * sound / all;
    weights_[k] = 1.0 / (noise + own_[k] * own_[k]);
  }
}

double BeatFit::misfit(std::ptrdiff_t shift) const {
  double sum = 0.0;
  const float* logs = logs_.data() + shift;
  for (std::size_t k = 0; k < grid_.size; ++k)
    sum += weights_[k] * std::pow(static_cast<double>(logs[k]) - expected_[k], 2);
  return sum;
}

std::ptrdiff_t BeatFit::best_shift() {
  const auto shifts = static_cast<std::size_t>(2 * grid_.reach + 1);
  misfits_.assign(shifts, 0.0F);
  // Shift by shift inside: that is what compilers vectorise.
  for (std::size_t k = 0; k < grid_.size; ++k) {
    const auto weight = static_cast<float>(weights_[k]),
               expected = static_cast<float>(expected_[k]);
    const float* logs = logs_.data() + k;
    for (std::size_t shift = 0; shift < shifts; ++shift)
      misfits_[shift] += weight * (logs[shift] - expected) * (logs[shift] - expected);
  }
  constexpr double widths = 4.0; // standard deviations of a rough place in `reach`
  for (std::size_t shift = 0; shift < shifts; ++shift) {
    const double off =
        widths * (static_cast<double>(shift) / static_cast<double>(grid_.reach) - 1.0);
    misfits_[shift] += static_cast<float>(off * off);
  }
  return std::min_element(misfits_.begin(), misfits_.end()) - misfits_.begin();
}

BeatPlace BeatFit::placed(std::ptrdiff_t best, double strength) const {
  BeatPlace place;
  place.strength = strength;
  place.inside = best > 0 && best < 2 * grid_.reach;
  if (!place.inside) return place;
  const double before = misfit(best - 1), here = misfit(best), after = misfit(best + 1);
  const double bend = before - 2.0 * here + after;
  place.bin = static_cast<double>(best + static_cast<std::ptrdiff_t>(grid_.lead)) +
              (bend > 0.0 ? 0.5 * (before - after) / bend : 0.0);
  const double excess = std::max(1.0, here / static_cast<double>(grid_.size));
  constexpr double finest_bins = 0.03; // bins: what the parabola and the mean shape are right to
  place.sigma = std::hypot(std::sqrt(excess) * sigma(), finest_bins, spread(best));
  place.quality = log_likelihood(best, strength);
  return place;
}

double BeatFit::log_likelihood(std::ptrdiff_t best, double strength) const {
  const double silence = 1.0 + foot_share * strength;
  const double noise = grid_.log_variance(0.0, foot_share * strength);
  double sum = 0.0;
  for (std::size_t i = 0; i < logs_.size(); ++i) {
    const auto log = static_cast<double>(logs_[i]);
    const std::ptrdiff_t k = static_cast<std::ptrdiff_t>(i) - best;
    const bool inside = k >= 0 && k < static_cast<std::ptrdiff_t>(grid_.size);
    const double weight = inside ? weights_[static_cast<std::size_t>(k)] : 1.0 / noise;
    const double expected =
        inside ? expected_[static_cast<std::size_t>(k)] : std::log(silence) - 0.5 * noise;
    // The last term makes a density of the logarithm one of the power.
    sum += 0.5 * (std::log(weight) - weight * (log - expected) * (log - expected)) - log;
  }
  return sum;
}

double BeatFit::spread(std::ptrdiff_t best) const {
  const double alike = std::max(1.0, grid_.alike());
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < misfits_.size(); ++i) {
    const double off = static_cast<double>(i) - static_cast<double>(best);
    const auto worse = static_cast<double>(misfits_[i] - misfits_[static_cast<std::size_t>(best)]);
    const double likely = std::exp(-0.5 / alike * worse);
    constexpr double reach_bins = 2.0; // bins: what the parabola has
    sum += likely;
    if (std::abs(off) > reach_bins) squares += likely * off * off;
  }
  return std::sqrt(squares / sum);
}

double BeatFit::sigma() const {
  std::vector<double> by_noise(grid_.size, 0.0), by_own(grid_.size, 0.0);
  double information = 0.0;
  for (std::size_t k = 1; k + 1 < grid_.size; ++k) {
    const double slope = 0.5 * (expected_[k + 1] - expected_[k - 1]);
    by_noise[k] = weights_[k] * slope * noise_[k];
    by_own[k] = weights_[k] * slope * own_[k];
    information += weights_[k] * slope * slope;
  }
  const double variance =
      correlated(by_noise, grid_.correlation) + correlated(by_own, kind_.correlation);
  return std::sqrt(std::max(variance, 0.0)) / information;
}

double BeatFit::correlated(std::span<const double> terms, std::span<const double> correlation) {
  double sum = 0.0;
  for (std::size_t lag = 0; lag < correlation.size(); ++lag) {
    double products = 0.0;
    for (std::size_t k = lag; k < terms.size(); ++k)
      products += terms[k] * terms[k - lag];
    sum += (lag == 0 ? 1.0 : 2.0) * correlation[lag] * products;
  }
  return sum;
}

} // namespace goingrate
