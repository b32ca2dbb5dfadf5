#include "answer.hpp"

#include "lag.hpp"
#include "reading_errors.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace goingrate::timing_model {

namespace {

constexpr double price = 8.0; // in 2 log L, of one more parameter that is searched on a grid

// Whether a block is known, by the share of its beats that are.
bool is_known(double share) { return share > 0.5; }

} // namespace

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

AnswerBlocks answer_blocks(const RateBlocks& blocks, const std::vector<double>& series,
                           std::size_t term) {
  AnswerBlocks result{series, blocks.values[term], blocks.length_s};
  const std::vector<double>& known = blocks.known[term];
  if (known.empty()) return result;
  const auto first = std::find_if(known.begin(), known.end(), is_known) - known.begin();
  const auto last = std::find_if(known.rbegin(), known.rend(), is_known).base() - known.begin();
  for (std::vector<double>* part : {&result.series, &result.value}) {
    put_lines(known, *part);
    *part = {part->begin() + first, part->begin() + std::max(first, last)};
  }
  const auto blocks_known =
      static_cast<double>(std::count_if(known.begin(), known.end(), is_known));
  result.known_share = blocks_known / static_cast<double>(known.size());
  const auto blocks_taken = static_cast<double>(std::max<std::size_t>(1, result.series.size()));
  result.filled_share = 1.0 - blocks_known / blocks_taken;
  return result;
}

AnswerBlocks without_start(AnswerBlocks blocks) {
  constexpr double start_share = 0.02; // of the log: of a week, several times what most clocks take
  const auto start =
      static_cast<std::ptrdiff_t>(start_share * static_cast<double>(blocks.series.size()));
  for (std::vector<double>* part : {&blocks.series, &blocks.value})
    part->erase(part->begin(), part->begin() + start);
  return blocks;
}

Answer::Answer(std::span<const double> series, std::span<const double> value, double block_s,
               bool is_weather)
    : series_(cosines(series, true)), value_(value), block_s_(block_s) {
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

std::optional<EffectPart> Answer::at_once() const {
  if (!action_.also_at_once) return {};
  return EffectPart{EffectWay::at_once, found_.coefficients[1], found_.sigmas[1]};
}

std::vector<double> Answer::series_of(std::span<const double> value) const {
  std::vector<double> series(value.size(), 0.0);
  const auto courses = courses_of(value);
  for (std::size_t k = 0; k < courses.size(); ++k)
    for (std::size_t i = 0; i < series.size(); ++i)
      series[i] += found_.coefficients[k] * courses[k][i];
  return series;
}

Answer::Candidate Answer::likeliest() {
  settle({});
  Candidate best{{}, found_.deviance};
  std::vector<RateRegression> with_two_ways;
  for (const double lag_s : lags_to_try(series_.size(), block_s_))
    for (const int twice : {0, 1}) {
      settle({lag_s, twice == 1});
      if (twice == 1) with_two_ways.push_back(found_);
      const double score = found_.deviance + price * (1.0 + twice);
      if (score < best.score) best = {action_, score};
    }
  best.with_two_ways = std::move(with_two_ways);
  return best;
}

// A lagged response is fitted with an immediate part unless the log excludes one. A daily wave
// determines only two numbers, its size and its delay, and a lag alone would seem to explain both.
void Answer::settle_whole(Action action) {
  action.also_at_once = action.lag_s > 0.0;
  if (action.lag_s > 0.0)
    action.lag_s = refined_lag(action.lag_s, [&](double lag_s) {
      settle({lag_s, true});
      return found_.deviance;
    });
  settle(action);
}

// b (lagged c) + b_at_once (c - lagged c): b is the response once c has been constant for long.
std::vector<std::vector<double>> Answer::courses_of(std::span<const double> value) const {
  std::vector<std::vector<double>> courses{lagged(value, block_s_, action_.lag_s)};
  if (!action_.also_at_once) return courses;
  std::vector<double> ahead(value.begin(), value.end());
  for (std::size_t i = 0; i < ahead.size(); ++i)
    ahead[i] -= courses.front()[i];
  courses.push_back(std::move(ahead));
  return courses;
}

// σ with the lag free: the derivative with respect to the lag is fitted as one more course, whose
// size at the best lag is zero.
void Answer::find_sigmas() {
  std::vector<std::vector<double>> causes = cosines_of(courses_of(value_));
  const std::size_t own = causes.size();
  if (action_.lag_s > 0.0) {
    constexpr double step = 0.02; // relative: the course is nearly linear in the lag over it
    std::vector<double> by_lag = lagged(value_, block_s_, action_.lag_s * (1.0 + step));
    const auto less = lagged(value_, block_s_, action_.lag_s * (1.0 - step));
    for (std::size_t i = 0; i < by_lag.size(); ++i)
      by_lag[i] -= less[i];
    causes.push_back(signal_of(cosines(by_lag, true)));
    causes.push_back(cosines(memory(value_.size(), block_s_, action_.lag_s), true));
  }
  const RateRegression with_lag = regress(series_, causes, found_.noise, NoiseSize::unbiased);
  std::copy_n(with_lag.sigmas.begin(), own, found_.sigmas.begin());
}

// σ where the log hardly determines the lag, so that the likelihood has a curved ridge over lag and
// coefficients. It is so wide that the coefficients at each lag lie within as many σ as the
// likelihood puts that lag from the best, and those at a lag within one σ with their own σ added.
void Answer::widen_by_lags(const std::vector<RateRegression>& with_two_ways) {
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

std::vector<double> Answer::signal_of(std::vector<double> cosines) const {
  for (std::size_t k = 0; k < shares_.size(); ++k)
    cosines[k] *= shares_[k];
  return cosines;
}

std::vector<std::vector<double>>
Answer::cosines_of(const std::vector<std::vector<double>>& courses) const {
  std::vector<std::vector<double>> causes;
  for (const std::vector<double>& course : courses)
    causes.push_back(signal_of(cosines(course, true)));
  return causes;
}

void Answer::settle(const Action& action) {
  action_ = action;
  constexpr std::size_t first = 2; // the mean and the line
  std::vector<std::vector<double>> causes = cosines_of(courses_of(value_));
  if (action.lag_s > 0.0)
    causes.push_back(cosines(memory(value_.size(), block_s_, action.lag_s), true));
  found_ = regress(series_, causes, RateNoise(first, {}));
}

} // namespace goingrate::timing_model
