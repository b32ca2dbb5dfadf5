#include "impulse_words.hpp"

#include "fit/push_shapes.hpp"

#include "goingrate/report/tables.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate {

std::string how_often(const ImpulseCycle& pushes) {
  if (pushes.is_regular) return fmt::format("once every {:.0f} swings", pushes.periods);
  return fmt::format(
      "about every {:.3g} swings, as if whenever its amplitude has fallen to a limit",
      pushes.periods);
}

std::string quality_of(const ImpulseCycle& pushes) {
  const double q = 0.5 / pushes.epsilon->value;
  return with_sigma(q, q * pushes.epsilon->sigma / pushes.epsilon->value);
}

std::string impulse_text(const ImpulseCycle& pushes, const DisplayUnit& angle) {
  std::string text =
      fmt::format("  the pendulum is pushed {}; its saw-tooth was taken off, and what is fitted is "
                  "the mean drive\n",
                  how_often(pushes));
  if (pushes.amplitude_step)
    text += fmt::format("  a push raises the amplitude by {} {}\n",
                        with_sigma(angle.factor * pushes.amplitude_step->value,
                                   angle.factor * pushes.amplitude_step->sigma),
                        angle.name);
  const auto microseconds = [](const ImpulseCycle::Estimate& e) {
    return with_sigma(1e6 * std::abs(e.value), 1e6 * e.sigma);
  };
  const ImpulseCycle::Estimate kick = push_shapes::kick_alone(pushes);
  const std::string set =
      fmt::format("{} µs {}\n", microseconds(kick), kick.value < 0.0 ? "ahead" : "back");
  text +=
      pushes.periods > 2.0
          ? fmt::format("  half-way between two pushes the clock is {} µs {} by the circular "
                        "error; each push by itself sets it {}",
                        microseconds(pushes.lateness),
                        pushes.lateness.value < 0.0 ? "ahead" : "late", set)
          : fmt::format(
                "  each push, with its effect through the circular error, sets the clock {}", set);
  constexpr double seen = 4.0; // sigma: more is taken as real
  if (std::abs(pushes.middle.value) > seen * pushes.middle.sigma)
    text += fmt::format("  the crossing in the midst of a push comes {} µs {}\n",
                        microseconds(pushes.middle), pushes.middle.value < 0.0 ? "early" : "late");
  if (pushes.epsilon)
    text +=
        fmt::format("  if nothing else drives it: ε = {}, Q = {}\n",
                    with_sigma(pushes.epsilon->value, pushes.epsilon->sigma), quality_of(pushes));
  return text;
}

} // namespace goingrate
