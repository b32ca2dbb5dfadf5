#include "goingrate/log/reading.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/scaled_time.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fast_float/fast_float.h>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <sys/stat.h>

namespace goingrate {

namespace {

constexpr double no_amplitude = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t fewest_events = 3; // two periods: the least from which a rate has a scatter

struct Field {
  std::string_view text;
  std::size_t column; // from 1
};

std::vector<Field> split(std::string_view line, std::string_view separators, bool merge) {
  std::vector<Field> fields;
  std::size_t begin = 0;
  while (begin <= line.size()) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    std::string_view text = line.substr(begin, end - begin);
    std::size_t column = begin + 1;
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) {
      text.remove_prefix(1);
      ++column;
    }
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t'))
      text.remove_suffix(1);
    if (!merge || !text.empty()) fields.push_back({text, column});
    begin = end + 1;
  }
  return fields;
}

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 40; // enough to recognise the place, short enough for one line
  std::string clean;
  for (const char c :
       text.substr(0, longest)) { // Latin-1 or half a character must not spoil a message
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7f)
      clean += c;
    else
      clean += fmt::format("\\x{:02x}", byte);
  }
  return fmt::format("'{}{}'", clean, text.size() > longest ? "..." : "");
}

bool is_number(std::string_view text) { return parse_instant(text).has_value(); }

struct Line {
  std::string_view text;
  std::uint32_t number;
};

// Data lines with their numbers; '#' lines are kept apart.
struct Lines {
  std::vector<Line> data;
  std::vector<Line> comments;
};

Lines split_lines(std::string_view text) {
  Lines lines;
  std::uint32_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    const std::size_t start = line.find_first_not_of(" \t");
    if (start == std::string_view::npos) continue;
    (line[start] == '#' ? lines.comments : lines.data).push_back({line, number});
  }
  return lines;
}

void refuse_binary(std::string_view text, const std::string& source) {
  std::size_t line = 1;
  std::size_t column = 1;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 && c != '\n' && c != '\r' && c != '\t' && c != '\f')
      throw InputError({source, line, column}, fmt::format("the binary byte 0x{:02x}", byte),
                       "a log in plain text");
    column = c == '\n' ? 1 : column + 1;
    line += c == '\n' ? 1 : 0;
  }
}

// Columns of the native format by name.
using Columns = std::map<std::string, std::size_t, std::less<>>;

std::optional<Columns> native_header(std::string_view line) {
  Columns columns;
  std::size_t index = 0;
  for (const Field& field : split(line, ",", false))
    columns.emplace(field.text, index++);
  if (!columns.contains("time_s")) return {};
  return columns;
}

bool looks_like_clock_error(const std::vector<Line>& data) {
  // Whole-number labels in step with the lines, and an error that is small beside them.
  for (std::size_t i = 0; i < std::min<std::size_t>(data.size(), 3); ++i) {
    const auto fields = split(data[i].text, " \t", true);
    if (fields.size() != 3) return false;
    const auto label = parse_instant(fields[0].text);
    const auto error = parse_instant(fields[1].text);
    if (!label || !error || !is_number(fields[2].text)) return false;
    if (label->fraction != 0.0 || std::abs(error->to_double()) > 43200.0) return false;
  }
  return true;
}

LogFormat detect(const std::vector<Line>& data, const std::string& source) {
  const Line& first = data.front();
  if (native_header(first.text)) return LogFormat::native;
  const auto fields = split(first.text, " \t,;", true);
  if (fields.size() == 1 && is_number(fields[0].text)) return LogFormat::timestamps;
  if (looks_like_clock_error(data)) return LogFormat::clock_error;
  throw InputError({source, first.number, 1}, shown(first.text),
                   "a native log (a header row with time_s), one time in seconds a line, or "
                   "'label error amplitude_mrad'");
}

// Collects events and the lines that gave none.
class Collector {
public:
  Collector(ClockLog& log, std::size_t lines) : log_(log) { log.events.reserve(lines); }

  void reject(const Line& line, const Field& field, std::string_view expected) {
    log_.issues.push_back({line.number, field.column,
                           fmt::format("found {}, expected {}", shown(field.text), expected),
                           "line left out"});
  }
  void accept(const Line& line, const Instant& time, double amplitude, Edge edge) {
    if (std::abs(time.to_double()) > 4e18) { // differences of two such would not fit
      log_.issues.push_back({line.number, 1, "a time beyond 4e18 s", "line left out"});
      return;
    }
    if (!std::isnan(amplitude) && !(amplitude > 0.0 && amplitude < std::numbers::pi)) {
      log_.issues.push_back({line.number, 1, fmt::format("an amplitude of {} rad", amplitude),
                             "amplitude taken as unknown"});
      amplitude = no_amplitude;
    }
    log_.events.push_back(event_at(time, edge, line.number, amplitude));
    log_.has_amplitude = log_.has_amplitude || !std::isnan(amplitude);
  }

private:
  ClockLog& log_;
};

void read_timestamps(const std::vector<Line>& data, Collector& collector) {
  for (const Line& line : data) {
    const auto fields = split(line.text, " \t,;", true);
    if (fields.empty()) continue;
    const auto time = parse_instant(fields[0].text);
    if (!time) {
      collector.reject(line, fields[0], "a time in seconds");
    } else if (fields.size() > 1) {
      collector.reject(line, fields[1], "nothing after the time");
    } else {
      collector.accept(line, *time, no_amplitude, Edge::up);
    }
  }
}

void read_clock_error(const std::vector<Line>& data, Collector& collector) {
  for (const Line& line : data) {
    const auto fields = split(line.text, " \t", true);
    constexpr std::array<std::string_view, 3> meaning{
        "a label in seconds", "a clock error in seconds", "an amplitude in mrad"};
    std::array<Instant, 3> value;
    std::size_t good = 0;
    while (good < 3 && good < fields.size()) {
      const auto number = parse_instant(fields[good].text);
      if (!number) break;
      value[good++] = *number;
    }
    if (good < 3 || fields.size() > 3) {
      const Field end{"end of line", line.text.size() + 1};
      collector.reject(line, good < fields.size() ? fields[good] : end,
                       good < 3 ? meaning[good] : "three columns");
      continue;
    }
    // The clock shows `label` when true time is label - error: a positive error is a fast clock.
    collector.accept(line, value[0] + -value[1].to_double(), value[2].to_double() * 1e-3, Edge::up);
  }
}

void read_native(const std::vector<Line>& data, const std::string& source, Collector& collector) {
  const auto columns = native_header(data.front().text);
  if (!columns)
    throw InputError({source, data.front().number, 1}, shown(data.front().text),
                     "a header row with time_s");
  const std::size_t time_at = columns->at("time_s");
  const auto edge_at = columns->find("edge");
  const auto amplitude_at = columns->find("amplitude_rad");
  for (const Line& line : std::span(data).subspan(1)) {
    const auto fields = split(line.text, ",", false);
    if (fields.size() != columns->size()) {
      collector.reject(line, fields.front(), fmt::format("{} columns", columns->size()));
      continue;
    }
    const auto time = parse_instant(fields[time_at].text);
    if (!time) {
      collector.reject(line, fields[time_at], "a time in seconds");
      continue;
    }
    Edge edge = Edge::up;
    if (edge_at != columns->end()) {
      const Field& word = fields[edge_at->second];
      if (word.text != "up" && word.text != "down") {
        collector.reject(line, word, "up or down");
        continue;
      }
      edge = word.text == "up" ? Edge::up : Edge::down;
    }
    double amplitude = no_amplitude;
    if (amplitude_at != columns->end() && !fields[amplitude_at->second].text.empty()) {
      const auto number = parse_instant(fields[amplitude_at->second].text);
      if (!number) {
        collector.reject(line, fields[amplitude_at->second], "an amplitude in rad");
        continue;
      }
      amplitude = number->to_double();
    }
    collector.accept(line, *time, amplitude, edge);
  }
}

// "# key: value"
std::optional<std::string_view> header_value(const std::vector<Line>& comments,
                                             std::string_view key) {
  for (const Line& line : comments) {
    std::string_view text = line.text.substr(line.text.find('#') + 1);
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) continue;
    const auto name = split(text.substr(0, colon), "", false).front().text;
    if (name == key) return split(text.substr(colon + 1), "", false).front().text;
  }
  return {};
}

void restore_order(ClockLog& log) {
  const auto earlier = [](const Beat& a, const Beat& b) { return a.time < b.time; };
  const auto out_of_order = std::is_sorted_until(log.events.begin(), log.events.end(), earlier);
  if (out_of_order == log.events.end()) return;
  log.issues.push_back(
      {out_of_order->line, 1, "a time earlier than the one before", "events sorted by time"});
  std::stable_sort(log.events.begin(), log.events.end(), earlier);
}

std::string_view name_of(LogFormat format) {
  switch (format) {
  case LogFormat::native:
    return "goingrate's native log";
  case LogFormat::clock_error:
    return "a clock-error log (label s, error s, amplitude mrad)";
  case LogFormat::timestamps:
    break;
  }
  return "one time in seconds a line";
}

// The commonest step of the labels: a label is the time the clock should have shown.
double label_step(const std::vector<Line>& data) {
  std::map<std::int64_t, std::size_t> steps;
  std::optional<std::int64_t> last;
  for (const Line& line : data) {
    const auto fields = split(line.text, " \t", true);
    const auto label = fields.empty() ? std::nullopt : parse_instant(fields[0].text);
    if (!label || std::abs(label->to_double()) > 4e18) continue;
    if (last) ++steps[label->seconds - *last];
    last = label->seconds;
  }
  const auto commonest = std::max_element(steps.begin(), steps.end(),
                                          [](auto& a, auto& b) { return a.second < b.second; });
  return commonest == steps.end() ? 0.0 : static_cast<double>(commonest->first);
}

void settle_nominal_period(ClockLog& log, const Lines& lines, const ReadingOptions& options) {
  if (options.nominal_period_s) {
    log.nominal_period_s = options.nominal_period_s;
  } else if (log.format == LogFormat::clock_error) {
    const double step = label_step(lines.data);
    if (step > 0.0) {
      log.nominal_period_s = step;
      log.assumptions.push_back(fmt::format("nominal period {} s, the step of the labels", step));
    }
  } else if (const auto stated = header_value(lines.comments, "nominal_period_s")) {
    if (const auto value = parse_instant(*stated);
        value && value->to_double() > 1e-9 && value->to_double() < 1e9) {
      log.nominal_period_s = value->to_double();
      log.assumptions.push_back(fmt::format("nominal period {} s, from the header", *stated));
    }
  }
}

void refuse_if_mostly_bad(const ClockLog& log, std::size_t data_lines) {
  if (log.events.size() * 2 < data_lines && !log.issues.empty()) {
    const LineIssue& first = log.issues.front();
    throw InputError({log.source, first.line, first.column},
                     fmt::format("{} unusable lines out of {}, here first: {}", log.issues.size(),
                                 data_lines, first.found),
                     "a log of which at least half can be read");
  }
  if (log.events.size() < fewest_events)
    throw InputError(
        {log.source,
         data_lines == 0      ? 1
         : log.events.empty() ? 1
                              : log.events.back().line,
         1},
        fmt::format("{} event{}", log.events.size(), log.events.size() == 1 ? "" : "s"),
        fmt::format("at least {}", fewest_events));
}

} // namespace

ClockLog read_log(std::string_view text, const std::string& source, const ReadingOptions& options) {
  if (text.empty()) throw InputError({source, 1, 1}, "an empty file", "a log of events");
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3); // byte-order mark
  refuse_binary(text, source);
  const Lines lines = split_lines(text);
  if (lines.data.empty()) throw InputError({source, 1, 1}, "no line of data", "a log of events");

  ClockLog log;
  log.source = source;
  log.format = options.format ? *options.format : detect(lines.data, source);
  log.assumptions.push_back(fmt::format("format: {}{}", name_of(log.format),
                                        options.format ? "" : ", found from the first lines"));
  Collector collector(log, lines.data.size());
  switch (log.format) {
  case LogFormat::native:
    read_native(lines.data, source, collector);
    break;
  case LogFormat::timestamps:
    read_timestamps(lines.data, collector);
    break;
  case LogFormat::clock_error:
    read_clock_error(lines.data, collector);
    break;
  }
  const std::size_t headers = log.format == LogFormat::native ? 1 : 0;
  refuse_if_mostly_bad(log, lines.data.size() - headers);
  restore_order(log);
  settle_nominal_period(log, lines, options);
  return log;
}

std::vector<double> read_numbers(std::string_view text, const std::string& source) {
  if (text.empty()) throw InputError({source, 1, 1}, "an empty file", "one number a line");
  refuse_binary(text, source);
  std::vector<double> numbers;
  for (const Line& line : split_lines(text).data) {
    const auto fields = split(line.text, " \t,;", true);
    std::string_view word = fields.front().text;
    if (word == "nan" || word == "NaN" || word == "NAN") {
      numbers.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    if (word.front() == '+') word.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = fast_float::from_chars(word.data(), word.data() + word.size(), value);
    const bool whole = error == std::errc() && end == word.data() + word.size();
    if (!whole || !std::isfinite(value))
      throw InputError({source, line.number, fields.front().column}, shown(word), "a number");
    if (fields.size() > 1)
      throw InputError({source, line.number, fields[1].column}, shown(fields[1].text),
                       "one number a line");
    numbers.push_back(value);
  }
  if (numbers.size() < fewest_events)
    throw InputError({source, 1, 1}, fmt::format("{} numbers", numbers.size()),
                     fmt::format("at least {}", fewest_events));
  return numbers;
}

std::string read_text(const std::string& path) {
  if (path == "-") return {std::istreambuf_iterator<char>(std::cin), {}};
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0)
    throw InputError({path, 0, 0}, std::strerror(errno), "a readable file");
  if (S_ISDIR(status.st_mode)) throw InputError({path, 0, 0}, "a directory", "a readable file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError({path, 0, 0}, std::strerror(errno), "a readable file");
  return {std::istreambuf_iterator<char>(file), {}};
}

void correct_edge_to_centre(ClockLog& log, double edge_angle_rad, double period_s) {
  if (edge_angle_rad == 0.0) return;
  std::erase_if(log.events, [&](Beat& event) {
    if (!(event.amplitude_rad > std::abs(edge_angle_rad))) {
      log.issues.push_back({event.line, 1,
                            fmt::format("amplitude {} rad that does not reach the sensor's edge",
                                        event.amplitude_rad),
                            "event left out"});
      return true;
    }
    const double angle = event.edge == Edge::up ? edge_angle_rad : -edge_angle_rad;
    event.time = event.time + -std::asin(angle / event.amplitude_rad) * period_s / two_pi;
    return false;
  });
  log.assumptions.push_back(fmt::format(
      "times moved from the sensor's edge at {:g} mrad to the vertical, with each beat's amplitude",
      edge_angle_rad * 1e3));
}

} // namespace goingrate
