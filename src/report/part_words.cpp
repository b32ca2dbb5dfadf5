#include "part_words.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <string_view>

namespace goingrate {

namespace {

// The kind of the breaks between the parts, if it is the same everywhere.
std::optional<GapKind> kind_of_breaks(const std::vector<Gap>& gaps) {
  std::optional<GapKind> kind;
  for (const Gap& gap : gaps) {
    if (gap.bridged) continue;
    if (kind && *kind != gap.kind) return std::nullopt;
    kind = gap.kind;
  }
  return kind;
}

std::string_view why(GapKind kind) {
  switch (kind) {
  case GapKind::step:
    return ", because the beats go on displaced, as if the reference had been set";
  case GapKind::stop:
    return ", because the clock seems to have stood still in between";
  case GapKind::restart:
    return ", because the time goes back in between";
  case GapKind::missed:
  case GapKind::gap:
    break;
  }
  return ", because too many beats are missing in between to count them";
}

// A sentence; empty if its rate, or the uncertainty, is not known.
std::string rate_of_other_part(const Analysis& data, const Wording& words) {
  if (!data.rate.nominal_is_known) return {};
  for (const PartRate& part : segment_rates(data.numbered.beats, data.rate.nominal_period_s))
    if (std::isfinite(part.rate.rate_excess_sigma) &&
        (part.from_cycle > data.beats.back().cycle || part.to_cycle < data.beats.front().cycle))
      return fmt::format(" The rate of the other part, {} it, is {}.",
                         part.from_cycle > data.beats.back().cycle ? "after" : "before",
                         words.rate(part.rate.rate_excess, part.rate.rate_excess_sigma));
  return {};
}

} // namespace

bool stop_is_told(const Analysis& data) {
  return data.numbered.segments > 1 && kind_of_breaks(data.numbered.gaps) == GapKind::stop;
}

std::string which_part(const Analysis& data, const Wording& words) {
  const Beats& all = data.numbered;
  if (all.segments < 2) return {};
  const double begin_s = words.is_dated() ? 0.0 : data.beats.front().time - all.beats.front().time;
  const std::string from_to =
      fmt::format("{} to {}{}", words.short_moment(begin_s),
                  words.short_moment(begin_s + data.rate.duration_s),
                  words.is_dated() ? "" : " after the log's first event");
  const auto kind = kind_of_breaks(all.gaps);
  const std::string text =
      fmt::format("This log is in {} parts that could not be joined{}; the longest, which this "
                  "report is about, is from {}.",
                  all.segments, kind ? why(*kind) : "", from_to);
  if (all.segments > 2)
    return stop_is_told(data) ? text + " Analyse the other parts as logs of their own." : text;
  return text + rate_of_other_part(data, words) +
         (stop_is_told(data) ? " Analyse the other part as a log of its own." : "");
}

} // namespace goingrate
