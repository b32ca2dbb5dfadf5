// goingrate monitor.
#pragma once

#include "common.hpp"

namespace goingrate::apps {

void add_monitor(CLI::App& program, const GlobalOptions& global);

} // namespace goingrate::apps
