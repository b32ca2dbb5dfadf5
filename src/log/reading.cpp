#include "goingrate/log/reading.hpp"

#include "beginning.hpp"
#include "column_names.hpp"
#include "issue_list.hpp"
#include "labx.hpp"
#include "layout_detection.hpp"
#include "log_parts.hpp"
#include "repairs.hpp"
#include "row_reader.hpp"
#include "sound_log.hpp"
#include "swing_circle.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace goingrate {

namespace {

constexpr std::size_t fewest_events = 3, // two periods: the least from which a rate has a scatter
    fewest_readings = 2;                 // of the weather, to draw a line between

// Numbers that the header states.
std::optional<double> stated(const LogHead& head, std::string_view key, double least, double most) {
  const auto text = head.value_of(key);
  const auto value = text ? parse_number(*text) : std::nullopt;
  return value && *value > least && *value < most ? value : std::nullopt;
}

std::optional<Site> stated_site(const LogHead& head) {
  constexpr double pole_margin_deg = 1e-9; // degrees: the poles themselves will do
  const auto latitude =
      stated(head, "latitude_deg", -90.0 - pole_margin_deg, 90.0 + pole_margin_deg);
  const auto longitude =
      stated(head, "longitude_deg", -180.0 - pole_margin_deg, 360.0 + pole_margin_deg);
  return latitude && longitude ? std::optional(Site{*latitude, *longitude}) : std::nullopt;
}

void settle_nominal_period(ClockLog& log, const LogHead& head, const Layout& layout,
                           const ReadingOptions& options) {
  log.flag_width_rad = stated(head, "flag_width_rad", 0.0, 1.0);
  log.gravity_share = stated(head, "gravity_share", -10.0, 1.5);
  log.site = stated_site(head);
  if (layout.find(ColumnRole::phase) || layout.find(ColumnRole::frequency)) {
    log.nominal_period_s = layout.tau0_s;
  } else if (options.nominal_period_s) {
    log.nominal_period_s = options.nominal_period_s;
  } else if (layout.label_step_s > 0.0) {
    log.nominal_period_s = layout.label_step_s;
    log.assumptions.push_back(
        {fmt::format("nominal period {} s, the step of the labels", layout.label_step_s),
         Setting::nominal_period});
  } else if (const auto value = stated(head, "nominal_period_s", 1e-9, 1e9)) {
    log.nominal_period_s = value;
    log.assumptions.push_back(
        {fmt::format("nominal period {} s, from the header", *value), Setting::nominal_period});
  }
}

void refuse_if_mostly_bad(const ClockLog& log, const RowReader& rows) {
  if (rows.rejected() * 2 <= rows.data_lines() || log.issues.empty()) return;
  const auto line = std::find_if(log.issues.begin(), log.issues.end(), [](const LineIssue& issue) {
    return issue.kind != IssueKind::header;
  });
  const LineIssue& first = line == log.issues.end() ? log.issues.front() : *line;
  const FaultWords words = words_of(first.found);
  throw InputError(log.place(first.line, first.column),
                   fmt::format("{} unusable lines out of {}, here first: {}{}{}", rows.rejected(),
                               rows.data_lines(), words.found,
                               words.expected.empty() ? "" : " instead of ", words.expected),
                   "a log of which at least half can be read");
}

// Checks for another column that swings, or for crossings that were timed by other software.
std::vector<OtherReading> readings_beside_angle(const Layout& layout) {
  std::vector<OtherReading> others;
  if (layout.swinging)
    others.push_back({.words = fmt::format("column {} swings", *layout.swinging + 1),
                      .columns = {fmt::format("angle={}", *layout.swinging + 1)}});
  others.push_back({.words = "each line is a crossing, timed", .format = LogFormat::table});
  if (others.size() < 2)
    others.push_back({.words = "the angle stands in another column", .columns = {"angle=3"}});
  return others;
}

void refuse_if_too_few(const ClockLog& log, const RowReader& rows, const Layout& layout,
                       bool weather) {
  const std::size_t fewest = weather ? fewest_readings : fewest_events;
  if (log.events.size() >= fewest) return;
  if (log.events.empty() && rows.other_channels() > 0)
    throw InputError(log.place(layout.first_line),
                     fmt::format("{} lines of other channels", rows.other_channels()),
                     fmt::format("lines of channel {}", layout.channel));
  if (layout.format == LogFormat::angle)
    throw ImpossibleReading(log.place(layout.first_line),
                            fmt::format("{} samples of an angle with {} crossings",
                                        rows.samples().size(), log.events.size()),
                            "three swings or more", readings_beside_angle(layout));
  const std::size_t line = log.events.empty() ? 1 : log.events.back().line;
  throw InputError(log.place(line),
                   fmt::format("{} {}{}", log.events.size(),
                               weather    ? "reading"
                               : log.grid ? "value"
                                          : "event",
                               log.events.size() == 1 ? "" : "s"),
                   fmt::format("at least {}", fewest));
}

// Turns places of the bob into angles about the centre of its arc; returns whether that was
// possible.
bool take_angles(std::vector<AngleSample>& samples, const std::vector<double>& heights,
                 ClockLog& log) {
  std::vector<double> x;
  for (const AngleSample& sample : samples)
    x.push_back(sample.angle);
  const auto circle = circle_through(x, heights);
  if (!circle) {
    log.assumptions.push_back({"the arc is too flat to tell the length of the pendulum: only x is "
                               "read, and there are no amplitudes",
                               Setting::columns, "angle=N"});
    return false;
  }
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i].angle = circle->angle_of(x[i], heights[i]);
  log.assumptions.push_back(
      {fmt::format("angles are those about ({:.4g}, {:.4g}), the centre of the circle through the "
                   "places: a pendulum {:.6g} ± {:.2g} long, in their unit",
                   circle->x, circle->y, circle->radius, circle->radius_sigma)});
  return true;
}

// Samples of an angle become the events.
void find_crossings(const RowReader& rows, const Layout& layout, const ReadingOptions& options,
                    ClockLog& log, IssueList& issues) {
  auto samples = rows.samples();
  const bool in_rad = layout.find(ColumnRole::angle) ||
                      (!rows.heights().empty() && take_angles(samples, rows.heights(), log));
  if (layout.newest_first) std::reverse(samples.begin(), samples.end());
  std::stable_sort(samples.begin(), samples.end(),
                   [](const AngleSample& a, const AngleSample& b) { return a.time < b.time; });
  const auto swings = crossings_of_samples(samples, options.rest_angle_rad, in_rad);
  if (swings.samples_per_period > 0.0 && swings.samples_per_period < fewest_samples_per_period)
    throw InputError(
        log.place(layout.first_line),
        fmt::format("sampled too coarsely: {:.2g} samples per period", swings.samples_per_period),
        fmt::format("at least {}", fewest_samples_per_period));
  for (const SampledCrossing& crossing : swings.crossings) {
    const bool known = in_rad && crossing.amplitude > 0.0 && crossing.amplitude < 3.14;
    const double amplitude = known ? crossing.amplitude : std::numeric_limits<double>::quiet_NaN();
    log.events.push_back(event_at(crossing.time, crossing.edge, crossing.line, amplitude));
    log.columns.sigma_s.push_back(crossing.sigma_s);
    log.has_amplitude = log.has_amplitude || known;
  }
  if (swings.unfitted > 0)
    issues.add(samples.front().line, 1, IssueKind::gap,
               fmt::format("{} passages with too few samples around them", swings.unfitted),
               "taken as missing");
  log.assumptions.push_back({fmt::format("{} samples, whose noise is {:.2g}, give {} crossings",
                                         samples.size(), swings.noise, swings.crossings.size())});
  if (!options.rest_angle_rad)
    log.assumptions.push_back({fmt::format("the pendulum hangs at {:.6g}{}, the middle of its "
                                           "swings",
                                           swings.rest_angle, in_rad ? " rad" : ""),
                               Setting::rest_angle});
}

// Times of crossings may be those of one direction or of both. A log of our own has a column of
// edges where it holds both. The state of a light gate tells no direction.
bool directions_are_open(const LogHead& head, const Layout& layout) {
  const auto has = [&](ColumnRole role) { return layout.find(role).has_value(); };
  const auto edge = layout.find(ColumnRole::edge);
  const bool tells_edges = edge && !names_gate_state(layout.columns[*edge].name);
  return has(ColumnRole::time) && !tells_edges && !has(ColumnRole::clock_error) &&
         layout.format != LogFormat::angle && !head.value_of("goingrate log");
}

} // namespace

Layout settle_layout(std::string_view text, bool whole, ClockLog& log,
                     const ReadingOptions& options) {
  const LogHead head = cut_head(text, whole, log.source, options.decimal_comma);
  Layout layout = detect_layout(head, options, log);
  log.format = layout.format;
  log.directions_are_open = directions_are_open(head, layout);
  settle_nominal_period(log, head, layout, options);
  return layout;
}

// 1e-9 s to 1e9 s: from a tick of the finest counter to thirty years.
void check(const ReadingOptions& options) {
  const auto within = [](std::string_view name, std::optional<double> value, double least) {
    if (value && !(*value >= least && *value <= 1e9))
      throw ArgumentError(name, *value, fmt::format("between {} and 1e9 s", least));
  };
  within("nominal-period", options.nominal_period_s, 1e-9);
  within("tau0", options.tau0_s, 1e-9);
  if (options.counter_hz && !(*options.counter_hz >= 1.0 && *options.counter_hz <= 1e12))
    throw ArgumentError("counter-hz", *options.counter_hz, "between 1 and 1e12 Hz");
  if (options.wrap_s != 0.0) within("wrap", options.wrap_s, 1e-9);
  if (options.rest_angle_rad && !(std::abs(*options.rest_angle_rad) <= std::numbers::pi))
    throw ArgumentError("rest-angle", *options.rest_angle_rad, "between -pi and pi rad");
}

namespace {

// A log that had its newest line first can be unwrapped only now.
void unwrap_turned(ClockLog& log, Layout layout, const ReadingOptions& options) {
  layout.newest_first = false;
  Unwrapper unwrap(unwrapping(layout, options.nominal_period_s));
  double typical_step_s = 0.0;
  Instant before = log.events.front().time;
  for (Beat& event : log.events) {
    const double step = event.time - before;
    before = event.time;
    event.time = unwrap(event.time, [&] { return typical_step_s; });
    if (step > 0.0) // of the last eight or so
      typical_step_s += (step - typical_step_s) * (typical_step_s > 0.0 ? 0.125 : 1.0);
  }
  if (unwrap.wraps() > 0)
    log.assumptions.push_back(
        {fmt::format("the times begin again {} time{}, every {:.12g} s", unwrap.wraps(),
                     unwrap.wraps() == 1 ? "" : "s", unwrap.wrap_s()),
         Setting::wrap});
}

// False at the end.
bool add_next(LineReader& lines, RowReader& rows) {
  const auto line = lines.next();
  if (line) rows.add(*line);
  return line.has_value();
}

} // namespace

void refuse_another_format(bool sound, const std::string& name, const ReadingOptions& options) {
  if (options.format && sound != (*options.format == LogFormat::sound))
    throw InputError({name}, sound ? in_words(LogFormat::sound) : "no sound that is known",
                     sound ? in_words(*options.format) : "a recording: WAV, FLAC or OGG");
}

bool is_same(const Layout& a, const Layout& b) {
  const auto same_column = [](const LogColumn& one, const LogColumn& other) {
    return one.role == other.role && one.scale == other.scale && one.offset == other.offset &&
           one.unit == other.unit;
  };
  return a.format == b.format && a.separator == b.separator && a.point == b.point &&
         a.calendar == b.calendar && a.month_first == b.month_first && a.channel == b.channel &&
         a.newest_first == b.newest_first &&
         std::equal(a.columns.begin(), a.columns.end(), b.columns.begin(), b.columns.end(),
                    same_column);
}

bool are_dates(const Layout& layout, const Instant& first) {
  const auto time = layout.find(ColumnRole::time);
  constexpr double years_s = 1e8;
  return time && ((layout.calendar && !layout.wrap_s) || layout.columns[*time].unit == in_days ||
                  first.to_double() > years_s);
}

TimeOrigin origin_of(const Layout& layout, const Instant& first) {
  if (!are_dates(layout, first)) return TimeOrigin::none;
  const bool days = layout.columns[*layout.find(ColumnRole::time)].unit == in_days;
  return days && !layout.calendar ? TimeOrigin::mjd : TimeOrigin::epoch;
}

// Leaves a margin, since the lines of a file differ in length.
std::size_t room_for(std::size_t lines_expected) {
  constexpr double margin = 1.02;
  return static_cast<std::size_t>(margin * static_cast<double>(lines_expected));
}

bool add_rows(LineReader& lines, RowReader& rows, const std::function<void(double)>& progress,
              std::size_t most_events) {
  constexpr std::uint32_t between_reports = 1 << 16; // lines
  std::uint32_t reported = lines.number();
  do {
    const auto plain = rows.add_plain(lines.at_hand(), lines.number() + 1);
    lines.skip(plain.bytes, plain.lines);
    if (progress && lines.number() >= reported + between_reports) {
      reported = lines.number();
      progress(lines.fraction_read().value_or(0.0));
    }
    if (rows.events() >= most_events) return false;
  } while (add_next(lines, rows));
  return true;
}

void complete(ClockLog& log, RowReader& rows, const Layout& layout, const ReadingOptions& options) {
  rows.finish();
  refuse_if_mostly_bad(log, rows);
  IssueList issues(log, options.strict);
  if (layout.format == LogFormat::angle) find_crossings(rows, layout, options, log, issues);
  refuse_if_too_few(log, rows, layout, options.weather);
  if (layout.newest_first && layout.format != LogFormat::angle) {
    turn_round(log);
    if (!log.grid) unwrap_turned(log, layout, options);
  }
  log.origin = origin_of(layout, log.events.front().time);
  if (layout.label_step_s > 0.0) {
    std::vector<double>& errors_s = rows.clock_errors();
    if (layout.newest_first) std::reverse(errors_s.begin(), errors_s.end());
    const double step_s =
        level_labels(log, errors_s, options.nominal_period_s.value_or(layout.label_step_s), issues);
    if (!options.nominal_period_s && step_s != layout.label_step_s) {
      log.nominal_period_s = step_s;
      std::erase_if(log.assumptions, [](const Assumption& assumption) {
        return assumption.setting == Setting::nominal_period;
      });
    }
    mend_label_jitter(log, layout.label_step_s, issues);
  }
  // Looking through a long log again takes a tenth of the time for reading it, so it is done only
  // if times were not appended unchanged.
  const bool as_read = !layout.find(ColumnRole::clock_error) && layout.format != LogFormat::angle &&
                       !layout.newest_first;
  if (!log.grid && (!as_read || !rows.in_order()))
    restore_order(log, are_dates(layout, log.events.front().time), issues);
}

namespace {

ClockLog whole_of(LineReader& lines, const ReadingOptions& options) {
  LogParts parts(lines, options);
  parts.read();
  return std::move(parts.log());
}

} // namespace

ClockLog read_log(std::string_view text, const std::string& source, const ReadingOptions& options) {
  constexpr std::size_t head_bytes = 1024; // tell a measurement
  const bool is_table = !is_labx(text.substr(0, head_bytes));
  const std::string table = is_table ? std::string() : table_of_labx(text, source);
  LineReader lines(is_table ? text : std::string_view(table), source);
  return whole_of(lines, options);
}

ClockLog read_log_file(const std::string& path, const ReadingOptions& options) {
  if (is_sound_on_disk(path)) { // hours of it need not lie in memory
    check(options);
    refuse_another_format(true, path, options);
    return read_recording(Recording::on_disk(path), path, options);
  }
  LineReader lines(open_source(path, options.unpacked_limit), path);
  return whole_of(lines, options);
}

} // namespace goingrate
