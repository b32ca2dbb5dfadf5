// Clocks without a log: stationary operation, and motion under laws written in Python.
#include "arrays.hpp"
#include "module.hpp"
#include "options.hpp"
#include "waiting.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/custom_pendulum.hpp"
#include "goingrate/dynamics/direct.hpp"
#include "goingrate/dynamics/rate_map.hpp"
#include "goingrate/dynamics/stationary.hpp"
#include "goingrate/report/chart_report.hpp"

#include <cmath>
#include <pybind11/stl.h>

namespace goingrate::python {

namespace {

Equations equations_of(bool first_order) {
  return first_order ? Equations::first_order : Equations::exact;
}

py::array map_of(double phi0, const std::vector<double>& epsilon, const std::vector<double>& mu,
                 bool first_order) {
  const RateMap map = [&] {
    const Waiting waiting{py::none()};
    return rate_map(phi0, epsilon, mu, equations_of(first_order));
  }();
  py::array_t<double> rates({mu.size(), epsilon.size()});
  double* to = rates.mutable_data();
  for (const std::vector<double>& row : map.rate_excess)
    to = std::copy(row.begin(), row.end(), to);
  return rates;
}

py::list points_of(const py::dict& known, double phi0, bool first_order) {
  KnownPair pair;
  const auto put = [&](const char* name, auto& to) { take_option(known, name, to); };
  put("epsilon", pair.epsilon);
  put("mu", pair.mu);
  put("amplitude", pair.amplitude);
  put("rate_excess", pair.rate_excess);
  py::list points;
  for (const OperatingPoint& point : operating_points(pair, phi0, equations_of(first_order)))
    points.append(py::make_tuple(point.epsilon, point.mu, point.amplitude, point.rate_excess));
  return points;
}

// A law written in Python. The GIL must be held; a non-numeric result raises.
ForceLaw law_of(const py::object& callable) {
  return [callable](double phi, double velocity) { return callable(phi, velocity).cast<double>(); };
}

// The paper's escapement. While every swing reaches phi0, the sign of the velocity determines the
// torque's last switch.
ForceLaw torque_of(double mu, double phi0) {
  return [mu, phi0](double phi, double velocity) {
    const bool helps_right = velocity > 0.0 ? phi < phi0 : phi < -phi0;
    return helps_right ? mu : -mu;
  };
}

struct Course {
  std::vector<double> period_excess, velocity;
};

// Period by period until the pendulum stops. Checks for Ctrl-C each period, because the GIL is
// held.
Course course_of(CustomPendulum& pendulum, std::size_t periods, std::string& ended) {
  Course course;
  for (std::size_t i = 0; i < periods; ++i) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    const PeriodStep step = pendulum.advance();
    if (step.status != SwingStatus::crossed) {
      ended = words_for(step.status);
      break;
    }
    course.period_excess.push_back(step.excess);
    course.velocity.push_back(pendulum.velocity());
  }
  return course;
}

py::tuple integrate(const py::object& friction, const py::object& torque, double mu, double phi0,
                    double velocity, std::size_t periods, std::vector<double> jumps,
                    bool jumps_with_direction) {
  CustomLaws laws;
  laws.friction = law_of(friction);
  laws.torque = torque.is_none() ? torque_of(mu, phi0) : law_of(torque);
  laws.jumps = std::move(jumps);
  laws.jumps_with_direction = jumps_with_direction;
  CustomPendulum pendulum(std::move(laws), velocity);
  std::string ended;
  Course course = course_of(pendulum, periods, ended);
  return py::make_tuple(array_of(std::move(course.period_excess)),
                        array_of(std::move(course.velocity)), ended);
}

} // namespace

void bind_clock(py::module_& module) {
  module.def("rate_map", &map_of, py::arg("phi0"), py::arg("epsilon"), py::arg("mu"),
             py::arg("first_order"));
  module.def("log_grid", &log_grid);
  module.def("operating_points", &points_of);
  module.def("integrate", &integrate, py::arg("friction"), py::arg("torque"), py::arg("mu"),
             py::arg("phi0"), py::arg("velocity"), py::arg("periods"), py::arg("jumps"),
             py::arg("jumps_with_direction"));
}

} // namespace goingrate::python
