#include "page.hpp"

#include "fault_counts.hpp"
#include "logbook_words.hpp"
#include "markup.hpp"
#include "mean_amplitude.hpp"
#include "wording.hpp"

#include "base/scaled_time.hpp"
#include "base/special_values.hpp"
#include "spectra/noise_type.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace goingrate::page {

namespace {

// One of the key figures at the top of the page.
std::string card(std::string_view name, const std::string& value, std::string_view note) {
  return fmt::format("<div><dt>{}</dt><dd><strong>{}</strong>{}</dd></div>\n", escape_markup(name),
                     escape_markup(value),
                     note.empty() ? "" : fmt::format("<br>{}", escape_markup(note)));
}

std::string counts(const Analysis& data) {
  const Beats& numbered = data.numbered;
  std::string text = fault_counts(numbered);
  if (numbered.segments > 1)
    return text +
           fmt::format("; the log is in {} segments, the longest was analysed", numbered.segments);
  return text + "; one segment";
}

std::string relaxation_text(const Relaxation& relaxation) {
  std::string text = fmt::format(
      "{} s, from {}{}", measured(relaxation.time_constant_s, relaxation.sigma_s),
      plain_number(relaxation.window_s, 4) + " s",
      relaxation.exponential ? "; one exponential is enough" : "; not a single exponential");
  if (relaxation.shorter_window_s > 0.0 && relaxation.longer_window_s > 0.0)
    text += fmt::format("; {} s from a stretch ¾ and {} s from one 1¼ as long",
                        plain_number(relaxation.shorter_window_s, 4),
                        plain_number(relaxation.longer_window_s, 4));
  return text;
}

std::string rate_or_dash(double rate, double sigma, const Wording& words) {
  return std::isfinite(rate) ? typeset(words.rate(rate, sigma)) : "–";
}

// The rates before and after a change, if they are known.
std::string change_table(const Analysis& data, const Wording& words) {
  const Diary& diary = data.diary;
  Table table("Changes, numbered as in the figures",
              {"no.", "when", "cycle", "what changed", "mean rate before", "mean rate after"});
  for (std::size_t i = 0; i < diary.changes.size(); ++i) {
    const Change& change = diary.changes[i];
    const bool known = data.rate.nominal_is_known;
    table.row({fmt::format("{}", i + 1), words.moment(change.at_s), fmt::format("{}", change.cycle),
               (change.kind == ChangeKind::unclear ? "–" : std::string(name_of(change.kind))) +
                   (change.is_only_noted() ? " (only in the diary)" : ""),
               known ? rate_or_dash(change.rate_before, change.rate_before_sigma, words) : "–",
               known ? rate_or_dash(change.rate_after, change.rate_after_sigma, words) : "–"});
  }
  return table.html();
}

std::string interruption_table(const Interruption& event, std::size_t number,
                               const Wording& words) {
  Table table(fmt::format("Interruption {} of the drive", number), {"what", "value"});
  table.row(
      {"from", fmt::format("{} (cycle {})", words.moment(event.begin.at_s), event.begin.cycle)});
  table.row({"to", fmt::format("{} (cycle {})", words.moment(event.end.at_s), event.end.cycle)});
  table.row({"change of rate at once", typeset(words.rate(event.rate_change, not_known))});
  if (std::isfinite(event.amplitude_before_rad) && std::isfinite(event.amplitude_after_rad))
    table.row({"amplitude before and at the end",
               fmt::format("{} and {}", words.angle(event.amplitude_before_rad, not_known),
                           words.angle(event.amplitude_after_rad, not_known))});
  if (event.decay)
    table.row({"decay of the amplitude, time constant", relaxation_text(*event.decay)});
  if (event.recovery)
    table.row({"recovery after it, time constant", relaxation_text(*event.recovery)});
  if (event.decay)
    table.row({"recovery that theory asks for, half the decay time",
               measured(0.5 * event.decay->time_constant_s, 0.5 * event.decay->sigma_s) + " s"});
  return table.html();
}

std::string list(const std::vector<std::string>& items) {
  std::string html = "<ul>\n";
  for (const std::string& item : items)
    html += "<li>" + escape_markup(item) + "</li>\n";
  return html + "</ul>\n";
}

std::string and_more(std::size_t all, std::size_t shown) {
  return all > shown ? paragraph(fmt::format("… and {} more.", all - shown)) : std::string();
}

std::string issue_table(const ClockLog& log) {
  const std::vector<LineIssue>& issues = log.issues;
  if (issues.empty()) return paragraph("Every line of the log could be used.");
  constexpr std::size_t most_rows = 20;
  constexpr std::size_t bytes = 120; // of a faulty line
  Table table("Lines with something wrong", {"line", "column", "found", "what was done"});
  const auto line_of = [&](const LineIssue& issue) {
    const TextPlace place = log.place(issue.line);
    return log.files.empty() ? fmt::format("{}", place.line)
                             : fmt::format("{}:{}", file_name(place.file), place.line);
  };
  for (std::size_t i = 0; i < std::min(most_rows, issues.size()); ++i)
    table.row({line_of(issues[i]), issues[i].column > 0 ? fmt::format("{}", issues[i].column) : "–",
               shortened(issues[i].found, bytes), shortened(issues[i].action, bytes)});
  return table.html() + and_more(issues.size(), most_rows);
}

std::string gap_table(const std::vector<Gap>& gaps) {
  constexpr std::size_t most_rows = 50;
  Table table("Gaps over which the beats could not be counted",
              {"after cycle", "best guess of cycles missing", "probability of that guess"});
  std::size_t unbridged = 0;
  for (const Gap& gap : gaps) {
    if (gap.bridged || ++unbridged > most_rows) continue;
    table.row({fmt::format("{}", gap.after_cycle), fmt::format("{}", gap.length),
               plain_number(gap.probability, 2)});
  }
  if (unbridged == 0)
    return paragraph("No gap had to be left open: the count of beats holds throughout.");
  return table.html() + and_more(unbridged, most_rows);
}

} // namespace

std::string duration_text(double seconds) {
  if (!std::isfinite(seconds)) return "not known";
  if (std::abs(seconds) < 600.0) return plain_number(seconds, 4) + " s";
  if (std::abs(seconds) < 2.0 * 3600.0) return plain_number(seconds / 60.0, 4) + " min";
  if (std::abs(seconds) < 2.0 * seconds_per_day) return plain_number(seconds / 3600.0, 4) + " h";
  return plain_number(seconds / seconds_per_day, 4) + " days";
}

// The Q of a ring-down; empty if the log does not determine it.
std::string card_of_q(const FitSummary& fit, const Wording& words) {
  if (!fit.decay || !std::isfinite(fit.decay->q.value)) return "";
  return card("Quality factor Q", measured(fit.decay->q.value, fit.decay->q.sigma),
              fmt::format("at an amplitude of {}, whichever law the friction has",
                          words.angle(fit.decay->amplitude_rad, 0.0)));
}

std::string key_figures(const Analysis& data) {
  const RateSummary& rate = data.rate;
  const Wording words(data);
  std::string cards;
  if (swings_freely(data)) {
    // Only a clock has a rate.
  } else if (rate.nominal_is_known) {
    if (data.stretches.size() > 1 || data.now.rate.rate_excess != rate.rate_excess)
      cards += card("Rate now",
                    typeset(words.rate(data.now.rate.rate_excess, data.now.rate.rate_excess_sigma)),
                    "from " + words.short_moment(data.now.start - data.beats.front().time) + " on");
    cards +=
        card(data.numbered.segments > 1 ? "Rate over the whole part" : "Rate over the whole log",
             typeset(words.rate(rate.rate_excess, rate.rate_excess_sigma)),
             "time gained from the first beat to the last, over the time between; ± allows "
             "for how the rate varied on the way");
  } else {
    cards +=
        card("Rate", "not known", "no nominal period is known to compare the mean period with");
  }
  if (!has_no_period(data.log))
    cards += card("Mean period", measured(rate.mean_period_s, rate.mean_period_sigma_s, 12) + " s",
                  (rate.nominal_is_known
                       ? fmt::format("against {} s", plain_number(rate.nominal_period_s, 12))
                       : std::string("from the first beat to the last")) +
                      "; ± allows for how it varied on the way");
  cards += card_of_q(data.fit, words);
  if (const auto& error = data.sensor.beat_error_s; error && !swings_freely(data))
    cards += card("Beat error", typeset(short_time(std::abs(error->value), error->sigma)),
                  "what tick and tock differ by (half of it is also called so): the clock is out "
                  "of beat, or the sensor "
                  "stands off the middle");
  const bool is_fitted = data.fit.decay && std::isfinite(data.fit.decay->first.rad);
  for (const bool end : {false, true}) {
    if (is_fitted) { // a mean over beats would lag behind a swing that dies away
      const TurningAngle& swing = end ? data.fit.decay->last : data.fit.decay->first;
      cards += card(end ? "Amplitude at the end" : "Amplitude at the start",
                    words.angle(swing.rad, swing.sigma_rad),
                    fmt::format("of the fit, at the {} beat; {:.3g}°", end ? "last" : "first",
                                swing.rad * 360.0 / two_pi));
      continue;
    }
    const MeanAmplitude mean = amplitude_at(data.beats, end);
    if (std::isfinite(mean.rad))
      cards +=
          card(end ? "Amplitude at the end" : "Amplitude at the start",
               words.angle(mean.rad, mean.sigma_rad),
               fmt::format("mean of {} beats; {:.3g}°", mean.beats, mean.rad * 360.0 / two_pi));
  }
  cards +=
      card(capitalised(event_word(has_no_period(data.log), rate.nominal_period_s)),
           fmt::format("{} in {}", rate.crossings, words.duration(rate.duration_s)), counts(data));
  return section("key-figures", "Key figures", "<dl class=\"cards\">\n" + cards + "</dl>\n");
}

// The keeper's diary, entry by entry.
std::string logbook_tables(const LogbookCheck& check, const Wording& words) {
  Table table("The keeper's diary beside the log",
              {"when", "what", "planned", "found", "the log", "note"});
  for (const EntryFinding& finding : check.entries) {
    const LogbookEntry& entry = finding.entry;
    const auto value = [&](double size, double sigma) {
      const std::string text = value_in_words(entry.what, size, sigma, words);
      return text.empty() ? "–" : typeset(text);
    };
    table.row({words.moment(finding.at_s), std::string(in_words(entry.what)),
               value(entry.value, entry.sigma), value(finding.found, finding.found_sigma),
               std::string(name_of(finding.verdict)), escape_markup(entry.note)});
  }
  Table unwritten("What the log shows and nobody wrote down", {"when", "what", "found", "note"});
  for (const UnwrittenFinding& finding : check.unwritten) {
    const LogbookEntry& entry = finding.entry;
    unwritten.row({words.moment(finding.at_s), std::string(in_words(entry.what)),
                   std::isnan(entry.value)
                       ? "–"
                       : typeset(value_in_words(entry.what, entry.value, entry.sigma, words)),
                   escape_markup(entry.note)});
  }
  return table.html() + (unwritten.empty() ? "" : unwritten.html());
}

std::string diary(const Analysis& data) {
  if (data.diary.changes.empty() && data.diary.interruptions.empty() && !data.logbook)
    return section("diary", "Diary",
                   paragraph("No sudden change of rate or amplitude stands out."));
  const Wording words(data);
  std::string body;
  if (!data.diary.changes.empty()) body += change_table(data, words);
  for (std::size_t i = 0; i < data.diary.interruptions.size(); ++i)
    body += interruption_table(data.diary.interruptions[i], i + 1, words);
  if (data.logbook) body += logbook_tables(*data.logbook, words);
  return section("diary", "Diary", body);
}

std::string stability(const Analysis& data) {
  const Wording words(data);
  const bool overlapping = data.deviation.kind == DeviationKind::oadev;
  Table table(overlapping ? "Overlapping Allan deviation" : "Allan deviation",
              {"τ, s", "differences", "deviation", "68 % interval",
               std::string(words.deviation_unit().name), "noise"});
  for (const DeviationRow& row : data.deviation.rows)
    table.row({plain_number(row.tau_s, 6), fmt::format("{}", row.n), plain_number(row.value, 4),
               row.interval ? plain_number(row.low) + " to " + plain_number(row.high) : "–",
               plain_number(words.deviation_unit().factor * row.value),
               row.interval ? std::string(noise_name(row.alpha)) : "–"});
  return section("stability", "Stability",
                 table.empty() ? paragraph("The log is too short for it.") : table.html());
}

std::string reading(const Analysis& data) {
  std::string body = "<h3>What was assumed</h3>\n";
  std::vector<std::string> assumed;
  for (const Assumption& assumption : data.log.assumptions)
    assumed.push_back(assumption.text);
  body += assumed.empty() ? paragraph("Nothing.") : list(assumed);
  body += issue_table(data.log) + gap_table(data.numbered.gaps);
  return section("reading", "How the log was read", body);
}

} // namespace goingrate::page
