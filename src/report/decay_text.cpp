// Describes the decay of a free swing, in sentences and as a table.
#include "goingrate/report/tables.hpp"

#include "rounded.hpp"
#include "wording.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

bool is_known(const DecayEstimate& estimate) { return std::isfinite(estimate.value); }

std::string open_laws(const Decay& decay) {
  std::vector<std::string> names;
  for (const FrictionLaw& law : decay.laws)
    if (law.is_open()) names.push_back(law.friction);
  return listed(names, "and");
}

// How many times less likely a law is whose BIC is larger by this difference, which is twice the
// logarithm of the odds (Schwarz, Ann. Stat. 6, 461, 1978).
std::string times_as_likely(double behind) {
  constexpr double most_told = 1e6;
  const double odds = std::exp(0.5 * behind);
  return odds > most_told ? "more than a million times"
                          : fmt::format("{} times", with_sigma(odds, 0.0, 2));
}

std::string law_sentence(const Decay& decay) {
  if (decay.laws.empty()) return {};
  if (decay.law_is_open())
    return fmt::format("The law of friction is open between {} (the likeliest first; none is 20 "
                       "times less likely than it).",
                       open_laws(decay));
  std::string text =
      fmt::format("The friction of this pendulum is {}", decay.laws.front().friction);
  if (decay.laws.size() > 1)
    text += fmt::format(" (the next best law, {}, is {} less likely)", decay.laws[1].friction,
                        times_as_likely(decay.laws[1].behind));
  return text + ".";
}

std::string angle(double rad, const DisplayUnit& unit) {
  return fmt::format("{} {}", with_sigma(unit.factor * rad, 0.0, 4), unit.name);
}

// Q and decay time at the one amplitude at which the log determines them best.
std::string time_sentence(const Decay& decay, const DisplayUnit& unit) {
  if (!is_known(decay.time_s)) return {};
  const std::string q =
      is_known(decay.q) ? ", and Q is " + with_sigma(decay.q.value, decay.q.sigma) : "";
  return fmt::format("At an amplitude of {} the decay time, in which the swing would fall by a "
                     "factor e at the rate it has there, is {} s{}.",
                     angle(decay.amplitude_rad, unit),
                     with_sigma(decay.time_s.value, decay.time_s.sigma), q);
}

bool has_open(const Decay& decay, std::string_view friction) {
  return std::any_of(decay.laws.begin(), decay.laws.end(), [&](const FrictionLaw& law) {
    return law.is_open() && law.friction == friction;
  });
}

// Whether the log shows that Q is the same for wide and small swings: linear friction explains it,
// and a difference that counts would have been seen.
bool shows_one_q(const Decay& decay) {
  constexpr double largest_relative_sigma = 0.03; // of the ratio: a tenth is seen at three sigma
  const DecayEstimate &narrow = decay.q_at_amplitude.front().q,
                      &wide = decay.q_at_amplitude.back().q;
  return has_open(decay, "linear") &&
         std::hypot(narrow.sigma / narrow.value, wide.sigma / wide.value) < largest_relative_sigma;
}

std::string q_sentence(const Decay& decay, const DisplayUnit& unit) {
  const auto known_at = [](const QAtAmplitude& at) { return is_known(at.q); };
  const auto& all = decay.q_at_amplitude;
  const auto last = std::find_if(all.begin(), all.end(), known_at);
  const auto first = std::find_if(all.rbegin(), all.rend(), known_at);
  if (last == all.end())
    return "Q is not determined: the log allows too many ways to lose the swing. A longer log, one "
           "with amplitudes, or a larger first swing would tell more.";
  constexpr double least_significance = 2.0; // sigma of the difference
  const auto significance = [&](const QAtAmplitude& at) {
    if (!is_known(at.q)) return 0.0;
    return std::abs(first->q.value - at.q.value) / std::hypot(first->q.sigma, at.q.sigma);
  };
  // Small swings may tell less than those between.
  const auto other = std::max_element(all.begin(), all.end(), [&](const auto& a, const auto& b) {
    return significance(a) < significance(b);
  });
  const bool differs = significance(*other) >= least_significance;
  const QAtAmplitude& to = !differs || significance(*last) > least_significance ? *last : *other;
  if (to.amplitude_rad == first->amplitude_rad)
    return "This log leaves open what Q is at other amplitudes.";
  const std::string_view form =
      differs              ? "Q goes from {} at {} to {} at {}."
      : shows_one_q(decay) ? "Q is the same for wide and small swings, within its error: {} at {} "
                             "and {} at {}."
      : has_open(decay, "linear") || decay.laws.empty()
          ? "Whether Q changes with the swing this log leaves open: it is {} at {} and {} at {}."
          : "How much Q changes with the swing this log leaves open: it is {} at {} and {} at {}.";
  return fmt::format(fmt::runtime(form), with_sigma(first->q.value, first->q.sigma),
                     angle(first->amplitude_rad, unit), with_sigma(to.q.value, to.q.sigma),
                     angle(to.amplitude_rad, unit));
}

} // namespace

std::string decay_sentences(const Decay& decay) {
  const DisplayUnit unit = angle_unit(decay);
  std::string text;
  for (const std::string& sentence :
       {time_sentence(decay, unit), q_sentence(decay, unit), law_sentence(decay)})
    if (!sentence.empty()) text += (text.empty() ? "" : " ") + sentence;
  return text;
}

std::string decay_text(const Decay& decay) {
  std::string text = "  " + decay_sentences(decay) + "\n";
  const auto& all = decay.q_at_amplitude;
  if (std::none_of(all.begin(), all.end(), [](const auto& at) { return is_known(at.q); }))
    return text;
  const DisplayUnit unit = angle_unit(decay);
  text += fmt::format("  {:<16} {:<20} {}\n", fmt::format("amplitude, {}", unit.name),
                      "Q, whichever law", "95 %");
  for (auto at = all.rbegin(); at != all.rend(); ++at) {
    text += fmt::format("  {:<16} ", with_sigma(unit.factor * at->amplitude_rad, 0.0, 4));
    if (!is_known(at->q)) {
      text += "undetermined\n";
      continue;
    }
    text += fmt::format("{:<20} {} to {}\n", with_sigma(at->q.value, at->q.sigma),
                        to_the_digits_of(at->q.low95, at->q.sigma),
                        std::isfinite(at->q.high95) ? to_the_digits_of(at->q.high95, at->q.sigma)
                                                    : "no end");
  }
  return text;
}

} // namespace goingrate
