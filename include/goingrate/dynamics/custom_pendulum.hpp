// A pendulum under any torque and friction that a user defines.
//
//   phi'' + sin phi = torque(phi, phi') - friction(phi, phi')      (Hoyng, end of sec. KBR)
//
// Integrated by Boost.odeint's Fehlberg 7(8) with error control; crossings and the angles at which
// the laws jump are found by Newton steps. The laws are black boxes, so this is slower and less
// exact than DirectPendulum, which uses the form of its laws. The averaged equations of the same
// laws: drive_moments(ForceLaw) in moments.hpp.
#pragma once

#include "goingrate/dynamics/moments.hpp"
#include "goingrate/dynamics/period_step.hpp"

#include <array>
#include <vector>

namespace goingrate {

/// The laws, both without memory, and the angles at which either jumps.
struct CustomLaws {
  ForceLaw torque;                   ///< along phi, scaled as mu
  ForceLaw friction;                 ///< against phi' > 0, scaled as 2 epsilon phi'
  std::vector<double> jumps{};       ///< rad; steps end there
  bool jumps_with_direction = false; ///< a law depends on the sign of phi': steps end at the apex
};

/// The pendulum between upward crossings.
///
/// Velocity and period to 1e-12 of direct integration for the laws that it knows too
/// (CustomPendulumTest.AgreesWithDirectIntegration, CustomPendulumTest.JumpsAreSteppedToNotOver);
/// about 20 us per period.
class CustomPendulum {
public:
  /// Starts at an upward crossing with phi' = `velocity` in (0, 2); throws ArgumentError otherwise.
  CustomPendulum(CustomLaws laws, double velocity);

  /// One period; stalled if the pendulum turns before it comes back to the vertical.
  PeriodStep advance();
  /// phi' at the last crossing.
  [[nodiscard]] double velocity() const { return state_[1]; }

private:
  using State = std::array<double, 2>; // phi, phi'
  [[nodiscard]] State step(const State& from, double h) const;
  [[nodiscard]] double acceleration(const State& state) const;
  [[nodiscard]] double time_to(double target, std::size_t of, double h) const;
  SwingStatus to_vertical(bool upward, double& excess);
  void enter_stretch(bool rightwards);

  CustomLaws laws_;
  State state_;
  bool rightwards_ = true;
  double low_ = 0.0, high_ = 0.0; // between which the laws do not jump
};

} // namespace goingrate
