// Files that are embedded in the library and copied into the page.
#pragma once

#include <string_view>

namespace goingrate {

/// plotly.js as it came from the npm registry (MIT licence, named in its first lines); empty if the
/// build could not fetch it. Contains no "</script".
std::string_view plotly_script();

/// page_series.js: the functions with which page.js unpacks and thins numbers; must come before it.
std::string_view series_script();

/// page.js: draws the figures of a page with plotly.js.
std::string_view page_script();

} // namespace goingrate
