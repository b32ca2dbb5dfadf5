// The decay of a free pendulum, from a ring-down.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace goingrate {

/// A value with the ends of its intervals; a high end is infinite where the log sets none. All NaN
/// where the log does not determine the value: sigma would be above a third of it.
struct DecayEstimate {
  double value = 0.0;
  double sigma = 0.0; ///< half the 68 % interval
  double low68 = 0.0, high68 = 0.0, low95 = 0.0, high95 = 0.0;
};

/// How far a pendulum swings from where it hangs; NaN where the log does not determine it.
struct TurningAngle {
  double rad = std::numeric_limits<double>::quiet_NaN();
  double sigma_rad = std::numeric_limits<double>::quiet_NaN(); ///< whichever law of friction
};

/// Q of swings of one amplitude.
struct QAtAmplitude {
  double amplitude_rad = 0.0; ///< turning angle
  DecayEstimate q{};
};

/// A law of friction, and its BIC for the log.
struct FrictionLaw {
  std::string friction; ///< "linear", "quadratic + dry" ...
  double bic = 0.0;
  double behind = 0.0; ///< its BIC less that of the best; 0 for the best
  /// The other parameters under this law; NaN if they are held or the law is not open.
  double T0_s = 0.0, T0_sigma_s = 0.0, lambda0 = 0.0, lambda0_sigma = 0.0;
  /// Its terms of friction, as the fit has them; 0 ± 0 for one that this law does not have, NaN if
  /// the law is not open.
  double epsilon = 0.0, epsilon_sigma = 0.0, quadratic_drag = 0.0, quadratic_drag_sigma = 0.0,
         dry_friction = 0.0, dry_friction_sigma = 0.0;

  /// The difference of BIC that excludes a law: odds of 20 to 1.
  static constexpr double decisive = 6.0;
  [[nodiscard]] bool is_open() const { return behind < decisive; }
};

/// The decay of a free swing.
///
/// Q(A) = 2 pi times the energy over its loss in a period (dynamics/swing_loss.hpp):
///   1/Q = 2 epsilon + (8/3 pi) k A + (4/pi) c/A   for small swings,
/// with linear friction epsilon, quadratic drag k and dry friction c, none below 0. No law is
/// assumed: all three terms are fitted, each free to be 0 or above, and the intervals are those of
/// the likelihood. They include the uncertainty of how the friction divides among the terms. The
/// 95 % intervals of Q hold the true value in 95 % of simulated logs (in 156 of 166 logs of angle
/// samples and photogates; tests/studies/ring_down.txt, RingDownStudy.ShortForm).
struct Decay {
  double amplitude_rad = 0.0; ///< geometric mean of the first and the last; `q` belongs to it
  DecayEstimate q{};
  DecayEstimate time_s{};                     ///< A/(-dA/dt) at that amplitude
  std::vector<QAtAmplitude> q_at_amplitude{}; ///< from the last amplitude of the log to the first
  std::vector<FrictionLaw> laws{};            ///< those that were tried, the best first
  TurningAngle first{}, last{};               ///< at the first beat of the log, and at the last

  /// Whether a second law explains the log nearly as well.
  [[nodiscard]] bool law_is_open() const;
};

} // namespace goingrate
