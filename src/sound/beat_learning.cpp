#include "beat_learning.hpp"

#include "base/robust.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace goingrate {

namespace {

// A value between two.
double between(std::span<const float> values, double place) {
  const auto i = static_cast<std::size_t>(place);
  const auto part = static_cast<float>(place - static_cast<double>(i));
  return static_cast<double>((1.0F - part) * values[i] + part * values[i + 1]);
}

constexpr std::size_t longest_correlation = 32; // bins: 2 ms, several periods of a click's tone

/// Learns one kind of beat from many.
class BeatLearning {
public:
  BeatLearning(const BeatGrid& grid, std::vector<BeatSnippet> snippets)
      : grid_(grid), snippets_(std::move(snippets)) {}

  // Begins once from the mean of all beats, which is blurred by misplaced loud ones, and once from
  // a single beat, which is noisy if beats are faint; returns the result that predicts beats
  // better.
  BeatKind run() {
    const std::vector<double> none(grid_.size, 0.0);
    best_ = {none, none, {1.0}, 0.0, 0.0};
    if (snippets_.empty()) return best_;
    place_as_expected();
    learn();
    settle();
    place_as_expected();
    learn_from_one();
    settle();
    if (best_places_.empty()) return best_; // no beat is near its expected place
    kind_ = best_;
    places_ = best_places_;
    learn_correlation();
    begin_at_onset();
    return std::move(kind_);
  }

private:
  void place_as_expected() {
    places_.clear();
    for (const BeatSnippet& snippet : snippets_)
      places_.push_back({snippet.expected, 0.0, strength_of(snippet, snippet.expected), 0.0, true});
  }

  // The beat of median strength.
  void learn_from_one() {
    std::vector<std::size_t> order(snippets_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
    std::nth_element(order.begin(), middle, order.end(), [&](std::size_t a, std::size_t b) {
      return places_[a].strength < places_[b].strength;
    });
    const BeatSnippet& one = snippets_[*middle];
    kind_.shape.assign(grid_.size, 0.0);
    for (std::size_t k = 0; k < grid_.size; ++k)
      kind_.shape[k] = std::max(0.0, power_at(one, one.expected, k));
    const double loudest = *std::max_element(kind_.shape.begin(), kind_.shape.end());
    for (double& value : kind_.shape)
      value /= loudest > 0.0 ? loudest : 1.0;
    constexpr double likeness_limit = 0.1; // the square of a third: no two beats are quite alike
    kind_.variance.assign(grid_.size, likeness_limit);
  }

  // Keeps the kind that predicts most beats best, by the median of the log-likelihood. It must be
  // clearly better, because a kind that scatters over places fits a little better than it should.
  void settle() {
    constexpr int rounds = 4;
    const double clear = 0.05 * static_cast<double>(grid_.size);
    for (int round = 0; round < rounds; ++round) {
      BeatFit fit(grid_, kind_);
      std::vector<double> qualities;
      for (std::size_t i = 0; i < snippets_.size(); ++i) {
        places_[i] = fit(snippets_[i]);
        if (places_[i].inside) qualities.push_back(places_[i].quality);
      }
      if (qualities.empty()) return;
      const double worst = *std::min_element(qualities.begin(), qualities.end());
      qualities.resize(snippets_.size(), worst);
      if (const double quality = median(qualities); quality > best_quality_ + clear)
        best_quality_ = quality, best_ = kind_, best_places_ = places_;
      learn();
    }
  }

  // The mean power over the background.
  [[nodiscard]] double strength_of(const BeatSnippet& snippet, double begin) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < grid_.size; ++k)
      sum += power_at(snippet, begin, k);
    return std::max(sum / static_cast<double>(grid_.size), 1e-3);
  }

  [[nodiscard]] double power_at(const BeatSnippet& snippet, double begin, std::size_t k) const {
    const double place =
        std::clamp(begin - static_cast<double>(grid_.lead) + static_cast<double>(k), 0.0,
                   static_cast<double>(snippet.powers.size()) - 2.0);
    return between(snippet.powers, place) / snippet.background - 1.0;
  }

  void learn() {
    kind_.shape.assign(grid_.size, 0.0);
    kind_.variance.assign(grid_.size, 0.0);
    std::vector<double> values, sizes;
    double loudest = 0.0;
    for (std::size_t k = 0; k < grid_.size; ++k) {
      values.clear();
      for (std::size_t i = 0; i < snippets_.size(); ++i)
        if (places_[i].inside)
          values.push_back(power_at(snippets_[i], places_[i].bin, k) / places_[i].strength);
      kind_.shape[k] = values.empty() ? 0.0 : trimmed_mean(values);
    }
    std::vector<double> before(kind_.shape.begin(),
                               kind_.shape.begin() + static_cast<std::ptrdiff_t>(grid_.lead / 2));
    const double silence = median(before); // the background is known to a few hundredths only
    for (double& value : kind_.shape) {
      value = std::max(0.0, value - silence);
      loudest = std::max(loudest, value);
    }
    for (double& value : kind_.shape) // their strength is that of the loudest bin
      value /= loudest > 0.0 ? loudest : 1.0;
    for (BeatPlace& place : places_)
      place.strength *= loudest > 0.0 ? loudest : 1.0;
    for (std::size_t k = 0; k < grid_.size; ++k)
      kind_.variance[k] = own_variance(k, values);
  }

  // The variance of the logarithm that the noise does not explain.
  [[nodiscard]] double own_variance(std::size_t k, std::vector<double>& values) const {
    values.clear();
    double noise = 0.0, own = 0.0;
    for (std::size_t i = 0; i < snippets_.size(); ++i) {
      if (!places_[i].inside) continue;
      const double sound = places_[i].strength * kind_.shape[k];
      const double all = 1.0 + sound;
      const double power = std::max(1e-6, 1.0 + power_at(snippets_[i], places_[i].bin, k));
      values.push_back(std::log(power / all));
      noise += grid_.log_variance(sound);
      own += sound * sound / (all * all);
    }
    if (values.empty() || !(own > 0.0)) return 0.0;
    const double sigma = robust_sigma(values);
    const auto count = static_cast<double>(values.size());
    constexpr double least_power_share =
        0.01; // a tenth of the power: what shapes between bins are known to
    return std::max(least_power_share, (sigma * sigma - noise / count) / (own / count));
  }

  // The correlation of the beats' departures from their mean, where these exceed the noise.
  void learn_correlation() {
    std::vector<double> products(longest_correlation, 0.0), sizes(longest_correlation, 1e-12);
    for (std::size_t i = 0; i < snippets_.size(); ++i) {
      if (!places_[i].inside) continue;
      std::vector<double> own(grid_.size, 0.0);
      for (std::size_t k = 0; k < grid_.size; ++k) {
        const double sound = places_[i].strength * kind_.shape[k], all = 1.0 + sound;
        const double noise = grid_.log_variance(sound);
        const double variance = kind_.variance[k] * sound * sound / (all * all);
        const double power = std::max(1e-6, 1.0 + power_at(snippets_[i], places_[i].bin, k));
        constexpr double most_sigmas = 3.0; // standard deviations
        if (variance > noise)
          own[k] = std::clamp(std::log(power / all) / std::sqrt(variance + noise), -most_sigmas,
                              most_sigmas);
      }
      for (std::size_t lag = 0; lag < longest_correlation; ++lag)
        for (std::size_t k = lag; k < grid_.size; ++k)
          if (own[k] != 0.0 && own[k - lag] != 0.0)
            products[lag] += own[k] * own[k - lag], sizes[lag] += 1.0;
    }
    kind_.correlation.assign(1, 1.0);
    if (!(products[0] > 0.0)) return;
    for (std::size_t lag = 1; lag < longest_correlation; ++lag) {
      // Bartlett's weights, which leave no negative variance.
      const double weight = 1.0 - static_cast<double>(lag) / longest_correlation;
      kind_.correlation.push_back(weight * products[lag] / sizes[lag] / (products[0] / sizes[0]));
    }
  }

  // The beat begins where its power first reaches two hundredths of the largest, and remains above
  // the uncertainty of the mean.
  void begin_at_onset() {
    double count = 0.0, strength = 0.0;
    for (const BeatPlace& place : places_)
      if (place.inside) count += 1.0, strength += place.strength;
    if (count == 0.0) return;
    strength /= count;
    const double unknown = std::sqrt(2.0 / grid_.degrees / count) / strength;
    const double begun = std::max(0.02, 5.0 * unknown);
    const auto first_above = [&](double level) {
      std::size_t bin = 0;
      while (bin + 1 < grid_.size && kind_.shape[bin] < level)
        ++bin;
      return bin;
    };
    const std::size_t onset = first_above(begun);
    // The rise ends at half of the highest power within a millisecond of the onset.
    const auto first = kind_.shape.begin() + static_cast<std::ptrdiff_t>(onset);
    const auto next = std::min<std::ptrdiff_t>(kind_.shape.end() - first, grid_.reach / 4);
    const double half = 0.5 * *std::max_element(first, first + std::max<std::ptrdiff_t>(1, next));
    const auto rise = static_cast<double>(first_above(std::max(half, begun)) - onset);
    kind_.rise = std::max(0.5, rise); // where in a bin it begins is not known
    const std::ptrdiff_t by =
        static_cast<std::ptrdiff_t>(onset) - static_cast<std::ptrdiff_t>(grid_.lead);
    std::vector<double> after;
    for (std::size_t i = 0; i < places_.size(); ++i)
      if (places_[i].inside) after.push_back(places_[i].bin - snippets_[i].expected);
    BeatKind moved{std::vector<double>(grid_.size, 0.0), std::vector<double>(grid_.size, 0.0),
                   kind_.correlation, kind_.rise, median(after) + static_cast<double>(by)};
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(grid_.size); ++k) {
      const std::ptrdiff_t from = k + by;
      if (from < 0 || from >= static_cast<std::ptrdiff_t>(grid_.size)) continue;
      moved.shape[static_cast<std::size_t>(k)] = kind_.shape[static_cast<std::size_t>(from)];
      moved.variance[static_cast<std::size_t>(k)] = kind_.variance[static_cast<std::size_t>(from)];
    }
    kind_ = std::move(moved);
  }

  const BeatGrid& grid_;
  std::vector<BeatSnippet> snippets_;
  std::vector<BeatPlace> places_, best_places_;
  BeatKind kind_, best_;
  double best_quality_ = -std::numeric_limits<double>::infinity();
};

} // namespace

BeatKind learn_kind(const BeatGrid& grid, std::vector<BeatSnippet> snippets) {
  return BeatLearning(grid, std::move(snippets)).run();
}

} // namespace goingrate
