// Stands in for what the system that WebAssembly runs on lacks: special functions of the standard
// library, and the means to start other programs.
#include "missing_parts.hpp"

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <cerrno>
#include <spawn.h>

#if !defined(__cpp_lib_math_special_functions)
double std::comp_ellint_1(double k) { return boost::math::ellint_1(k); }
double std::comp_ellint_2(double k) { return boost::math::ellint_2(k); }
#endif

extern "C" {

// gnuplot cannot be started, so its figures are left out, as on a computer without gnuplot.
int posix_spawnp(pid_t*, const char*, const posix_spawn_file_actions_t*, const posix_spawnattr_t*, char* const[],
                 char* const[]) {
  return ENOSYS;
}

int posix_spawn_file_actions_init(posix_spawn_file_actions_t*) { return 0; }
int posix_spawn_file_actions_adddup2(posix_spawn_file_actions_t*, int, int) { return 0; }
int posix_spawn_file_actions_destroy(posix_spawn_file_actions_t*) { return 0; }

} // extern "C"
