// Reads options out of a Python dict, by name.
#pragma once

#include "goingrate/base/errors.hpp"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <string>

namespace goingrate::python {

/// Puts the option into `to` if it was given. Throws ArgumentError for a value of another type.
template <class T> void take_option(const pybind11::dict& options, const char* name, T& to) {
  if (!options.contains(name)) return;
  const pybind11::object value = options[name];
  try {
    to = value.cast<T>();
  } catch (const pybind11::cast_error&) {
    throw ArgumentError(name, std::string(pybind11::repr(value)), "a value of the type it takes");
  }
}

} // namespace goingrate::python
