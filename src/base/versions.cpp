#include "versions.hpp"

#include <array>

namespace goingrate {

std::span<const std::pair<std::string_view, std::string_view>> versions() {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 4> all{
      {{"goingrate", GOINGRATE_VERSION},
       {"ceres", GOINGRATE_CERES_VERSION},
       {"eigen", GOINGRATE_EIGEN_VERSION},
       {"fftw", GOINGRATE_FFTW_VERSION}}};
  return all;
}

} // namespace goingrate
