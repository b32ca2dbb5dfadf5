// Describes how the keeper's diary compares with the log. Private to the report.
#pragma once

#include "wording.hpp"

#include "goingrate/analysis/logbook_check.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// The subject of an entry: "rate", "driving weight", ...
std::string_view in_words(LogbookWord word);

/// The value of an entry with its unit: "-0.25 ± 0.05 s/day", "+10 ± 2 %"; empty for NaN.
std::string value_in_words(LogbookWord word, double value, double sigma, const Wording& words);

/// How many entries the log shows, which it does not show, and which changes have no entry.
std::string logbook_sentence(const LogbookCheck& check, const Wording& words);

} // namespace goingrate
