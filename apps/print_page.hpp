// A page as PDF.
#pragma once

#include <string>

namespace goingrate::apps {

/// Prints the HTML file `page` to the file `pdf` by a Chromium or Chrome found in PATH; false, and
/// no file, where there is none or it does not do so within a minute.
bool print_page(const std::string& page, const std::string& pdf);

} // namespace goingrate::apps
