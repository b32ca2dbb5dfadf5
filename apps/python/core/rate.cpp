// The rate of a log, and its stability.
#include "archive.hpp"
#include "arrays.hpp"
#include "log_state.hpp"
#include "members.hpp"
#include "module.hpp"
#include "waiting.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/tables.hpp"

#include <pybind11/stl.h>
#include <variant>

namespace goingrate::python {

namespace {

RateSummary rate_of(const NumberedLog& loaded) {
  const Waiting waiting{py::none()};
  return mean_rate(loaded);
}

// Arrays with one entry per part of the log, under the column names of the command's table.
py::dict parts_of(const std::vector<PartRate>& parts) {
  py::dict table;
  const auto add = [&](const char* name, auto member) { table[name] = column_of(parts, member); };
  add("segment", [](const PartRate& p) { return p.segment; });
  add("from_cycle", [](const PartRate& p) { return p.from_cycle; });
  add("to_cycle", [](const PartRate& p) { return p.to_cycle; });
  add("time_s", [](const PartRate& p) { return p.start.to_double(); });
  add("duration_s", [](const PartRate& p) { return p.rate.duration_s; });
  add("rate_excess", [](const PartRate& p) { return p.rate.rate_excess; });
  add("sigma", [](const PartRate& p) { return p.rate.rate_excess_sigma; });
  add("amplitude_rad", [](const PartRate& p) { return p.amplitude_rad; });
  return table;
}

std::string rate_csv(const NumberedLog& loaded, std::int64_t running_cycles) {
  RateTable table({loaded.nominal_period_s, loaded.log.has_amplitude, running_cycles,
                   loaded.beats.step, loaded.sensor.gravity_share},
                  loaded.log.columns, loaded.beats.gaps);
  std::string text = table.header();
  for (std::size_t i = 0; i < loaded.beats.beats.size(); ++i)
    table.append(text, loaded.beats.beats[i], i);
  return text;
}

void bind_rate_summary(py::module_& module) {
  py::class_<RateSummary>(module, "RateSummary")
      .def_readonly("crossings", &RateSummary::crossings)
      .def_readonly("periods", &RateSummary::periods)
      .def_readonly("duration_s", &RateSummary::duration_s)
      .def_readonly("nominal_period_s", &RateSummary::nominal_period_s)
      .def_readonly("nominal_is_known", &RateSummary::nominal_is_known)
      .def_readonly("mean_period_s", &RateSummary::mean_period_s)
      .def_readonly("mean_period_sigma_s", &RateSummary::mean_period_sigma_s)
      .def_readonly("last_period_s", &RateSummary::last_period_s)
      .def_readonly("rate_excess", &RateSummary::rate_excess)
      .def_readonly("rate_excess_sigma", &RateSummary::rate_excess_sigma)
      .def("json",
           [](const RateSummary& self, const NumberedLog& log) {
             return rate_json(log.log, log.beats, self, log.sensor);
           })
      .def("text",
           [](const RateSummary& self, const NumberedLog& log) {
             return rate_text(log.beats, self, log.sensor,
                              !log.log.grid || log.log.nominal_period_s);
           })
      .def(py::pickle([](const RateSummary& self) { return py::bytes(archived("rate", self)); },
                      [](const py::bytes& state) {
                        RateSummary summary;
                        restore("rate", std::string_view(state), summary);
                        return summary;
                      }));
  module.def("rate", &rate_of);
  module.def("rate_csv", &rate_csv, py::call_guard<py::gil_scoped_release>());
  module.def("rate_per_period", [](const NumberedLog& log) {
    return array_of(rate_per_period(log.good, log.nominal_period_s));
  });
  module.def("clock_error", [](const NumberedLog& log) {
    return array_of(clock_error(log.good, log.nominal_period_s));
  });
  module.def("block_rates", [](const NumberedLog& log, double block_s) {
    return parts_of(block_rates(log.beats.beats, log.nominal_period_s, block_s));
  });
  module.def("segment_rates", [](const NumberedLog& log) {
    return parts_of(segment_rates(log.beats.beats, log.nominal_period_s));
  });
}

using Taus = std::variant<std::string, std::vector<double>>;

std::vector<std::size_t> factors_of(const Taus& taus, std::size_t points, double tau0_s,
                                    DeviationKind kind) {
  if (const auto* list = std::get_if<std::vector<double>>(&taus))
    return factors_for(*list, points, tau0_s, kind);
  const std::string& word = std::get<std::string>(taus);
  if (auto factors = factors_named(word, points, kind)) return std::move(*factors);
  throw ArgumentError("taus", word, "octave, decade, all, or a list of seconds");
}

DeviationTable deviation(std::span<const double> phase_s, double tau0_s, const std::string& kind,
                         const Taus& taus, const DeviationOptions& options) {
  const auto which = deviation_named(kind);
  if (!which)
    throw ArgumentError("kind", kind,
                        "oadev, mdev, hdev and the others that DEVIATION_KINDS lists");
  const auto factors = factors_of(taus, phase_s.size(), tau0_s, *which);
  const Waiting waiting{py::none()};
  return stability_table(*which, phase_s, tau0_s, factors, options);
}

DeviationTable deviation_of_phase(const Array<double>& phase_s, double tau0_s,
                                  const std::string& kind, const Taus& taus,
                                  std::optional<int> alpha, bool remove_bias, std::size_t threads) {
  return deviation(span_of(phase_s), tau0_s, kind, taus, {alpha, remove_bias, threads});
}

// The deviation of a log's phase; a tau0 of 0 stands for the log's own interval.
DeviationTable deviation_of_log(const NumberedLog& log, double tau0_s, const std::string& kind,
                                const Taus& taus, std::optional<int> alpha, bool remove_bias,
                                std::size_t threads) {
  const PhaseSeries series = phase_series(log);
  return deviation(series.phase_s, tau0_s > 0.0 ? tau0_s : series.tau0_s, kind, taus,
                   {alpha, remove_bias, threads});
}

template <class Class, class Member>
void add_column(Class& table, const char* name, Member member) {
  table.def_property_readonly(
      name, [member](const DeviationTable& self) { return column_of(self.rows, member); });
}

void bind_deviation(py::module_& module) {
  py::class_<DeviationTable> table(module, "DeviationTable");
  add_column(table, "tau_s", [](const DeviationRow& r) { return r.tau_s; });
  add_column(table, "m", [](const DeviationRow& r) { return static_cast<std::int64_t>(r.m); });
  add_column(table, "n", [](const DeviationRow& r) { return static_cast<std::int64_t>(r.n); });
  add_column(table, "value", [](const DeviationRow& r) { return r.value; });
  add_column(table, "low", [](const DeviationRow& r) { return r.low; });
  add_column(table, "high", [](const DeviationRow& r) { return r.high; });
  add_column(table, "alpha", [](const DeviationRow& r) { return r.alpha; });
  add_column(table, "has_interval", [](const DeviationRow& r) { return r.interval; });
  add_column(table, "bias", [](const DeviationRow& r) { return r.bias; });
  table
      .def_property_readonly(
          "kind", [](const DeviationTable& self) { return std::string(name_of(self.kind)); })
      .def_property_readonly("in_seconds",
                             [](const DeviationTable& self) { return is_in_seconds(self.kind); })
      .def_readonly("tau0_s", &DeviationTable::tau0_s)
      .def_readonly("bridged", &DeviationTable::bridged)
      .def("json", &stability_json)
      .def("text",
           [](const DeviationTable& self) {
             return deviation_text(self) + deviation_findings(self);
           })
      .def(py::pickle(
          [](const DeviationTable& self) { return py::bytes(archived("deviation", self)); },
          [](const py::bytes& state) {
            DeviationTable restored{};
            restore("deviation", std::string_view(state), restored);
            return restored;
          }));
  module.def("deviation", &deviation_of_phase, py::arg("phase_s").noconvert(), py::arg("tau0_s"),
             py::arg("kind"), py::arg("taus"), py::arg("alpha"), py::arg("remove_bias"),
             py::arg("threads"));
  module.def("deviation_of_log", &deviation_of_log);
  module.def("phase_from_frequency",
             [](const Array<double>& y, double tau0_s, double gap_frequency) {
               return array_of(phase_from_frequency(span_of(y), tau0_s, gap_frequency));
             });
  module.def("phase_series", [](const NumberedLog& log) {
    PhaseSeries series = phase_series(log);
    return py::make_tuple(array_of(std::move(series.phase_s)), series.tau0_s);
  });
  py::list kinds;
  for (const DeviationKind kind : deviation_kinds)
    kinds.append(std::string(name_of(kind)));
  module.attr("DEVIATION_KINDS") = py::tuple(kinds);
}

} // namespace

void bind_rate(py::module_& module) {
  bind_rate_summary(module);
  bind_deviation(module);
}

} // namespace goingrate::python
