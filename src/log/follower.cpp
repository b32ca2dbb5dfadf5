// A log that is still being written.
#include "beginning.hpp"
#include "lines.hpp"
#include "row_reader.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <thread>

namespace goingrate {

namespace {

constexpr std::size_t enough_lines = 12; // a dozen beats show what they are
constexpr std::size_t enough_events = 8; // of these, where some lines say other things
constexpr std::size_t most_lines = 400;  // before the first that make sense

// Where in a text the log begins, and as what.
struct Start {
  Layout layout;
  std::string_view text; // from there on
  std::size_t lines = 0; // before it
};

std::string_view first_lines(std::string_view text, std::size_t count) {
  std::size_t end = 0;
  for (; count > 0 && end != text.npos; --count)
    end = text.find('\n', end == 0 ? 0 : end + 1);
  return text.substr(0, end == text.npos ? end : end + 1);
}

bool is_same(const Layout& a, const Layout& b) {
  const auto same_column = [](const LogColumn& one, const LogColumn& other) {
    return one.role == other.role && one.scale == other.scale && one.unit == other.unit;
  };
  return a.format == b.format && a.separator == b.separator && a.point == b.point &&
         a.calendar == b.calendar && a.channel == b.channel &&
         std::equal(a.columns.begin(), a.columns.end(), b.columns.begin(), b.columns.end(),
                    same_column);
}

// How many events the first lines of data give; none if more than a quarter of them give nothing.
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

// The first line from which on the text is a log; `known` is what it was before. A logger may say
// many things before its first beat.
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
      if (events >= enough_events || (events > 0 && known && is_same(layout, *known)))
        return Start{layout, text, skipped};
    } catch (const InputError&) { // not from this line on
    }
    const std::size_t end = text.find('\n');
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
  }
  return {};
}

} // namespace

struct LogFollower::Parts {
  Parts(std::string file, const ReadingOptions& reading, std::function<bool()> asked)
      : path(std::move(file)), options(reading), wait([this, ask = std::move(asked)] {
          gave_up = !ask();
          return !gave_up;
        }) {
    check(options);
    log.source = path;
    std::error_code unknown;
    is_file = path != "-" && std::filesystem::is_regular_file(path, unknown);
    lines.emplace(open_source(path, options.unpacked_limit, wait), path);
    settle();
  }

  // Looks at ever more lines until they make sense.
  void settle() {
    for (std::size_t enough = layout ? 1 : enough_lines;; enough += 1 + enough / 8) {
      const std::string_view text = lines->head(enough);
      const std::string_view whole_lines = text.substr(0, text.rfind('\n') + 1);
      if (const auto start = find_start(whole_lines, options, layout)) return use(*start);
      const bool is_all = lines->whole_is_in_head();
      if (is_all || enough > most_lines || is_of_another_kind(text)) return use_all(text, is_all);
    }
  }

  // What can be read but does not grow by one event a line is told at once.
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
    read_on(settle_layout(start.text, false, log, options), before);
  }

  // Without a beginning that makes sense: as it was before, or an error.
  void use_all(std::string_view text, bool is_all) {
    if (layout) return rows->begin_anew(1);
    read_on(settle_layout(text, is_all, log, options), 0);
  }

  void read_on(Layout found, std::uint32_t lines_before) {
    found.first_line += lines_before;
    // Seconds that fall to nothing are those of a logger that began again: were it midnight, one
    // could not tell after twelve hours.
    const auto time = found.find(ColumnRole::time);
    const bool seconds = time && found.columns[*time].unit == in_seconds;
    if (!found.calendar && !found.wrap_s && seconds) found.wrap_s = 0.0;
    if (found.format == LogFormat::angle || found.newest_first)
      throw InputError({path, found.first_line, 1},
                       found.newest_first ? "the newest line first" : "samples of an angle",
                       "a log that grows by one event a line");
    layout = std::move(found);
    rows.emplace(*layout, options, log);
  }

  // The file was written anew, or there is another of its name; false if nobody waits for it.
  bool begin_anew() {
    while (is_file && !gave_up) {
      try {
        lines.emplace(open_source(path, options.unpacked_limit, wait), path);
        settle();
        return true;
      } catch (const InputError&) { // it has gone once more
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        if (!wait()) return false;
      }
    }
    return false;
  }

  std::string path;
  ReadingOptions options;
  std::function<bool()> wait;
  bool gave_up = false;
  bool is_file = false;
  ClockLog log;
  std::optional<LineReader> lines;
  std::optional<Layout> layout;
  std::optional<RowReader> rows;
  std::size_t handed_out = 0; // of log.events
};

LogFollower::LogFollower(const std::string& path, const ReadingOptions& options,
                         std::function<bool()> wait)
    : parts_(std::make_unique<Parts>(path, options, std::move(wait))) {}

LogFollower::~LogFollower() = default;

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
  // The reader looks back at the last events: not all that were handed out can go.
  constexpr std::size_t beats_looked_back_at = 16, most_handed_out = 4096;
  if (parts_->handed_out > most_handed_out) {
    const std::size_t gone = parts_->handed_out - beats_looked_back_at;
    events.erase(events.begin(), events.begin() + static_cast<std::ptrdiff_t>(gone));
    parts_->handed_out -= gone;
    parts_->log.columns = {}; // nobody asks for them
  }
  return beat;
}

} // namespace goingrate
