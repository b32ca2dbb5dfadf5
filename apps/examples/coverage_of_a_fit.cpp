// A scenario becomes many logs, each is fitted, and the truth is counted in the intervals:
// coverage_of_a_fit SCENARIO.toml LOGS
//
// The scenario has one event, a change of mu, as data/scenarios/jump.toml has.
#include <goingrate/goingrate.hpp>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>

using namespace goingrate;

TimingData simulated(const Scenario& scenario, std::uint64_t seed) {
  ClockRun clock(scenario, seed);
  Sensor sensor(scenario, seed);
  sensor.see(clock.last());
  while (const auto period = clock.next())
    sensor.see(*period);
  return timing_data(
      number_beats(sensor.log(scenario.clock.nominal_period_s)).longest_segment());
}

int main(int count, char** words) {
  if (count != 3) {
    std::cerr << "coverage_of_a_fit SCENARIO.toml LOGS\n";
    return 2;
  }
  std::ifstream file(words[1]);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const Scenario scenario = parse_scenario(text, words[1]);

  FitOptions options;
  options.fixed["T0"] = scenario.clock.nominal_period_s;
  options.events = {{*scenario.events.at(0).at_period, {"mu"}}};

  const int logs = std::atoi(words[2]);
  int inside68 = 0, inside95 = 0;
  for (int k = 0; k < logs; ++k) {
    const FitSummary fit = fit_clock(simulated(scenario, 1000 + static_cast<std::uint64_t>(k)),
                                     scenario.clock.nominal_period_s, options);
    const FittedParameter& epsilon = fit["epsilon"];
    const double truth = scenario.clock.epsilon;
    inside68 += epsilon.low68 <= truth && truth <= epsilon.high68 ? 1 : 0;
    inside95 += epsilon.low95 <= truth && truth <= epsilon.high95 ? 1 : 0;
  }
  std::cout << "epsilon lies in its 68 % interval in " << inside68 << " of " << logs
            << " logs, in its 95 % interval in " << inside95 << "\n";
}
