#include "tick_times.hpp"

#include "base/robust.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

namespace goingrate {

namespace {

constexpr double lead_s = 8e-3, tail_s = 24e-3, // of a beat, from where it begins
    step_s = 62.5e-6,                           // of its power
    reach_s = 4e-3;                             // a rough place is right to three milliseconds
constexpr std::size_t most_learnt_from = 600;
constexpr std::size_t longest_correlation = 32; // bins: 2 ms, several periods of a click's tone

/// Sizes of a beat's power in bins.
struct Grid {
  explicit Grid(double rate_hz)
      : samples(std::max<std::int64_t>(1, std::llround(step_s * rate_hz))) {
    const double step = static_cast<double>(samples) / rate_hz;
    lead = static_cast<std::size_t>(std::lround(lead_s / step));
    size = lead + static_cast<std::size_t>(std::lround(tail_s / step));
    reach = static_cast<std::ptrdiff_t>(std::lround(reach_s / step));
    degrees = static_cast<double>(samples);
  }
  std::int64_t samples = 1; ///< a bin
  std::size_t lead = 0, size = 0;
  std::ptrdiff_t reach = 0;
  double degrees = 1.0;                 ///< of freedom of one power of the background
  std::vector<double> correlation{1.0}; ///< of its powers so many bins apart

  // How many neighbours are as good as one.
  [[nodiscard]] double alike() const {
    return 2.0 * std::accumulate(correlation.begin(), correlation.end(), 0.0) - 1.0;
  }
};

/// The power around a place where a beat may begin.
struct Snippet {
  std::int64_t first = 0;    // sample
  double background = 1.0;   // power
  double expected = 0.0;     // where the beat begins, in bins
  std::vector<float> powers; // `reach` more than the grid on both sides
};

/// Reads snippets.
class Snippets {
public:
  Snippets(Whitening& sound, const Loudness& loudness, const Grid& grid)
      : sound_(sound), loudness_(loudness), grid_(grid) {}

  // Around a rough place; `after` as of the kind.
  Snippet read(double bin, double after = 0.0) {
    const double at = (bin + 0.5) * static_cast<double>(loudness_.hop) +
                      after * static_cast<double>(grid_.samples);
    const auto before = static_cast<std::ptrdiff_t>(grid_.lead) + grid_.reach;
    const std::size_t size = grid_.size + 2 * static_cast<std::size_t>(grid_.reach);
    Snippet snippet;
    snippet.first = std::llround(at) - before * grid_.samples;
    snippet.expected = static_cast<double>(before);
    snippet.background = loudness_.background(at);
    samples_.resize((size + 2) * static_cast<std::size_t>(grid_.samples));
    sound_.read(snippet.first - grid_.samples, samples_);
    bins_.assign(size + 2, 0.0F);
    for (std::size_t i = 0; i < samples_.size(); ++i)
      bins_[i / static_cast<std::size_t>(grid_.samples)] += samples_[i] * samples_[i];
    const float quarter = 0.25F / static_cast<float>(grid_.samples);
    snippet.powers.resize(size);
    for (std::size_t i = 0; i < size; ++i)
      snippet.powers[i] = quarter * (bins_[i] + 2.0F * bins_[i + 1] + bins_[i + 2]) +
                          1e-9F * static_cast<float>(snippet.background);
    return snippet;
  }

private:
  Whitening& sound_;
  const Loudness& loudness_;
  const Grid& grid_;
  std::vector<float> samples_, bins_;
};

// Measures the background halfway between beats: power is chi-square of as many degrees as its
// scatter tells, in the band of the beats fewer than there are samples.
void measure_background(Snippets& snippets, const TickTrack& track, Grid& grid) {
  constexpr std::size_t most = 300, lags = 24;
  std::vector<double> products(lags, 0.0), sizes(lags, 1e-12), squares;
  const std::size_t every = track.ticks.size() / most + 1;
  for (std::size_t i = 0; i + 1 < track.ticks.size(); i += every) {
    const Snippet snippet = snippets.read(0.5 * (track.ticks[i].bin + track.ticks[i + 1].bin));
    std::vector<double> powers(snippet.powers.begin(), snippet.powers.end());
    const double mean = trimmed_mean(powers);
    std::vector<double> off;
    constexpr double largest = 4.0; // what is louder is no background
    for (const float power : snippet.powers)
      off.push_back(std::min(static_cast<double>(power) / mean - 1.0, largest));
    for (std::size_t lag = 0; lag < lags; ++lag)
      for (std::size_t k = lag; k < off.size(); ++k)
        products[lag] += off[k] * off[k - lag], sizes[lag] += 1.0;
  }
  const double variance = products[0] / sizes[0];
  if (!(variance > 0.0)) return;
  grid.degrees = 2.0 / variance;
  grid.correlation.clear();
  for (std::size_t lag = 0; lag < lags; ++lag) { // Bartlett's weights leave no negative variance
    const double weight = 1.0 - static_cast<double>(lag) / lags;
    grid.correlation.push_back(weight * products[lag] / sizes[lag] / variance);
  }
}

/// What ticks, or tocks, are like: power over their own strength, its relative variance from beat
/// to beat, and how far that is alike in bins so far apart.
struct Kind {
  std::vector<double> shape;
  std::vector<double> variance;
  std::vector<double> correlation{1.0};
  double rise = 0.0;  // bins
  double after = 0.0; // bins that it begins after the rough places
};

// Where a beat begins in its snippet.
struct Place {
  double bin = 0.0, sigma = 0.0;
  double strength = 0.0;
  double quality = 0.0; // log-likelihood, but for a constant
  bool inside = false;
};

double between(std::span<const float> values, double place) {
  const auto i = static_cast<std::size_t>(place);
  const auto part = static_cast<float>(place - static_cast<double>(i));
  return static_cast<double>((1.0F - part) * values[i] + part * values[i + 1]);
}

/// Fits the mean beat to one.
class Fit {
public:
  Fit(const Grid& grid, const Kind& kind) : grid_(grid), kind_(kind) {}

  Place operator()(const Snippet& snippet) {
    double strength = strength_at(snippet, grid_.reach);
    std::ptrdiff_t best = grid_.reach;
    constexpr int rounds = 3;
    for (int round = 0; round < rounds; ++round) {
      take_logs(snippet, strength);
      foretell(strength);
      best = best_shift();
      const double now = strength_at(snippet, best);
      constexpr double settled = 0.05; // relative: the logarithms hardly change
      if (std::abs(now - strength) < settled * strength) break;
      strength = now;
    }
    return placed(best, strength);
  }

private:
  // In units of the background; at least one that can be told from none.
  [[nodiscard]] double strength_at(const Snippet& snippet, std::ptrdiff_t shift) const {
    double sum = 0.0, weight = 0.0;
    for (std::size_t k = 0; k < grid_.size; ++k) {
      const double power =
          static_cast<double>(snippet.powers[k + static_cast<std::size_t>(shift)]) /
          snippet.background;
      sum += kind_.shape[k] * (power - 1.0);
      weight += kind_.shape[k] * kind_.shape[k];
    }
    return std::max(sum / weight, 1e-3);
  }

  // A hundredth of the strength is added: the foot of a loud beat changes by orders of magnitude
  // within a bin, and would be all that counts.
  static constexpr double foot = 0.01;

  void take_logs(const Snippet& snippet, double strength) {
    logs_.resize(snippet.powers.size());
    for (std::size_t i = 0; i < logs_.size(); ++i)
      logs_[i] = std::log(snippet.powers[i] / static_cast<float>(snippet.background) +
                          static_cast<float>(foot * strength));
  }

  // Expected logarithms and the inverse of their variances.
  void foretell(double strength) {
    expected_.resize(grid_.size);
    weights_.resize(grid_.size);
    noise_.resize(grid_.size);
    own_.resize(grid_.size);
    for (std::size_t k = 0; k < grid_.size; ++k) {
      const double sound = strength * kind_.shape[k];
      const double all = 1.0 + sound + foot * strength;
      const double noise = (1.0 + 2.0 * sound) / (all * all) / grid_.degrees; // half its variance
      const double own = sound / all;
      expected_[k] = std::log(all) - noise;
      noise_[k] = std::sqrt(2.0 * noise);
      own_[k] = std::sqrt(kind_.variance[k]) * own;
      weights_[k] = 1.0 / (2.0 * noise + own_[k] * own_[k]);
    }
  }

  [[nodiscard]] double misfit(std::ptrdiff_t shift) const {
    double sum = 0.0;
    const float* logs = logs_.data() + shift;
    for (std::size_t k = 0; k < grid_.size; ++k)
      sum += weights_[k] * std::pow(static_cast<double>(logs[k]) - expected_[k], 2);
    return sum;
  }

  [[nodiscard]] std::ptrdiff_t best_shift() {
    const auto shifts = static_cast<std::size_t>(2 * grid_.reach + 1);
    misfits_.assign(shifts, 0.0F);
    // Shift by shift inside: that is what compilers vectorise.
    for (std::size_t k = 0; k < grid_.size; ++k) {
      const auto weight = static_cast<float>(weights_[k]), expected = static_cast<float>(expected_[k]);
      const float* logs = logs_.data() + k;
      for (std::size_t shift = 0; shift < shifts; ++shift)
        misfits_[shift] += weight * (logs[shift] - expected) * (logs[shift] - expected);
    }
    constexpr double widths = 4.0; // standard deviations of a rough place in `reach`
    for (std::size_t shift = 0; shift < shifts; ++shift) {
      const double off = widths * (static_cast<double>(shift) / static_cast<double>(grid_.reach) - 1.0);
      misfits_[shift] += static_cast<float>(off * off);
    }
    return std::min_element(misfits_.begin(), misfits_.end()) - misfits_.begin();
  }

  // Between bins by the parabola through three misfits.
  [[nodiscard]] Place placed(std::ptrdiff_t best, double strength) const {
    Place place;
    place.strength = strength;
    place.inside = best > 0 && best < 2 * grid_.reach;
    if (!place.inside) return place;
    const double before = misfit(best - 1), here = misfit(best), after = misfit(best + 1);
    const double bend = before - 2.0 * here + after;
    place.bin = static_cast<double>(best + static_cast<std::ptrdiff_t>(grid_.lead)) +
                (bend > 0.0 ? 0.5 * (before - after) / bend : 0.0);
    const double excess = std::max(1.0, here / static_cast<double>(grid_.size));
    constexpr double finest = 0.03; // bins: what the parabola and the mean shape are right to
    place.sigma = std::hypot(std::sqrt(excess) * sigma(), finest, spread(best));
    place.quality = log_likelihood(best, strength);
    return place;
  }

  // Of all powers of the snippet, those around the beat being background; but for a constant.
  [[nodiscard]] double log_likelihood(std::ptrdiff_t best, double strength) const {
    const double silence = 1.0 + foot * strength;
    const double noise = 1.0 / (silence * silence) / grid_.degrees; // half its variance
    double sum = 0.0;
    for (std::size_t i = 0; i < logs_.size(); ++i) {
      const auto log = static_cast<double>(logs_[i]);
      const std::ptrdiff_t k = static_cast<std::ptrdiff_t>(i) - best;
      const bool inside = k >= 0 && k < static_cast<std::ptrdiff_t>(grid_.size);
      const double weight = inside ? weights_[static_cast<std::size_t>(k)] : 0.5 / noise;
      const double expected =
          inside ? expected_[static_cast<std::size_t>(k)] : std::log(silence) - noise;
      // The last term makes a density of the logarithm one of the power.
      sum += 0.5 * (std::log(weight) - weight * (log - expected) * (log - expected)) - log;
    }
    return sum;
  }

  // How far other places, as likely as they are, lie from the best: in noise there are several.
  [[nodiscard]] double spread(std::ptrdiff_t best) const {
    const double alike = std::max(1.0, grid_.alike());
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < misfits_.size(); ++i) {
      const double off = static_cast<double>(i) - static_cast<double>(best);
      const auto worse =
          static_cast<double>(misfits_[i] - misfits_[static_cast<std::size_t>(best)]);
      const double likely = std::exp(-0.5 / alike * worse);
      constexpr double at_hand = 2.0; // bins: what the parabola has
      sum += likely;
      if (std::abs(off) > at_hand) squares += likely * off * off;
    }
    return std::sqrt(squares / sum);
  }

  // Of the place, in bins: the estimate is a sum of the logarithms' errors, each times weight and
  // slope.
  [[nodiscard]] double sigma() const {
    std::vector<double> by_noise(grid_.size, 0.0), by_own(grid_.size, 0.0);
    double information = 0.0;
    for (std::size_t k = 1; k + 1 < grid_.size; ++k) {
      const double slope = 0.5 * (expected_[k + 1] - expected_[k - 1]);
      by_noise[k] = weights_[k] * slope * noise_[k];
      by_own[k] = weights_[k] * slope * own_[k];
      information += weights_[k] * slope * slope;
    }
    const double variance = correlated(by_noise, grid_.correlation) +
                            correlated(by_own, kind_.correlation);
    return std::sqrt(std::max(variance, 0.0)) / information;
  }

  static double correlated(std::span<const double> terms, std::span<const double> correlation) {
    double sum = 0.0;
    for (std::size_t lag = 0; lag < correlation.size(); ++lag) {
      double products = 0.0;
      for (std::size_t k = lag; k < terms.size(); ++k)
        products += terms[k] * terms[k - lag];
      sum += (lag == 0 ? 1.0 : 2.0) * correlation[lag] * products;
    }
    return sum;
  }

  const Grid& grid_;
  const Kind& kind_;
  std::vector<float> logs_, misfits_;
  std::vector<double> expected_, weights_, noise_, own_;
};

/// Learns one kind of beat from many.
class Learning {
public:
  Learning(const Grid& grid, std::vector<Snippet> snippets)
      : grid_(grid), snippets_(std::move(snippets)) {}

  // From the mean of all, which loud beats out of line blur, and from one beat, in which faint ones
  // are drowned: whichever comes to foretell them better.
  Kind run() {
    const std::vector<double> none(grid_.size, 0.0);
    best_ = {none, none, {1.0}, 0.0, 0.0};
    if (snippets_.empty()) return best_;
    place_as_expected();
    learn();
    settle();
    place_as_expected();
    learn_from_one();
    settle();
    if (best_places_.empty()) return best_; // no beat lies near where it should
    kind_ = best_;
    places_ = best_places_;
    learn_correlation();
    begin_at_onset();
    return std::move(kind_);
  }

private:
  void place_as_expected() {
    places_.clear();
    for (const Snippet& snippet : snippets_)
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
    const Snippet& one = snippets_[*middle];
    kind_.shape.assign(grid_.size, 0.0);
    for (std::size_t k = 0; k < grid_.size; ++k)
      kind_.shape[k] = std::max(0.0, power_at(one, one.expected, k));
    const double loudest = *std::max_element(kind_.shape.begin(), kind_.shape.end());
    for (double& value : kind_.shape)
      value /= loudest > 0.0 ? loudest : 1.0;
    constexpr double alike_to = 0.1; // the square of a third: one beat is not quite another
    kind_.variance.assign(grid_.size, alike_to);
  }

  // The kind by which most beats are foretold best is kept: by the median of the log-likelihood, and
  // clearly, as a kind that scatters over places fits a little better than it should.
  void settle() {
    constexpr int rounds = 4;
    const double clear = 0.05 * static_cast<double>(grid_.size);
    for (int round = 0; round < rounds; ++round) {
      Fit fit(grid_, kind_);
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
  [[nodiscard]] double strength_of(const Snippet& snippet, double begin) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < grid_.size; ++k)
      sum += power_at(snippet, begin, k);
    return std::max(sum / static_cast<double>(grid_.size), 1e-3);
  }

  [[nodiscard]] double power_at(const Snippet& snippet, double begin, std::size_t k) const {
    const double place = std::clamp(begin - static_cast<double>(grid_.lead) + static_cast<double>(k),
                                    0.0, static_cast<double>(snippet.powers.size()) - 2.0);
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
    for (Place& place : places_)
      place.strength *= loudest > 0.0 ? loudest : 1.0;
    for (std::size_t k = 0; k < grid_.size; ++k)
      kind_.variance[k] = own_variance(k, values);
  }

  // Of the logarithm, what the noise does not explain.
  [[nodiscard]] double own_variance(std::size_t k, std::vector<double>& values) const {
    values.clear();
    double noise = 0.0, own = 0.0;
    for (std::size_t i = 0; i < snippets_.size(); ++i) {
      if (!places_[i].inside) continue;
      const double sound = places_[i].strength * kind_.shape[k];
      const double all = 1.0 + sound;
      const double power = std::max(1e-6, 1.0 + power_at(snippets_[i], places_[i].bin, k));
      values.push_back(std::log(power / all));
      noise += 2.0 * (1.0 + 2.0 * sound) / (all * all) / grid_.degrees;
      own += sound * sound / (all * all);
    }
    if (values.empty() || !(own > 0.0)) return 0.0;
    const double sigma = robust_sigma(values);
    const auto count = static_cast<double>(values.size());
    constexpr double least = 0.01; // a tenth of the power: what shapes between bins are known to
    return std::max(least, (sigma * sigma - noise / count) / (own / count));
  }

  // Of what the beats differ by from their mean, where that is more than the noise.
  void learn_correlation() {
    std::vector<double> products(longest_correlation, 0.0), sizes(longest_correlation, 1e-12);
    for (std::size_t i = 0; i < snippets_.size(); ++i) {
      if (!places_[i].inside) continue;
      std::vector<double> own(grid_.size, 0.0);
      for (std::size_t k = 0; k < grid_.size; ++k) {
        const double sound = places_[i].strength * kind_.shape[k], all = 1.0 + sound;
        const double noise = 2.0 * (1.0 + 2.0 * sound) / (all * all) / grid_.degrees;
        const double variance = kind_.variance[k] * sound * sound / (all * all);
        const double power = std::max(1e-6, 1.0 + power_at(snippets_[i], places_[i].bin, k));
        constexpr double most = 3.0; // standard deviations
        if (variance > noise)
          own[k] = std::clamp(std::log(power / all) / std::sqrt(variance + noise), -most, most);
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

  // The beat begins where its power first reaches two hundredths of the largest, and stays clear of
  // what the mean does not know.
  void begin_at_onset() {
    double count = 0.0, strength = 0.0;
    for (const Place& place : places_)
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
    // To half of what it comes to within a millisecond.
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
    Kind moved{std::vector<double>(grid_.size, 0.0), std::vector<double>(grid_.size, 0.0),
               kind_.correlation, kind_.rise, median(after) + static_cast<double>(by)};
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(grid_.size); ++k) {
      const std::ptrdiff_t from = k + by;
      if (from < 0 || from >= static_cast<std::ptrdiff_t>(grid_.size)) continue;
      moved.shape[static_cast<std::size_t>(k)] = kind_.shape[static_cast<std::size_t>(from)];
      moved.variance[static_cast<std::size_t>(k)] = kind_.variance[static_cast<std::size_t>(from)];
    }
    kind_ = std::move(moved);
  }

  const Grid& grid_;
  std::vector<Snippet> snippets_;
  std::vector<Place> places_, best_places_;
  Kind kind_, best_;
  double best_quality_ = -std::numeric_limits<double>::infinity();
};

Kind learnt(Snippets& snippets, const Grid& grid, const TickTrack& track, bool tocks) {
  std::vector<double> bins;
  for (const RoughTick& tick : track.ticks)
    if (tick.is_tock == tocks && tick.stands_out) bins.push_back(tick.bin);
  const std::size_t count = std::min(most_learnt_from, bins.size());
  std::vector<Snippet> read;
  for (std::size_t i = 0; i < count; ++i)
    read.push_back(snippets.read(bins[i * bins.size() / count]));
  return Learning(grid, std::move(read)).run();
}

MeanBeat mean_beat(const Kind& kind, const Grid& grid, double strength, double rate_hz) {
  MeanBeat beat;
  beat.step_s = static_cast<double>(grid.samples) / rate_hz;
  beat.rise_s = kind.rise * beat.step_s;
  beat.begin_s = -static_cast<double>(grid.lead) * beat.step_s;
  for (const double value : kind.shape)
    beat.power.push_back(1.0 + strength * value);
  return beat;
}

// A phase that steps may name one beat twice.
void drop_repeated(std::vector<Tick>& ticks, double period) {
  std::sort(ticks.begin(), ticks.end(), [](const Tick& a, const Tick& b) { return a.at < b.at; });
  std::vector<Tick> kept;
  constexpr double nearest = 0.15; // of a period: ticks and tocks are farther apart
  for (const Tick& tick : ticks) {
    if (kept.empty() || tick.at - kept.back().at > nearest * period)
      kept.push_back(tick);
    else if (tick.sigma < kept.back().sigma)
      kept.back() = tick;
  }
  ticks = std::move(kept);
}

} // namespace

TickTrain time_ticks(Whitening& sound, const Loudness& loudness, const TickTrack& track,
                     double rate_hz, const std::function<void(double)>& progress) {
  Grid grid(rate_hz);
  Snippets snippets(sound, loudness, grid);
  measure_background(snippets, track, grid);
  TickTrain train;
  train.period = track.pattern.period * static_cast<double>(loudness.hop);
  train.has_tocks = track.pattern.has_tocks;
  train.is_even = track.pattern.is_even;
  const Kind tick = learnt(snippets, grid, track, false);
  const Kind tock = train.has_tocks ? learnt(snippets, grid, track, true) : Kind{};
  Fit fit_tick(grid, tick), fit_tock(grid, tock);
  std::vector<double> strengths[2];
  std::size_t done = 0;
  for (const RoughTick& rough : track.ticks) {
    if (progress && ++done % 1024 == 0)
      progress(static_cast<double>(done) / static_cast<double>(track.ticks.size()));
    if (!rough.stands_out) {
      ++train.drowned;
      continue;
    }
    const Snippet snippet = snippets.read(rough.bin, rough.is_tock ? tock.after : tick.after);
    const Place place = rough.is_tock ? fit_tock(snippet) : fit_tick(snippet);
    constexpr double worst_s = 2e-3; // of a place: it is then not found, but expected
    const bool known = place.sigma * static_cast<double>(grid.samples) <= worst_s * rate_hz;
    if (!place.inside || !known) {
      ++train.drowned;
      continue;
    }
    const auto samples = static_cast<double>(grid.samples);
    // A bin's power is that of its middle.
    train.ticks.push_back({static_cast<double>(snippet.first) + (place.bin + 0.5) * samples - 0.5,
                           place.sigma * samples, rough.is_tock});
    strengths[rough.is_tock ? 1 : 0].push_back(place.strength);
  }
  drop_repeated(train.ticks, train.period);
  if (!strengths[0].empty()) train.tick = mean_beat(tick, grid, median(strengths[0]), rate_hz);
  if (!strengths[1].empty()) train.tock = mean_beat(tock, grid, median(strengths[1]), rate_hz);
  return train;
}

} // namespace goingrate
