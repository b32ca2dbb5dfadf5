// The Fit class: fits a log, and gives the parameters and everything computed from them.
#include "fitted.hpp"

#include "archive.hpp"
#include "arrays.hpp"
#include "log_state.hpp"
#include "members.hpp"
#include "module.hpp"
#include "options.hpp"
#include "waiting.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/fit/par_file.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/tables.hpp"

#include <pybind11/stl.h>

namespace goingrate::python {

FitRequest fit_request_of(const py::dict& asked) {
  FitRequest request;
  const auto put = [&](const char* name, auto& to) { take_option(asked, name, to); };
  put("fixed", request.fixed);
  put("freed", request.freed);
  put("events", request.events);
  put("model", request.model);
  put("noise", request.noise);
  put("escapement", request.escapement);
  put("from", request.from);
  std::vector<std::tuple<std::string, double, double>> priors;
  put("priors", priors);
  for (const auto& [name, value, sigma] : priors)
    request.priors.push_back({name, value, sigma});
  return request;
}

namespace {

void refuse_without_beats(const NumberedLog& log) {
  if (log.good.empty())
    throw NumericsError(log.log.source + ": read as phases only, it has no beats to fit");
}

Fitted fit(const SharedLog& log, const py::dict& asked, bool profiles, const py::object& progress) {
  refuse_without_beats(*log);
  const FitRequest request = fit_request_of(asked);
  Waiting waiting(progress);
  Fitted fitted;
  waiting.tell("looking for changes");
  fitted.asked = fit_options(searching(request), *log);
  fitted.asked.profiles = profiles;
  fitted.data = fit_data(*log);
  fitted.summary = fit_clock(fitted.data, log->nominal_period_s, fitted.asked,
                             [&](std::string_view stage) { waiting.tell(stage); });
  fitted.first_cycle = log->good.front().cycle;
  fitted.nominal_period_s = log->nominal_period_s;
  return fitted;
}

void bind_parameter(py::module_& module) {
  py::class_<FittedParameter>(module, "FittedParameter")
      .def_readonly("name", &FittedParameter::name)
      .def_readonly("unit", &FittedParameter::unit)
      .def_property_readonly(
          "status", [](const FittedParameter& self) { return std::string(name_of(self.status)); })
      .def_readonly("value", &FittedParameter::value)
      .def_readonly("sigma", &FittedParameter::sigma)
      .def_readonly("low68", &FittedParameter::low68)
      .def_readonly("high68", &FittedParameter::high68)
      .def_readonly("low95", &FittedParameter::low95)
      .def_readonly("high95", &FittedParameter::high95)
      .def_readonly("at_bound", &FittedParameter::at_bound)
      .def_readonly("model_shift", &FittedParameter::model_shift)
      .def_property_readonly("profile",
                             [](const FittedParameter& self) {
                               py::list points;
                               for (const ProfilePoint& point : self.profile)
                                 points.append(py::make_tuple(point.value, point.fall));
                               return points;
                             })
      .def(py::pickle(
          [](const FittedParameter& self) { return py::bytes(archived("parameter", self)); },
          [](const py::bytes& state) {
            FittedParameter parameter;
            restore("parameter", std::string_view(state), parameter);
            return parameter;
          }));
  py::class_<DerivedQuantity>(module, "DerivedQuantity")
      .def_readonly("name", &DerivedQuantity::name)
      .def_readonly("expression", &DerivedQuantity::expression)
      .def_readonly("unit", &DerivedQuantity::unit)
      .def_readonly("value", &DerivedQuantity::value)
      .def_readonly("sigma", &DerivedQuantity::sigma);
}

py::list notes_of(const Fitted& fit) {
  py::list notes;
  for (const FitNote& note : fit.summary.notes) {
    const bool amplitude_helps =
        note.kind == NoteKind::twin && fit.summary.amplitude_residual_rad.empty();
    notes.append(note.text + (amplitude_helps ? " (prior={'lambda0': (VALUE, SIGMA)})" : ""));
  }
  return notes;
}

template <class Class> void add_arrays(Class& fit) {
  const auto view = [&](const char* name, auto member) {
    fit.def_property_readonly(name, [member](py::object self) {
      return view_of(self.cast<const Fitted&>().summary.*member, self);
    });
  };
  view("residual_s", &FitSummary::residual_s);
  view("model_amplitude_rad", &FitSummary::model_amplitude_rad);
  view("amplitude_residual_rad", &FitSummary::amplitude_residual_rad);
  fit.def_property_readonly(
         "elapsed_s",
         [](py::object self) { return view_of(self.cast<const Fitted&>().data.elapsed_s, self); })
      .def_property_readonly("cycle", [](const Fitted& self) {
        return column_of(self.data.cycle, [&](double cycle) {
          return self.first_cycle + static_cast<std::int64_t>(cycle);
        });
      });
}

template <class Class> void add_texts(Class& fit) {
  fit.def("json", [](const Fitted& self) { return fit_json(self.summary); })
      .def("text", [](const Fitted& self) { return fit_text(self.summary); })
      .def("csv", [](const Fitted& self) { return fit_csv(self.summary); })
      .def("latex", [](const Fitted& self) { return fit_latex(self.summary); })
      .def("par",
           [](const Fitted& self) { return par_text(self.summary, self.asked, self.first_cycle); });
}

py::tuple predicted(const Fitted& self, const Array<std::int64_t>& cycles) {
  const auto asked = span_of(cycles);
  const std::vector<std::int64_t> list(asked.begin(), asked.end());
  Prediction prediction = [&] {
    const Waiting waiting{py::none()};
    return predict(self, list);
  }();
  return py::make_tuple(array_of(std::move(prediction.time_s)),
                        array_of(std::move(prediction.amplitude_rad)));
}

py::array sigma_of_predicted(const Fitted& self, const Array<std::int64_t>& cycles) {
  const auto asked = span_of(cycles);
  const std::vector<std::int64_t> list(asked.begin(), asked.end());
  std::vector<double> sigma = [&] {
    const Waiting waiting{py::none()};
    return predict_sigma(self, list);
  }();
  return array_of(std::move(sigma));
}

} // namespace

void bind_fit(py::module_& module) {
  bind_parameter(module);
  py::class_<Fitted> fitted(module, "Fit");
  add_arrays(fitted);
  add_texts(fitted);
  fitted
      .def_property_readonly("parameters",
                             [](const Fitted& self) { return self.summary.parameters; })
      .def_property_readonly("combinations",
                             [](const Fitted& self) { return self.summary.combinations; })
      .def_property_readonly(
          "derived",
          [](const Fitted& self) {
            const FitSummary& s = self.summary;
            return std::vector{s.q_factor, s.stationary_amplitude, s.rate_s_per_day, s.decay_time};
          })
      .def_property_readonly("names", [](const Fitted& self) { return self.summary.correlated; })
      .def_property_readonly("correlation",
                             [](const Fitted& self) { return self.summary.correlation; })
      .def_property_readonly(
          "status", [](const Fitted& self) { return std::string(name_of(self.summary.status)); })
      .def_property_readonly("termination",
                             [](const Fitted& self) { return self.summary.termination; })
      .def_property_readonly("has_result",
                             [](const Fitted& self) { return self.summary.has_result(); })
      .def_property_readonly("notes", &notes_of)
      .def_readonly("first_cycle", &Fitted::first_cycle)
      .def("predict", &predicted, py::arg("cycles").noconvert())
      .def("predict_sigma", &sigma_of_predicted, py::arg("cycles").noconvert())
      .def(py::pickle(
          [](const Fitted& self) {
            return py::bytes(archived("fit", self.summary, self.asked, self.data, self.first_cycle,
                                      self.nominal_period_s));
          },
          [](const py::bytes& state) {
            Fitted fit;
            restore("fit", std::string_view(state), fit.summary, fit.asked, fit.data,
                    fit.first_cycle, fit.nominal_period_s);
            return fit;
          }));
  module.def("fit", &fit, py::arg("log"), py::arg("asked"), py::arg("profiles"),
             py::arg("progress"));
  module.def("with_sigma", &with_sigma, py::arg("value"), py::arg("sigma"), py::arg("digits") = 6);
  module.def("parse_prior", [](const std::string& text) {
    const Prior prior = parse_prior(text);
    return py::make_tuple(prior.name, prior.value, prior.sigma);
  });
  module.def("parse_fixed", &parse_fixed);
}

} // namespace goingrate::python
