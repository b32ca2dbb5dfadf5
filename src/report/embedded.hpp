// Files that are part of the library, for the page to hold.
#pragma once

#include <string_view>

namespace goingrate {

/// plotly.js as it came from the npm registry (MIT licence, named at its head); empty if the build
/// could not fetch it. Holds no "</script".
std::string_view plotly_script();

/// page_series.js: what page.js does with numbers; must come before it.
std::string_view series_script();

/// page.js: what draws the figures of a page with it.
std::string_view page_script();

} // namespace goingrate
