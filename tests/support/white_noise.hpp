// White noise of unit variance, the same for the same seed.
#pragma once

#include "goingrate/base/random.hpp"

#include <vector>

namespace goingrate::test {

inline std::vector<double> noise(std::size_t n, std::uint64_t seed) {
  RandomStream random(seed, StreamPurpose::jitter);
  std::vector<double> x(n);
  for (double& v : x)
    v = random.normal();
  return x;
}

} // namespace goingrate::test
