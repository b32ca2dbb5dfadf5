// How often the interval of the slope of the rate against the amplitude holds that of the simulated
// clock. Prints a table; arguments: logs, first seed.
#include "support/varying_amplitudes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

int main(int count, char** words) {
  using namespace goingrate;
  const std::uint64_t logs = count > 1 ? std::strtoull(words[1], nullptr, 10) : 300;
  const std::uint64_t first = count > 2 ? std::strtoull(words[2], nullptr, 10) : 1;
  std::printf("%-22s %5s %7s %8s %8s %6s %15s\n", "length", "logs", "stated", "in 68 %", "in 95 %",
              "rms z", "median σ/slope");
  for (const int longer : {1, 4, 16}) {
    test::SlopeScore score;
    for (std::uint64_t seed = first; seed < first + logs; ++seed)
      score.add(seed, longer);
    const double n = score.stated;
    std::sort(score.relative_sigma.begin(), score.relative_sigma.end());
    std::printf("%5d to %6d periods %5d %7d %7.1f%% %7.1f%% %6.2f %14.4f\n", 1500 * longer,
                4000 * longer, score.logs, score.stated, 100.0 * score.within68 / n,
                100.0 * score.within95 / n, std::sqrt(score.z2 / n), score.relative_sigma[score.relative_sigma.size() / 2]);
  }
}
