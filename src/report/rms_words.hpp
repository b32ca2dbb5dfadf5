// An rms of the drive's split in words, with its interval. Private to the report.
#pragma once

#include "goingrate/drive/drive_split.hpp"

#include <functional>
#include <string>
#include <string_view>

namespace goingrate {

/// "0.3 s (0.2 to 0.5)", "at most 0.4 %" where the interval begins at 0, or that nothing bounds it;
/// `number` writes a number, which is `factor` times the value.
std::string rms_words(const RmsEstimate& rms, double factor, std::string_view unit,
                      const std::function<std::string(double)>& number);

} // namespace goingrate
