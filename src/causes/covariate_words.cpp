// Sentences about covariates.
#include "goingrate/causes/covariates.hpp"

#include "base/readable.hpp"
#include "base/scaled_time.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

std::string unit_below(const CovariateEffect& effect) {
  if (effect.unit == "m^3/kg") return "kg/m^3";
  return effect.unit.starts_with("1/") ? effect.unit.substr(2) : effect.unit;
}

std::string daily_with_sigma(double rate, double sigma) {
  return fmt::format("{:.3g} ± {:.2g} s/day", seconds_per_day * rate, seconds_per_day * sigma);
}

// The effect of Moon and Sun is known from theory: the clock shows a share of it, or does not.
std::string tide_text(const CovariateEffect& effect) {
  const std::string share = fmt::format("tide: the rate responds to Moon and Sun with {:.3g} ± "
                                        "{:.2g} of the theoretical effect",
                                        effect.coefficient, effect.sigma);
  return effect.significant() ? share : share + ": not distinguishable from the noise";
}

std::string parts_text(const CovariateEffect& effect) {
  std::string text;
  for (const EffectPart& part : effect.parts)
    text += fmt::format("{} {} by {}", text.empty() ? ":" : ",", words_of(part.way),
                        daily_with_sigma(part.coefficient, part.sigma));
  if (effect.part(EffectWay::at_once) != nullptr)
    text += fmt::format("; the rest follows with a lag of {} s", readable(effect.lag_s, 3));
  if (std::isfinite(effect.amplitude) && std::abs(effect.amplitude) > 3.0 * effect.amplitude_sigma)
    text += fmt::format(" (the amplitude changes by {:.3g} ± {:.2g} mrad)", 1e3 * effect.amplitude,
                        1e3 * effect.amplitude_sigma);
  return text;
}

} // namespace

std::string_view words_of(EffectWay way) {
  switch (way) {
  case EffectWay::at_once:
    return "at once";
  case EffectWay::direct:
    return "directly";
  case EffectWay::through_amplitude:
    return "through the amplitude";
  case EffectWay::circular_error:
    return "by the circular error of the amplitude";
  case EffectWay::other:
    break;
  }
  return "by all but the circular error";
}

std::string covariate_text(const CovariateEffect& effect) {
  if (effect.name == "tide") return tide_text(effect);
  std::string text =
      fmt::format("{}: the rate changes by {} per {}", effect.name,
                  daily_with_sigma(effect.coefficient, effect.sigma), unit_below(effect));
  if (effect.known_share < 1.0)
    text += fmt::format(", from {:.0f} % of the log", 100.0 * effect.known_share);
  if (!effect.significant()) return text + ": not distinguishable from the noise";
  return text + parts_text(effect) +
         fmt::format("; in the half of the log from which it was not found, compensating for it {} "
                     "the time error from {:.3g} s to {:.3g} s (rms)",
                     effect.helps() ? "lowers" : "raises", effect.without_s, effect.with_s);
}

} // namespace goingrate
