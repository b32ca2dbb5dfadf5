// Q at the amplitudes of a ring-down, whichever law of friction. Private to the fit room.
#pragma once

#include "every_friction.hpp"

#include "goingrate/fit/decay.hpp"

namespace goingrate::timing_model {

/// An estimate for a quantity that the log does not determine.
DecayEstimate nothing_known();

/// Q as a function of the amplitude, from a fit with every term of friction. `all` must outlive it.
class QualityCurve {
public:
  QualityCurve(const Fitted& all, const Evaluation& at) : all_(all), cone_(cone_of(all, at)) {}

  /// Whether the full equation agrees with the result at this amplitude.
  [[nodiscard]] bool holds_by_dynamics(double amplitude) const;
  /// `factor` times Q.
  [[nodiscard]] DecayEstimate at(double amplitude, double factor = 1.0) const;
  /// The amplitude at one end of the fitted swing.
  [[nodiscard]] TurningAngle swing(double Span::*end) const;

private:
  // 1/Q = weights . coordinates + held.
  struct Loss {
    Eigen::VectorXd weights;
    double held = 0.0; // the part of 1/Q from the terms that are not free
  };
  [[nodiscard]] Loss loss_at(double amplitude) const;

  const Fitted& all_;
  FrictionCone cone_;
};

} // namespace goingrate::timing_model
