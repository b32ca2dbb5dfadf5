#include "goingrate/causes/covariates.hpp"
#include "goingrate/causes/diagnosis.hpp"

#include "lag.hpp"
#include "rate_blocks.hpp"
#include "reading_errors.hpp"

#include "base/scaled_time.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

namespace goingrate {

namespace {

using namespace timing_model;

double mean_of(std::span<const double> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

/// How a covariate is assumed to act.
struct Action {
  double lag_s = 0.0; ///< 0: all of it acts at once
  /// Besides through the lag, at once: on a rod, and through the lag on its compensation; as
  /// buoyancy, and as friction, which the amplitude follows.
  bool also_at_once = false;
};

/// The regression of a rate on a covariate, at once or through a lag. The first cosine is left out:
/// taking off the line has emptied it.
class Regression {
public:
  Regression(std::span<const double> rate, std::span<const double> value, double block_s,
             bool is_weather)
      : rate_(cosines(rate, true)), value_(value), block_s_(block_s) {
    if (!is_weather) {
      settle({});
      find_sigmas();
      return;
    }
    const std::vector<double> shares = signal_shares(cosines(value, true));
    Candidate best = likeliest();
    shares_ = shares;
    if (Candidate inexact = likeliest(); inexact.score < best.score + price)
      best = std::move(inexact);
    else
      shares_.clear();
    settle_whole(best.action);
    find_sigmas();
    if (action_.lag_s > 0.0) widen_by_lags(best.with_two_ways);
  }

  /// The coefficient of all that the covariate does, once it has held for long.
  [[nodiscard]] double coefficient() const { return found_.coefficients.front(); }
  [[nodiscard]] double sigma() const { return found_.sigmas.front(); }
  [[nodiscard]] double lag_s() const { return action_.lag_s; }
  /// The part that acts at once, where another part follows later.
  [[nodiscard]] std::optional<EffectPart> at_once() const {
    if (!action_.also_at_once) return {};
    return EffectPart{EffectWay::at_once, found_.coefficients[1], found_.sigmas[1]};
  }
  /// The rate that other values of the covariate would make.
  [[nodiscard]] std::vector<double> rate_of(std::span<const double> value) const {
    std::vector<double> rate(value.size(), 0.0);
    const auto courses = courses_of(value);
    for (std::size_t k = 0; k < courses.size(); ++k)
      for (std::size_t i = 0; i < rate.size(); ++i)
        rate[i] += found_.coefficients[k] * courses[k][i];
    return rate;
  }

private:
  static constexpr double price = 8.0; // of 2 log L: for one more parameter, looked for on a grid
  struct Candidate {
    Action action;
    double score = 0.0;
    std::vector<RateRegression> with_two_ways{}; ///< for each lag that was tried
  };

  [[nodiscard]] Candidate likeliest() {
    settle({});
    Candidate best{{}, found_.deviance};
    std::vector<RateRegression> with_two_ways;
    for (const double lag_s : lags_to_try(rate_.size(), block_s_))
      for (const int twice : {0, 1}) {
        settle({lag_s, twice == 1});
        if (twice == 1) with_two_ways.push_back(found_);
        const double score = found_.deviance + price * (1.0 + twice);
        if (score < best.score) best = {action_, score};
      }
    best.with_two_ways = std::move(with_two_ways);
    return best;
  }

  // What lags in part acts at once in part, so far as the log does not tell otherwise: otherwise
  // two numbers that a daily wave tells, its size and its lateness, would pass for the whole.
  void settle_whole(Action action) {
    action.also_at_once = action.lag_s > 0.0;
    if (action.lag_s > 0.0)
      action.lag_s = refined_lag(action.lag_s, [&](double lag_s) {
        settle({lag_s, true});
        return found_.deviance;
      });
    settle(action);
  }

  // b (c through the lag) + b_at_once (c - c through the lag): b is what remains when c holds.
  [[nodiscard]] std::vector<std::vector<double>> courses_of(std::span<const double> value) const {
    std::vector<std::vector<double>> courses{lagged(value, block_s_, action_.lag_s)};
    if (!action_.also_at_once) return courses;
    std::vector<double> ahead(value.begin(), value.end());
    for (std::size_t i = 0; i < ahead.size(); ++i)
      ahead[i] -= courses.front()[i];
    courses.push_back(std::move(ahead));
    return courses;
  }

  // σ with the lag free: its course is one more cause, which at the best lag adds nothing.
  void find_sigmas() {
    std::vector<std::vector<double>> causes = cosines_of(courses_of(value_));
    const std::size_t own = causes.size();
    if (action_.lag_s > 0.0) {
      constexpr double step = 0.02; // relative: the course bends little over it
      std::vector<double> by_lag = lagged(value_, block_s_, action_.lag_s * (1.0 + step));
      const auto less = lagged(value_, block_s_, action_.lag_s * (1.0 - step));
      for (std::size_t i = 0; i < by_lag.size(); ++i)
        by_lag[i] -= less[i];
      causes.push_back(signal_of(cosines(by_lag, true)));
      causes.push_back(cosines(memory(value_.size(), block_s_, action_.lag_s), true));
    }
    const RateRegression with_lag = regress(rate_, causes, found_.noise, NoiseSize::unbiased);
    std::copy_n(with_lag.sigmas.begin(), own, found_.sigmas.begin());
  }

  // σ where the log tells little of the lag, by which the coefficients go along a bent ridge: so
  // wide that those of each lag lie within as many σ as the likelihood has that lag off, and those
  // of a lag within one σ with their own σ.
  void widen_by_lags(const std::vector<RateRegression>& with_two_ways) {
    constexpr double three_sigma = 9.0; // of 2 log L
    for (const RateRegression& other : with_two_ways) {
      const double behind = std::max(0.0, other.deviance - found_.deviance);
      if (behind > three_sigma) continue;
      for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
        const double away = std::abs(other.coefficients[k] - found_.coefficients[k]);
        const double sigma =
            behind > 1.0 ? away / std::sqrt(behind) : std::hypot(away, other.sigmas[k]);
        found_.sigmas[k] = std::max(found_.sigmas[k], sigma);
      }
    }
  }

  [[nodiscard]] std::vector<double> signal_of(std::vector<double> cosines) const {
    for (std::size_t k = 0; k < shares_.size(); ++k)
      cosines[k] *= shares_[k];
    return cosines;
  }

  [[nodiscard]] std::vector<std::vector<double>>
  cosines_of(const std::vector<std::vector<double>>& courses) const {
    std::vector<std::vector<double>> causes;
    for (const std::vector<double>& course : courses)
      causes.push_back(signal_of(cosines(course, true)));
    return causes;
  }

  void settle(const Action& action) {
    action_ = action;
    constexpr std::size_t first = 2;
    std::vector<std::vector<double>> causes = cosines_of(courses_of(value_));
    if (action.lag_s > 0.0)
      causes.push_back(cosines(memory(value_.size(), block_s_, action.lag_s), true));
    found_ = regress(rate_, causes, RateNoise(first, {}));
  }

  std::vector<double> rate_;
  std::span<const double> value_;
  std::vector<double> shares_; // of each cosine of the covariate that is no error; empty: all of it
  double block_s_;
  RateRegression found_;
  Action action_;
};

/// Rate and covariate in blocks, from the first to the last in which the covariate is known.
struct Answer {
  std::vector<double> rate, value;
  double block_s = 0.0;
  double known_share = 1.0;  ///< of the whole log
  double filled_share = 0.0; ///< of these blocks: straight lines over holes
};

// Whether a block is known, by the share of its beats that are.
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

HeldOut judged(
    const Answer& answer, std::size_t split, bool learn_first,
    const std::function<Regression(std::span<const double>, std::span<const double>)>& regression) {
  const std::size_t n = answer.rate.size();
  const auto part = [&](const std::vector<double>& x, bool first) {
    return first ? std::span(x).first(split) : std::span(x).last(n - split);
  };
  const Regression known =
      regression(part(answer.rate, learn_first), part(answer.value, learn_first));
  const auto caused = known.rate_of(answer.value);
  const double rate = mean_of(part(answer.rate, learn_first));
  const double mean = mean_of(part(caused, learn_first));
  HeldOut result;
  double without = 0.0, with = 0.0;
  const auto seen = part(answer.rate, !learn_first);
  const auto cause = part(caused, !learn_first);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    without += (seen[i] - rate) * answer.block_s;
    with += (seen[i] - rate - (cause[i] - mean)) * answer.block_s;
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

namespace {

// Blocks of a log. The tide of half a day needs short ones, and is so well known that many do no
// harm; other covariates are judged in blocks of which a thousand are enough.
RateBlocks blocks_for(const TimingData& data, bool of_tide) {
  constexpr std::size_t most_of_tide = 16384; // two hours in four years
  return rate_blocks(data, std::min(of_tide ? most_of_tide : most_blocks, data.size() / 8));
}

// An answer without the beginning of the log, where the swing may still settle: that is no answer
// to the weather, but a lag could be taken for it.
Answer without_start(Answer answer) {
  constexpr double start_share = 0.02; // of the log: some relaxation times of most clocks in a week
  const auto start =
      static_cast<std::ptrdiff_t>(start_share * static_cast<double>(answer.rate.size()));
  for (std::vector<double>* series : {&answer.rate, &answer.value})
    series->erase(series->begin(), series->begin() + start);
  return answer;
}

std::optional<CovariateEffect> effect_of(const RateTerm& term, const Answer& answer) {
  if (answer.rate.size() < least_blocks || !bends(answer.value)) return {};
  const auto regression = [&](std::span<const double> rate, std::span<const double> value) {
    const bool is_weather = term.name != "tide"; // the tide is known, and acts at once
    return Regression(rate, value, answer.block_s, is_weather);
  };
  const Regression all = regression(answer.rate, answer.value);
  const std::size_t half = answer.rate.size() / 2;
  const HeldOut second = judged(answer, half, true, regression);
  const HeldOut first = judged(answer, half, false, regression);
  CovariateEffect effect{term.name, term.unit, all.coefficient(), 0.0, all.lag_s()};
  const double widened = 1.0 / std::sqrt(1.0 - answer.filled_share);
  const double weakened = attenuation(answer, term);
  effect.sigma = std::hypot(all.sigma() * widened, all.coefficient() * weakened);
  if (auto part = all.at_once()) {
    part->sigma = std::hypot(part->sigma * widened, part->coefficient * weakened);
    effect.parts.push_back(*part);
  }
  effect.without_s = std::sqrt(0.5 * (first.without2 + second.without2));
  effect.with_s = std::sqrt(0.5 * (first.with2 + second.with2));
  effect.interpolation_sigma = term.sigma;
  effect.step_s = term.step_s;
  effect.known_share = answer.known_share;
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
    const bool of_tide = term.name == "tide";
    const Answer answer =
        of_tide ? answer_in(blocks_for(data, true), k) : without_start(answer_in(blocks, k));
    if (auto effect = effect_of(term, answer)) effects.push_back(std::move(*effect));
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
      if (!is_of_it(suspicion)) continue;
      suspicion.numbers.size = effect.coefficient;
      suspicion.numbers.sigma = effect.sigma;
    }
  }
}

} // namespace goingrate
