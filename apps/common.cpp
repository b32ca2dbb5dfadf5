#include "common.hpp"

#include "base/printable.hpp"
#include "goingrate/report/tables.hpp"
#include "progress.hpp"
#include "terminal.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <functional>

namespace goingrate::apps {

namespace {
constexpr std::size_t issues_shown = 5; // the rest is counted; `rate --json` lists all of them

CLI::Validator number_that(bool (*holds)(double), const char* words) {
  return {[holds, words](std::string& text) {
            char* end = nullptr;
            const double value = std::strtod(text.c_str(), &end);
            const bool whole = !text.empty() && *end == '\0';
            return whole && std::isfinite(value) && holds(value)
                       ? std::string()
                       : fmt::format("{} is not a number {}", text, words);
          },
          ""};
}
} // namespace

CLI::Validator positive() {
  return number_that([](double value) { return value > 0.0; }, "above 0");
}
CLI::Validator not_negative() {
  return number_that([](double value) { return value >= 0.0; }, "from 0 on");
}
CLI::Validator seed_range() {
  return number_that([](double value) { return value >= 0.0 && value < 0x1p64; },
                     "from 0 to 2^64 - 1");
}

void say(const GlobalOptions& global, std::string_view line) {
  if (global.quiet) return;
  // In a file or a pipe a note stays on one line, for programs that read it.
  const std::string shown = printable(line);
  if (!error_is_terminal()) {
    std::fputs((shown + '\n').c_str(), stderr);
    return;
  }
  constexpr const char* wipe = "\r\x1b[K"; // what a line of progress may have left
  const std::string lines = wrapped(shown, line_columns, 2);
  const std::size_t colon = lines.find(": ");
  const bool has_kind = colon < lines.find(' '); // "assumed: ...", "warning: ..."
  const std::string kind = has_kind ? lines.substr(0, colon + 1) : "";
  const Paint paint = kind == "warning:" ? Paint::warning : Paint::note;
  std::fputs(
      fmt::format("{}{}{}\n", wipe, kind.empty() ? "" : painted(kind, paint),
                  lines.substr(kind.size()))
          .c_str(),
      stderr);
}

void add_log_options(CLI::App& command, LogOptions& options) {
  command
      .add_option("log", options.paths,
                  "the log, gzip or not; '-' is standard input. Several files, a folder or a ZIP "
                  "are read as one log of one clock")
      ->required();
  add_log_settings(command, options);
}

namespace {

void add_weather_options(CLI::App& command, WeatherRequest& weather, std::string& site) {
  constexpr const char* group = "The surroundings of the clock";
  auto* files =
      command
          .add_option("--weather", weather.files,
                      "table with a header, with columns for the time and for temperature, "
                      "pressure or humidity; its readings are interpolated to the beats")
          ->allow_extra_args(false)
          ->group(group);
  command
      .add_option("--weather-zone", weather.zone,
                  "time zone of the table's dates, such as +01:00, if they name none and the "
                  "log's dates are in another zone")
      ->needs(files)
      ->group(group);
  command.add_option("--weather-offset", weather.offset_s, "s to add to the table's times")
      ->needs(files)
      ->group(group);
  command
      .add_option("--site", site,
                  "LATITUDE,LONGITUDE of the clock, degrees, north and east positive: gives the "
                  "effect of Moon and Sun on the rate of a dated log")
      ->group(group);
}

} // namespace

void add_log_settings(CLI::App& command, LogOptions& options) {
  command
      .add_option("--nominal-period", options.nominal_period_s,
                  "T0 in s, the period to compare with")
      ->check(positive());
  command.add_flag(
      "--both-edges", options.both_edges,
      "the log holds crossings in both directions, without labels; recognised without this "
      "option if the clock is out of beat");
  command
      .add_option("--flag-width", options.flag_width_rad,
                  "angle (rad) of a centred flag as seen from the pivot. With a column of widths "
                  "it gives the amplitudes. Without one, the times are those of the flag's leading "
                  "edge and are moved to the vertical with each beat's amplitude")
      ->check(CLI::Range(0.0, 1.0) & not_negative());
  command
      .add_option("--gravity-share", options.gravity_share,
                  "share of gravity in the restoring torque; the rest is a spring's. 1: a "
                  "pendulum, 0: torsion. Used for the circular error, for amplitudes from "
                  "--flag-width and in the fit. Without it: as the log states it, or 1")
      ->check(CLI::Range(-10.0, 1.5));
  auto* place = command.add_option(
      "--sensor-offset", options.sensor_offset,
      "angle (rad) of the sensor from the vertical: the times are moved to the vertical, and the "
      "two half-periods give amplitudes; auto: estimated from the log");
  offers(place, {"auto"});
  command
      .add_option("--gap-probability", options.gap_probability,
                  "split the log at a gap whose count is right with less than this probability")
      ->check(CLI::Range(0.5, 1.0) & not_negative())
      ->capture_default_str();
  command
      .add_option(
          "--dead-time", options.dead_time_s,
          "for a contact that bounces: events within this many s after an edge are bounces; 0: "
          "there are none; estimated from the log if not given")
      ->check(not_negative());
  add_reading_options(command, options);
  add_weather_options(command, options.weather, options.site);
}

void add_reading_options(CLI::App& command, LogOptions& options) {
  constexpr const char* group = "How the log is read (recognised and reported if not given)";
  std::vector<std::string> formats = format_names();
  formats.insert(formats.end(), {"labx", "zip"}); // recognised without the option
  command.add_option("--format", options.format, "what kind of log it is")
      ->check(one_of(formats))
      ->group(group);
  std::vector<std::string> roles = role_names();
  for (std::string& role : roles)
    role += '=';
  auto* column = command.add_option(
      "--column", options.columns,
      "what a column holds: ROLE=PLACE[:UNIT], the place counted from 1 or a name of the header; "
      "time=2, date=1, period=3:us, amplitude=5:mrad, angle=2:deg, error, width, edge, "
      "temperature, pressure, humidity, ignored");
  offers(column, roles)->allow_extra_args(false)->group(group);
  command.add_option("--unit", options.unit, "of the times: s, ms, us, ns, min, h, d, mjd")
      ->check(one_of({"s", "ms", "us", "ns", "min", "h", "d", "mjd"}))
      ->group(group);
  command
      .add_option("--wrap", options.wrap_s,
                  "the times start again after this many s; 0: they never do. With "
                  "--nominal-period also for counters that overflow more than once a beat")
      ->check(not_negative())
      ->group(group);
  command.add_option("--tau0", options.tau0_s, "s between values of phase, frequency or intervals")
      ->check(positive())
      ->group(group);
  command
      .add_option("--counter-hz", options.counter_hz,
                  "for a log in cycles of a counter: cycles in a second")
      ->check(positive() & CLI::Range(1.0, 1e12))
      ->group(group);
  command.add_flag("--decimal-comma", options.decimal_comma, "12,5 is twelve and a half")
      ->group(group);
  command
      .add_option("--date-order", options.date_order,
                  "what comes first in dates such as 03/04/2013: day or month")
      ->check(one_of({"day", "month"}))
      ->group(group);
  auto* channel = command.add_option(
      "--channel", options.channels,
      "for a TICC: chA or chB; for a recording: beat=1, or just 1, is the channel in which the "
      "clock is heard, and pps=2 that of a reference that clicks once a second");
  offers(channel, {"chA", "chB", "beat=", "pps="})->allow_extra_args(false)->group(group);
  command
      .add_option("--clock-ppm", options.clock_ppm,
                  "for a recording: standard deviation of the sampling rate, parts in a million")
      ->check(not_negative() & CLI::Range(0.0, 1e5))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--rest-angle", options.rest_angle_rad,
                  "for angle samples: the angle (rad) at which the pendulum hangs at rest")
      ->group(group);
  command
      .add_option("--unpacked-limit", options.unpacked_limit_gib,
                  "largest size of a packed log after unpacking, GiB")
      ->check(positive() & CLI::Range(0.0, 1e9))
      ->capture_default_str()
      ->group(group);
  command
      .add_flag("--strict", options.strict, "stop with an error at the first faulty line")
      ->group(group);
}

namespace {

// "chB", or "beat=1", "1" (the same), "pps=2".
void take_channel(const std::string& words, ReadingOptions& reading) {
  const std::size_t equals = words.find('=');
  const bool is_number =
      !words.empty() && words.find_first_not_of("0123456789") == std::string::npos;
  if (equals == std::string::npos && !is_number) {
    reading.channel = words;
    return;
  }
  const std::string role = is_number ? "beat" : words.substr(0, equals);
  std::size_t number = 0;
  const char* end = words.data() + words.size();
  const auto parsed = std::from_chars(words.data() + (is_number ? 0 : equals + 1), end, number);
  if (parsed.ec != std::errc() || parsed.ptr != end || (role != "beat" && role != "pps"))
    throw CLI::ValidationError("--channel", fmt::format("found {}, expected chA, chB, NUMBER, "
                                                        "beat=NUMBER or pps=NUMBER",
                                                        words));
  if (role == "beat") reading.beat_channel = number;
  if (role == "pps") reading.pps_channel = number;
}

} // namespace

ReadingOptions reading_options(const LogOptions& options) {
  ReadingOptions reading;
  if (options.format == "labx")
    reading.format = LogFormat::table;
  else if (!options.format.empty())
    reading.format = format_named(options.format);
  if (options.nominal_period_s > 0.0) reading.nominal_period_s = options.nominal_period_s;
  if (options.tau0_s > 0.0) reading.tau0_s = options.tau0_s;
  if (options.counter_hz > 0.0) reading.counter_hz = options.counter_hz;
  if (!options.unit.empty()) reading.unit = unit_named(options.unit);
  reading.columns = options.columns;
  reading.wrap_s = options.wrap_s;
  reading.rest_angle_rad = options.rest_angle_rad;
  reading.decimal_comma = options.decimal_comma;
  if (!options.date_order.empty()) reading.month_first = options.date_order == "month";
  for (const std::string& channel : options.channels)
    take_channel(channel, reading);
  reading.clock_ppm = options.clock_ppm;
  reading.strict = options.strict;
  reading.unpacked_limit = static_cast<std::uint64_t>(options.unpacked_limit_gib * gib);
  return reading;
}

std::string words_for(const LineIssue& issue, const ClockLog& log) {
  const TextPlace first = log.place(issue.line), last = log.place(issue.last_line);
  const std::string lines =
      issue.scattered && issue.lines > 1
          ? fmt::format(" (as in {} lines from here to line {})", issue.lines, last.line)
      : issue.last_line > issue.line ? fmt::format(" (and on to line {})", last.line)
                                     : std::string();
  return fmt::format("{}:{}:{}: {}: {}{}", first.file, first.line, issue.column, issue.found,
                     issue.action, lines);
}

namespace {

std::string split_text(const Gap& gap) {
  const std::string place = fmt::format("the log is split after cycle {}: ", gap.after_cycle);
  if (gap.kind == GapKind::restart)
    return place + "the time goes back there, and a new segment begins; the longest part is used";
  if (gap.kind == GapKind::gap && gap.probability >= 0.99)
    return place + fmt::format("about {} beats are missing, too many to be sure of their number; "
                               "the longest part is used",
                               gap.length);
  if (gap.kind == GapKind::step)
    return place + "later times are displaced, as if the reference clock had been set; the longest "
                   "part is used";
  if (gap.probability == 0.0 && gap.kind == GapKind::gap)
    return place +
           fmt::format("about {} beats are missing, more than ten times the log's longest run, "
                       "which is the most that can be counted; the longest part is used",
                       gap.length);
  constexpr double least_shown = 1e-3;
  const std::string probability =
      gap.probability < least_shown
          ? fmt::format("below {}", least_shown)
          : fmt::format("{:.3f}", std::floor(gap.probability / least_shown) * least_shown);
  return place + fmt::format("about {} beats are missing, a count that is right with probability "
                             "{}{}; the longest part is used",
                             gap.length, probability,
                             gap.kind == GapKind::stop ? " (the clock seems to have stopped)" : "");
}

void tell_about(const NumberedLog& loaded, const GlobalOptions& global) {
  for (const Assumption& assumption : loaded.log.assumptions)
    say(global, "assumed: " + assumption.text);
  const auto& issues = loaded.log.issues;
  for (std::size_t i = 0; i < std::min(issues.size(), issues_shown); ++i)
    say(global, words_for(issues[i], loaded.log));
  if (issues.size() > issues_shown)
    say(global, fmt::format("... and {} more issues (rate --json lists all)",
                            issues.size() - issues_shown));
  std::size_t splits = 0;
  for (const Gap& gap : loaded.beats.gaps)
    if (!gap.bridged && ++splits <= issues_shown) say(global, split_text(gap));
  if (splits > issues_shown)
    say(global, fmt::format("... and {} more splits", splits - issues_shown));
  constexpr double largest_swing_rad = 1.0; // rad: no clock swings so far
  if (loaded.sensor.amplitude && loaded.sensor.amplitude->mean_rad > largest_swing_rad)
    say(global,
        fmt::format("warning: the amplitudes, with a mean of {:.3g}, were taken for radians; if "
                    "they are not, give their unit: --column amplitude=NAME:deg (or mrad)",
                    loaded.sensor.amplitude->mean_rad));
}

} // namespace

LoadRequest load_request(const LogOptions& options) {
  LoadRequest request;
  if (!options.paths.empty()) {
    request.path = options.paths.front();
    request.more.assign(options.paths.begin() + 1, options.paths.end());
  }
  request.reading = reading_options(options);
  request.weather = options.weather;
  if (!options.site.empty()) {
    request.site = parse_site(options.site);
    if (!request.site)
      throw ArgumentError("site", options.site,
                          "LATITUDE,LONGITUDE in degrees, north and east positive, such as "
                          "51.48,-0.0015");
  }
  request.both_edges = options.both_edges;
  request.dead_time_s = options.dead_time_s;
  if (options.flag_width_rad > 0.0) request.flag_width_rad = options.flag_width_rad;
  request.gravity_share = options.gravity_share;
  request.find_sensor_offset = options.sensor_offset == "auto";
  if (!options.sensor_offset.empty() && !request.find_sensor_offset)
    request.sensor_offset_rad = numbers_in("sensor-offset", options.sensor_offset).front();
  request.gap_probability = options.gap_probability;
  request.phases_will_do = options.phases_will_do;
  return request;
}

NumberedLog load(const LogOptions& options, const GlobalOptions& global) {
  LoadRequest request = load_request(options);
  request.part_events = request.most_beats = most_events_at_once;
  return load(std::move(request), global);
}

NumberedLog load(LoadRequest request, const GlobalOptions& global, const LogVisitor& visit) {
  NumberedLog loaded;
  {
    ProgressBar bar(global.quiet, "reading " + request.path);
    request.reading.progress = std::ref(bar);
    loaded = goingrate::load(request, visit);
  }
  name_options(loaded.log.assumptions);
  tell_about(loaded, global);
  return loaded;
}

namespace {

std::string_view option_of(Setting setting) {
  switch (setting) {
  case Setting::none:
    break;
  case Setting::format:
    return "--format";
  case Setting::columns:
    return "--column";
  case Setting::unit:
    return "--unit";
  case Setting::wrap:
    return "--wrap";
  case Setting::tau0:
    return "--tau0";
  case Setting::counter_rate:
    return "--counter-hz";
  case Setting::decimal_comma:
    return "--decimal-comma";
  case Setting::date_order:
    return "--date-order";
  case Setting::channel:
    return "--channel";
  case Setting::pps_channel:
    return "--channel pps=NUMBER";
  case Setting::clock_ppm:
    return "--clock-ppm";
  case Setting::rest_angle:
    return "--rest-angle";
  case Setting::nominal_period:
    return "--nominal-period";
  case Setting::both_edges:
    return "--both-edges";
  case Setting::flag_width:
    return "--flag-width";
  case Setting::weather:
    return "--weather";
  case Setting::weather_zone:
    return "--weather-zone";
  case Setting::site:
    return "--site";
  }
  return {};
}

} // namespace

void name_options(std::vector<Assumption>& assumptions) {
  for (Assumption& assumption : assumptions) {
    if (assumption.setting == Setting::none) continue;
    assumption.text += fmt::format(" (see {}{}{})", option_of(assumption.setting),
                                   assumption.value.empty() ? "" : " ", assumption.value);
    assumption.setting = Setting::none;
  }
}

void name_options(FitSummary& fit) {
  for (FitNote& note : fit.notes)
    if (note.kind == NoteKind::twin && fit.amplitude_residual_rad.empty())
      note.text += " (--prior lambda0=VALUE+-SIGMA)";
}

std::string options_for(const OtherReading& other) {
  std::string words;
  const auto add = [&](const std::string& option) { words += " --" + option; };
  if (other.format) add(fmt::format("format {}", name_of(*other.format)));
  for (const std::string& column : other.columns)
    add("column " + column);
  if (!other.unit.empty()) add("unit " + other.unit);
  if (other.wrap_s) add(fmt::format("wrap {}", *other.wrap_s));
  if (other.tau0_s) add(fmt::format("tau0 {}", *other.tau0_s));
  if (other.nominal_period_s) add(fmt::format("nominal-period {:.6g}", *other.nominal_period_s));
  if (other.both_edges) add("both-edges");
  return words.substr(1);
}

std::string table_output(const std::string& output, const std::string& json) {
  if (!output.empty()) return output;
  return json == "-" ? "" : "-";
}

void add_json_option(CLI::App& command, std::string& path) {
  command.add_option("--json", path,
                     "write the result as JSON to this file; '-' is standard output");
}

} // namespace goingrate::apps
