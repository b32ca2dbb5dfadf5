#include "logbook_words.hpp"

#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

std::size_t count(const LogbookCheck& check, bool (*is_one)(const EntryFinding&)) {
  return static_cast<std::size_t>(
      std::count_if(check.entries.begin(), check.entries.end(), is_one));
}

bool shows(const EntryFinding& finding) {
  return finding.verdict == EntryVerdict::as_planned || finding.verdict == EntryVerdict::differs ||
         finding.verdict == EntryVerdict::seen;
}

// Winding or a note need not show in the log, so they do not count as missing there.
bool is_missed(const EntryFinding& finding) {
  return finding.verdict == EntryVerdict::not_seen && finding.entry.what != LogbookWord::wind &&
         finding.entry.what != LogbookWord::note;
}

bool is_unclear(const EntryFinding& finding) {
  return finding.verdict == EntryVerdict::unclear;
}

bool is_outside(const EntryFinding& finding) {
  return finding.verdict == EntryVerdict::outside;
}

bool has_other_size(const EntryFinding& finding) {
  return finding.verdict == EntryVerdict::differs;
}

std::string number_of(std::size_t n, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

} // namespace

std::string_view in_words(LogbookWord word) {
  switch (word) {
  case LogbookWord::weight:
    return "driving weight";
  case LogbookWord::clean:
    return "cleaning";
  case LogbookWord::set:
    return "hands set";
  case LogbookWord::wind:
    return "winding";
  default:
    return name_of(word);
  }
}

std::string value_in_words(LogbookWord word, double value, double sigma, const Wording& words) {
  if (std::isnan(value)) return {};
  constexpr double day_s = 86400.0;
  if (word == LogbookWord::rate) return words.rate(value / day_s, sigma / day_s);
  const bool is_set = word == LogbookWord::set;
  const double factor = is_set ? 1.0 : 100.0;
  return fmt::format("{}{} {}", value < 0.0 ? "" : "+", with_sigma(factor * value, factor * sigma),
                     is_set ? "s" : "%");
}

std::string logbook_sentence(const LogbookCheck& check, const Wording& words) {
  const std::size_t shown = count(check, shows), other = count(check, has_other_size),
                    missed = count(check, is_missed);
  std::string text = fmt::format("Of {} in the keeper's diary the log shows {}",
                                 number_of(check.entries.size(), "entry", "entries"), shown);
  if (other > 0)
    text += fmt::format(", {} with another size than was planned", other);
  if (missed > 0) {
    const auto first = std::find_if(check.entries.begin(), check.entries.end(), is_missed);
    text += fmt::format("; {} not: {}, {}{}", number_of(missed, "does", "do"),
                        in_words(first->entry.what), words.short_moment(first->at_s),
                        missed > 1 ? " and later" : "");
  }
  if (const std::size_t unclear = count(check, is_unclear); unclear > 0)
    text += fmt::format("; of {} it does not tell", unclear);
  if (const std::size_t outside = count(check, is_outside); outside > 0)
    text += fmt::format("; {} outside of what was analysed", number_of(outside, "lies", "lie"));
  if (!check.unwritten.empty())
    text += fmt::format("; {} that the log shows {} not written down",
                        number_of(check.unwritten.size(), "change", "changes"),
                        check.unwritten.size() == 1 ? "was" : "were");
  return text + ".";
}

} // namespace goingrate
