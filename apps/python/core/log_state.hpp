// A numbered log as one value: copied, and as bytes.
#pragma once

#include "goingrate/analysis/load.hpp"

#include <memory>
#include <string>
#include <string_view>

namespace goingrate::python {

/// A log is never changed once it is read, so many results may share one.
using SharedLog = std::shared_ptr<NumberedLog>;

/// A copy of all of it, whose `good` points into itself.
NumberedLog copy_of(const NumberedLog& loaded);

std::string bytes_of(const NumberedLog& loaded);
NumberedLog log_of(std::string_view bytes); ///< throws std::invalid_argument for other bytes

} // namespace goingrate::python
