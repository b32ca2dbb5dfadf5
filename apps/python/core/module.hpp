// What the files of the extension module `goingrate._core` share. One file per topic; each adds its
// part to the module. The classes that users see are written in Python, in ../goingrate.
#pragma once

#include <pybind11/pybind11.h>

namespace goingrate::python {

void bind_errors(pybind11::module_& module);
void bind_log(pybind11::module_& module);
void bind_rate(pybind11::module_& module);
void bind_fit(pybind11::module_& module);
void bind_spectra(pybind11::module_& module);
void bind_analysis(pybind11::module_& module);
void bind_simulation(pybind11::module_& module);
void bind_clock(pybind11::module_& module);

} // namespace goingrate::python
