// The effect of a covariate on the rate, split into that through the amplitude and the rest.
#include "goingrate/causes/covariates.hpp"

#include "answer.hpp"
#include "rate_blocks.hpp"

#include "fit/gravity_share.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace goingrate {

namespace {

using namespace timing_model;

struct Measured {
  double value = 0.0, sigma = 0.0;
};

// d(rate)/d(amplitude) in stationary operation when only the friction changes.
std::optional<double> slope_under_friction(const ClockParameters& clock) {
  constexpr double step = 1e-3; // relative, of the friction: the curve is smooth
  // The law of friction does not matter: only the amplitude does.
  ClockParameters less = clock, more = clock;
  less.epsilon *= 1.0 - step;
  more.epsilon *= 1.0 + step;
  const auto wide = stationary_amplitude(less), narrow = stationary_amplitude(more);
  const auto rate_wide = stationary_rate_first_order(less),
             rate_narrow = stationary_rate_first_order(more);
  if (!wide || !narrow || !rate_wide || !rate_narrow || !(*wide > *narrow)) return {};
  return (*rate_wide - *rate_narrow) / (*wide - *narrow);
}

// The slope, with an upper bound on its standard deviation that holds for any correlations of the
// fit.
std::optional<Measured> slope_of(const FitSummary& fit) {
  const auto clock = fit.has_result() ? fitted_clock(fit) : std::nullopt;
  const auto slope = clock ? slope_under_friction(*clock) : std::nullopt;
  if (!slope) return {};
  Measured result{*slope, 0.0};
  for (const auto& [name, member] :
       {std::pair{"epsilon", &ClockParameters::epsilon}, std::pair{"mu", &ClockParameters::mu},
        std::pair{"phi0", &ClockParameters::phi0}}) {
    const FittedParameter* found = fit.find(name);
    if (found == nullptr || !std::isfinite(found->sigma)) continue;
    ClockParameters other = *clock;
    other.*member += found->sigma;
    if (const auto moved = slope_under_friction(other)) result.sigma += std::abs(*moved - *slope);
  }
  return result;
}

// The change of the amplitude per unit of the covariate, once it has settled.
Measured answer_of_amplitude(const RateBlocks& blocks, std::size_t term) {
  const AnswerBlocks of_swing = without_start(answer_blocks(blocks, blocks.amplitude_rad, term));
  const Answer found(of_swing.series, of_swing.value, of_swing.block_s, true);
  return {found.coefficient(), found.sigma()};
}

} // namespace

std::string_view name_of(EffectWay way) {
  switch (way) {
  case EffectWay::at_once:
    return "at-once";
  case EffectWay::direct:
    return "direct";
  case EffectWay::through_amplitude:
    return "through-amplitude";
  case EffectWay::circular_error:
    return "circular-error";
  case EffectWay::other:
    break;
  }
  return "other";
}

const EffectPart* CovariateEffect::part(EffectWay way) const {
  const auto at =
      std::find_if(parts.begin(), parts.end(), [&](const EffectPart& p) { return p.way == way; });
  return at == parts.end() ? nullptr : &*at;
}

bool CovariateEffect::significant() const {
  constexpr double sigmas = 3.0;
  const EffectPart* first = part(EffectWay::at_once);
  return std::abs(coefficient) > sigmas * sigma ||
         (first != nullptr && std::abs(first->coefficient) > sigmas * first->sigma);
}

void tell_ways(const TimingData& data, const FitSummary& fit,
               std::vector<CovariateEffect>& effects) {
  if (!data.has_amplitude()) return;
  constexpr std::size_t most_blocks = 1024;
  const RateBlocks blocks = rate_blocks(data, std::min(most_blocks, data.size() / 8));
  if (blocks.amplitude_rad.empty()) return;
  const double mean =
      std::accumulate(blocks.amplitude_rad.begin(), blocks.amplitude_rad.end(), 0.0) /
      static_cast<double>(blocks.amplitude_rad.size());
  const auto whole = slope_of(fit);
  const Measured slope = whole.value_or(Measured{-gravity_share_of(fit) * mean / 8.0, 0.0});
  for (CovariateEffect& effect : effects) {
    const auto term = std::find_if(data.terms.begin(), data.terms.end(),
                                   [&](const RateTerm& t) { return t.name == effect.name; });
    if (term == data.terms.end() || term->name == "tide" || !term->is_known.empty()) continue;
    const Measured answer =
        answer_of_amplitude(blocks, static_cast<std::size_t>(term - data.terms.begin()));
    effect.amplitude = answer.value;
    effect.amplitude_sigma = answer.sigma;
    const EffectPart through{whole ? EffectWay::through_amplitude : EffectWay::circular_error,
                             slope.value * answer.value,
                             std::hypot(slope.value * answer.sigma, slope.sigma * answer.value)};
    effect.parts.push_back(through);
    effect.parts.push_back({whole ? EffectWay::direct : EffectWay::other,
                            effect.coefficient - through.coefficient,
                            std::hypot(effect.sigma, through.sigma)});
  }
}

} // namespace goingrate
