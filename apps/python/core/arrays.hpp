// Arrays between NumPy and the library, without a copy.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <span>
#include <utility>
#include <vector>

namespace goingrate::python {

namespace py = pybind11;

/// An array that Python hands over in the right form (one dimension, contiguous, of exactly this
/// type); the Python package ensures that.
template <class T> using Array = py::array_t<T, py::array::c_style>;

template <class T> std::span<const T> span_of(const Array<T>& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// A read-only view of memory that belongs to `owner`, which it keeps alive.
template <class T> py::array view_of(std::span<const T> values, py::handle owner) {
  py::array_t<T> view(static_cast<py::ssize_t>(values.size()), values.data(), owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

template <class T> py::array view_of(const std::vector<T>& values, py::handle owner) {
  return view_of(std::span<const T>(values), owner);
}

/// An array that takes over the memory of a vector.
template <class T> py::array array_of(std::vector<T>&& values) {
  auto* kept = new std::vector<T>(std::move(values));
  const py::capsule owner(kept, [](void* memory) { delete static_cast<std::vector<T>*>(memory); });
  return view_of(std::span<const T>(*kept), owner);
}

/// One value of each element of a sequence of structs, as an array.
template <class Sequence, class Member> py::array column_of(const Sequence& rows, Member member) {
  using Value = std::decay_t<decltype(member(*rows.begin()))>;
  py::array_t<Value> column(static_cast<py::ssize_t>(rows.size()));
  auto* to = column.mutable_data();
  for (const auto& row : rows)
    *to++ = member(row);
  return column;
}

} // namespace goingrate::python
