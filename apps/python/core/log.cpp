// The Log class: reads logs from files, text or arrays, and exposes their columns as NumPy arrays.
#include "arrays.hpp"
#include "log_state.hpp"
#include "module.hpp"
#include "options.hpp"
#include "waiting.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/log/writing.hpp"
#include "goingrate/report/tables.hpp"

#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <pybind11/stl.h>

namespace goingrate::python {

namespace {

// The keyword options of read() and Log() in Python as the library's request. The Python package
// has already checked their types.
LoadRequest request_of(const py::dict& options) {
  LoadRequest request;
  ReadingOptions& reading = request.reading;
  const auto put = [&](const char* name, auto& to) { take_option(options, name, to); };
  const auto named = [&](const char* name, auto& to, auto find, const char* legal) {
    std::string word;
    take_option(options, name, word);
    if (word.empty()) return;
    to = find(word);
    if (!to) throw ArgumentError(name, word, legal);
  };
  const std::string formats = fmt::format("one of {}", fmt::join(format_names(), ", "));
  named("format", reading.format, format_named, formats.c_str());
  named("unit", reading.unit, unit_named, "s, ms, us, ns, min, h, d or mjd");
  put("nominal_period_s", reading.nominal_period_s);
  put("columns", reading.columns);
  put("wrap_s", reading.wrap_s);
  put("tau0_s", reading.tau0_s);
  put("counter_hz", reading.counter_hz);
  put("decimal_comma", reading.decimal_comma);
  put("month_first", reading.month_first);
  put("channel", reading.channel);
  put("beat_channel", reading.beat_channel);
  put("pps_channel", reading.pps_channel);
  put("clock_ppm", reading.clock_ppm);
  put("rest_angle_rad", reading.rest_angle_rad);
  put("strict", reading.strict);
  put("unpacked_limit", reading.unpacked_limit);
  put("both_edges", request.both_edges);
  put("dead_time_s", request.dead_time_s);
  put("flag_width_rad", request.flag_width_rad);
  put("gravity_share", request.gravity_share);
  put("sensor_offset_rad", request.sensor_offset_rad);
  put("find_sensor_offset", request.find_sensor_offset);
  put("gap_probability", request.gap_probability);
  put("only_phases", request.phases_will_do);
  put("weather", request.weather.files);
  put("weather_zone", request.weather.zone);
  put("weather_offset_s", request.weather.offset_s);
  if (options.contains("site") && !options["site"].is_none()) {
    const auto [latitude, longitude] = options["site"].cast<std::pair<double, double>>();
    request.site = parse_site(fmt::format("{},{}", latitude, longitude));
    if (!request.site)
      throw ArgumentError("site", fmt::format("({}, {})", latitude, longitude),
                          "latitude and longitude in degrees");
  }
  return request;
}

template <class Load>
SharedLog loaded_by(LoadRequest request, const py::object& progress, Load load) {
  Waiting waiting(progress);
  request.reading.progress = [&](double share) { waiting.tell(share); };
  return std::make_shared<NumberedLog>(load(request));
}

SharedLog read(const std::vector<std::string>& paths, const py::dict& options,
               const py::object& progress) {
  LoadRequest request = request_of(options);
  request.path = paths.at(0);
  request.more.assign(paths.begin() + 1, paths.end());
  return loaded_by(std::move(request), progress,
                   [](const LoadRequest& asked) { return load(asked); });
}

SharedLog read_text(const py::bytes& text, const std::string& name, const py::dict& options,
                    const py::object& progress) {
  LoadRequest request = request_of(options);
  request.path = name;
  const std::string_view view = text;
  return loaded_by(std::move(request), progress,
                   [&](const LoadRequest& asked) { return load_text(view, asked); });
}

// The arrays that Log() was given, all of the same length; an optional array not given is empty.
// `edge` is 0 for an upward crossing and 1 for a downward one; without it the directions are
// unknown.
struct EventArrays {
  Array<std::int64_t> seconds;
  Array<double> fraction, amplitude_rad, width_s, temperature_c, pressure_mbar, humidity_percent;
  Array<std::uint8_t> edge;
};

ClockLog log_of(const EventArrays& arrays, const std::string& name) {
  ClockLog log;
  log.source = name;
  const auto count = static_cast<std::size_t>(arrays.seconds.size());
  const bool amplitudes = arrays.amplitude_rad.size() > 0, edges = arrays.edge.size() > 0;
  log.events.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    Beat event = event_at({arrays.seconds.data()[i], arrays.fraction.data()[i]});
    event.line = static_cast<std::uint32_t>(i + 1);
    if (edges && arrays.edge.data()[i] != 0) event.edge = Edge::down;
    if (amplitudes) event.amplitude_rad = arrays.amplitude_rad.data()[i];
    log.has_amplitude = log.has_amplitude || std::isfinite(event.amplitude_rad);
    log.events.push_back(event);
  }
  const auto copied = [](const Array<double>& from) {
    const auto values = span_of(from);
    return std::vector<double>(values.begin(), values.end());
  };
  log.columns = {
      copied(arrays.width_s), {}, copied(arrays.temperature_c), copied(arrays.pressure_mbar),
      copied(arrays.humidity_percent)};
  log.directions_are_open = !edges;
  return log;
}

SharedLog from_arrays(const Array<std::int64_t>& seconds, const Array<double>& fraction,
                      const Array<double>& amplitude_rad, const Array<std::uint8_t>& edge,
                      const std::vector<Array<double>>& columns, const std::string& name,
                      const py::dict& options) {
  const EventArrays arrays{seconds,       fraction,      amplitude_rad, columns.at(0),
                           columns.at(1), columns.at(2), columns.at(3),  edge};
  const LoadRequest request = request_of(options);
  ClockLog log = log_of(arrays, name);
  const Waiting waiting{py::none()};
  return std::make_shared<NumberedLog>(load_events(std::move(log), request));
}

// A read-only structured array that shares the memory of `beats`, so that a long log is not copied;
// `owner` keeps that memory alive.
py::array beats_view(std::span<const Beat> beats, py::handle owner) {
  // Deliberately leaked: static objects are destroyed after the interpreter has shut down, too late
  // to release a Python object.
  static const py::dtype& layout = *new py::dtype([] {
    const auto field = [](const char* name, const char* type, std::size_t at) {
      return py::make_tuple(name, type, at);
    };
    const std::vector<py::tuple> fields = {
        field("seconds", "i8", offsetof(Beat, time) + offsetof(Instant, seconds)),
        field("fraction", "f8", offsetof(Beat, time) + offsetof(Instant, fraction)),
        field("cycle", "i8", offsetof(Beat, cycle)),
        field("amplitude_rad", "f8", offsetof(Beat, amplitude_rad)),
        field("line", "u4", offsetof(Beat, line)),
        field("segment", "u2", offsetof(Beat, segment)),
        field("flag", "u1", offsetof(Beat, flag)),
        field("edge", "u1", offsetof(Beat, edge))};
    py::list names, types, places;
    for (const py::tuple& f : fields) {
      names.append(f[0]);
      types.append(f[1]);
      places.append(f[2]);
    }
    return py::dtype(names, types, places, sizeof(Beat));
  }());
  py::array view(layout, {beats.size()}, {sizeof(Beat)}, beats.data(), owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

// The numbered beats. Gridded data read as phases only have none; their events as read take the
// place of beats.
const std::vector<Beat>& events_of(const NumberedLog& log) {
  return log.beats.beats.empty() ? log.log.events : log.beats.beats;
}

template <class Time> py::array times_of(std::span<const Beat> beats, Time time) {
  std::vector<double> times;
  times.reserve(beats.size());
  for (const Beat& beat : beats)
    times.push_back(time(beat));
  return array_of(std::move(times));
}

// The keyword of read() that overrides an assumption about this setting, for the list of
// assumptions shown to the user.
const char* keyword_of(Setting setting) {
  switch (setting) {
  case Setting::none:
    break;
  case Setting::format:
    return "format";
  case Setting::columns:
    return "columns";
  case Setting::unit:
    return "unit";
  case Setting::wrap:
    return "wrap_s";
  case Setting::tau0:
    return "tau0_s";
  case Setting::counter_rate:
    return "counter_hz";
  case Setting::decimal_comma:
    return "decimal_comma";
  case Setting::date_order:
    return "date_order";
  case Setting::channel:
    return "channel";
  case Setting::pps_channel:
    return "pps_channel";
  case Setting::clock_ppm:
    return "clock_ppm";
  case Setting::rest_angle:
    return "rest_angle_rad";
  case Setting::nominal_period:
    return "nominal_period_s";
  case Setting::both_edges:
    return "both_edges";
  case Setting::flag_width:
    return "flag_width_rad";
  case Setting::weather:
    return "weather";
  case Setting::weather_zone:
    return "weather_zone";
  case Setting::site:
    return "site";
  }
  return "";
}

py::list assumptions_of(const NumberedLog& log) {
  py::list assumptions;
  for (const Assumption& assumed : log.log.assumptions)
    assumptions.append(assumed.setting == Setting::none
                           ? assumed.text
                           : fmt::format("{} ({}{}{})", assumed.text, keyword_of(assumed.setting),
                                         assumed.value.empty() ? "" : "=", assumed.value));
  return assumptions;
}

py::list issues_of(const NumberedLog& log) {
  py::list issues;
  for (const LineIssue& issue : log.log.issues)
    issues.append(py::make_tuple(log.log.place(issue.line).line, issue.column,
                                 std::string(name_of(issue.kind)), issue.found, issue.action,
                                 log.log.place(std::max(issue.line, issue.last_line)).line,
                                 issue.lines, log.log.place(issue.line).file));
  return issues;
}

py::list gaps_of(const NumberedLog& log) {
  py::list gaps;
  for (const Gap& gap : log.beats.gaps)
    gaps.append(py::make_tuple(gap.after_cycle, gap.length, gap.probability, gap.bridged,
                               std::string(name_of(gap.kind))));
  return gaps;
}

std::string native_text(const NumberedLog& loaded, int decimals) {
  ClockLog log = loaded.log;
  log.nominal_period_s = loaded.nominal_period_s;
  log.events = events_of(loaded);
  return native_log_text(log, decimals);
}

py::object column_view(const std::vector<double>& column, py::handle owner) {
  return column.empty() ? py::object(py::none()) : py::object(view_of(column, owner));
}

py::object estimate(const std::optional<SensorEstimate>& found) {
  return found ? py::object(py::make_tuple(found->value, found->sigma)) : py::none();
}

template <class Class> void add_columns(Class& log) {
  const auto column = [&](const char* name, auto member) {
    log.def_property_readonly(name, [member](py::object self) {
      return column_view(self.cast<const NumberedLog&>().log.columns.*member, self);
    });
  };
  column("width_s", &EventColumns::width_s);
  column("sigma_s", &EventColumns::sigma_s);
  column("temperature_c", &EventColumns::temperature_c);
  column("pressure_mbar", &EventColumns::pressure_mbar);
  column("humidity_percent", &EventColumns::humidity_percent);
  log.def_property_readonly("events",
                            [](py::object self) {
                              return beats_view(events_of(self.cast<const NumberedLog&>()), self);
                            })
      .def_property_readonly(
          "good",
          [](py::object self) { return beats_view(self.cast<const NumberedLog&>().good, self); })
      .def_property_readonly("phase_s",
                             [](py::object self) -> py::object {
                               const auto& grid = self.cast<const NumberedLog&>().log.grid;
                               return grid ? py::object(view_of(grid->phase_s, self)) : py::none();
                             })
      .def("time_s",
           [](const NumberedLog& self) {
             return times_of(events_of(self),
                             [](const Beat& beat) { return beat.time.to_double(); });
           })
      .def("elapsed_s", [](const NumberedLog& self) {
        const std::span<const Beat> beats = events_of(self);
        return times_of(beats, [&](const Beat& beat) { return beat.time - beats.front().time; });
      });
}

} // namespace

void bind_log(py::module_& module) {
  py::class_<NumberedLog, std::shared_ptr<NumberedLog>> log(module, "Log");
  add_columns(log);
  log.def_property_readonly("files", [](const NumberedLog& self) {
    std::vector<std::string> names;
    for (const LogFile& file : self.log.files)
      names.push_back(file.name);
    return names;
  });
  log.def_property_readonly("source", [](const NumberedLog& self) { return self.log.source; })
      .def_property_readonly(
          "format", [](const NumberedLog& self) { return std::string(name_of(self.log.format)); })
      .def_property_readonly("has_amplitude",
                             [](const NumberedLog& self) { return self.log.has_amplitude; })
      .def_property_readonly("tau0_s",
                             [](const NumberedLog& self) {
                               return self.log.grid ? std::optional(self.log.grid->tau0_s)
                                                    : std::nullopt;
                             })
      .def_readonly("nominal_period_s", &NumberedLog::nominal_period_s)
      .def_readonly("nominal_is_known", &NumberedLog::nominal_is_known)
      .def_property_readonly("typical_period_s",
                             [](const NumberedLog& self) { return self.beats.typical_period_s; })
      .def_property_readonly("segments",
                             [](const NumberedLog& self) { return self.beats.segments; })
      .def_property_readonly("missed", [](const NumberedLog& self) { return self.beats.missed; })
      .def_property_readonly("spurious",
                             [](const NumberedLog& self) { return self.beats.spurious; })
      .def_property_readonly("assumptions", &assumptions_of)
      .def_property_readonly("issues", &issues_of)
      .def_property_readonly("gaps", &gaps_of)
      .def_property_readonly(
          "beat_error_s",
          [](const NumberedLog& self) { return estimate(self.sensor.beat_error_s); })
      .def_property_readonly(
          "sensor_offset_rad",
          [](const NumberedLog& self) { return estimate(self.sensor.offset_rad); })
      .def("native_text", &native_text, py::arg("decimals"))
      .def(py::pickle([](const NumberedLog& self) { return py::bytes(bytes_of(self)); },
                      [](const py::bytes& state) {
                        return std::make_shared<NumberedLog>(log_of(std::string_view(state)));
                      }));
  module.def("read", &read, py::arg("paths"), py::arg("options"), py::arg("progress"));
  module.def("read_text", &read_text, py::arg("text"), py::arg("name"), py::arg("options"),
             py::arg("progress"));
  module.def("from_arrays", &from_arrays, py::arg("seconds").noconvert(),
             py::arg("fraction").noconvert(), py::arg("amplitude_rad").noconvert(),
             py::arg("edge").noconvert(), py::arg("columns"), py::arg("name"), py::arg("options"));
}

} // namespace goingrate::python
