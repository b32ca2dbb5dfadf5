// Several files of one clock, read as one log.
#include "base/special_values.hpp"
#include "beginning.hpp"
#include "file_parts.hpp"
#include "typical_period.hpp"
#include "weather_quantities.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/log/beats.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

/// Reads the parts into one log, one after the other.
class Joining {
public:
  explicit Joining(const ReadingOptions& options) : options_(options) { check(options); }

  ClockLog run(const std::vector<std::string>& paths) {
    std::vector<Assumption> told;
    parts_ = file_parts(paths, options_, told);
    if (parts_.front().is_recording) {
      log_ = read_log_file(parts_.front().path, options_);
      log_.assumptions.insert(log_.assumptions.end(), told.begin(), told.end());
      return std::move(log_);
    }
    for (std::size_t i = 0; i < parts_.size(); ++i)
      read(i);
    log_.assumptions.insert(log_.assumptions.end(), told.begin(), told.end());
    refuse_what_is_not_one_clock();
    log_.source = paths.size() == 1
                      ? paths.front()
                      : fmt::format("{} and {} more", paths.front(), paths.size() - 1);
    complete(log_, *rows_, layout_, options_);
    return std::move(log_);
  }

private:
  void read(std::size_t i) {
    FilePart& part = parts_[i];
    LineReader lines(open_source(part.path, options_.unpacked_limit), part.path);
    (void)lines.head(head_lines); // settles how lines end
    lines.count_from(lines_read_);
    log_.source = part.path;
    log_.files.push_back({part.path, lines_read_, read_so_far()});
    Layout layout = part.layout;
    layout.first_line += lines_read_;
    if (i == 0)
      begin_first(layout);
    else if (is_alike(layout, layout_))
      rows_->begin_anew(layout.first_line);
    else
      begin_another(layout, part);
    take_statements(part);
    add_rows(lines, *rows_, [&](double share) { tell(static_cast<double>(i) + share); });
    lines_read_ = lines.number();
    tell(static_cast<double>(i + 1));
    fill_columns();
  }

  void tell(double files) const {
    if (options_.progress) options_.progress(files / static_cast<double>(parts_.size()));
  }

  // Events, or samples of an angle, which become events at the end.
  [[nodiscard]] std::size_t read_so_far() const {
    return log_.events.size() + (rows_ ? rows_->samples().size() : 0);
  }

  void begin_first(const Layout& layout) {
    const ClockLog& said = parts_.front().said;
    log_.format = layout.format;
    log_.directions_are_open = said.directions_are_open;
    log_.nominal_period_s = said.nominal_period_s;
    log_.flag_width_rad = said.flag_width_rad;
    log_.gravity_share = said.gravity_share;
    log_.assumptions = said.assumptions;
    layout_ = layout;
    rows_.emplace(layout_, options_, log_);
    std::size_t expected = 0;
    for (const FilePart& part : parts_)
      expected += part.lines_expected;
    rows_->reserve(room_for(expected));
  }

  // Whether the times of a layout do not depend on the lines before and after them.
  static bool can_change(const Layout& layout) {
    return layout.find(ColumnRole::time) && !layout.find(ColumnRole::clock_error) &&
           layout.format != LogFormat::angle && !layout.newest_first && !layout.wrap_s;
  }

  static bool is_alike(const Layout& a, const Layout& b) {
    return is_same(a, b) && a.wrap_s == b.wrap_s && a.tau0_s == b.tau0_s &&
           a.date_begins_run == b.date_begins_run && a.coarse_time == b.coarse_time;
  }

  void begin_another(const Layout& layout, const FilePart& part) {
    if (!(can_change(layout_) && can_change(layout)))
      throw InputError({part.path, part.layout.first_line, 1},
                       fmt::format("another layout than in {}", parts_.front().path),
                       "the same, for times that do not stand by themselves");
    for (const Assumption& assumption : part.said.assumptions)
      log_.assumptions.push_back({fmt::format("{}: {}", part.path, assumption.text),
                                  assumption.setting, assumption.value});
    for (const WeatherQuantity& quantity : weather_quantities)
      if (layout.find(quantity.role))
        (log_.columns.*quantity.values).resize(log_.events.size(), not_known);
    rows_->finish();
    layout_ = layout;
    RowReader next(layout_, options_, log_);
    next.go_on_from(*rows_);
    rows_.reset();
    rows_.emplace(std::move(next));
  }

  // Takes over the statements of a file's head, and its faults.
  void take_statements(const FilePart& part) {
    IssueList issues(log_, options_.strict);
    for (const LineIssue& issue : part.said.issues)
      issues.add(issue.line + lines_read_, issue.column, issue.kind, issue.found, issue.action);
    const auto refuse_if_other = [&](std::optional<double> stated, std::optional<double> before,
                                     std::string_view what) {
      if (stated && before && *stated != *before)
        throw InputError({part.path, 1, 1}, fmt::format("{} of {:.12g}", what, *stated),
                         fmt::format("{:.12g}, as in {}", *before, parts_.front().path));
    };
    refuse_if_other(part.said.nominal_period_s, log_.nominal_period_s, "a nominal period (s)");
    refuse_if_other(part.said.flag_width_rad, log_.flag_width_rad, "a flag's width (rad)");
    refuse_if_other(part.said.gravity_share, log_.gravity_share, "a share of gravity");
  }

  // A column that this file does not have is unknown in it.
  void fill_columns() {
    for (std::vector<double>* column : log_.columns.all())
      if (!column->empty()) column->resize(log_.events.size(), not_known);
  }

  // The times of file i, and their first and last lines.
  struct Range {
    std::size_t count = 0;
    Instant first, last;
    std::uint32_t first_line = 0, last_line = 0;
    void add(const Instant& time, std::uint32_t line) {
      if (count == 0 || time < first) first = time, first_line = line;
      if (count == 0 || last < time) last = time, last_line = line;
      ++count;
    }
  };

  [[nodiscard]] std::pair<std::size_t, std::size_t> places_of(std::size_t i) const {
    const auto& files = log_.files;
    return {files[i].events_before,
            i + 1 < files.size() ? files[i + 1].events_before : read_so_far()};
  }

  [[nodiscard]] Range range_of(std::size_t i) const {
    Range range;
    const auto [from, to] = places_of(i);
    for (std::size_t k = from; k < to; ++k)
      if (layout_.format == LogFormat::angle)
        range.add(rows_->samples()[k].time, rows_->samples()[k].line);
      else
        range.add(log_.events[k].time, log_.events[k].line);
    return range;
  }

  void refuse_what_is_not_one_clock() const {
    if (!layout_.find(ColumnRole::time)) return; // periods, and data on a grid
    std::optional<std::size_t> before, known; // the last file with events, the first with a period
    double period_s = 0.0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const auto [from, to] = places_of(i);
      if (from == to) continue;
      if (const auto period = period_of(i)) {
        if (known) refuse_another_period(i, *period, *known, period_s);
        if (!known) period_s = *period;
        known = known.value_or(i);
      }
      if (before) refuse_overlap(*before, i, period_s);
      before = i;
    }
  }

  void refuse_another_period(std::size_t i, double period_s, std::size_t known,
                             double known_s) const {
    constexpr double largest_difference = 0.02; // half an hour a day
    for (const double times : {0.5, 1.0, 2.0})  // both directions in one of them
      if (std::abs(period_s / (times * known_s) - 1.0) < largest_difference) return;
    throw InputError({parts_[i].path}, fmt::format("beats {:.6g} s apart", period_s),
                     fmt::format("those of one clock: they are {:.6g} s apart in {}", known_s,
                                 parts_[known].path));
  }

  // The same beat may be in both files, or have a label that is late.
  void refuse_overlap(std::size_t before, std::size_t i, double period_s) const {
    const Range a = range_of(before), b = range_of(i);
    const bool same = a.count == b.count && a.first == b.first && a.last == b.last;
    const bool ordered = parts_[i].date || layout_.format == LogFormat::angle;
    if (!same && !(ordered && a.last - b.first >= period_s)) return;
    throw InputError(
        log_.place(b.first_line),
        same ? fmt::format("the same times as in {}", parts_[before].path)
             : fmt::format("times that overlap those of {}, which end in its line {}",
                           parts_[before].path, log_.place(a.last_line).line),
        "files of one clock, one after the other; several clocks are compared, not joined");
  }

  // The period of one file as the numbering would find it, if the file is long enough.
  [[nodiscard]] std::optional<double> period_of(std::size_t i) const {
    constexpr std::size_t fewest_events = 20, events_looked_at = 5000;
    const auto [from, to] = places_of(i);
    if (layout_.format == LogFormat::angle || to - from < fewest_events) return {};
    const auto begin = log_.events.begin() + static_cast<std::ptrdiff_t>(from);
    ClockLog part;
    part.events.assign(begin,
                       begin + static_cast<std::ptrdiff_t>(std::min(events_looked_at, to - from)));
    try {
      mark_bounces(part);
      label_alternate_edges(part, false, options_.nominal_period_s);
      return typical_period(part.events, parts_[i].path, options_.nominal_period_s).mean_s;
    } catch (const InputError&) {
      return {};
    }
  }

  const ReadingOptions& options_;
  std::vector<FilePart> parts_;
  ClockLog log_;
  Layout layout_;
  std::optional<RowReader> rows_;
  std::uint32_t lines_read_ = 0;
};

} // namespace

ClockLog read_log_files(const std::vector<std::string>& paths, const ReadingOptions& options) {
  if (paths.size() == 1 && !holds_files(paths.front()))
    return read_log_file(paths.front(), options);
  return Joining(options).run(paths);
}

} // namespace goingrate
