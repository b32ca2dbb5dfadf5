// The rms values of a DriveSplit in words, the same in the text and page reports. Private to the
// report.
#pragma once

#include "goingrate/drive/drive_split.hpp"

#include <functional>
#include <string>
#include <string_view>

namespace goingrate {

/// An rms and its 68 % interval, such as "0.3 s (0.2 to 0.5)". If the interval begins at 0, only
/// its upper limit is given: "at most 0.4 %", or, without an upper limit, words to say that any
/// size is possible. "not known" if the rms is NaN. Values are multiplied by `factor`, which
/// converts them to `unit`, and formatted by `number`.
std::string rms_words(const RmsEstimate& rms, double factor, std::string_view unit,
                      const std::function<std::string(double)>& number);

} // namespace goingrate
