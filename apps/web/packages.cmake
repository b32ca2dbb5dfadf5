# What find_package gives elsewhere, from the folder that libraries.sh fills.
add_compile_options("SHELL:-include ${CMAKE_CURRENT_LIST_DIR}/missing_parts.hpp")
include_directories(SYSTEM ${GOINGRATE_WEB_PREFIX}/include)
foreach(name Boost::headers fmt::fmt FastFloat::fast_float tomlplusplus::tomlplusplus
    nlohmann_json::nlohmann_json CLI11::CLI11 Threads::Threads Eigen3::Eigen)
  add_library(${name} INTERFACE IMPORTED GLOBAL)
endforeach()
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)
target_include_directories(Eigen3::Eigen SYSTEM INTERFACE /usr/include/eigen3)

function(add_static name file)
  add_library(${name} STATIC IMPORTED GLOBAL)
  set_target_properties(${name} PROPERTIES IMPORTED_LOCATION ${GOINGRATE_WEB_PREFIX}/lib/${file})
endfunction()
add_static(ZLIB::ZLIB libz.a)
add_static(PkgConfig::FFTW libfftw3.a)
add_static(PkgConfig::SNDFILE libsndfile.a)
add_static(PkgConfig::ZIP libzip.a)
target_link_libraries(PkgConfig::ZIP INTERFACE ZLIB::ZLIB)
add_static(Ceres::ceres libceres.a)
target_link_libraries(Ceres::ceres INTERFACE Eigen3::Eigen)
# Its headers log through its own small stand-in for glog.
target_include_directories(Ceres::ceres SYSTEM INTERFACE ${GOINGRATE_WEB_PREFIX}/include/ceres/internal/miniglog)

# Which versions a batch says it was made by: those of the headers.
function(read_version variable file expression)
  file(STRINGS ${file} lines REGEX "define ${expression} ")
  list(TRANSFORM lines REPLACE ".* ([0-9]+)$" "\\1")
  list(JOIN lines "." version)
  set(${variable} ${version} PARENT_SCOPE)
endfunction()
read_version(Eigen3_VERSION /usr/include/eigen3/Eigen/src/Core/util/Macros.h "EIGEN_(WORLD|MAJOR|MINOR)_VERSION")
read_version(Ceres_VERSION ${GOINGRATE_WEB_PREFIX}/include/ceres/version.h "CERES_VERSION_(MAJOR|MINOR|REVISION)")
file(STRINGS ${GOINGRATE_WEB_PREFIX}/lib/fftw3.version FFTW_VERSION)
