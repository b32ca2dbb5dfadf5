// Confusion of ten causes and of health on simulated weeks. Argument: clocks of each kind (28).
#include "support/sick_clocks.hpp"

#include <cstdio>
#include <cstdlib>
#include <map>
#include <thread>

namespace {

using namespace goingrate;

constexpr int causes = 10;

} // namespace

int main(int count, char** words) {
  const auto each = static_cast<std::size_t>(count > 1 ? std::atoi(words[1]) : 28);
  int first_right = 0, second_right = 0, healthy_right = 0, sick = 0;
  std::printf("%-20s named first\n", "truth");
  for (int k = 0; k <= causes; ++k) {
    const bool healthy = k == causes;
    const auto cause = static_cast<Cause>(k);
    std::vector<std::vector<Suspicion>> found(each);
    const auto half = [&](std::size_t first) {
      for (std::size_t i = first; i < each; i += 2) {
        test::SickClock clock;
        if (!healthy) clock.cause = cause;
        clock.seed = 1000 * static_cast<std::uint64_t>(k + 1) + i;
        found[i] = test::diagnosed(clock);
      }
    };
    std::thread other(half, 1);
    half(0);
    other.join();
    std::map<std::string, int> named;
    for (const auto& suspicions : found) {
      ++named[suspicions.empty() ? "healthy" : std::string(name_of(suspicions[0].cause))];
      if (healthy) {
        healthy_right += suspicions.empty() ? 1 : 0;
        continue;
      }
      ++sick;
      const bool one = !suspicions.empty() && suspicions[0].cause == cause;
      first_right += one ? 1 : 0;
      second_right += one || (suspicions.size() > 1 && suspicions[1].cause == cause) ? 1 : 0;
    }
    std::printf("%-20s", healthy ? "healthy" : std::string(name_of(cause)).c_str());
    for (const auto& [name, times] : named)
      std::printf(" %s %d,", name.c_str(), times);
    std::printf("\n");
    std::fflush(stdout);
  }
  std::printf("right cause first %.3f, among the first two %.3f, healthy called healthy %.3f\n",
              static_cast<double>(first_right) / sick, static_cast<double>(second_right) / sick,
              static_cast<double>(healthy_right) / static_cast<double>(each));
}
