// The answer of a series to a covariate, at once and through a lag. Private to the causes room.
#pragma once

#include "rate_blocks.hpp"

#include "goingrate/causes/covariates.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace goingrate::timing_model {

/// A series (the rate, the amplitude) and a covariate in blocks, from the first to the last in
/// which the covariate is known.
struct AnswerBlocks {
  std::vector<double> series, value;
  double block_s = 0.0;
  double known_share = 1.0;  ///< of the whole log
  double filled_share = 0.0; ///< of these blocks: straight lines over holes
};
/// `series`: one value for each of the blocks.
AnswerBlocks answer_blocks(const RateBlocks& blocks, const std::vector<double>& series,
                           std::size_t term);
/// Without the beginning of the log, where the swing may still settle: that is no answer to the
/// weather, but a lag could be taken for it.
AnswerBlocks without_start(AnswerBlocks blocks);
/// Blocks in which a covariate is not known get the straight line between their neighbours.
void put_lines(const std::vector<double>& known, std::vector<double>& series);

/// The regression of a series on a covariate, at once or through a lag, whichever is likelier. The
/// first cosine is left out: taking off the line has emptied it.
class Answer {
public:
  /// `is_weather`: it may lag, and its readings may err.
  Answer(std::span<const double> series, std::span<const double> value, double block_s,
         bool is_weather);

  /// The coefficient of all that the covariate does, once it has held for long.
  [[nodiscard]] double coefficient() const { return found_.coefficients.front(); }
  [[nodiscard]] double sigma() const { return found_.sigmas.front(); }
  [[nodiscard]] double lag_s() const { return action_.lag_s; }
  /// The part that acts at once, where another part follows later.
  [[nodiscard]] std::optional<EffectPart> at_once() const;
  /// The series that other values of the covariate would make.
  [[nodiscard]] std::vector<double> series_of(std::span<const double> value) const;

private:
  /// How the covariate is assumed to act.
  struct Action {
    double lag_s = 0.0; ///< 0: all of it acts at once
    /// Besides through the lag, at once: on a rod, and through the lag on its compensation; as
    /// buoyancy, and as friction, which the amplitude follows.
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
  std::vector<double> shares_; // of each cosine of the covariate that is no error; empty: all of it
  double block_s_;
  RateRegression found_;
  Action action_;
};

} // namespace goingrate::timing_model
