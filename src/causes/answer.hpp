// The response of a series to a covariate, immediate and lagged. Private to the causes room.
#pragma once

#include "rate_blocks.hpp"

#include "goingrate/causes/covariates.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace goingrate::timing_model {

/// A series (rate or amplitude) and a covariate in blocks, from the first to the last block with a
/// known covariate.
struct AnswerBlocks {
  std::vector<double> series, value;
  double block_s = 0.0;
  double known_share = 1.0;  ///< of the whole log
  double filled_share = 0.0; ///< of these blocks: filled by straight lines across gaps
};
/// `series`: one value for each of the blocks.
AnswerBlocks answer_blocks(const RateBlocks& blocks, const std::vector<double>& series,
                           std::size_t term);
/// The blocks without the beginning of the log, where the amplitude may still settle: that could be
/// mistaken for a lagged response to the weather.
AnswerBlocks without_start(AnswerBlocks blocks);
/// Blocks in which a covariate is not known get the straight line between their neighbours.
void put_lines(const std::vector<double>& known, std::vector<double>& series);

/// The regression of a series on a covariate, immediate or lagged, whichever is more likely. The
/// first cosine is left out: subtracting the straight line has emptied it.
class Answer {
public:
  /// `is_weather`: the response may lag, and the readings may have errors.
  Answer(std::span<const double> series, std::span<const double> value, double block_s,
         bool is_weather);

  /// The coefficient of the whole response, once the covariate has been constant for long.
  [[nodiscard]] double coefficient() const { return found_.coefficients.front(); }
  [[nodiscard]] double sigma() const { return found_.sigmas.front(); }
  [[nodiscard]] double lag_s() const { return action_.lag_s; }
  /// The immediate part of the response, if another part lags.
  [[nodiscard]] std::optional<EffectPart> at_once() const;
  /// The response of the series to other values of the covariate.
  [[nodiscard]] std::vector<double> series_of(std::span<const double> value) const;

private:
  /// The form of the response.
  struct Action {
    double lag_s = 0.0; ///< 0: the whole response is immediate
    /// Part of the response is immediate and part lags. Examples: a rod, and its compensation;
    /// buoyancy, and friction, to which the amplitude adjusts slowly.
    bool also_at_once = false;
  };
  struct Candidate {
    Action action;
    double score = 0.0;
    std::vector<RateRegression> with_two_ways{}; ///< for each lag that was tried
  };

  [[nodiscard]] Candidate likeliest();
  void settle(const Action& action);
  void settle_whole(Action action);
  void find_sigmas();
  void widen_by_lags(const std::vector<RateRegression>& with_two_ways);
  [[nodiscard]] std::vector<std::vector<double>> courses_of(std::span<const double> value) const;
  [[nodiscard]] std::vector<double> signal_of(std::vector<double> cosines) const;
  [[nodiscard]] std::vector<std::vector<double>>
  cosines_of(const std::vector<std::vector<double>>& courses) const;

  std::vector<double> series_; // cosines
  std::span<const double> value_;
  std::vector<double> shares_; // signal_shares() of the covariate; empty: there are no errors
  double block_s_;
  RateRegression found_;
  Action action_;
};

} // namespace goingrate::timing_model
