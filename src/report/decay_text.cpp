// The decay of a free swing in words and as a table.
#include "goingrate/report/tables.hpp"

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
  return fmt::format("{}", fmt::join(names, "; "));
}

std::string law_sentence(const Decay& decay) {
  if (decay.laws.empty()) return {};
  if (decay.law_is_open())
    return fmt::format("The law of friction is open: this log cannot tell apart {} (the best "
                       "first; their BIC differ by less than 6).",
                       open_laws(decay));
  std::string text = fmt::format("The log demands {} friction", decay.laws.front().friction);
  if (decay.laws.size() > 1)
    text += fmt::format(" (the next, {}, is behind by {:.3g} in BIC)", decay.laws[1].friction,
                        decay.laws[1].behind);
  return text + ".";
}

std::string time_sentence(const Decay& decay) {
  if (!is_known(decay.time_s)) return {};
  return fmt::format("At an amplitude of {:.4g} rad the swing dies away by a factor e in {} s.",
                     decay.amplitude_rad, with_sigma(decay.time_s.value, decay.time_s.sigma));
}

std::string q_sentence(const Decay& decay) {
  const auto known_at = [](const QAtAmplitude& at) { return is_known(at.q); };
  const auto& all = decay.q_at_amplitude;
  const auto last = std::find_if(all.begin(), all.end(), known_at);
  const auto first = std::find_if(all.rbegin(), all.rend(), known_at);
  if (last == all.end())
    return "Q is not determined: the log allows too many ways to lose the swing. A longer log, one "
           "with amplitudes, or a larger first swing would tell more.";
  std::string text;
  if (is_known(decay.q))
    text = fmt::format("Q there is {}; it goes", with_sigma(decay.q.value, decay.q.sigma));
  else
    text = "Q goes";
  return text + fmt::format(" from {} at {:.4g} rad to {} at {:.4g} rad.",
                            with_sigma(first->q.value, first->q.sigma), first->amplitude_rad,
                            with_sigma(last->q.value, last->q.sigma), last->amplitude_rad);
}

} // namespace

std::string decay_sentences(const Decay& decay) {
  std::string text;
  for (const std::string& sentence : {time_sentence(decay), q_sentence(decay), law_sentence(decay)})
    if (!sentence.empty()) text += (text.empty() ? "" : " ") + sentence;
  return text;
}

std::string decay_text(const Decay& decay) {
  std::string text = "  " + decay_sentences(decay) + "\n";
  const auto& all = decay.q_at_amplitude;
  if (std::none_of(all.begin(), all.end(), [](const auto& at) { return is_known(at.q); }))
    return text;
  text += fmt::format("  {:<16} {:<20} {}\n", "amplitude, rad", "Q, whichever law", "95 %");
  for (auto at = all.rbegin(); at != all.rend(); ++at) {
    text += fmt::format("  {:<16.4g} ", at->amplitude_rad);
    if (!is_known(at->q)) {
      text += "undetermined\n";
      continue;
    }
    text += fmt::format("{:<20} {:.4g} to ", with_sigma(at->q.value, at->q.sigma), at->q.low95);
    text += std::isfinite(at->q.high95) ? fmt::format("{:.4g}\n", at->q.high95)
                                        : std::string("no end\n");
  }
  return text;
}

} // namespace goingrate
