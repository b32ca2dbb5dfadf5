#include "calendar.hpp"

#include <array>
#include <chrono>
#include <string>

namespace goingrate {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// Takes pieces off the front of a text.
class Taker {
public:
  explicit Taker(std::string_view text) : rest(text) {}

  // A whole number of `least` to `most` digits.
  std::optional<int> number(std::size_t least, std::size_t most) {
    std::size_t count = 0;
    int value = 0;
    while (count < most && count < rest.size() && is_digit(rest[count]))
      value = value * 10 + (rest[count++] - '0');
    if (count < least) return {};
    rest.remove_prefix(count);
    return value;
  }
  bool any_of(std::string_view characters) {
    if (rest.empty() || characters.find(rest.front()) == std::string_view::npos) return false;
    rest.remove_prefix(1);
    return true;
  }
  void blanks() {
    while (any_of(" \t")) {
    }
  }

  std::string_view rest;
};

// Hours to add for "AM" or "PM", also in small letters and with points; nothing where there is
// neither. Twelve is the first hour of both halves of the day.
std::optional<int> half_of_day(Taker& text, int hour) {
  Taker behind(text);
  behind.blanks();
  const bool afternoon = behind.any_of("Pp");
  if (!afternoon && !behind.any_of("Aa")) return 0;
  behind.any_of(".");
  if (!behind.any_of("Mm")) return 0;
  behind.any_of(".");
  if (hour < 1 || hour > 12) return {};
  text = behind;
  return (afternoon ? 12 : 0) - (hour == 12 ? 12 : 0);
}

// "hh:mm:ss.fff", the seconds with all their digits, or "hh:mm:ss.fff PM"; nothing else may follow
// but a zone.
std::optional<Instant> time_of_day(Taker& text, std::string_view between, char point) {
  const auto hour = text.number(1, 2);
  if (!hour || *hour > 24 || !text.any_of(between)) return {};
  const auto minute = text.number(1, 2);
  if (!minute || *minute > 59) return {};
  Instant seconds;
  if (text.any_of(between)) {
    std::size_t length = 0;
    while (length < text.rest.size() && (is_digit(text.rest[length]) || text.rest[length] == point))
      ++length;
    const auto value = parse_instant(text.rest.substr(0, length), in_seconds, point);
    if (!value || value->seconds > 60) return {}; // 60: a leap second
    seconds = *value;
    text.rest.remove_prefix(length);
  }
  const auto half = half_of_day(text, *hour);
  if (!half) return {};
  seconds.seconds += (*hour + *half) * 3600 + *minute * 60;
  return seconds;
}

// Seconds east of Greenwich; nothing if what is left is not a zone.
std::optional<std::int64_t> zone(Taker& text, bool& given) {
  text.blanks();
  given = !text.rest.empty();
  if (text.rest.empty() || text.rest == "Z" || text.rest == "z" || text.rest == "UTC" ||
      text.rest == "GMT")
    return 0;
  const bool west = text.rest.front() == '-';
  if (!text.any_of("+-")) return {};
  const auto hours = text.number(2, 2);
  text.any_of(":");
  const auto minutes = text.rest.empty() ? 0 : text.number(2, 2);
  if (!hours || !minutes || !text.rest.empty() || *hours > 14 || *minutes > 59) return {};
  const std::int64_t east = *hours * 3600 + *minutes * 60;
  return west ? -east : east;
}

std::optional<std::chrono::year_month_day> date_of(int year, int month, int day) {
  const std::chrono::year_month_day ymd{std::chrono::year(year),
                                        std::chrono::month(static_cast<unsigned>(month)),
                                        std::chrono::day(static_cast<unsigned>(day))};
  return ymd.ok() ? std::optional(ymd) : std::nullopt;
}

// "2013-02-22".
std::optional<std::chrono::year_month_day> day_with_year_in_front(Taker& text) {
  Taker forwards(text);
  const auto year = forwards.number(4, 4);
  if (!year || !forwards.any_of("-_/.")) return {};
  const auto month = forwards.number(1, 2);
  if (!month || !forwards.any_of("-_/.")) return {};
  const auto day = forwards.number(1, 2);
  if (!day) return {};
  text = forwards;
  return date_of(*year, *month, *day);
}

// "22.02.2013", in which the day comes first, or "22/02/2013", in which it may be the month.
std::optional<std::chrono::year_month_day> day_with_year_behind(Taker& text, DateOrder order) {
  Taker forwards(text);
  const auto first = forwards.number(1, 2);
  const bool strokes = forwards.any_of("/");
  if (!first || (!strokes && !forwards.any_of("."))) return {};
  const auto second = forwards.number(1, 2);
  if (!second || !forwards.any_of(strokes ? "/" : ".")) return {};
  const auto year = forwards.number(4, 4);
  if (!year) return {};
  text = forwards;
  const auto day_first = date_of(*year, *second, *first);
  const auto month_first = date_of(*year, *first, *second);
  if (!strokes || order == DateOrder::day_first) return day_first;
  if (order == DateOrder::month_first) return month_first;
  return day_first ? day_first : month_first;
}

// "Feb", "february": the number of a month by its English name, whole or its first three letters.
std::optional<int> named_month(Taker& text) {
  constexpr std::array<std::string_view, 12> names{"january",   "february", "march",    "april",
                                                   "may",       "june",     "july",     "august",
                                                   "september", "october",  "november", "december"};
  std::string word;
  while (!text.rest.empty() && is_letter(text.rest.front())) {
    word += static_cast<char>(text.rest.front() | 0x20); // a small letter
    text.rest.remove_prefix(1);
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    if (word == names[i] || word == names[i].substr(0, 3)) return static_cast<int>(i) + 1;
  return {};
}

// "22 Feb 2013", "22-Feb-2013".
std::optional<std::chrono::year_month_day> day_with_named_month(Taker& text) {
  constexpr std::string_view between = " -/.";
  Taker forwards(text);
  const auto day = forwards.number(1, 2);
  if (!day || !forwards.any_of(between)) return {};
  const auto month = named_month(forwards);
  if (!month || !forwards.any_of(between)) return {};
  const auto year = forwards.number(4, 4);
  if (!year) return {};
  text = forwards;
  return date_of(*year, *month, *day);
}

std::optional<std::chrono::year_month_day> day_of(Taker& text, DateOrder order) {
  if (const auto day = day_with_year_in_front(text)) return day;
  if (const auto day = day_with_year_behind(text, order)) return day;
  return day_with_named_month(text);
}

} // namespace

std::optional<CalendarTime> parse_calendar(std::string_view text, char point, DateOrder order) {
  CalendarTime result;
  Taker alone(text);
  if (const auto time = time_of_day(alone, ":", point)) {
    const auto east = zone(alone, result.has_zone);
    if (!east) return {};
    result.zone_s = static_cast<double>(*east);
    result.time = *time;
    return result;
  }
  Taker date(text);
  const auto ymd = day_of(date, order);
  if (!ymd || !date.any_of(" \tTt_-")) return {};
  date.blanks();
  const auto time = time_of_day(date, ":-_", point);
  if (!time) return {};
  const auto east = zone(date, result.has_zone);
  if (!east) return {};
  result.zone_s = static_cast<double>(*east);
  const std::int64_t days = std::chrono::sys_days(*ymd).time_since_epoch().count();
  result.has_date = true;
  result.time = {time->seconds + days * 86400 - *east, time->fraction};
  return result;
}

std::optional<std::int64_t> zone_named(std::string_view text) {
  Taker taker{text};
  bool given = false;
  const auto east = zone(taker, given);
  return given ? east : std::nullopt;
}

} // namespace goingrate
