// Turns the library's exceptions into Python's. The classes are written in Python
// (../goingrate/errors.py), so that they can be pickled, and caught by their base classes:
// InputError is a ValueError, and ArgumentError becomes one.
#include "module.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/log/reading.hpp"

#include <pybind11/stl.h>

namespace goingrate::python {

namespace py = pybind11;

namespace {

py::object error_class(const char* name) {
  return py::module_::import("goingrate.errors").attr(name);
}

void raise(const char* name, const py::tuple& arguments) {
  const py::object type = error_class(name);
  const py::object error = type(*arguments);
  PyErr_SetObject(type.ptr(), error.ptr());
}

// A line or column that is not known is 0 in the library and None in Python.
py::object counted(std::size_t number) {
  return number > 0 ? py::object(py::int_(number)) : py::none();
}

// Another reading of the log, as keywords of Python's read().
py::dict options_for(const OtherReading& other) {
  py::dict options;
  if (other.format) options["format"] = std::string(name_of(*other.format));
  if (!other.columns.empty()) options["columns"] = other.columns;
  if (!other.unit.empty()) options["unit"] = other.unit;
  if (other.wrap_s) options["wrap_s"] = *other.wrap_s;
  if (other.tau0_s) options["tau0_s"] = *other.tau0_s;
  if (other.nominal_period_s) options["nominal_period_s"] = *other.nominal_period_s;
  if (other.both_edges) options["both_edges"] = true;
  return options;
}

void raise_input(const InputError& error) {
  const TextPlace& place = error.place();
  raise("InputError",
        py::make_tuple(error.what(), place.file, counted(place.line), counted(place.column)));
}

void raise_impossible(const ImpossibleReading& error) {
  py::list others;
  for (const OtherReading& other : error.others())
    others.append(py::make_tuple(other.words, options_for(other)));
  const TextPlace& place = error.place();
  raise("ImpossibleReading", py::make_tuple(error.what(), place.file, counted(place.line),
                                            counted(place.column), others));
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const ImpossibleReading& error) {
    raise_impossible(error);
  } catch (const InputError& error) {
    raise_input(error);
  } catch (const NumericsError& error) {
    raise("NumericsError", py::make_tuple(error.what()));
  } catch (const NoStationarySwing& error) {
    raise("NumericsError", py::make_tuple(error.what()));
  } catch (const OutputError& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  } // ArgumentError is an invalid_argument, which becomes a ValueError
}

} // namespace

void bind_errors(py::module_&) { py::register_local_exception_translator(&translate); }

} // namespace goingrate::python
