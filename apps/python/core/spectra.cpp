// The DriveAnalysis class: the spectrum of the rate, and its split into fast drive, slow drive and
// jitter.
#include "archive.hpp"
#include "arrays.hpp"
#include "fitted.hpp"
#include "log_state.hpp"
#include "members.hpp"
#include "module.hpp"
#include "waiting.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/drive/drive_split.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/tables.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

namespace goingrate::python {

namespace {

DriveAnalysis spectrum(const SharedLog& log, const Fitted& fit, double split_hz) {
  const Waiting waiting{py::none()};
  const auto moved_back = without_displacements(log->good, fit.data);
  DriveAnalysis drive =
      analyse_drive(moved_back ? std::span<const Beat>(*moved_back) : log->good,
                    log->nominal_period_s, fit.summary, split_hz);
  if (!drive.rate_spectrum)
    throw NumericsError(fmt::format("{} beats are too few for a spectrum", log->good.size()));
  return drive;
}

// Adds a property for one part of the fitted spectral density; it is None if the analysis could not
// split the drive.
template <class Class>
void add_part(Class& drive, const char* name, std::vector<double> DriveSplit::*part) {
  drive.def_property_readonly(name, [part](py::object self) -> py::object {
    const auto& split = self.cast<const DriveAnalysis&>().split;
    return split ? py::object(view_of((*split).*part, self)) : py::none();
  });
}

} // namespace

void bind_spectra(py::module_& module) {
  py::class_<DriveAnalysis> drive(module, "DriveAnalysis");
  const auto rate_part = [&](const char* name, std::vector<double> Spectrum::*part) {
    drive.def_property_readonly(name, [part](py::object self) {
      return view_of(*self.cast<const DriveAnalysis&>().rate_spectrum.*part, self);
    });
  };
  rate_part("frequency_hz", &Spectrum::frequency_hz);
  rate_part("density", &Spectrum::density);
  add_part(drive, "fast_density", &DriveSplit::fast_density);
  add_part(drive, "slow_density", &DriveSplit::slow_density);
  add_part(drive, "jitter_density", &DriveSplit::jitter_density);
  drive
      .def_property_readonly(
          "has_spectrum", [](const DriveAnalysis& self) { return self.rate_spectrum.has_value(); })
      .def_property_readonly(
          "rates",
          [](py::object self) { return view_of(self.cast<const DriveAnalysis&>().rates, self); })
      .def("json", &spectrum_json)
      .def("text", [](const DriveAnalysis& self) { return drive_text(self); })
      .def("csv", &spectrum_table)
      .def(py::pickle([](const DriveAnalysis& self) { return py::bytes(archived("drive", self)); },
                      [](const py::bytes& state) {
                        DriveAnalysis restored;
                        restore("drive", std::string_view(state), restored);
                        return restored;
                      }));
  module.def("spectrum", &spectrum, py::arg("log"), py::arg("fit"), py::arg("split_hz"));
}

} // namespace goingrate::python
