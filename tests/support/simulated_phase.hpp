// Simulated phase series with power-law noise, for tests of the stability statistics.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

#include "goingrate/base/random.hpp"

namespace goingrate::test {

/// White noise of unit variance, cumulatively summed `walks` times: 0 gives white phase noise, 1
/// white frequency noise (a random walk of phase), 2 a random walk of frequency.
inline std::vector<double> simulated_phase(int walks, std::size_t points, std::uint64_t seed) {
  RandomStream stream(seed, StreamPurpose::jitter);
  std::vector<double> phase(points);
  for (double& x : phase)
    x = stream.normal();
  for (int walk = 0; walk < walks; ++walk)
    std::partial_sum(phase.begin(), phase.end(), phase.begin());
  return phase;
}

} // namespace goingrate::test
