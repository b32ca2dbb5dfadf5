// Causes in the words of a clock's keeper. Private to the report.
#pragma once

#include "wording.hpp"

#include <string>
#include <string_view>

namespace goingrate {

/// What the cause is called where it is one of several: "a change of the regulation".
std::string_view owners_name(Cause cause);

/// One sentence: what is seen, what most likely makes it, and from what the log cannot tell that.
/// `when` stands for the moment of a step whose rates were told before, such as "then"; empty: the
/// sentence has moment and size.
std::string explanation(const Suspicion& suspicion, const Wording& words, bool sees_amplitude,
                        std::string_view when = {});

} // namespace goingrate
