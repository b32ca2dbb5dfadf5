// Causes in words that a clock's keeper knows. Private to the report.
#pragma once

#include "wording.hpp"

#include <string>
#include <string_view>

namespace goingrate {

/// The name of the cause in a list of several: "a change of the regulation".
std::string_view owners_name(Cause cause);

/// What a change of the drive changes, if nothing more is known of it.
inline constexpr std::string_view driving_force = "the force that drives the pendulum";

/// One sentence: what is seen, its most likely cause, and the causes that the log cannot tell from
/// it. For a step whose rates were given before, `when` refers to its moment, such as "then"; if it
/// is empty, the sentence gives moment and size. `drive` is what a change of the drive changed.
std::string explanation(const Suspicion& suspicion, const Wording& words, bool sees_amplitude,
                        std::string_view when = {},
                        std::string_view drive = driving_force);

} // namespace goingrate
