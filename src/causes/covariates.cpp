#include "goingrate/causes/covariates.hpp"
#include "goingrate/causes/diagnosis.hpp"

#include "rate_blocks.hpp"

#include "base/scaled_time.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace goingrate {

namespace {

using namespace timing_model;

double mean_of(std::span<const double> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

std::vector<double> lagged(std::span<const double> value, double block_s, double lag_s) {
  if (lag_s == 0.0) return {value.begin(), value.end()};
  std::vector<double> result;
  double state = value.front();
  const double share = -std::expm1(-block_s / lag_s);
  for (const double v : value)
    result.push_back(state += share * (v - state));
  return result;
}

/// The regression of a rate on a covariate through a lag. The first cosine is left out: taking off
/// the line has emptied it.
class Regression {
public:
  Regression(std::span<const double> rate, std::span<const double> value, double block_s)
      : rate_(cosines(rate, true)), value_(value), block_s_(block_s) {
    settle(0.0);
    double best = found_.deviance, lag_found = 0.0;
    const double plain = best;
    constexpr double least_gain = 8.0; // of 2 log L: for one more parameter, looked for on a grid
    const double longest = 0.1 * block_s * static_cast<double>(rate.size());
    for (double lag = block_s; lag < longest; lag *= 1.3) {
      settle(lag);
      if (found_.deviance >= best || found_.deviance >= plain - least_gain) continue;
      best = found_.deviance;
      lag_found = lag;
    }
    settle(lag_found);
  }

  [[nodiscard]] double coefficient() const { return found_.coefficients.front(); }
  [[nodiscard]] double sigma() const { return found_.sigmas.front(); }
  [[nodiscard]] double lag_s() const { return lag_s_; }

private:
  void settle(double lag_s) {
    lag_s_ = lag_s;
    constexpr std::size_t first = 2;
    found_ = regress(rate_, {cosines(lagged(value_, block_s_, lag_s), true)}, RateNoise(first, {}));
  }

  std::vector<double> rate_;
  std::span<const double> value_;
  double block_s_;
  RateRegression found_;
  double lag_s_ = 0.0;
};

// Sums of squares of the time error that a half leaves, by what the other half says.
struct HeldOut {
  double without2 = 0.0, with2 = 0.0;
};

HeldOut judged(const RateBlocks& blocks, const std::vector<double>& values, std::size_t split,
               bool learn_first) {
  const std::size_t n = blocks.rate.size();
  const auto part = [&](const std::vector<double>& x, bool first) {
    return first ? std::span(x).first(split) : std::span(x).last(n - split);
  };
  const Regression known(part(blocks.rate, learn_first), part(values, learn_first),
                         blocks.length_s);
  const auto value = lagged(values, blocks.length_s, known.lag_s());
  const double rate = mean_of(part(blocks.rate, learn_first));
  const double mean = mean_of(part(value, learn_first));
  HeldOut result;
  double without = 0.0, with = 0.0;
  const auto seen = part(blocks.rate, !learn_first);
  const auto cause = part(value, !learn_first);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    without += (seen[i] - rate) * blocks.length_s;
    with += (seen[i] - rate - known.coefficient() * (cause[i] - mean)) * blocks.length_s;
    result.without2 += without * without / static_cast<double>(seen.size());
    result.with2 += with * with / static_cast<double>(seen.size());
  }
  return result;
}

bool varies(const RateTerm& term) {
  return std::any_of(term.advance_s.begin(), term.advance_s.end(),
                     [](double v) { return std::abs(v) > 1e-9; });
}

} // namespace

std::vector<CovariateEffect> covariate_effects(const TimingData& data) {
  std::vector<CovariateEffect> effects;
  constexpr std::size_t least_beats = 256,
                        most_blocks = 1024; // beats: 32 blocks, 16 in a half; and blocks
  if (data.size() < least_beats) return effects;
  const RateBlocks blocks = rate_blocks(data, std::min(most_blocks, data.size() / 8));
  for (std::size_t k = 0; k < data.terms.size(); ++k) {
    const RateTerm& term = data.terms[k];
    const auto& values = blocks.values[k];
    if (term.name == "drift" || !varies(term)) continue;
    const Regression all(blocks.rate, values, blocks.length_s);
    const std::size_t half = blocks.rate.size() / 2;
    const HeldOut second = judged(blocks, values, half, true);
    const HeldOut first = judged(blocks, values, half, false);
    CovariateEffect effect{term.name, term.unit, all.coefficient(), all.sigma(), all.lag_s()};
    effect.without_s = std::sqrt(0.5 * (first.without2 + second.without2));
    effect.with_s = std::sqrt(0.5 * (first.with2 + second.with2));
    effects.push_back(std::move(effect));
  }
  return effects;
}

std::string covariate_text(const CovariateEffect& effect) {
  const double daily = seconds_per_day;
  const std::string per = effect.unit == "m^3/kg"         ? "kg/m^3"
                          : effect.unit.starts_with("1/") ? effect.unit.substr(2)
                                                          : effect.unit;
  std::string text =
      fmt::format("{}: the rate answers by {:.3g} ± {:.2g} s/day per {}", effect.name,
                  daily * effect.coefficient, daily * effect.sigma, per);
  if (effect.lag_s > 0.0) text += fmt::format(", with a lag of {:.3g} s", effect.lag_s);
  if (!effect.significant()) return text + ": nothing that stands out of the noise";
  return text +
         fmt::format("; over the half of the log it was not found in, compensating for it {} the "
                     "time error from {:.3g} s to {:.3g} s (rms)",
                     effect.helps() ? "lowers" : "raises", effect.without_s, effect.with_s);
}

void name_weather(std::span<const CovariateEffect> effects, std::vector<Suspicion>& suspicions) {
  for (const CovariateEffect& effect : effects) {
    const Cause cause = effect.name == "temperature" ? Cause::temperature
                        : effect.name == "pressure"  ? Cause::pressure
                                                     : Cause::unknown;
    if (cause == Cause::unknown) continue;
    const auto is_of_it = [&](const Suspicion& suspicion) { return suspicion.cause == cause; };
    for (Suspicion& suspicion : suspicions) {
      if (suspicion.cause == Cause::unlogged_weather && effect.helps() &&
          std::none_of(suspicions.begin(), suspicions.end(), is_of_it))
        suspicion = {cause, suspicion.gain, suspicion.evidence};
      if (!is_of_it(suspicion)) continue;
      suspicion.numbers.size = effect.coefficient;
      suspicion.numbers.sigma = effect.sigma;
    }
  }
}

} // namespace goingrate
