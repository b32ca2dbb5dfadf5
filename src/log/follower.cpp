// A log that is still being written.
#include "beginning.hpp"
#include "lines.hpp"
#include "row_reader.hpp"

#include "sound/recording.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <thread>
#include <utility>

namespace goingrate {

namespace {

constexpr std::size_t enough_lines = 12; // enough to recognise the layout
constexpr std::size_t enough_events = 8; // among them, as some lines may be other text
constexpr std::string_view native_beginning = "# goingrate log:"; // then one event is enough
constexpr std::size_t most_lines = 400; // searched for the beginning of the log

// Where a log begins in a text, and its layout.
struct Start {
  Layout layout;
  std::string_view text; // from the beginning of the log
  std::size_t lines = 0; // before the log
};

std::string_view first_lines(std::string_view text, std::size_t count) {
  std::size_t end = 0;
  for (; count > 0 && end != text.npos; --count)
    end = text.find('\n', end == 0 ? 0 : end + 1);
  return text.substr(0, end == text.npos ? end : end + 1);
}

// Number of events in the first lines of data; 0 if more than a quarter of these are rejected.
std::size_t events_in(std::string_view text, const Layout& layout, const ReadingOptions& options) {
  constexpr std::size_t lines_looked_at = 16;
  text = first_lines(text, layout.first_line - 1 + lines_looked_at);
  ClockLog log;
  RowReader rows(layout, options, log);
  LineReader lines(text, log.source);
  while (const auto line = lines.next())
    rows.add(*line);
  return rows.rejected() * 4 > rows.data_lines() ? 0 : log.events.size();
}

// Searches for the first line from which the text is a log; `known` is the layout before. A logger
// may write other text before its first beat.
std::optional<Start> find_start(std::string_view text, const ReadingOptions& asked,
                                const std::optional<Layout>& known) {
  ReadingOptions options = asked;
  options.strict = false;
  for (std::size_t skipped = 0; skipped < most_lines && !text.empty(); ++skipped) {
    const std::string_view looked_at = first_lines(text, most_lines);
    try {
      ClockLog log;
      const Layout layout = settle_layout(looked_at, false, log, options);
      const std::size_t events = events_in(looked_at, layout, options);
      const bool is_sure = layout.format == LogFormat::native || (known && is_same(layout, *known));
      if (events >= enough_events || (events > 0 && is_sure)) return Start{layout, text, skipped};
    } catch (const InputError&) { // no log begins at this line
    }
    const std::size_t end = text.find('\n');
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
  }
  return {};
}

} // namespace

struct LogFollower::Parts {
  Parts(std::string file, const ReadingOptions& reading, Wait asked, std::string_view before)
      : path(std::move(file)), options(reading), wait([this, ask = std::move(asked)] {
          const bool is_seeking = lines && !rows;
          gave_up = !ask(is_seeking ? lines->at_hand() : std::string_view());
          return !gave_up;
        }) {
    check(options);
    log.source = path;
    std::error_code unknown;
    is_file = path != "-" && std::filesystem::is_regular_file(path, unknown);
    lines.emplace(open_source(path, options.unpacked_limit, wait), path, before);
    lines->cut_long_lines();
    settle();
  }

  // Reads more lines until a log is recognised.
  void settle() {
    const bool says_what_it_is = lines->head(1).starts_with(native_beginning);
    for (std::size_t line_count = layout || says_what_it_is ? 1 : enough_lines;;
         line_count += 1 + line_count / 8) {
      const std::string_view text = lines->head(line_count);
      if (is_sound(text))
        throw InputError({path}, "a recording of sound", "a log that grows line by line");
      const std::string_view whole_lines = text.substr(0, text.rfind('\n') + 1);
      if (const auto start = find_start(whole_lines, options, layout)) return use(*start);
      const bool is_all = lines->whole_is_in_head();
      if (is_all || line_count > most_lines || is_of_another_kind(text))
        return use_all(text, is_all);
    }
  }

  // Whether the text is a log of a kind that does not grow by one event per line: then no more lines
  // are awaited.
  [[nodiscard]] bool is_of_another_kind(std::string_view text) const {
    ClockLog unused;
    try {
      const Layout found = settle_layout(first_lines(text, most_lines), false, unused, options);
      return found.format == LogFormat::angle || found.newest_first;
    } catch (const InputError&) {
      return false;
    }
  }

  void use(const Start& start) {
    const auto before = static_cast<std::uint32_t>(start.lines);
    if (before > 0)
      IssueList(log, options.strict)
          .add(1, 1, IssueKind::header, fmt::format("{} lines that do not belong to a log", before),
               "left out");
    if (layout && is_same(start.layout, *layout))
      return rows->begin_anew(before + start.layout.first_line);
    const Layout found = settle_layout(start.text, false, log, options);
    if (found.first_line > 1) head = first_lines(start.text, found.first_line - 1);
    read_on(found, before);
  }

  // Without a recognised beginning, reading goes on with the layout before, if there is one;
  // otherwise the layout is taken from the text as a whole, or an error reports what is wrong.
  void use_all(std::string_view text, bool is_all) {
    if (layout) return rows->begin_anew(1);
    read_on(settle_layout(text, is_all, log, options), 0);
  }

  void read_on(Layout found, std::uint32_t lines_before) {
    found.first_line += lines_before;
    // Seconds that fall back to 0 show that the logger restarted. If they were allowed to wrap at
    // midnight, a restart after twelve hours could be taken for midnight.
    const auto time = found.find(ColumnRole::time);
    const bool seconds = time && found.columns[*time].unit == in_seconds;
    if (!found.calendar && !found.wrap_s && seconds) found.wrap_s = 0.0;
    if (found.format == LogFormat::angle || found.newest_first)
      throw InputError({path, found.first_line, 1},
                       found.newest_first ? "the newest line first" : "samples of an angle",
                       "a log that grows by one event per line");
    log.columns = {}; // those of a layout before
    layout = std::move(found);
    rows.emplace(*layout, options, log);
    is_first = true;
  }

  // Reopens a file that was rewritten or replaced; false if the caller stops waiting.
  bool begin_anew() {
    while (is_file && !gave_up) {
      try {
        lines.emplace(open_source(path, options.unpacked_limit, wait), path);
        lines->cut_long_lines();
        settle();
        return true;
      } catch (const InputError&) { // the file has disappeared again
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        if (!wait()) return false;
      }
    }
    return false;
  }

  // The row reader looks back at the last events, so these are kept.
  void forget_old() {
    constexpr std::size_t beats_looked_back_at = 16, most_handed_out = 4096;
    if (handed_out <= most_handed_out) return;
    const std::size_t gone = handed_out - beats_looked_back_at, left = log.events.size() - gone;
    const auto shorten = [left](auto& all) {
      if (all.size() > left) all.erase(all.begin(), all.end() - static_cast<std::ptrdiff_t>(left));
    };
    shorten(log.events);
    for (std::vector<double>* column : log.columns.all())
      shorten(*column);
    handed_out -= gone;
  }

  // A column's value of the event that was handed out last. A column that began later than the
  // events ends with them.
  [[nodiscard]] double last_of(const std::vector<double>& column) const {
    const std::size_t from_end = log.events.size() - handed_out + 1;
    return handed_out > 0 && column.size() >= from_end
               ? column[column.size() - from_end]
               : std::numeric_limits<double>::quiet_NaN();
  }

  std::string path;
  ReadingOptions options;
  std::function<bool()> wait;
  bool gave_up = false;
  bool is_file = false;
  ClockLog log;
  std::optional<LineReader> lines;
  std::optional<Layout> layout;
  std::string head; // the lines of the log before its data
  std::optional<RowReader> rows;
  std::size_t handed_out = 0; // of log.events
  bool is_first = true;       // no event of this layout was handed out
};

LogFollower::LogFollower(const std::string& path, const ReadingOptions& options,
                         Wait wait, std::string before)
    : parts_(std::make_unique<Parts>(path, options, std::move(wait), before)) {}

LogFollower::~LogFollower() = default;

const std::string& LogFollower::head() const { return parts_->head; }

const ClockLog& LogFollower::log() const { return parts_->log; }

std::optional<Beat> LogFollower::next() {
  auto& events = parts_->log.events;
  while (parts_->handed_out == events.size()) {
    const auto line = parts_->lines->next();
    if (line)
      parts_->rows->add(*line);
    else if (!parts_->begin_anew())
      return {};
  }
  const Beat beat = events[parts_->handed_out++];
  if (std::exchange(parts_->is_first, false))
    parts_->log.origin = origin_of(*parts_->layout, beat.time);
  parts_->forget_old();
  return beat;
}

EventValues LogFollower::values() const {
  const EventColumns& columns = parts_->log.columns;
  return {parts_->last_of(columns.width_s), parts_->last_of(columns.temperature_c),
          parts_->last_of(columns.pressure_mbar), parts_->last_of(columns.humidity_percent)};
}

} // namespace goingrate
