// libFuzzer target: any bytes as a scenario, and the same as an override of a key.
#include "memory.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/clock/scenario.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace goingrate;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  fuzz::reset_peak();
  const std::size_t before = fuzz::peak_bytes();
  try {
    const Scenario scenario = parse_scenario(text, "fuzz.toml");
    if (!std::isfinite(scenario.clock.epsilon) || !(scenario.clock.nominal_period_s > 0.0)) {
      std::fprintf(stderr, "violated: what is accepted is in range\n");
      std::abort();
    }
  } catch (const InputError&) {
  } catch (const ArgumentError&) {
  }
  try {
    constexpr std::string_view good = "[clock]\nepsilon = 1e-3\nmu = 2e-5\nphi0 = 0.03\n"
                                      "[run]\nperiods = 10\n";
    (void)parse_scenario(good, "fuzz.toml", {std::string(text.substr(0, 200))});
  } catch (const InputError&) {
  } catch (const ArgumentError&) {
  }
  // A TOML tree takes about a hundred bytes a node, the shortest of which is "a=1" and a line end.
  const std::size_t limit = 100 * size + (1U << 20);
  if (fuzz::peak_bytes() - before > limit) {
    std::fprintf(stderr, "violated: memory in proportion to the input\n");
    std::abort();
  }
  return 0;
}
