// Parts of C++20 that the standard library of Emscripten 3.1 still lacks. Every source of the
// library is compiled with this header before it, so that no source has to include it.
#pragma once

#include <cmath>
#include <cstring>
#include <memory>
#include <type_traits>
#include <version>

namespace std {

#if !defined(__cpp_lib_math_special_functions)
// Complete elliptic integrals of modulus k.
double comp_ellint_1(double k);
double comp_ellint_2(double k);
#endif

#if !defined(__cpp_lib_bit_cast)
template <class To, class From> constexpr To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From) && is_trivially_copyable_v<From>);
  return __builtin_bit_cast(To, from);
}
#endif

#if !defined(__cpp_lib_smart_ptr_for_overwrite)
template <class T> unique_ptr<T> make_unique_for_overwrite(size_t count) {
  static_assert(is_unbounded_array_v<T>);
  return unique_ptr<T>(new remove_extent_t<T>[count]);
}
#endif

} // namespace std
