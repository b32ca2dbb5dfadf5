// How often the interval of a temperature coefficient holds the truth if the weather is in a file
// of its own at another cadence. Prints a table; arguments: logs per thermometer, first seed.
#include "support/weathered_logs.hpp"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <unistd.h>

int main(int count, char** words) {
  using namespace goingrate;
  const std::uint64_t logs = count > 1 ? std::strtoull(words[1], nullptr, 10) : 300;
  const std::uint64_t first = count > 2 ? std::strtoull(words[2], nullptr, 10) : 1;
  const std::string path = (std::filesystem::temp_directory_path() /
                            fmt::format("goingrate-weather-{}.csv", ::getpid()))
                               .string();
  std::printf("%-26s %5s %7s %7s %8s %12s %12s\n", "thermometer", "logs", "in 68 %", "in 95 %",
              "rms z", "rms shift/σ", "worst shift/σ");
  for (const test::Thermometer& thermometer : test::thermometers) {
    test::WeatherScore score;
    for (std::uint64_t seed = first; seed < first + logs; ++seed) {
      test::WeatheredLog log(thermometer, seed);
      score.add(log, path);
    }
    const double n = score.logs;
    std::printf("%-26s %5d %6.1f%% %6.1f%% %8.2f %12.3f %12.3f\n", thermometer.name, score.logs,
                100.0 * score.within68 / n, 100.0 * score.within95 / n, std::sqrt(score.z2 / n),
                std::sqrt(score.shift2 / n), score.worst_shift);
  }
  std::filesystem::remove(path);
}
