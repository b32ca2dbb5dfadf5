// The Analysis class: everything that a report says about one log; and the comparison of clocks.
#include "archive.hpp"
#include "arrays.hpp"
#include "fitted.hpp"
#include "log_state.hpp"
#include "members.hpp"
#include "module.hpp"
#include "waiting.hpp"

#include "goingrate/analysis/analyse.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/report/compare_report.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/report.hpp"

#include <pybind11/stl.h>

namespace goingrate::python {

namespace {

// An analysis, with the data and options of its fit, which the Fit class needs.
struct Analysed {
  Analysis data{};
  Fitted fit{};
};

Analysed analysed(const SharedLog& log, const py::dict& asked, std::optional<double> nut_pitch_m,
                  std::optional<double> rod_length_m, bool profiles,
                  const std::optional<std::string>& diary, const py::object& progress) {
  if (log->good.empty())
    throw NumericsError(log->log.source + ": read as phases only, it has no beats to analyse");
  const FitRequest fit = fit_request_of(asked);
  Waiting waiting(progress);
  AnalysisRequest request;
  request.fit = fit_options(fit, *log);
  request.finds_events = finds_events(fit);
  request.traces_profiles = profiles;
  if (diary) request.logbook = read_logbook(*diary);
  request.nut_pitch_m = nut_pitch_m;
  request.rod_length_m = rod_length_m;
  request.now = [&](std::string_view what) { waiting.tell(what); };
  Analysed result;
  result.fit.asked = request.fit;
  result.fit.data = fit_data(*log);
  result.fit.first_cycle = log->good.front().cycle;
  result.fit.nominal_period_s = log->nominal_period_s;
  result.data = analyse(copy_of(*log), request);
  return result;
}

Fitted fit_of(const Analysed& self) {
  Fitted fit = self.fit;
  fit.summary = self.data.fit;
  return fit;
}

py::object history_of(const Analysed& self) {
  if (!self.data.history) return py::none();
  const auto& points = self.data.history->points;
  py::dict table;
  table["time_s"] = column_of(points, [](const DrivePoint& p) { return p.at_s; });
  table["relative_drive"] = column_of(points, [](const DrivePoint& p) { return p.relative; });
  table["sigma"] = column_of(points, [](const DrivePoint& p) { return p.sigma; });
  return table;
}

py::list covariates_of(const Analysed& self) {
  py::list effects;
  for (const CovariateEffect& effect : self.data.covariates) {
    py::dict one;
    one["name"] = effect.name;
    one["unit"] = effect.unit;
    one["coefficient"] = effect.coefficient;
    one["sigma"] = effect.sigma;
    one["lag_s"] = effect.lag_s;
    py::list parts;
    for (const EffectPart& part : effect.parts) {
      py::dict way;
      way["way"] = std::string(name_of(part.way));
      way["coefficient"] = part.coefficient;
      way["sigma"] = part.sigma;
      parts.append(way);
    }
    one["parts"] = parts;
    one["amplitude"] = effect.amplitude;
    one["amplitude_sigma"] = effect.amplitude_sigma;
    one["interpolation_sigma"] = effect.interpolation_sigma;
    one["readings_step_s"] = effect.step_s;
    one["known_share"] = effect.known_share;
    one["without_s"] = effect.without_s;
    one["with_s"] = effect.with_s;
    effects.append(one);
  }
  return effects;
}

// The comparison of several clocks: JSON, text, and the rates as CSV.
std::vector<std::string> compared(const std::vector<SharedLog>& logs) {
  const Waiting waiting{py::none()};
  std::vector<NumberedLog> copies;
  copies.reserve(logs.size());
  for (const SharedLog& log : logs)
    copies.push_back(copy_of(*log));
  const Comparison comparison = compare(copies);
  return {compare_json(comparison), compare_text(comparison), compare_table(comparison)};
}

} // namespace

void bind_analysis(py::module_& module) {
  py::class_<Analysed>(module, "Analysis")
      .def_property_readonly("rate", [](const Analysed& self) { return self.data.rate; })
      .def_property_readonly("fit", &fit_of)
      .def_property_readonly("drive", [](const Analysed& self) { return self.data.drive; })
      .def_property_readonly("deviation", [](const Analysed& self) { return self.data.deviation; })
      .def_property_readonly("history", &history_of)
      .def_property_readonly("covariates", &covariates_of)
      .def("json", [](const Analysed& self) { return report_json(self.data); })
      .def("diary_text", [](const Analysed& self) { return logbook_text(findings_of(self.data)); })
      .def("text", [](const Analysed& self) { return report_text(self.data); })
      .def("html",
           [](const Analysed& self) {
             const Waiting waiting{py::none()};
             return report_html(self.data);
           })
      .def(py::pickle(
          [](const Analysed& self) {
            return py::bytes(archived("analysis", self.data, self.fit.asked, self.fit.data,
                                      self.fit.first_cycle, self.fit.nominal_period_s));
          },
          [](const py::bytes& state) {
            Analysed restored;
            restore("analysis", std::string_view(state), restored.data, restored.fit.asked,
                    restored.fit.data, restored.fit.first_cycle, restored.fit.nominal_period_s);
            return restored;
          }));
  module.def("compare", &compared, py::arg("logs"));
  module.def("analyse", &analysed, py::arg("log"), py::arg("asked"), py::arg("nut_pitch_m"),
             py::arg("rod_length_m"), py::arg("profiles"), py::arg("diary"), py::arg("progress"));
}

} // namespace goingrate::python
