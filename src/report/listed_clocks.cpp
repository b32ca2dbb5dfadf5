#include "listed_clocks.hpp"

#include "parameter_words.hpp"

#include "base/readable.hpp"
#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

std::string parameters_of(const ClockTwin& clock, const FitSummary& fit, const DisplayUnit& angle) {
  std::vector<std::string> values;
  for (std::size_t i = 0; i < clock.parameters.size(); ++i) {
    const auto& [name, value] = clock.parameters[i];
    FittedParameter p;
    p.name = name;
    if (const FittedParameter* own = fit.find(name)) p.unit = own->unit;
    p.value = value;
    p.sigma = clock.sigma[i].second;
    p = in_shown_unit(angle, p);
    if (!std::isfinite(p.sigma)) continue;
    values.push_back(fmt::format("{} {}{}{}", label_of(name), with_sigma(p.value, p.sigma),
                                 p.unit.empty() ? "" : " ", p.unit));
  }
  return values.empty() ? "none of its parameters is determined"
                        : fmt::format("{}", fmt::join(values, ", "));
}

} // namespace

std::vector<ListedClock> listed_clocks(const FitSummary& fit, const DisplayUnit& angle) {
  const auto says_something = [](const ClockTwin& clock) {
    return std::any_of(clock.sigma.begin(), clock.sigma.end(),
                       [](const auto& known) { return std::isfinite(known.second); });
  };
  if (!fit.likeliest_twin || (!says_something(*fit.likeliest_twin) &&
                              std::none_of(fit.twins.begin(), fit.twins.end(), says_something)))
    return {};
  std::vector<ListedClock> clocks{{"", parameters_of(*fit.likeliest_twin, fit, angle)}};
  for (const ClockTwin& twin : fit.twins) {
    const double odds = std::exp(0.5 * twin.delta_2logL);
    clocks.push_back({odds < 1.05 ? "as likely" : readable(odds, 2) + " times less likely",
                      parameters_of(twin, fit, angle)});
  }
  return clocks;
}

} // namespace goingrate
