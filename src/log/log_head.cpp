#include "log_head.hpp"

#include "calendar.hpp"
#include "column_names.hpp"
#include "separators.hpp"
#include "typical_period.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <span>

namespace goingrate {

namespace {

constexpr std::size_t most_rows = 20000; // enough to see any pendulum swing at 10 kHz

// A program or a picture is refused; a log with a hole in it (zeros after a power cut, bytes lost
// on a line) is not: its bad lines are left out one by one.
void refuse_binary(const std::vector<HeadLine>& lines, const std::string& source) {
  constexpr std::size_t lines_looked_at = 100; // lines: more than most holes have
  const HeadLine* first = nullptr;
  std::size_t bad = 0, all = 0;
  for (const HeadLine& line : std::span(lines).first(std::min(lines.size(), lines_looked_at))) {
    ++all;
    if (!has_binary(line.text)) continue;
    ++bad;
    if (first == nullptr) first = &line;
  }
  if (first == nullptr || (first->number > 1 && bad * 2 < all)) return;
  const auto at = std::find_if(first->text.begin(), first->text.end(), is_binary);
  throw InputError({source, first->number, static_cast<std::size_t>(at - first->text.begin()) + 1},
                   fmt::format("the binary byte 0x{:02x}", static_cast<unsigned char>(*at)),
                   "a log in plain text");
}

std::vector<HeadLine> lines_of(std::string_view text, bool whole) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  if (text.starts_with(mark)) text.remove_prefix(mark.size());
  const bool has_lf = text.find('\n') != std::string_view::npos;
  const char line_end = has_lf ? '\n' : '\r';
  std::vector<HeadLine> lines;
  lines.reserve(std::min(
      most_rows, static_cast<std::size_t>(std::count(text.begin(), text.end(), line_end) + 1)));
  std::uint32_t number = 0;
  while (!text.empty() && lines.size() < most_rows) {
    const std::size_t end = text.find(line_end);
    if (end == std::string_view::npos && !whole && !lines.empty()) break; // cut by the buffer
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    while (!line.empty() && line.back() == '\r') // some programs write CR CR LF
      line.remove_suffix(1);
    lines.push_back({line, ++number});
  }
  return lines;
}

bool is_value(std::string_view text, char point) {
  return parse_number(text, point) || parse_calendar(text, point);
}

bool is_date(std::string_view text) {
  return text.size() >= 8 && parse_calendar(fmt::format("{}{}", text, midnight)).has_value();
}

// "tick", "down": a direction in front of the numbers.
bool is_edge_word(std::string_view text) { return text.size() > 1 && edge_named(text).has_value(); }

// Whether a line looks like data: its first field is a value, or one of its first is a time.
bool is_row(std::string_view line, char separator, char point) {
  std::vector<Field> fields;
  split_fields(line, separator, fields);
  if (fields.empty()) return false;
  const std::size_t looked_at = std::min<std::size_t>(fields.size(), 3);
  for (std::size_t i = 0; i < looked_at; ++i) {
    const std::string_view text = fields[i].text;
    if (is_value(text, point) || is_date(text)) return true;
    if (i == 0 && is_edge_word(text)) continue;
    if (i == 0 && !text.empty() && separator == ' ' && !says_nothing(text)) return false;
  }
  return false;
}

// Where no line is data with a decimal comma, as was said: the first that is with a point.
void refuse_points(const LogHead& head, const std::string& source) {
  for (const HeadLine& line : head.titles)
    for (const char separator : {head.separator, ','})
      if (is_row(line.text, separator, '.'))
        throw InputError(
            {source, line.number, 1},
            fmt::format("{}, and no line whose decimal point is a comma", shown(line.text)),
            "decimal commas, as was said");
}

std::vector<std::string> names_in(std::string_view line, char separator) {
  std::vector<Field> fields;
  split_fields(line, separator, fields);
  std::vector<std::string> names;
  for (const Field& field : fields) {
    const bool unit = separator == ' ' && !names.empty() && field.text.find_first_of("([") == 0;
    if (unit) // "Time (s)": one name
      names.back() += fmt::format(" {}", field.text);
    else
      names.emplace_back(field.text);
  }
  return names;
}

// A Vernier block has long names, short names and units in lines of their own.
void name_vernier_columns(LogHead& head) {
  std::vector<std::vector<std::string>> lines;
  for (const HeadLine& title : head.titles)
    if (auto names = names_in(title.text, head.separator); names.size() == head.columns)
      lines.push_back(std::move(names));
  if (lines.size() < 2) return;
  const auto& units = lines.back();
  const auto& longs = lines.size() >= 3 ? lines[lines.size() - 3] : lines[lines.size() - 2];
  head.names.clear();
  for (std::size_t i = 0; i < head.columns; ++i)
    head.names.push_back(fmt::format("{} ({})", longs[i], units[i]));
}

void name_columns(LogHead& head) {
  if (!head.titles.empty() && head.titles.front().text.starts_with("Vernier Format"))
    return name_vernier_columns(head);
  if (!head.titles.empty()) {
    head.names = names_in(head.titles.back().text, head.separator);
    // Blanks do not cut the name of a single column, "Time in s", unless it is a sentence.
    constexpr std::size_t most_words = 3;
    if (head.columns == 1 && head.names.size() > 1 && head.names.size() <= most_words)
      head.names = names_in(head.titles.back().text, '\n');
    return;
  }
  // "# time_s, amplitude_rad" as a comment: as many words as columns, the last such line.
  for (const HeadLine& comment : head.comments) {
    if (comment.number > head.rows.front().number) break;
    const std::string_view text = comment.text.substr(comment.text.find_first_of("#%") + 1);
    auto names = names_in(text, head.separator);
    if (head.columns >= 2 && names.size() == head.columns) head.names = std::move(names);
  }
}

} // namespace

LogHead cut_head(std::string_view text, bool whole, const std::string& source, bool decimal_comma) {
  if (text.empty()) throw InputError({source, 1, 1}, "an empty file", "a log of events");
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw InputError({source, 1, 1}, "text in UTF-16", "text in UTF-8, Latin-1 or ASCII");
  LogHead head;
  std::vector<HeadLine> lines = lines_of(text, whole); // stays the only list of its length
  refuse_binary(lines, source);
  std::erase_if(lines, [&](const HeadLine& line) {
    const std::size_t start = line.text.find_first_not_of(" \t\f");
    if (start == std::string_view::npos || has_binary(line.text)) return true;
    const bool comment = line.text[start] == '#' || line.text[start] == '%';
    if (comment) head.comments.push_back(line);
    return comment;
  });
  if (lines.empty()) throw InputError({source, 1, 1}, "no line of data", "a log of events");
  settle_separators(head, lines, decimal_comma);
  std::map<std::size_t, std::size_t> counts;
  const auto first_row = std::find_if(lines.begin(), lines.end(), [&](const HeadLine& line) {
    return is_row(line.text, head.separator, head.point);
  });
  head.titles.assign(lines.begin(), first_row);
  lines.erase(lines.begin(), first_row);
  head.rows = std::move(lines);
  for (const HeadLine& line : head.rows)
    ++counts[count_fields(line.text, head.separator)];
  if (head.rows.empty()) {
    const HeadLine& first = head.titles.front();
    if (decimal_comma) refuse_points(head, source);
    constexpr std::size_t most_words = 3; // "Time in s", and no sentence
    if (first.text.find("time") != std::string_view::npos &&
        (head.separator != ' ' || first.text.find(',') != std::string_view::npos ||
         count_fields(first.text, ' ') <= most_words))
      throw InputError({source, first.number, 1}, "a header and 0 events", "lines of data");
    throw InputError({source, first.number, 1}, shown(first.text),
                     "a log: one time per line, or columns with a header");
  }
  const auto commonest = std::max_element(counts.begin(), counts.end(),
                                          [](auto& a, auto& b) { return a.second < b.second; });
  head.columns = commonest->first;
  if (head.columns > most_fields)
    throw InputError({source, head.rows.front().number, 1},
                     fmt::format("more than {} columns", most_fields), "a log of fewer");
  name_columns(head);
  return head;
}

std::vector<Field> LogHead::whole_row() const {
  std::vector<Field> result;
  for (const HeadLine& row : rows) {
    split_fields(row.text, separator, result);
    if (result.size() == columns) break;
  }
  return result;
}

std::optional<std::string_view> LogHead::value_of(std::string_view key) const {
  for (const HeadLine& line : comments) {
    const std::string_view text = line.text.substr(line.text.find_first_of("#%") + 1);
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) continue;
    std::vector<Field> name, value;
    split_fields(text.substr(0, colon), '\n', name);
    split_fields(text.substr(colon + 1), '\n', value);
    if (name.front().text == key) return value.front().text;
  }
  return {};
}

namespace {

double median_of(std::vector<double>& values) { return values.empty() ? 0.0 : median(values); }

void describe_steps(ColumnSample& sample, const std::vector<double>& values) {
  std::vector<double> steps;
  steps.reserve(values.size());
  double up = 0.0, down = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = values[i] - values[i - 1];
    up += step > 0.0 ? 1.0 : 0.0;
    down += step < 0.0 ? 1.0 : 0.0;
    if (step != 0.0) steps.push_back(std::abs(step));
  }
  const auto count = static_cast<double>(std::max<std::size_t>(values.size(), 2) - 1);
  sample.rising = up / count;
  sample.falling = down / count;
  if (steps.empty()) return;
  const auto [shortest, longest] = std::minmax_element(steps.begin(), steps.end());
  sample.even = steps.size() + 1 == values.size() && *shortest == *longest;
  if (std::max(sample.rising, sample.falling) > 0.98) {
    // If a contact bounces, most steps are from one bounce to the next and say nothing about the
    // beat. At most nine in ten are such steps, and gaps are rarer than one in ten.
    const auto most = steps.begin() + static_cast<std::ptrdiff_t>(9 * (steps.size() - 1) / 10);
    std::nth_element(steps.begin(), most, steps.end());
    const double bounce = 0.1 * *most;
    std::erase_if(steps, [bounce](double step) { return step < bounce; });
  }
  sample.typical_step = median_of(steps);
}

void describe_swing(ColumnSample& sample, const std::vector<double>& values) {
  const double middle = 0.5 * (sample.least + sample.most);
  double variance = 0.0, next = 0.0;
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    const double a = values[i] - middle, b = values[i + 1] - middle;
    sample.crossings += (a < 0.0) != (b < 0.0) ? 1 : 0;
    variance += a * a;
    next += a * b;
  }
  // Five samples per swing or more have a correlation of cos(2 pi / 5) or more. Fewer obey the
  // difference equation of a sine, x[i+1] + x[i-1] = 2 cos(2 pi / n) x[i], with n above 2.5.
  double sums = 0.0, with = 0.0;
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double both = values[i - 1] + values[i + 1] - 2.0 * middle;
    sums += both * both;
    with += both * (values[i] - middle);
  }
  const double factor = variance > 0.0 ? with / variance : 0.0;
  const bool sine = sums - factor * with < 0.5 * variance && factor > -1.6;
  sample.smooth = variance > 0.0 && (next > 0.3 * variance || sine);
}

} // namespace

namespace {

// Each row is cut up for each column, so that wide tables are known by fewer rows.
std::span<const HeadLine> rows_looked_at(const LogHead& head) {
  constexpr std::size_t most_fields_cut = 4'000'000, always = 400;
  const std::size_t most = std::max(always, most_fields_cut / (head.columns * head.columns));
  return std::span(head.rows).first(std::min(head.rows.size(), most));
}

void add_calendar(ColumnSample& sample, const CalendarTime& time, std::vector<double>& values) {
  ++sample.calendars;
  sample.has_date = sample.has_date || time.has_date;
  values.push_back(time.time.to_double());
  sample.whole = sample.whole && time.time.fraction == 0.0;
}

void describe(ColumnSample& sample, std::vector<double>& values) {
  if (values.empty()) return;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  sample.least = *least;
  sample.most = *most;
  describe_steps(sample, values);
  describe_swing(sample, values);
  sample.median = median_of(values); // their order is not needed any more
  for (double& value : values)
    value = std::abs(value - sample.median);
  sample.spread = median_of(values);
}

} // namespace

ColumnSample LogHead::sample(std::size_t column) const {
  const auto looked_at = rows_looked_at(*this);
  ColumnSample result;
  std::vector<double> values;
  values.reserve(looked_at.size());
  std::vector<Field> row;
  for (const HeadLine& line : looked_at) {
    split_fields(line.text, separator, row);
    if (column >= row.size()) continue;
    ++result.rows;
    const std::string_view text = row[column].text;
    if (const auto number = parse_number(text, point)) {
      ++result.numbers;
      if (all_nines(text)) continue;
      values.push_back(*number);
      result.whole = result.whole && text.find(point) == std::string_view::npos;
    } else if (const auto time = parse_calendar(text, point)) {
      add_calendar(result, *time, values);
    } else if (is_date(text)) {
      ++result.dates;
    } else if (is_edge_word(text)) {
      ++result.edges;
    }
  }
  describe(result, values);
  return result;
}

ColumnSample LogHead::sample_of_dates(const DateColumns& from, DateOrder order) const {
  ColumnSample result;
  std::vector<double> values;
  std::vector<Field> row;
  std::string text;
  for (const HeadLine& line : rows_looked_at(*this)) {
    split_fields(line.text, separator, row);
    if (std::max(from.time, from.date.value_or(0)) >= row.size()) continue;
    ++result.rows;
    text.clear();
    if (from.date) text.append(row[*from.date].text).append(" ");
    text.append(row[from.time].text).append(from.days_alone ? midnight : "");
    if (const auto time = parse_calendar(text, point, order)) add_calendar(result, *time, values);
  }
  describe(result, values);
  return result;
}

} // namespace goingrate
