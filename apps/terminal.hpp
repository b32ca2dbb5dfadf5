// What standard error looks like on a terminal.
#pragma once

#include <string>
#include <string_view>

namespace goingrate::apps {

/// Whether somebody reads standard error as it comes.
bool error_is_terminal();

enum class Paint { error, warning, note };

/// The text in the colour of its kind where standard error is a terminal that shows colours;
/// unchanged elsewhere, and where NO_COLOR (https://no-color.org) is set and not empty.
std::string painted(std::string_view text, Paint paint);

} // namespace goingrate::apps
