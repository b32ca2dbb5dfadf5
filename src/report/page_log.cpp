#include "page.hpp"

#include "fault_counts.hpp"
#include "markup.hpp"

#include "base/scaled_time.hpp"
#include "spectra/noise_type.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

namespace goingrate::page {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// One of the numbers at the head of the page.
std::string card(std::string_view name, const std::string& value, std::string_view note) {
  return fmt::format("<div><dt>{}</dt><dd><strong>{}</strong>{}</dd></div>\n", escape_markup(name),
                     escape_markup(value),
                     note.empty() ? "" : fmt::format("<br>{}", escape_markup(note)));
}

// Mean of the first or last twenty amplitudes, with the standard error of that mean.
std::pair<double, double> amplitude_at(const std::vector<Beat>& beats, bool end) {
  constexpr std::size_t taken = 20;
  double sum = 0.0, sum2 = 0.0, count = 0.0;
  for (std::size_t i = 0; i < beats.size() && count < static_cast<double>(taken); ++i) {
    const double amplitude = beats[end ? beats.size() - 1 - i : i].amplitude_rad;
    if (!std::isfinite(amplitude)) continue;
    sum += amplitude;
    sum2 += amplitude * amplitude;
    ++count;
  }
  if (count == 0.0) return {unknown, unknown};
  const double mean = sum / count;
  if (count < 2.0) return {mean, unknown};
  const double variance = std::max(0.0, sum2 - count * mean * mean) / (count - 1.0);
  return {mean, std::sqrt(variance / count)};
}

std::string per_day(double rate_excess, double sigma) {
  return measured(seconds_gained_per_day(rate_excess), seconds_gained_per_day(sigma), 5) + " s/day";
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
      duration_text(relaxation.window_s),
      relaxation.exponential ? "; one exponential is enough" : "; not a single exponential");
  if (relaxation.shorter_window_s > 0.0 && relaxation.longer_window_s > 0.0)
    text += fmt::format("; {} s from a stretch ¾ and {} s from one 1¼ as long",
                        plain_number(relaxation.shorter_window_s, 4),
                        plain_number(relaxation.longer_window_s, 4));
  return text;
}

std::string rate_change(const Change& change) {
  const double after_less_before = change.rate_after - change.rate_before;
  if (!std::isfinite(after_less_before)) return "–";
  return measured(
      seconds_gained_per_day(after_less_before),
      seconds_gained_per_day(std::hypot(change.rate_before_sigma, change.rate_after_sigma)));
}

std::string change_table(const Diary& diary) {
  Table table("Changes", {"no.", "cycle", "after the first beat", "what changed",
                          "mean rate after it less that before, s/day",
                          "change of amplitude's slope, mrad/h", "significance"});
  for (std::size_t i = 0; i < diary.changes.size(); ++i) {
    const Change& change = diary.changes[i];
    table.row({fmt::format("{}", i + 1), fmt::format("{}", change.cycle),
               duration_text(change.at_s),
               change.kind == ChangeKind::unclear ? "–" : std::string(name_of(change.kind)),
               rate_change(change),
               std::isfinite(change.amplitude_slope_change)
                   ? plain_number(3.6e6 * change.amplitude_slope_change)
                   : "–",
               plain_number(change.significance, 2)});
  }
  return table.html();
}

std::string interruption_table(const Interruption& event, std::size_t number) {
  Table table(fmt::format("Interruption {} of the drive", number), {"what", "value"});
  table.row(
      {"from", fmt::format("{} (cycle {})", duration_text(event.begin.at_s), event.begin.cycle)});
  table.row({"to", fmt::format("{} (cycle {})", duration_text(event.end.at_s), event.end.cycle)});
  table.row({"lasted", duration_text(event.end.at_s - event.begin.at_s)});
  table.row({"change of rate meanwhile",
             plain_number(seconds_gained_per_day(event.rate_change)) + " s/day"});
  if (std::isfinite(event.amplitude_before_rad) && std::isfinite(event.amplitude_after_rad))
    table.row({"amplitude before and at the end",
               fmt::format("{} and {} mrad", plain_number(1e3 * event.amplitude_before_rad, 4),
                           plain_number(1e3 * event.amplitude_after_rad, 4))});
  if (event.decay)
    table.row({"decay of the amplitude, time constant", relaxation_text(*event.decay)});
  if (event.recovery)
    table.row({"recovery after it, time constant", relaxation_text(*event.recovery)});
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

std::string issue_table(const std::vector<LineIssue>& issues) {
  if (issues.empty()) return paragraph("Every line of the log could be used.");
  constexpr std::size_t most = 20;
  constexpr std::size_t bytes = 120; // of a faulty line
  Table table("Lines with something wrong", {"line", "column", "found", "what was done"});
  for (std::size_t i = 0; i < std::min(most, issues.size()); ++i)
    table.row({fmt::format("{}", issues[i].line),
               issues[i].column > 0 ? fmt::format("{}", issues[i].column) : "–",
               shortened(issues[i].found, bytes), shortened(issues[i].action, bytes)});
  return table.html() + and_more(issues.size(), most);
}

std::string gap_table(const std::vector<Gap>& gaps) {
  constexpr std::size_t most = 50;
  Table table("Gaps over which the beats could not be counted",
              {"after cycle", "best guess of cycles missing", "probability of that guess"});
  std::size_t unbridged = 0;
  for (const Gap& gap : gaps) {
    if (gap.bridged || ++unbridged > most) continue;
    table.row({fmt::format("{}", gap.after_cycle), fmt::format("{}", gap.length),
               plain_number(gap.probability, 2)});
  }
  if (unbridged == 0)
    return paragraph("No gap had to be left open: the count of beats holds throughout.");
  return table.html() + and_more(unbridged, most);
}

} // namespace

std::string duration_text(double seconds) {
  if (!std::isfinite(seconds)) return "not known";
  if (std::abs(seconds) < 600.0) return plain_number(seconds, 4) + " s";
  if (std::abs(seconds) < 2.0 * 3600.0) return plain_number(seconds / 60.0, 4) + " min";
  if (std::abs(seconds) < 2.0 * seconds_per_day) return plain_number(seconds / 3600.0, 4) + " h";
  return plain_number(seconds / seconds_per_day, 4) + " days";
}

std::string key_figures(const Analysis& data) {
  const RateSummary& rate = data.rate;
  std::string cards;
  if (rate.nominal_is_known) {
    cards += card("Rate, end to end", per_day(rate.rate_excess, rate.rate_excess_sigma),
                  "time gained from the first beat to the last, over the time between: what "
                  "the hands show");
    cards += card("Rate, straight line",
                  plain_number(seconds_gained_per_day(rate.slope_rate_excess), 4) + " s/day",
                  "slope of a line fitted to the clock's error");
  } else {
    cards +=
        card("Rate", "not known", "no nominal period is known to hold the mean period against");
  }
  cards += card("Mean period", measured(rate.mean_period_s, rate.mean_period_sigma_s, 12) + " s",
                rate.nominal_is_known
                    ? fmt::format("against {} s", plain_number(rate.nominal_period_s, 12))
                    : std::string("from the first beat to the last"));
  const auto [start, start_sigma] = amplitude_at(data.beats, false);
  const auto [end, end_sigma] = amplitude_at(data.beats, true);
  if (std::isfinite(start)) {
    cards += card("Amplitude at the start", measured(1e3 * start, 1e3 * start_sigma, 4) + " mrad",
                  "mean of the first twenty");
    cards += card("Amplitude at the end", measured(1e3 * end, 1e3 * end_sigma, 4) + " mrad",
                  "mean of the last twenty");
  }
  cards += card("Beats", fmt::format("{} over {}", rate.crossings, duration_text(rate.duration_s)),
                counts(data));
  return section("key-figures", "Key figures", "<dl class=\"cards\">\n" + cards + "</dl>\n");
}

std::string diary(const Analysis& data) {
  if (data.diary.changes.empty() && data.diary.interruptions.empty())
    return section("diary", "Diary",
                   paragraph("No sudden change of rate or amplitude stands out."));
  std::string body;
  if (!data.diary.changes.empty()) body += change_table(data.diary);
  for (std::size_t i = 0; i < data.diary.interruptions.size(); ++i)
    body += interruption_table(data.diary.interruptions[i], i + 1);
  return section("diary", "Diary", body);
}

std::string stability(const Analysis& data) {
  const bool overlapping = data.deviation.kind == DeviationKind::oadev;
  Table table(overlapping ? "Overlapping Allan deviation" : "Allan deviation",
              {"τ", "τ, s", "differences", "deviation", "68 % interval", "s/day", "noise"});
  for (const DeviationRow& row : data.deviation.rows)
    table.row({duration_text(row.tau_s), plain_number(row.tau_s, 6), fmt::format("{}", row.n),
               plain_number(row.value, 4),
               row.interval ? plain_number(row.low) + " to " + plain_number(row.high) : "–",
               plain_number(seconds_gained_per_day(row.value)),
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
  body += issue_table(data.log.issues) + gap_table(data.numbered.gaps);
  return section("reading", "How the log was read", body);
}

} // namespace goingrate::page
