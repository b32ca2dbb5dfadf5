#include "module.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() =
      "goingrate's library as it is; the classes for people are in the package around it";
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
