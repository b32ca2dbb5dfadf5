// The keeper's diary compared with the log, in words. Private to the report.
#pragma once

#include "wording.hpp"

#include "goingrate/analysis/logbook_check.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// "rate", "driving weight", ...: what an entry is about.
std::string_view in_words(LogbookWord word);

/// The value of an entry with its unit: "-0.25 ± 0.05 s/day", "+10 ± 2 %"; empty for NaN.
std::string value_in_words(LogbookWord word, double value, double sigma, const Wording& words);

/// How many entries the log shows, which it does not, and what nobody wrote down.
std::string logbook_sentence(const LogbookCheck& check, const Wording& words);

} // namespace goingrate
