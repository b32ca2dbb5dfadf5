// Predicts the next beat from those so far: a Kalman filter of a clock's time and period.
#pragma once

#include "beat_noise.hpp"

#include <utility>

namespace goingrate {

/// Estimates the time of the last beat (free of its jitter) and the period, with their covariance,
/// under the noise of beat_noise.hpp. Times are kept relative to the last beat as it was seen, so
/// no digit is lost in a long log.
class ClockFilter {
public:
  /// Covariance of (time, period), s^2.
  struct Covariance {
    double tt = 0.0, tp = 0.0, pp = 0.0;
  };

  ClockFilter(const BeatNoise& noise, double period_s) : noise_(noise), period_(period_s) {}

  /// Begins at a beat whose neighbours are not known; `period_sigma_s` is how far off the period
  /// may be.
  void start(double period_sigma_s) { start(period_sigma_s, period_); }
  /// Begins with a period from elsewhere.
  void start(double period_sigma_s, double period_s) {
    period_ = period_s;
    offset_ = 0.0;
    doubted_ = {};
    covariance_ = {noise_.jitter2, 0.0, period_sigma_s * period_sigma_s};
  }

  /// The covariance n >= 1 cycles on.
  [[nodiscard]] Covariance after(double n) const { return after(n, noise_.rate_walk2); }
  /// The covariance n >= 1 cycles on, with another r^2 on the way.
  [[nodiscard]] Covariance after(double n, double rate_walk2) const {
    const Covariance& c = covariance_;
    const double squares = (n - 1.0) * (2.0 * n - 1.0) / 6.0; // 1^2 + ... + (n-1)^2, over n
    return {c.tt + n * (2.0 * c.tp + n * c.pp + noise_.walk2 + rate_walk2 * squares),
            c.tp + n * (c.pp + rate_walk2 * (n - 1.0) / 2.0), c.pp + n * rate_walk2};
  }

  /// Observed minus predicted time, s, of an event `elapsed_s` after the last beat, if that is n
  /// cycles.
  [[nodiscard]] double error(double elapsed_s, double n) const {
    return elapsed_s - offset_ - n * period_;
  }

  /// Variance of that error for a beat, s^2; `foreseen` from after(n).
  [[nodiscard]] double error_variance(const Covariance& foreseen) const {
    return foreseen.tt + noise_.jitter2;
  }

  /// Takes in a beat n cycles on. An error of more than four of its sigmas is a surprise: the clock
  /// has changed more than the noise allows, or the beat is false. Half of the change is then
  /// adopted in time and in period, so that a step of the rate is followed within some beats; if
  /// the next beat comes as predicted before the surprise, the surprise is forgotten. Returns
  /// whether this beat was a surprise.
  bool follow(double error_s, double n, Covariance foreseen) {
    double elapsed = error_s + offset_ + n * period_;
    if (doubted_.cycles > 0.0) {
      const Doubt doubt = std::exchange(doubted_, {});
      ClockFilter without(noise_, doubt.period);
      without.offset_ = doubt.offset;
      without.covariance_ = doubt.covariance;
      const double cycles = doubt.cycles + n;
      const auto expected = without.after(cycles);
      const double error = without.error(doubt.elapsed + elapsed, cycles);
      if (error * error <= 16.0 * error_variance(expected)) {
        *this = without;
        elapsed += doubt.elapsed;
        n = cycles;
        error_s = error;
        foreseen = expected;
      }
    }
    const double error2 = error_s * error_s;
    const bool surprise = error2 > 16.0 * error_variance(foreseen);
    if (surprise) {
      doubted_ = {elapsed, n, period_, offset_, covariance_};
      foreseen.tt += 2.0 * error2; // a displaced time, and a changed period's share in it
      foreseen.tp += error2 / n;
      foreseen.pp += error2 / (n * n);
    }
    take(error_s, foreseen, error_variance(foreseen));
    return surprise;
  }

  /// Takes in a beat one cycle on, if its error is no surprise, does not follow one, and
  /// `is_clear(error_s, variance)`; otherwise changes nothing. Returns whether it did. As follow(),
  /// but faster.
  template <class Clear> bool follow_plainly(double elapsed_s, const Clear& is_clear) {
    const double error_s = elapsed_s - offset_ - period_;
    const Covariance foreseen = after(1.0);
    const double variance = error_variance(foreseen);
    if (doubted_.cycles > 0.0 || error_s * error_s > 16.0 * variance || !is_clear(error_s, variance))
      return false;
    take(error_s, foreseen, variance);
    return true;
  }

  [[nodiscard]] double period() const { return period_; }
  /// The estimate of the last beat's time minus its time as seen, s.
  [[nodiscard]] double offset() const { return offset_; }
  [[nodiscard]] const Covariance& covariance() const { return covariance_; }

private:
  void take(double error_s, const Covariance& foreseen, double variance) {
    const double time_gain = foreseen.tt / variance;
    const double period_gain = foreseen.tp / variance;
    offset_ = (time_gain - 1.0) * error_s;
    period_ += period_gain * error_s;
    covariance_ = {time_gain * noise_.jitter2, period_gain * noise_.jitter2,
                   foreseen.pp - period_gain * foreseen.tp};
  }

  // The state before a surprise, and how far back its beat is.
  struct Doubt {
    double elapsed = 0.0, cycles = 0.0, period = 0.0, offset = 0.0;
    Covariance covariance;
  };

  BeatNoise noise_;
  double period_;
  double offset_ = 0.0;
  Covariance covariance_;
  Doubt doubted_; // cycles 0: none
};

} // namespace goingrate
