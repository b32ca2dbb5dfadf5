#include "goingrate/analysis/logbook_check.hpp"

#include "goingrate/analysis/analyse.hpp"

#include "base/scaled_time.hpp"
#include "base/special_values.hpp"
#include "causes/rate_step.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace goingrate {

namespace {

constexpr double alike_sigma = 2.0, tell_apart_sigma = 3.0;

std::optional<ChangeKind> kind_of(LogbookWord word) {
  switch (word) {
  case LogbookWord::rate:
    return ChangeKind::regulation;
  case LogbookWord::weight:
    return ChangeKind::drive;
  case LogbookWord::clean:
    return ChangeKind::friction;
  default:
    return {};
  }
}

std::string_view parameter_of(LogbookWord word) {
  return word == LogbookWord::rate ? "T0" : word == LogbookWord::weight ? "mu" : "epsilon";
}

// The ratio, new over old, that an entry states for the parameter of its kind.
std::optional<PlannedRatio> planned_by(const LogbookEntry& entry) {
  if (!(entry.sigma > 0.0) || std::isnan(entry.value)) return {};
  if (entry.what == LogbookWord::rate) // a shorter period is a faster clock
    return PlannedRatio{1.0 - entry.value / seconds_per_day, entry.sigma / seconds_per_day};
  if (!(entry.value > -1.0)) return {};
  return PlannedRatio{1.0 + entry.value, entry.sigma};
}

// What a moment in a log may be off by from that of a note: a clock that is read now and then shows
// a change between the readings before and after it only.
double tolerance_s(double at_s, std::span<const Beat> beats) {
  const auto next = std::upper_bound(
      beats.begin(), beats.end(), at_s,
      [&](double t, const Beat& beat) { return t < beat.time - beats.front().time; });
  if (next == beats.begin() || next == beats.end()) return note_tolerance_s;
  return std::max(note_tolerance_s, next->time - std::prev(next)->time);
}

/// The times, s after the first beat, at which something noted at `at_s` may have happened.
struct Span {
  double from_s, to_s;
  explicit Span(const LogbookEntry& entry, double at_s, std::span<const Beat> beats)
      : from_s(at_s - tolerance_s(at_s, beats)),
        to_s(at_s + tolerance_s(at_s, beats) + (entry.whole_day ? seconds_per_day : 0.0)) {}
  [[nodiscard]] bool holds(double at_s) const { return at_s >= from_s && at_s <= to_s; }
};

// The change that belongs to the entry, among those that no other entry has claimed: the nearest,
// or, where only the day is known, the most significant.
Change* change_for(const LogbookEntry& entry, double at_s, std::span<const Beat> beats,
                   std::vector<Change>& changes) {
  const Span span(entry, at_s, beats);
  Change* best = nullptr;
  const auto is_better = [&](const Change& a, const Change& b) {
    return entry.whole_day ? a.significance > b.significance
                           : std::abs(a.at_s - at_s) < std::abs(b.at_s - at_s);
  };
  for (Change& change : changes)
    if (!change.noted && span.holds(change.at_s) && (best == nullptr || is_better(change, *best)))
      best = &change;
  return best;
}

Change change_at(double at_s, std::span<const Beat> beats) {
  Change change;
  const auto beat = std::find_if(beats.begin(), beats.end(), [&](const Beat& b) {
    return b.time - beats.front().time >= at_s;
  });
  change.cycle = beat->cycle;
  change.at_s = beat->time - beats.front().time;
  change.rate_change = change.rate_change_sigma = not_known;
  change.amplitude_slope_change = not_known;
  change.stands_out = false;
  return change;
}

// Entries within a minute of each other count as one change, with the time of the first.
void take_entry(const LogbookEntry& entry, std::span<const Beat> beats, Diary& diary) {
  constexpr double same_moment_s = 60.0;
  const double at_s = entry.time - beats.front().time;
  Change* change = change_for(entry, at_s, beats, diary.changes);
  const auto is_taken = [&](const Change& known) {
    return known.noted && std::abs(known.at_s - at_s) < same_moment_s;
  };
  const bool is_within = at_s > 0.0 && entry.time < beats.back().time;
  if (change == nullptr && is_within && !entry.whole_day &&
      std::none_of(diary.changes.begin(), diary.changes.end(), is_taken)) {
    const auto place =
        std::upper_bound(diary.changes.begin(), diary.changes.end(), at_s,
                         [](double t, const Change& known) { return t < known.at_s; });
    change = &*diary.changes.insert(place, change_at(at_s, beats));
  }
  if (change == nullptr) return;
  change->noted = true;
  change->kind = *kind_of(entry.what);
  change->planned = planned_by(entry);
}

/// Matches the findings of the log with the entries.
class Check {
public:
  Check(const Analysis& data, const FitSummary& fit)
      : data_(data), fit_(fit), first_(data.beats.front().time),
        last_s_(data.beats.back().time - data.beats.front().time),
        findings_(findings_of(data).entries), written_(findings_.size(), false) {}

  LogbookCheck run(const Logbook& logbook) {
    LogbookCheck check;
    check.source = logbook.source;
    for (const LogbookEntry& entry : logbook.entries)
      check.entries.push_back(finding(entry));
    for (std::size_t i = 0; i < findings_.size(); ++i)
      if (!written_[i]) check.unwritten.push_back({findings_[i], findings_[i].time - first_});
    return check;
  }

private:
  EntryFinding finding(const LogbookEntry& entry) {
    EntryFinding found{.entry = entry, .at_s = entry.time - first_};
    const Span span(entry, found.at_s, data_.beats);
    if (const auto seen = finding_for(entry, span)) {
      written_[*seen] = true;
      found.found_at_s = findings_[*seen].time - first_;
      found.verdict = EntryVerdict::seen;
      if (entry.what == LogbookWord::set) take_setting(entry, findings_[*seen], found);
    } else if (is_outside(entry, found.at_s)) {
      found.verdict = EntryVerdict::outside;
      return found;
    }
    if (kind_of(entry.what)) measure(entry, found);
    const bool is_measured = std::isfinite(found.found_sigma);
    if (kind_of(entry.what) && !is_measured && found.verdict == EntryVerdict::not_seen)
      found.verdict = EntryVerdict::unclear;
    judge(entry, found);
    return found;
  }

  // Changes of the rate are searched in the part that was analysed, stops in the whole log.
  [[nodiscard]] bool is_outside(const LogbookEntry& entry, double at_s) const {
    const double to_s = at_s + (entry.whole_day ? seconds_per_day : 0.0);
    const bool of_rate = kind_of(entry.what).has_value();
    const double begin_s = of_rate ? 0.0 : data_.numbered.beats.front().time - first_;
    const double end_s = of_rate ? last_s_ : data_.numbered.beats.back().time - first_;
    return to_s < begin_s || at_s > end_s;
  }

  // Beats show by how much a clock was set only up to whole periods; these are taken from the plan.
  void take_setting(const LogbookEntry& entry, const LogbookEntry& seen,
                    EntryFinding& found) const {
    found.found = seen.value;
    found.found_sigma = seen.sigma;
    if (!std::isnan(entry.value))
      found.found = entry.value + std::remainder(seen.value - entry.value,
                                                 data_.numbered.typical_period_s);
  }

  // Displaced beats may also be those of a clock that stood still for a while.
  static bool may_be(LogbookWord entry, LogbookWord seen) {
    const bool stood = entry == LogbookWord::stop || entry == LogbookWord::start;
    const bool was_wound = entry == LogbookWord::wind && seen == LogbookWord::note;
    return entry == seen || (stood && seen == LogbookWord::set) || was_wound;
  }

  // The nearest finding of the entry's kind that no other entry names; for a note, one of any kind;
  // for winding, an interruption of the drive.
  [[nodiscard]] std::optional<std::size_t> finding_for(const LogbookEntry& entry,
                                                       const Span& span) const {
    const bool any = entry.what == LogbookWord::note;
    std::optional<std::size_t> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < findings_.size(); ++i) {
      const double at_s = findings_[i].time - first_;
      const double apart = std::abs(findings_[i].time - entry.time);
      if (written_[i] || !span.holds(at_s) || apart >= least || (!any && !may_be(entry.what, findings_[i].what)))
        continue;
      best = i;
      least = apart;
    }
    return best;
  }

  // The change of the rate between what is known before and after, or of a parameter of the fit.
  void measure(const LogbookEntry& entry, EntryFinding& found) const {
    const double at_s = std::isnan(found.found_at_s) ? found.at_s : found.found_at_s;
    const Change* change = nullptr;
    for (const Change& known : data_.diary.changes)
      if (known.noted && known.kind == *kind_of(entry.what) &&
          (change == nullptr || std::abs(known.at_s - at_s) < std::abs(change->at_s - at_s)))
        change = &known;
    if (change == nullptr || !Span(entry, found.at_s, data_.beats).holds(change->at_s)) return;
    if (entry.what == LogbookWord::rate) {
      const RateStep step = step_of(*change);
      found.found = seconds_per_day * step.rate;
      found.found_sigma = seconds_per_day * step.sigma;
    } else {
      take_ratio(entry, *change, found);
    }
  }

  void take_ratio(const LogbookEntry& entry, const Change& change, EntryFinding& found) const {
    for (std::size_t k = 0; k < fit_.events.size(); ++k) {
      if (fit_.events[k].cycle + data_.beats.front().cycle != change.cycle) continue;
      const auto ratio = ratio_at(fit_, parameter_of(entry.what), k + 1);
      if (!ratio) continue;
      found.found = ratio->ratio - 1.0;
      found.found_sigma = ratio->sigma;
    }
  }

  static void judge(const LogbookEntry& entry, EntryFinding& found) {
    const double from_zero = std::abs(found.found) / found.found_sigma;
    if (!std::isfinite(from_zero)) return;
    if (std::isnan(entry.value)) {
      if (from_zero > tell_apart_sigma) found.verdict = EntryVerdict::seen;
      return;
    }
    const double from_plan =
        std::abs(found.found - entry.value) / std::hypot(found.found_sigma, entry.sigma);
    if (from_plan <= alike_sigma)
      found.verdict = from_zero > alike_sigma ? EntryVerdict::as_planned : EntryVerdict::unclear;
    else if (from_zero <= alike_sigma)
      found.verdict = EntryVerdict::not_seen;
    else
      found.verdict = std::min(from_plan, from_zero) > tell_apart_sigma ? EntryVerdict::differs
                                                                        : EntryVerdict::unclear;
  }

  const Analysis& data_;
  const FitSummary& fit_; // a fit that did not use the plans
  Instant first_;
  double last_s_;
  std::vector<LogbookEntry> findings_;
  std::vector<bool> written_; // for each finding: an entry names it
};

LogbookEntry entry_of(const Change& change, const Analysis& data) {
  LogbookEntry entry;
  entry.time = data.beats.front().time + change.at_s;
  const RateStep step = step_of(change);
  const double rate = seconds_per_day * step.rate, sigma = seconds_per_day * step.sigma;
  switch (change.kind) {
  case ChangeKind::regulation:
    entry.what = LogbookWord::rate;
    entry.value = rate;
    entry.sigma = std::isfinite(sigma) ? sigma : 0.0;
    break;
  case ChangeKind::drive:
    entry.what = LogbookWord::weight;
    break;
  case ChangeKind::friction:
    entry.what = LogbookWord::clean;
    break;
  case ChangeKind::unclear:
    break;
  }
  if (change.kind != ChangeKind::regulation && std::isfinite(rate))
    entry.note = fmt::format("{}: the mean rate changed by {:.3g} s/day",
                             change.kind == ChangeKind::unclear ? "unclear" : name_of(change.kind),
                             rate);
  return entry;
}

void add_interruptions(const Analysis& data, std::vector<LogbookEntry>& entries) {
  for (const Interruption& event : data.diary.interruptions) {
    LogbookEntry entry;
    entry.time = data.beats.front().time + event.begin.at_s;
    entry.note = fmt::format("the drive was interrupted for {:.0f} s",
                             event.end.at_s - event.begin.at_s);
    entries.push_back(std::move(entry));
  }
}

// A stop of the clock, or a setting of the reference clock, between two beats.
void add_break(const Gap& gap, const Beat& before, const Beat& after, const Beats& numbered,
               std::vector<LogbookEntry>& entries) {
  LogbookEntry entry;
  if (gap.kind == GapKind::stop) {
    entry.what = LogbookWord::stop;
    entry.time = before.time;
    entries.push_back(entry);
    entry.what = LogbookWord::start;
    entry.time = after.time;
    entries.push_back(entry);
  } else if (gap.kind == GapKind::step) {
    entry.what = LogbookWord::set;
    entry.time = after.time;
    const double passed = after.time - before.time;
    entry.value = -std::remainder(passed, numbered.typical_period_s); // forward: beats come early
    entry.sigma = numbered.scatter_s;
    entry.note = "displaced by this much, or by whole periods more: set, or the clock stood still";
    entries.push_back(entry);
  }
}

// Adds the breaks between parts of the log; the gap after the last beat of a part gives the reason.
void add_breaks(const Analysis& data, std::vector<LogbookEntry>& entries) {
  const Beat* before = nullptr;
  for (const Beat& beat : data.numbered.beats) {
    if (beat.flag != BeatFlag::good) continue;
    if (before != nullptr && beat.segment != before->segment) {
      const auto gap = std::find_if(data.numbered.gaps.begin(), data.numbered.gaps.end(),
                                    [&](const Gap& known) {
                                      return !known.bridged && known.after_cycle == before->cycle;
                                    });
      if (gap != data.numbered.gaps.end())
        add_break(*gap, *before, beat, data.numbered, entries);
    }
    before = &beat;
  }
}

} // namespace

std::string_view name_of(EntryVerdict verdict) {
  switch (verdict) {
  case EntryVerdict::as_planned:
    return "as planned";
  case EntryVerdict::differs:
    return "differs";
  case EntryVerdict::seen:
    return "seen";
  case EntryVerdict::not_seen:
    return "not seen";
  case EntryVerdict::unclear:
    return "unclear";
  case EntryVerdict::outside:
    break;
  }
  return "outside of what was analysed";
}

void take_entries(const Logbook& logbook, std::span<const Beat> beats, Diary& diary) {
  for (const bool whole_day : {false, true}) // entries with a time of day are matched first
    for (const LogbookEntry& entry : logbook.entries)
      if (entry.whole_day == whole_day && kind_of(entry.what)) take_entry(entry, beats, diary);
}

std::optional<FoundRatio> ratio_at(const FitSummary& fit, std::string_view name, std::size_t k) {
  const FittedParameter* after = fit.find(fmt::format("{}@{}", name, k));
  const FittedParameter* before = nullptr;
  for (std::size_t earlier = k; earlier-- > 0 && before == nullptr;)
    before = fit.find(earlier == 0 ? std::string(name) : fmt::format("{}@{}", name, earlier));
  if (after == nullptr || before == nullptr) return {};
  const auto relative = [](const FittedParameter& p) { return p.sigma / std::abs(p.value); };
  const double a = relative(*after), b = before->status == ParameterStatus::fixed ? 0.0 : relative(*before);
  if (!std::isfinite(a) || !std::isfinite(b)) return {};
  const auto place = [&](const FittedParameter& p) {
    return std::find(fit.correlated.begin(), fit.correlated.end(), p.name) - fit.correlated.begin();
  };
  const auto i = static_cast<std::size_t>(place(*after)), j = static_cast<std::size_t>(place(*before));
  const bool known = i < fit.correlation.size() && j < fit.correlation.size();
  const double together = known ? fit.correlation[i][j] : 0.0;
  const double ratio = after->value / before->value;
  return FoundRatio{ratio, std::abs(ratio) *
                               std::sqrt(std::max(0.0, a * a + b * b - 2.0 * together * a * b))};
}

FitOptions without_what_is_excluded(FitOptions options, const FitSummary& alone) {
  constexpr double exclusion_sigma = 5.0;
  for (std::size_t k = 0; k < options.events.size(); ++k) {
    auto& planned = options.events[k].planned;
    if (!planned) continue;
    const bool same = k < alone.events.size() && alone.events[k].cycle == options.events[k].cycle;
    const auto found =
        same ? ratio_at(alone, options.events[k].names.front(), k + 1) : std::nullopt;
    if (found && std::abs(found->ratio - planned->ratio) >
                     exclusion_sigma * std::hypot(found->sigma, planned->sigma))
      planned.reset();
  }
  return options;
}

LogbookCheck check_logbook(const Logbook& logbook, const Analysis& data, const FitSummary& fit) {
  return Check(data, fit).run(logbook);
}

Logbook findings_of(const Analysis& data) {
  Logbook logbook;
  logbook.source = data.log.source;
  logbook.origin = data.log.origin;
  const auto is_in_one = [&](const Change& change) {
    return std::any_of(data.diary.interruptions.begin(), data.diary.interruptions.end(),
                       [&](const Interruption& event) {
                         return change.at_s >= event.begin.at_s && change.at_s <= event.end.at_s;
                       });
  };
  for (const Change& change : data.diary.changes)
    if ((!change.noted || change.significance > 0.0) && !is_in_one(change))
      logbook.entries.push_back(entry_of(change, data));
  add_interruptions(data, logbook.entries);
  add_breaks(data, logbook.entries);
  std::stable_sort(logbook.entries.begin(), logbook.entries.end(),
                   [](const LogbookEntry& a, const LogbookEntry& b) { return a.time < b.time; });
  for (LogbookEntry& entry : logbook.entries)
    entry.has_zone = data.log.zone_s.has_value();
  return logbook;
}

} // namespace goingrate
