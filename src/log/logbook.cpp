#include "goingrate/log/logbook.hpp"

#include "calendar.hpp"
#include "fields.hpp"

#include "base/spelling.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/log/reading.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <utility>

namespace goingrate {

namespace {

constexpr std::array<std::pair<LogbookWord, std::string_view>, 8> words{{
    {LogbookWord::rate, "rate"},
    {LogbookWord::weight, "weight"},
    {LogbookWord::clean, "clean"},
    {LogbookWord::set, "set"},
    {LogbookWord::wind, "wind"},
    {LogbookWord::stop, "stop"},
    {LogbookWord::start, "start"},
    {LogbookWord::note, "note"},
}};

constexpr std::array<std::string_view, 5> column_names{"time", "what", "value", "sigma", "note"};
enum Column : std::size_t { time, what, value, sigma, note };

template <class Names> std::string one_of(const Names& names) {
  return fmt::format("one of {}", fmt::join(names, ", "));
}

/// Reads the lines of one file.
class EntryReader {
public:
  EntryReader(std::string_view text, const std::string& source) : text_(text) {
    logbook_.source = source;
  }

  Logbook run() {
    while (!text_.empty()) {
      std::string_view line = next_line();
      const std::size_t start = line.find_first_not_of(" \t");
      if (start == std::string_view::npos || line[start] == '#') continue;
      if (!has_header_)
        take_header(line);
      else
        take_entry(line);
    }
    if (!has_header_) refuse(1, "an empty file", "a header with time and what");
    std::stable_sort(
        logbook_.entries.begin(), logbook_.entries.end(),
        [](const LogbookEntry& a, const LogbookEntry& b) { return a.time < b.time; });
    return std::move(logbook_);
  }

private:
  [[noreturn]] void refuse(std::size_t column, std::string_view found,
                           std::string_view expected) const {
    throw InputError({logbook_.source, line_, column}, found, expected);
  }

  std::string_view next_line() {
    const std::size_t end = text_.find('\n');
    std::string_view line = text_.substr(0, end);
    text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
    ++line_;
    if (line_ == 1 && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3); // Windows' mark
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  void take_header(std::string_view line) {
    for (const char separator : {',', ';', '\t'})
      if (line.find(separator) != std::string_view::npos) separator_ = separator;
    split_fields(line, separator_, fields_);
    const std::vector<std::string> known(column_names.begin(), column_names.end());
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const auto name = std::find(known.begin(), known.end(), fields_[i].text);
      if (name == known.end())
        refuse(fields_[i].column, shown(fields_[i].text),
               one_of(known) + meant_instead(fields_[i].text, known));
      place_[static_cast<std::size_t>(name - known.begin())] = i;
    }
    if (!place_[Column::time] || !place_[Column::what])
      refuse(1, shown(line), "a header with time and what");
    has_header_ = true;
  }

  [[nodiscard]] Field field(Column column) const {
    const auto& place = place_[column];
    return place && *place < fields_.size() ? fields_[*place] : Field{};
  }

  void take_entry(std::string_view line) {
    split_fields(line, separator_, fields_);
    join_what_is_left_of_a_note(line);
    LogbookEntry entry;
    entry.line = line_;
    entry.what = word_in(field(Column::what));
    take_time(field(Column::time), entry);
    entry.value = number_in(field(Column::value)).value_or(entry.value);
    entry.sigma = number_in(field(Column::sigma)).value_or(0.0);
    constexpr double largest_rate = 4320.0; // s/day: 5 %, no pendulum clock is off by more
    if (entry.what == LogbookWord::rate && std::abs(entry.value) > largest_rate)
      refuse(field(Column::value).column, shown(field(Column::value).text),
             "a change of the rate in s/day, 4320 at most");
    if (entry.sigma < 0.0) refuse(field(Column::sigma).column, "a negative sigma", "0 or more");
    const bool has_value = entry.what == LogbookWord::rate || entry.what == LogbookWord::weight ||
                           entry.what == LogbookWord::clean || entry.what == LogbookWord::set;
    if (!has_value && !std::isnan(entry.value))
      refuse(field(Column::value).column, shown(field(Column::value).text),
             fmt::format("no value beside {}", name_of(entry.what)));
    entry.note = std::string(field(Column::note).text);
    logbook_.entries.push_back(std::move(entry));
  }

  // A note that is the last column may hold separators without quotes.
  void join_what_is_left_of_a_note(std::string_view line) {
    std::size_t columns = 0;
    for (const auto& place : place_)
      columns = std::max(columns, place.value_or(0) + 1);
    if (fields_.size() <= columns) return;
    const bool note_is_last = place_[Column::note] == columns - 1;
    if (!note_is_last)
      refuse(fields_[columns].column, fmt::format("{} columns", fields_.size()),
             fmt::format("{}; quote a field that holds the separator", columns));
    Field& last = fields_[columns - 1];
    last.text = line.substr(last.column - 1);
    fields_.resize(columns);
  }

  [[nodiscard]] LogbookWord word_in(const Field& field) const {
    std::vector<std::string> known;
    for (const auto& [word, name] : words) {
      if (field.text == name) return word;
      known.emplace_back(name);
    }
    refuse(field.column, field.text.empty() ? "nothing" : shown(field.text),
           one_of(known) + meant_instead(field.text, known));
  }

  [[nodiscard]] std::optional<double> number_in(const Field& field) const {
    if (field.text.empty()) return {};
    const auto number = parse_number(field.text, separator_ == ',' ? '.' : point_of(field.text));
    if (!number) refuse(field.column, shown(field.text), "a number, or nothing");
    return number;
  }

  static char point_of(std::string_view text) {
    return text.find(',') == std::string_view::npos ? '.' : ',';
  }

  void take_time(const Field& field, LogbookEntry& entry) {
    TimeOrigin origin = TimeOrigin::epoch;
    const std::string day = std::string(field.text) + " 00:00:00";
    if (const auto date = parse_calendar(field.text); date && date->has_date) {
      entry.time = date->time;
      entry.has_zone = date->has_zone;
    } else if (const auto first = parse_calendar(day); first && first->has_date) {
      entry.time = first->time;
      entry.whole_day = true;
    } else if (const auto seconds = parse_instant(field.text)) {
      entry.time = *seconds;
      origin = TimeOrigin::none;
    } else {
      refuse(field.column, field.text.empty() ? "nothing" : shown(field.text),
             "a date, as 2013-03-30 or 2013-03-30 10:15, or seconds");
    }
    if (!logbook_.entries.empty() && origin != logbook_.origin)
      refuse(field.column, shown(field.text), "times of one kind, dates or seconds");
    logbook_.origin = origin;
  }

  std::string_view text_;
  Logbook logbook_;
  std::uint32_t line_ = 0;
  char separator_ = ',';
  bool has_header_ = false;
  std::array<std::optional<std::size_t>, column_names.size()> place_{};
  std::vector<Field> fields_;
};

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text)
    result += c == '"' ? "'" : std::string(1, c == '\n' ? ' ' : c);
  return result + "\"";
}

std::string time_text(const LogbookEntry& entry, TimeOrigin origin) {
  if (origin == TimeOrigin::none) return format_instant(entry.time, 1);
  const std::int64_t shift = seconds_before_1970(origin);
  const std::chrono::sys_seconds moment{std::chrono::seconds(entry.time.seconds - shift)};
  const auto midnight = std::chrono::floor<std::chrono::days>(moment);
  const std::chrono::year_month_day date{midnight};
  const std::chrono::hh_mm_ss clock{moment - midnight};
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}{}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     clock.hours().count(), clock.minutes().count(), clock.seconds().count(),
                     entry.has_zone ? "Z" : "");
}

} // namespace

std::string_view name_of(LogbookWord word) {
  const auto* entry =
      std::find_if(words.begin(), words.end(), [&](const auto& pair) { return pair.first == word; });
  return entry->second;
}

Logbook parse_logbook(std::string_view text, const std::string& source) {
  return EntryReader(text, source).run();
}

Logbook brought_to(const ClockLog& log, Logbook logbook) {
  if (!logbook.entries.empty() &&
      (logbook.origin == TimeOrigin::none) != (log.origin == TimeOrigin::none))
    throw InputError({logbook.source, logbook.entries.front().line, 1}, times_of(logbook.origin),
                     fmt::format("{}, as in {}", times_of(log.origin), log.source));
  const std::int64_t shift = seconds_before_1970(log.origin) - seconds_before_1970(logbook.origin);
  for (LogbookEntry& entry : logbook.entries) {
    entry.time.seconds += shift;
    const bool is_local = !entry.has_zone && log.origin != TimeOrigin::none && log.zone_s;
    if (is_local) entry.time = entry.time + -*log.zone_s;
    entry.has_zone = entry.has_zone || is_local;
  }
  logbook.origin = log.origin;
  return logbook;
}

Logbook read_logbook(const std::string& path) { return parse_logbook(read_text(path), path); }

std::string logbook_text(const Logbook& logbook) {
  std::string text = "time,what,value,sigma,note\n";
  for (const LogbookEntry& entry : logbook.entries) {
    const std::string value = std::isnan(entry.value) ? "" : fmt::format("{:.6g}", entry.value);
    const std::string sigma = entry.sigma > 0.0 ? fmt::format("{:.3g}", entry.sigma) : "";
    text += fmt::format("{},{},{},{},{}\n", time_text(entry, logbook.origin), name_of(entry.what),
                        value, sigma, quoted(entry.note));
  }
  return text;
}

} // namespace goingrate
