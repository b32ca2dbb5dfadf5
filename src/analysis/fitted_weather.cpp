#include "fitted_weather.hpp"

#include "base/scaled_time.hpp"
#include "causes/account.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace goingrate {

namespace {

struct Kind {
  Cause cause;
  std::string_view term, unit;
};

constexpr std::array kinds{Kind{Cause::temperature, "temperature", "K"},
                           Kind{Cause::pressure, "pressure", "mbar"}};

// Whether the cause is named with a coefficient that is known better than to `sigma`.
bool is_known_better(Cause cause, double sigma, std::span<const Suspicion> named) {
  return std::any_of(named.begin(), named.end(), [&](const Suspicion& suspicion) {
    return suspicion.cause == cause && suspicion.numbers.sigma < sigma;
  });
}

// Where the log leaves the noise of the drive open, the fit is one of a family whose members wander
// by different amounts: the sigma of what hides in that wander is that of one member.
bool knows_the_noise(const FitSummary& fit) {
  constexpr std::array noises{"jitter_rms", "walk_rms", "drive_rms", "slow_rms", "slow_time"};
  return std::none_of(noises.begin(), noises.end(), [&](const char* name) {
    const FittedParameter* noise = fit.find(name);
    return noise != nullptr && noise->status == ParameterStatus::undetermined;
  });
}

} // namespace

std::vector<Suspicion> weather_seen_by_fit(const FitSummary& fit,
                                           std::span<const Suspicion> named) {
  std::vector<Suspicion> seen;
  if (fit.status != FitStatus::converged || !knows_the_noise(fit)) return seen;
  for (const Kind& kind : kinds) {
    const FittedParameter* found = fit.find(kind.term);
    if (found == nullptr || found->status != ParameterStatus::free ||
        is_known_better(kind.cause, found->sigma, named))
      continue;
    // The penalty of the BIC for one more parameter.
    const double price = std::log(static_cast<double>(fit.residual_s.size()));
    const double gain = std::pow(found->value / found->sigma, 2) - price;
    if (!(gain > timing_model::convincing_gain)) continue;
    Suspicion suspicion{kind.cause, gain, {}};
    suspicion.evidence =
        fmt::format("in the fitted model the rate changes by {:+.3g} ± {:.2g} s/day per {}",
                    found->value * seconds_per_day, found->sigma * seconds_per_day, kind.unit);
    suspicion.numbers.size = found->value;
    suspicion.numbers.sigma = found->sigma;
    seen.push_back(std::move(suspicion));
  }
  return seen;
}

void take_off(std::span<const Suspicion> weather, TimingData& times) {
  for (const Kind& kind : kinds) {
    const auto cause =
        std::find_if(weather.begin(), weather.end(),
                     [&](const Suspicion& suspicion) { return suspicion.cause == kind.cause; });
    if (cause == weather.end()) continue;
    for (const RateTerm& term : times.terms)
      for (std::size_t i = 0; term.name == kind.term && i < times.size(); ++i)
        times.lateness_s[i] += cause->numbers.size * term.advance_s[i];
  }
}

} // namespace goingrate
