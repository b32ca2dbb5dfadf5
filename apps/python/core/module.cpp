#include "module.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() =
      "the C++ library, bound as it is; use the classes of the package goingrate instead";
  module.attr("version") = GOINGRATE_VERSION;
  using namespace goingrate::python;
  bind_errors(module);
  bind_log(module);
  bind_rate(module);
  bind_fit(module);
  bind_spectra(module);
  bind_analysis(module);
  bind_simulation(module);
  bind_clock(module);
}
