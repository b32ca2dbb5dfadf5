// Copies a numbered log, and turns one into bytes and back.
#pragma once

#include "goingrate/analysis/load.hpp"

#include <memory>
#include <string>
#include <string_view>

namespace goingrate::python {

/// A log is never changed once it is read, so many results may share one.
using SharedLog = std::shared_ptr<NumberedLog>;

/// A deep copy: its `good` points to beats of the copy, not of the original.
NumberedLog copy_of(const NumberedLog& loaded);

std::string bytes_of(const NumberedLog& loaded);
NumberedLog log_of(std::string_view bytes); ///< throws std::invalid_argument for bytes that
                                            ///< bytes_of() did not write

} // namespace goingrate::python
