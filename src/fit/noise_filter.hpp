// The likelihood of a log under drive noise, by a Kalman filter. Private to the fit room.
//
// State at upward crossing n, as departures from the undisturbed course of the clock:
//   t  lateness of the clock, s
//   w  departure of the squared amplitude, rad^2
//   s  slow part of the relative drive
// Over one cycle, with the relative drive u = d + s (d white, rms sigma_d) and the gains of
// cycle_response.hpp:
//   w' = kept w + raised u
//   t' = t + follow w + kick u + (walk)
//   s' = r s + (noise),                   r = exp(-T0/slow_time)
// The observations are t + jitter and the turning angle, H w + noise. Over k cycles without a beat
// the matrices of one cycle are combined by doubling. A beat costs a fixed number of operations, so
// a log of N beats costs O(N); once the covariance is constant, only the state is advanced.
//
// Where the log shows the amplitude more closely than it scatters about the course, second-order
// effects matter: the extended filter evaluates the gains at the estimated amplitude, adds to the
// mean half the second derivatives times the mean squares, and to the covariance that of these
// second-order terms (second-order extended Kalman filter: Jazwinski 1970, ch. 9).
// The first time sets the lateness without an innovation, because no time is predicted for it
// (exact diffuse start). The first amplitude scatters about the course like all others. If it were
// held to the course, clocks whose inverse response grows (slow gain of the opposite sign) would
// fit it to absurd precision and be preferred.
#pragma once

#include "clock_model.hpp"
#include "cycle_response.hpp"
#include "turning_angle.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

// Inlines all that a beat calls into one body. With a sanitizer's checks that body would take half
// an hour to compile.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define GOINGRATE_INLINED
#else
#define GOINGRATE_INLINED [[gnu::flatten]]
#endif

namespace goingrate::timing_model {

/// Sizes of the noise; 0 for absent kinds.
template <class T> struct NoiseSizes {
  T jitter{}, walk{}, drive{}, slow{}, slow_time{}, amplitude{};
};

/// Difference of one observation from its prediction, and its variance.
template <class T> struct Innovation {
  T value{};
  T variance{};
};

/// The filter with D = 2 (t, w) or 3 (t, w, s) states.
template <class T, std::size_t D> class NoiseFilter {
public:
  /// `extended`: whether second-order terms are included.
  explicit NoiseFilter(const NoiseSizes<T>& noise, bool extended = false)
      : noise_(noise), extended_(extended) {}

  /// Starts at the first beat: its lateness is unknown beforehand, while amplitude and slow drive
  /// have their stationary spread about the course, as in a clock that has long been running.
  void start(const Sight<T>& sight, const ResponseAt& response, const T& late) {
    state_ = {};
    covariance_ = {};
    state_[0] = late;
    covariance_[0][0] = noise_.jitter * noise_.jitter;
    const Step step = cycle_on_course(sight, response);
    const T& kept = step.transition[1][1];
    T spread = step.noise[1][1];
    if constexpr (D == 3) {
      const T &raised = step.transition[1][2], &memory = step.transition[2][2];
      const T slow2 = noise_.slow * noise_.slow;
      const T shared = memory * raised * slow2 / (T(1.0) - memory * kept);
      covariance_[2][2] = slow2;
      covariance_[1][2] = covariance_[2][1] = shared;
      spread += raised * raised * slow2 + kept * raised * shared * 2.0;
    }
    covariance_[1][1] = spread / ((T(1.0) - kept) * (kept + 1.0));
    step_ = {};
  }

  /// Advances by `cycles`; sight and response are those of the beat at their end.
  GOINGRATE_INLINED void pass(const Sight<T>& sight, const ResponseAt& response, double cycles) {
    // While they pass, the amplitude hardly returns to the course, so that the gains at their start
    // serve them all; longer gaps are rare.
    constexpr double most_alike_cycles = 8.0;
    if (extended_ && cycles <= most_alike_cycles) return pass_extended(sight, response, cycles);
    const bool known = sight.settled && kept_cycles_ == cycles && kept_settled_;
    if (!known) {
      step_ = over(cycle_on_course(sight, response), cycles);
      frozen_ = false;
    }
    kept_cycles_ = cycles;
    kept_settled_ = sight.settled;
    state_ = times(step_.transition, state_);
    if (frozen_) return;
    covariance_ = spread(step_.transition, covariance_);
    add(covariance_, step_.noise);
  }

  /// Corrects the state by the time of the beat, given as its lateness.
  GOINGRATE_INLINED Innovation<T> see_time(const T& late) {
    const T value = late - state_[0];
    if (!frozen_) {
      variance_ = covariance_[0][0] + noise_.jitter * noise_.jitter;
      const T precision = T(1.0) / variance_;
      std::array<T, D> shared;
      for (std::size_t i = 0; i < D; ++i) {
        shared[i] = covariance_[i][0];
        gain_[i] = shared[i] * precision;
      }
      take_away(gain_, shared);
      const std::array<double, D> before = last_;
      for (std::size_t i = 0; i < D; ++i)
        last_[i] = plain(gain_[i]);
      settle(before);
    }
    for (std::size_t i = 0; i < D; ++i)
      state_[i] += gain_[i] * value;
    return {value, variance_};
  }

  /// Corrects the state by the amplitude of the beat. `excess` is the observed amplitude less that
  /// of the course, `scale` the amplitude in the log's column over that of the pendulum,
  /// `relative2` the variance of this amplitude over that of all.
  GOINGRATE_INLINED Innovation<T> see_amplitude(const Sight<T>& sight, const ResponseAt& response,
                                                const T& excess, const T& scale, double relative2) {
    const T power = noise_.amplitude * noise_.amplitude * relative2;
    frozen_ = false; // an amplitude changes the covariance, and so the gain for times
    still_ = 0;
    T value = excess, slope, variance;
    if (extended_) {
      const TurningAngle seen = turning_angle_seen(sight, response, excess, scale, power);
      value = seen.value;
      slope = seen.slope;
      variance = seen.variance;
    } else {
      slope = scale * slope_of_turning_angle(*sight.laws, response.speed2_of(sight.amplitude2));
      value -= slope * state_[1];
      variance = slope * slope * covariance_[1][1] + power;
    }
    const T precision = T(1.0) / variance;
    std::array<T, D> shared, gain;
    for (std::size_t i = 0; i < D; ++i) {
      shared[i] = covariance_[i][1] * slope;
      gain[i] = shared[i] * precision;
    }
    take_away(gain, shared);
    for (std::size_t i = 0; i < D; ++i)
      state_[i] += gain[i] * value;
    return {value, variance};
  }

private:
  using Matrix = std::array<std::array<T, D>, D>;
  struct Step {
    Matrix transition{};
    Matrix noise{};
    std::array<T, D> shift{}; // of the state, besides what the transition makes of it
  };

  static std::array<T, D> times(const Matrix& a, const std::array<T, D>& v) {
    std::array<T, D> result;
    result[0] = v[0] + a[0][1] * v[1];
    result[1] = a[1][1] * v[1];
    if constexpr (D == 3) {
      result[0] += a[0][2] * v[2];
      result[1] += a[1][2] * v[2];
      result[2] = a[2][2] * v[2];
    }
    return result;
  }
  // a b for upper triangular matrices.
  static Matrix times(const Matrix& a, const Matrix& b) {
    Matrix result{};
    for (std::size_t i = 0; i < D; ++i)
      for (std::size_t k = i; k < D; ++k)
        for (std::size_t j = i; j <= k; ++j)
          result[i][k] += a[i][j] * b[j][k];
    return result;
  }
  // a p a' for a transition a, upper triangular with 1 for the times, and a symmetric p.
  static Matrix spread(const Matrix& a, const Matrix& p) {
    Matrix half, result; // the upper half of a p
    for (std::size_t i = 0; i < D; ++i)
      for (std::size_t k = i; k < D; ++k) {
        half[i][k] = i == 0 ? p[i][k] : a[i][i] * p[i][k];
        for (std::size_t j = i + 1; j < D; ++j)
          half[i][k] += a[i][j] * p[j][k];
      }
    for (std::size_t i = 0; i < D; ++i)
      for (std::size_t k = i; k < D; ++k) {
        result[i][k] = k == 0 ? half[i][k] : half[i][k] * a[k][k];
        for (std::size_t j = k + 1; j < D; ++j)
          result[i][k] += half[i][j] * a[k][j];
        result[k][i] = result[i][k];
      }
    return result;
  }
  // Reduces the covariance by an observation: gain times covariance of state and observation.
  void take_away(const std::array<T, D>& gain, const std::array<T, D>& shared) {
    for (std::size_t i = 0; i < D; ++i)
      for (std::size_t k = 0; k <= i; ++k)
        covariance_[k][i] = covariance_[i][k] = covariance_[i][k] - gain[i] * shared[k];
  }
  static std::array<T, D> plus(std::array<T, D> a, const std::array<T, D>& b) {
    for (std::size_t i = 0; i < D; ++i)
      a[i] += b[i];
    return a;
  }
  static void add(Matrix& to, const Matrix& what) {
    for (std::size_t i = 0; i < D; ++i)
      for (std::size_t k = 0; k < D; ++k)
        to[i][k] += what[i][k];
  }

  // A departure of the squared amplitude from the course. A poorly known amplitude may appear to
  // lie at the escapement, where no gains exist, so the departure is kept short of it.
  static T kept_outside(const Sight<T>& sight, const ResponseAt& response, const T& w) {
    constexpr double largest_step_share = 0.9;
    const T farthest = (sight.laws->phi0 * sight.laws->phi0 - sight.amplitude2 - response.shift) *
                       largest_step_share;
    return w < farthest ? farthest : w;
  }

  struct TurningAngle {
    T value, variance; // of the innovation
    T slope;
  };
  // The extended filter linearises about the amplitude estimated with this observation (iterated
  // extended Kalman filter: Jazwinski 1970, ch. 8), and adds half the second derivative, for small
  // angles, times the variance that remains. An amplitude that is well known, as after the first
  // beats, needs no iteration.
  [[nodiscard]] TurningAngle turning_angle_seen(const Sight<T>& sight, const ResponseAt& response,
                                                const T& excess, const T& scale,
                                                const T& power) const {
    const T on_course = response.speed2_of(sight.amplitude2);
    const T angle_on_course = turning_angle_at(*sight.laws, on_course);
    const T foreseen = kept_outside(sight, response, state_[1]);
    constexpr int most_steps = 4;          // each squares the error
    constexpr double settled_share = 0.01; // of the noise: the bend may add as much
    T at = foreseen;
    TurningAngle seen;
    for (int step = 0; step < most_steps; ++step) {
      const T there = on_course + at;
      seen.slope = scale * slope_of_turning_angle(*sight.laws, there);
      seen.variance = seen.slope * seen.slope * covariance_[1][1] + power;
      const T left = covariance_[1][1] * power / seen.variance;
      seen.value = excess + scale * (angle_on_course - turning_angle_at(*sight.laws, there)) +
                   seen.slope * (at - foreseen) + seen.slope / there * left * 0.25;
      const double bend = plain(seen.slope) / plain(there) * plain(covariance_[1][1]) * 0.25;
      if (bend <= settled_share * std::sqrt(plain(power))) break;
      at = kept_outside(sight, response,
                        T(foreseen + covariance_[1][1] * seen.slope / seen.variance * seen.value));
    }
    return seen;
  }

  // One cycle of a clock with these gains.
  [[nodiscard]] Step cycle(const T& T0, const CycleGains<T>& gains) const {
    using std::exp, std::expm1;
    const T &gone = gains.gone, &raised = gains.raised, &follow = gains.follow, &kick = gains.kick;
    Step step;
    step.transition[0][0] = T(1.0);
    step.transition[0][1] = follow;
    step.transition[1][1] = gone + 1.0;
    const T power = noise_.drive * noise_.drive;
    step.noise[0][0] = power * kick * kick + noise_.walk * noise_.walk;
    step.noise[0][1] = step.noise[1][0] = power * kick * raised;
    step.noise[1][1] = power * raised * raised;
    if constexpr (D == 3) {
      const T lag = T0 / noise_.slow_time * -1.0;
      step.transition[0][2] = kick;
      step.transition[1][2] = raised;
      step.transition[2][2] = exp(lag);
      step.noise[2][2] = noise_.slow * noise_.slow * expm1(lag * 2.0) * -1.0;
    }
    return step;
  }
  [[nodiscard]] Step cycle_on_course(const Sight<T>& sight, const ResponseAt& response) const {
    return cycle(sight.T0, response.there(*sight.laws, sight.amplitude2, sight.T0, T(0.0)).gains);
  }

  // Advances by cycles of the same gains. The mean first accounts for the departure of the
  // amplitude from the course, then for that of the drive; the covariance uses the gains with both
  // departures.
  GOINGRATE_INLINED void pass_extended(const Sight<T>& sight, const ResponseAt& response,
                                       double cycles) {
    const T end = kept_outside(sight, response, state_[1]);
    const auto [grown, late] = response.passed(*sight.laws, sight.amplitude2, sight.T0, end);
    auto [there, of_amplitude2, of_late] =
        response.there(*sight.laws, sight.amplitude2, sight.T0, end);
    const T w2 = covariance_[1][1];
    T product = T(0.0), u2 = noise_.drive * noise_.drive, of_mean = T(0.0);
    std::array<T, D> next;
    next[0] = state_[0] + late;
    next[1] = state_[1] + grown;
    if constexpr (D == 3) {
      const T& s = state_[2];
      next[0] += there.kick * s;
      next[1] += there.raised * s;
      product = covariance_[1][2];
      u2 += covariance_[2][2];
      of_mean = s * s;
      there.gone += s * of_amplitude2.wu;
      there.raised += s * of_amplitude2.uu * 2.0;
      there.follow += s * there.follow_by_drive;
      there.kick += s * of_late.uu * 2.0;
    }
    next[0] += of_late.of(w2, product, u2 + of_mean);
    next[1] += of_amplitude2.of(w2, product, u2 + of_mean);
    Step step = cycle(sight.T0, there);
    step.noise[0][0] += of_late.covariance(of_late, w2, product, u2);
    step.noise[0][1] += of_late.covariance(of_amplitude2, w2, product, u2);
    step.noise[1][0] = step.noise[0][1];
    step.noise[1][1] += of_amplitude2.covariance(of_amplitude2, w2, product, u2);
    if constexpr (D == 3) next[2] = step.transition[2][2] * state_[2];
    if (cycles > 1.0) {
      const std::array<T, D> carried = times(step.transition, state_);
      for (std::size_t i = 0; i < D; ++i)
        step.shift[i] = next[i] - carried[i];
      step = over(step, cycles);
      next = plus(times(step.transition, state_), step.shift);
    }
    state_ = next;
    covariance_ = spread(step.transition, covariance_);
    add(covariance_, step.noise);
  }

  // Combines `cycles` equal cycles, by doubling: the bits of their number below the highest one say
  // where one more is added.
  [[nodiscard]] Step over(const Step& one, double cycles) const {
    const auto count = static_cast<std::uint64_t>(cycles);
    Step total = one;
    for (std::uint64_t bit = std::bit_floor(count) / 2; bit > 0; bit /= 2) {
      total = joined(total, total);
      if ((count & bit) != 0) total = joined(one, total);
    }
    return total;
  }
  // `first` followed by `second`.
  static Step joined(const Step& second, const Step& first) {
    Step both{times(second.transition, first.transition), spread(second.transition, first.noise),
              plus(times(second.transition, first.shift), second.shift)};
    add(both.noise, second.noise);
    return both;
  }

  // The gain is taken as constant once three beats in a row, on a settled course, change it by less
  // than rounding would.
  void settle(const std::array<double, D>& before) {
    constexpr double relative_rounding = 1e-13;
    bool same = kept_settled_;
    for (std::size_t i = 0; i < D; ++i)
      same = same && std::abs(last_[i] - before[i]) <= relative_rounding * std::abs(last_[i]);
    still_ = same ? still_ + 1 : 0;
    frozen_ = still_ >= 3;
  }

  NoiseSizes<T> noise_;
  bool extended_;
  std::array<T, D> state_{};
  Matrix covariance_{};
  Step step_;
  std::array<T, D> gain_{};
  T variance_{};
  std::array<double, D> last_{};
  double kept_cycles_ = -1.0;
  bool kept_settled_ = false;
  bool frozen_ = false;
  int still_ = 0;
};

} // namespace goingrate::timing_model
