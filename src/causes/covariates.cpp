#include "goingrate/causes/covariates.hpp"
#include "goingrate/causes/diagnosis.hpp"

#include "rate_blocks.hpp"

#include "base/scaled_time.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <optional>

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

/// Rate and covariate in blocks, from the first to the last in which the covariate is known.
struct Answer {
  std::vector<double> rate, value;
  double block_s = 0.0;
  double known_share = 1.0; ///< of the whole log
  double filled_share = 0.0; ///< of these blocks: straight lines over holes
};

// A share of the beats of a block.
bool is_known(double share) { return share > 0.5; }

// Blocks in which a covariate is not known get the straight line between their neighbours.
void put_lines(const std::vector<double>& known, std::vector<double>& series) {
  std::optional<std::size_t> before;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!is_known(known[i])) continue;
    for (std::size_t k = before.value_or(i) + 1; k < i; ++k)
      series[k] = std::lerp(series[*before], series[i],
                            static_cast<double>(k - *before) / static_cast<double>(i - *before));
    if (!before)
      std::fill(series.begin(), series.begin() + static_cast<std::ptrdiff_t>(i), series[i]);
    before = i;
  }
  if (before)
    std::fill(series.begin() + static_cast<std::ptrdiff_t>(*before), series.end(), series[*before]);
}

Answer answer_in(const RateBlocks& blocks, std::size_t term) {
  Answer answer{blocks.rate, blocks.values[term], blocks.length_s};
  const std::vector<double>& known = blocks.known[term];
  if (known.empty()) return answer;
  const auto first = std::find_if(known.begin(), known.end(), is_known) - known.begin();
  const auto last = std::find_if(known.rbegin(), known.rend(), is_known).base() - known.begin();
  for (std::vector<double>* series : {&answer.rate, &answer.value}) {
    put_lines(known, *series);
    *series = {series->begin() + first, series->begin() + std::max(first, last)};
  }
  const auto blocks_known =
      static_cast<double>(std::count_if(known.begin(), known.end(), is_known));
  answer.known_share = blocks_known / static_cast<double>(known.size());
  const auto blocks_taken = static_cast<double>(std::max<std::size_t>(1, answer.rate.size()));
  answer.filled_share = 1.0 - blocks_known / blocks_taken;
  return answer;
}

// Sums of squares of the time error that a half leaves, by what the other half says.
struct HeldOut {
  double without2 = 0.0, with2 = 0.0;
};

HeldOut judged(const Answer& answer, std::size_t split, bool learn_first) {
  const std::size_t n = answer.rate.size();
  const auto part = [&](const std::vector<double>& x, bool first) {
    return first ? std::span(x).first(split) : std::span(x).last(n - split);
  };
  const Regression known(part(answer.rate, learn_first), part(answer.value, learn_first),
                         answer.block_s);
  const auto value = lagged(answer.value, answer.block_s, known.lag_s());
  const double rate = mean_of(part(answer.rate, learn_first));
  const double mean = mean_of(part(value, learn_first));
  HeldOut result;
  double without = 0.0, with = 0.0;
  const auto seen = part(answer.rate, !learn_first);
  const auto cause = part(value, !learn_first);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    without += (seen[i] - rate) * answer.block_s;
    with += (seen[i] - rate - known.coefficient() * (cause[i] - mean)) * answer.block_s;
    result.without2 += without * without / static_cast<double>(seen.size());
    result.with2 += with * with / static_cast<double>(seen.size());
  }
  return result;
}

// By how much errors of the readings may make the coefficient too small: their share of the
// variance of the covariate, means over blocks, without its line.
double attenuation(const Answer& answer, const RateTerm& term) {
  if (!(term.sigma > 0.0)) return 0.0;
  double variance = 0.0;
  for (const double c : cosines(answer.value, true))
    variance += c * c / static_cast<double>(answer.value.size());
  const double error2 = term.sigma * term.sigma * std::min(1.0, term.step_s / answer.block_s);
  return std::min(1.0, error2 / variance);
}

constexpr std::size_t least_beats = 256, most_blocks = 1024, least_blocks = 32; // 16 in a half

// What runs along a straight line cannot be told from a drift of the clock.
bool bends(const std::vector<double>& value) {
  constexpr double rounding = 1e-10; // of the variance
  const double mean = mean_of(value);
  double all = 0.0, bent = 0.0;
  for (const double v : value)
    all += (v - mean) * (v - mean);
  for (const double c : cosines(value, true))
    bent += c * c;
  return bent > rounding * all && all > 0.0;
}

} // namespace

std::vector<CovariateEffect> covariate_effects(const TimingData& data) {
  std::vector<CovariateEffect> effects;
  if (data.size() < least_beats) return effects;
  const RateBlocks blocks = rate_blocks(data, std::min(most_blocks, data.size() / 8));
  for (std::size_t k = 0; k < data.terms.size(); ++k) {
    const RateTerm& term = data.terms[k];
    if (term.name == "drift") continue;
    const Answer answer = answer_in(blocks, k);
    if (answer.rate.size() < least_blocks || !bends(answer.value)) continue;
    const Regression all(answer.rate, answer.value, answer.block_s);
    const std::size_t half = answer.rate.size() / 2;
    const HeldOut second = judged(answer, half, true);
    const HeldOut first = judged(answer, half, false);
    CovariateEffect effect{term.name, term.unit, all.coefficient(), 0.0, all.lag_s()};
    effect.sigma = std::hypot(all.sigma() / std::sqrt(1.0 - answer.filled_share),
                              all.coefficient() * attenuation(answer, term));
    effect.without_s = std::sqrt(0.5 * (first.without2 + second.without2));
    effect.with_s = std::sqrt(0.5 * (first.with2 + second.with2));
    effect.interpolation_sigma = term.sigma;
    effect.step_s = term.step_s;
    effect.known_share = answer.known_share;
    effects.push_back(std::move(effect));
  }
  return effects;
}

std::vector<WeatherPart> weather_parts(const TimingData& data) {
  std::vector<WeatherPart> parts;
  if (data.size() < least_beats) return parts;
  const RateBlocks blocks = rate_blocks(data, std::min(most_blocks, data.size() / 8));
  std::vector<double> rate = blocks.rate;
  std::vector<std::vector<double>> values;
  for (std::size_t k = 0; k < data.terms.size(); ++k) {
    const RateTerm& term = data.terms[k];
    if (term.name == "drift" || term.name == "density" || !bends(blocks.values[k])) continue;
    parts.push_back({term.name, term.unit, 0.0, 0.0});
    values.push_back(blocks.values[k]);
    put_lines(blocks.known[k], rate); // as the values there
  }
  if (parts.empty()) return parts;
  std::vector<std::vector<double>> causes;
  for (const std::vector<double>& value : values)
    causes.push_back(cosines(value, true));
  constexpr std::size_t first = 2; // the mean and the line
  const RateRegression found = regress(cosines(rate, true), causes, RateNoise(first, {}));
  for (std::size_t k = 0; k < parts.size(); ++k) {
    parts[k].coefficient = found.coefficients[k];
    parts[k].sigma = found.sigmas[k];
  }
  return parts;
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
  if (effect.known_share < 1.0)
    text += fmt::format(", from {:.0f} % of the log", 100.0 * effect.known_share);
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
