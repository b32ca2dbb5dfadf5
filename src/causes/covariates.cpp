#include "goingrate/causes/covariates.hpp"
#include "goingrate/causes/diagnosis.hpp"

#include "answer.hpp"
#include "rate_blocks.hpp"

#include "base/scaled_time.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace goingrate {

namespace {

using namespace timing_model;

double mean_of(std::span<const double> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

// Sums of squares of the time error that a half leaves, by what the other half says.
struct HeldOut {
  double without2 = 0.0, with2 = 0.0;
};

HeldOut judged(const AnswerBlocks& blocks, std::size_t split, bool learn_first, bool is_weather) {
  const std::size_t n = blocks.series.size();
  const auto part = [&](const std::vector<double>& x, bool first) {
    return first ? std::span(x).first(split) : std::span(x).last(n - split);
  };
  const Answer known(part(blocks.series, learn_first), part(blocks.value, learn_first),
                     blocks.block_s, is_weather);
  const auto caused = known.series_of(blocks.value);
  const double rate = mean_of(part(blocks.series, learn_first));
  const double mean = mean_of(part(caused, learn_first));
  HeldOut result;
  double without = 0.0, with = 0.0;
  const auto seen = part(blocks.series, !learn_first);
  const auto cause = part(caused, !learn_first);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    without += (seen[i] - rate) * blocks.block_s;
    with += (seen[i] - rate - (cause[i] - mean)) * blocks.block_s;
    result.without2 += without * without / static_cast<double>(seen.size());
    result.with2 += with * with / static_cast<double>(seen.size());
  }
  return result;
}

// By how much errors of the readings may make the coefficient too small: their share of the
// variance of the covariate, means over blocks, without its line.
double attenuation(const AnswerBlocks& blocks, const RateTerm& term) {
  if (!(term.sigma > 0.0)) return 0.0;
  double variance = 0.0;
  for (const double c : cosines(blocks.value, true))
    variance += c * c / static_cast<double>(blocks.value.size());
  const double error2 = term.sigma * term.sigma * std::min(1.0, term.step_s / blocks.block_s);
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

// Blocks of a log. The tide of half a day needs short ones, and is so well known that many do no
// harm; other covariates are judged in blocks of which a thousand are enough.
RateBlocks blocks_for(const TimingData& data, bool of_tide) {
  constexpr std::size_t most_of_tide = 16384; // two hours in four years
  return rate_blocks(data, std::min(of_tide ? most_of_tide : most_blocks, data.size() / 8));
}

std::optional<CovariateEffect> effect_of(const RateTerm& term, const AnswerBlocks& blocks) {
  if (blocks.series.size() < least_blocks || !bends(blocks.value)) return {};
  const bool is_weather = term.name != "tide"; // the tide is known, and acts at once
  const Answer all(blocks.series, blocks.value, blocks.block_s, is_weather);
  const std::size_t half = blocks.series.size() / 2;
  const HeldOut second = judged(blocks, half, true, is_weather);
  const HeldOut first = judged(blocks, half, false, is_weather);
  CovariateEffect effect{term.name, term.unit, all.coefficient(), 0.0, all.lag_s()};
  const double widened = 1.0 / std::sqrt(1.0 - blocks.filled_share);
  const double weakened = attenuation(blocks, term);
  effect.sigma = std::hypot(all.sigma() * widened, all.coefficient() * weakened);
  if (auto part = all.at_once()) {
    part->sigma = std::hypot(part->sigma * widened, part->coefficient * weakened);
    effect.parts.push_back(*part);
  }
  effect.without_s = std::sqrt(0.5 * (first.without2 + second.without2));
  effect.with_s = std::sqrt(0.5 * (first.with2 + second.with2));
  effect.interpolation_sigma = term.step_s > 0.0 ? term.sigma : 0.0;
  effect.step_s = term.step_s;
  effect.known_share = blocks.known_share;
  return effect;
}

} // namespace

std::vector<CovariateEffect> covariate_effects(const TimingData& data) {
  std::vector<CovariateEffect> effects;
  if (data.size() < least_beats) return effects;
  const RateBlocks blocks = blocks_for(data, false);
  for (std::size_t k = 0; k < data.terms.size(); ++k) {
    const RateTerm& term = data.terms[k];
    if (term.name == "drift") continue;
    if (term.name == "tide") {
      const RateBlocks short_ones = blocks_for(data, true);
      if (auto effect = effect_of(term, answer_blocks(short_ones, short_ones.rate, k)))
        effects.push_back(std::move(*effect));
      continue;
    }
    if (auto effect = effect_of(term, without_start(answer_blocks(blocks, blocks.rate, k))))
      effects.push_back(std::move(*effect));
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
    const bool is_weather = term.name != "drift" && term.name != "density" && term.name != "tide";
    if (!is_weather || !bends(blocks.values[k])) continue;
    parts.push_back({term.name, term.unit, 0.0, 0.0});
    values.push_back(blocks.values[k]);
    put_lines(blocks.known[k], rate); // as the values there
  }
  if (parts.empty()) return parts;
  std::vector<std::vector<double>> causes;
  for (const std::vector<double>& value : values)
    causes.push_back(cosines(value, true));
  constexpr std::size_t first = 2; // the mean and the line
  const RateRegression found =
      regress(cosines(rate, true), causes, RateNoise(first, {}), NoiseSize::unbiased);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    parts[k].coefficient = found.coefficients[k];
    parts[k].sigma = found.sigmas[k];
  }
  return parts;
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
      // An effect that does not show by itself knows no better than the diagnosis.
      if (!is_of_it(suspicion) || !effect.helps()) continue;
      suspicion.numbers.size = effect.coefficient;
      suspicion.numbers.sigma = effect.sigma;
    }
  }
}

} // namespace goingrate
