// The report in words, for somebody who keeps a clock.
#include "goingrate/report/report.hpp"

#include "base/printable.hpp"
#include "base/scaled_time.hpp"
#include "goingrate/report/tables.hpp"

#include "fault_counts.hpp"
#include "rms_words.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

std::string span_of(double seconds) {
  if (seconds < 600.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 2.0 * 3600.0) return fmt::format("{:.3g} min", seconds / 60.0);
  if (seconds < 2.0 * seconds_per_day) return fmt::format("{:.3g} h", seconds / 3600.0);
  return fmt::format("{:.3g} days", seconds / seconds_per_day);
}

std::string ppm(double rate) { return fmt::format("{:+.3g} ppm", rate * 1e6); }

// Rates of good clocks are milliseconds a day.
std::string per_day(double rate_excess, double sigma) {
  const double rate = seconds_gained_per_day(rate_excess);
  const double error = seconds_gained_per_day(sigma);
  if (std::abs(rate) < 1.0) return with_sigma(1e3 * rate, 1e3 * error, 4) + " ms/day";
  return with_sigma(rate, error, 5) + " s/day";
}

std::string plain_rate(double rate_excess) {
  const double rate = seconds_gained_per_day(rate_excess);
  return std::abs(rate) < 1.0 ? fmt::format("{:+.2f} ms/day", 1e3 * rate)
                              : fmt::format("{:+.4f} s/day", rate);
}

std::string beats_line(const Analysis& data) {
  std::string line = fmt::format("Beats: {} over {}; {}", data.rate.crossings,
                                 span_of(data.rate.duration_s), fault_counts(data.numbered));
  if (data.numbered.segments > 1)
    line +=
        fmt::format("; the log is in {} pieces, the longest is analysed", data.numbered.segments);
  return line + ".\n";
}

std::string rate_lines(const Analysis& data) {
  const RateSummary& rate = data.rate;
  const std::string mean = with_sigma(rate.mean_period_s, rate.mean_period_sigma_s, 12);
  if (!rate.nominal_is_known)
    return fmt::format("Rate: not known, for no nominal period is known. Mean period {} s.\n",
                       mean);
  std::string text = fmt::format("Rate: {} {}, from the first beat to the last.\n",
                                 rate.rate_excess < 0.0 ? "loses" : "gains",
                                 per_day(std::abs(rate.rate_excess), rate.rate_excess_sigma));
  text += fmt::format("  That is {}, what the hands show; a line through the clock's error, which "
                      "leans on the middle of the log, gives {}.\n",
                      plain_rate(rate.rate_excess), plain_rate(rate.slope_rate_excess));
  text += fmt::format("  Mean period {} s against {} s.\n", mean, rate.nominal_period_s);
  return text;
}

std::string nut_line(const NutTurns& nut, bool has_changed) {
  return fmt::format("  Rating nut: {} the bob by {} turns ({:.3g} mm) to bring the rate{} to "
                     "zero.\n",
                     nut.turns < 0.0 ? "lower" : "raise",
                     with_sigma(std::abs(nut.turns), nut.sigma, 3), 1e3 * std::abs(nut.raise_m),
                     has_changed ? " since the last change" : "");
}

std::string amplitude_line(const Analysis& data) {
  double least = INFINITY, most = -INFINITY, sum = 0.0;
  double count = 0.0;
  for (const Beat& beat : data.beats) {
    if (std::isnan(beat.amplitude_rad)) continue;
    least = std::min(least, beat.amplitude_rad);
    most = std::max(most, beat.amplitude_rad);
    sum += beat.amplitude_rad;
    ++count;
  }
  if (count == 0.0) return {};
  return fmt::format("Amplitude: {:.2f} mrad on average, between {:.2f} and {:.2f}.\n",
                     1e3 * sum / count, 1e3 * least, 1e3 * most);
}

std::string recovery_lines(const Relaxation& recovery) {
  std::string text =
      fmt::format("    Then it recovered with a time constant of {} s (first {:.0f} s",
                  with_sigma(recovery.time_constant_s, recovery.sigma_s), recovery.window_s);
  if (std::isfinite(recovery.shorter_window_s + recovery.longer_window_s))
    text += fmt::format(
        ";\n    {:.0f} s from three quarters of that stretch, {:.0f} s from five quarters",
        recovery.shorter_window_s, recovery.longer_window_s);
  text += ").\n";
  if (!recovery.exponential)
    text += "    The time depends on the stretch: no single exponential. The drive came back "
            "unevenly.\n";
  return text;
}

std::string interruption_lines(const Interruption& event) {
  std::string text = fmt::format("  {:.0f} to {:.0f} s: the drive was interrupted. The rate "
                                 "changed by {} at once and came back; "
                                 "the amplitude fell from {:.2f} to {:.2f} mrad",
                                 event.begin.at_s, event.end.at_s, ppm(event.rate_change),
                                 1e3 * event.amplitude_before_rad, 1e3 * event.amplitude_after_rad);
  if (event.decay)
    text += fmt::format(", a free decay with a time constant of {} s",
                        with_sigma(event.decay->time_constant_s, event.decay->sigma_s));
  text += ".\n";
  if (!event.recovery) return text;
  text += recovery_lines(*event.recovery);
  if (event.decay)
    text += fmt::format("    Theory asks for half the decay time, {:.0f} s.\n",
                        0.5 * event.decay->time_constant_s);
  return text;
}

bool part_of_interruption(const Diary& diary, const Change& change) {
  return std::any_of(diary.interruptions.begin(), diary.interruptions.end(),
                     [&](const Interruption& i) {
                       return change.at_s >= i.begin.at_s && change.at_s <= i.end.at_s;
                     });
}

std::string_view words_for(ChangeKind kind) {
  switch (kind) {
  case ChangeKind::regulation:
    return "the regulation changed (nut, weight or length)";
  case ChangeKind::drive:
    return "the drive changed";
  case ChangeKind::friction:
    return "the friction changed";
  case ChangeKind::unclear:
    break;
  }
  return "the going changed";
}

std::string jump_of(const Change& change) {
  return fmt::format("{}{} ppm", change.rate_change > 0.0 ? "+" : "",
                     with_sigma(1e6 * change.rate_change, 1e6 * change.rate_change_sigma, 3));
}

// What it was, and the rate from the change before to this one, and from here to the next.
std::string change_lines(const Change& change, bool nominal_is_known) {
  std::string text =
      fmt::format("  {:.0f} s ({}): {}", change.at_s, span_of(change.at_s), words_for(change.kind));
  text += change.kind == ChangeKind::friction
              ? std::string(", and the rate with the amplitude")
              : fmt::format(", the rate by {} at {}", jump_of(change),
                            change.kind == ChangeKind::regulation ? "once" : "first");
  if (nominal_is_known && std::isfinite(change.rate_before + change.rate_after))
    text += fmt::format(". Rate before {}, after {}",
                        per_day(change.rate_before, change.rate_before_sigma),
                        per_day(change.rate_after, change.rate_after_sigma));
  return text + ".\n";
}

std::string diary_lines(const Analysis& data) {
  const Diary& diary = data.diary;
  if (diary.changes.empty()) return "Diary: no sudden change of rate or amplitude.\n";
  std::string text = "Diary (seconds after the first beat):\n";
  for (const Interruption& event : diary.interruptions)
    text += interruption_lines(event);
  constexpr int most = 4; // the page has them all
  int told = 0;
  for (const Change& change : diary.changes) {
    if (part_of_interruption(diary, change) || told++ >= most) continue;
    text += change_lines(change, data.rate.nominal_is_known);
  }
  return text;
}

// The friction of the fit against that of a free decay in the diary.
std::string disagreement(const FitSummary& fit, const Diary& diary) {
  for (const Interruption& event : diary.interruptions) {
    if (!event.decay || !std::isfinite(fit.decay_time.value)) continue;
    const double apart = fit.decay_time.value - event.decay->time_constant_s;
    const double sigma = std::hypot(fit.decay_time.sigma, event.decay->sigma_s);
    if (std::abs(apart) > 2.0 * sigma)
      return fmt::format(
          "  Its decay time {} s disagrees with the free decay above: trust that one.\n",
          with_sigma(fit.decay_time.value, fit.decay_time.sigma));
  }
  return {};
}

std::string fit_lines(const FitSummary& fit, const Diary& diary) {
  if (!fit.has_result()) return "Fit: no result (" + fit.termination + ").\n";
  std::string known, unknown;
  std::size_t longest = 8;
  for (const FittedParameter& p : fit.parameters)
    longest = std::max(longest, p.name.size());
  for (const FittedParameter& p : fit.parameters) {
    if (p.status == ParameterStatus::undetermined)
      unknown += (unknown.empty() ? "" : ", ") + p.name;
    else if (p.status != ParameterStatus::fixed)
      known +=
          fmt::format("  {:<{}} {} {}\n", p.name, longest, with_sigma(p.value, p.sigma), p.unit);
  }
  std::string text = fmt::format("Fit of the pendulum model ({}, escapement {}):\n",
                                 name_of(fit.dynamics), name_of(fit.model.escapement));
  text += known;
  if (std::isfinite(fit.q_factor.value))
    text += fmt::format("  {:<{}} {}\n", "Q", longest,
                        with_sigma(fit.q_factor.value, fit.q_factor.sigma));
  if (fit.decay) text += "  " + decay_sentences(*fit.decay) + "\n";
  if (!unknown.empty()) text += fmt::format("  not determined by this log: {}\n", unknown);
  text += disagreement(fit, diary);
  if (fit.quality.whiteness_p < 1e-3)
    text += "  The residuals are not white: this clock does more than the model knows. Sigmas are "
            "widened for it; read the values as rough.\n";
  return text;
}

bool sees_amplitude(const Analysis& data) {
  return std::any_of(data.beats.begin(), data.beats.end(),
                     [](const Beat& beat) { return std::isfinite(beat.amplitude_rad); });
}

std::string drive_lines(const Analysis& data) {
  if (data.drive.swings_freely) return {};
  if (!data.drive.split)
    return fmt::format("Drive: not split into fast and slow, since the log does not determine the "
                       "clock's response. What would tell: {}a ring-down, or a change of the "
                       "driving weight.\n",
                       sees_amplitude(data) ? "" : "amplitudes, ");
  const auto number = [](double value) { return fmt::format("{:.2g}", value); };
  const auto part = [&](const RmsEstimate& rms) { return rms_words(rms, 100.0, "%", number); };
  std::string text = fmt::format("Drive: fast {}, slow {} (rms).\n", part(data.drive.split->fast),
                                 part(data.drive.split->slow));
  constexpr double week_s = 7.0 * 86400.0;
  for (const DriveCost& week : data.drive.split->costs) {
    if (week.after_s != week_s) continue;
    const auto cost = [&](const RmsEstimate& rms) {
      return rms.low68 > 0.0 ? number(rms.rms) + " s" : rms_words(rms, 1.0, "s", number);
    };
    text += fmt::format("  What they cost in a week: {} and {} (rms).\n", cost(week.fast_s),
                        cost(week.slow_s));
  }
  if (!data.drive.split->note.empty()) text += "  " + data.drive.split->note + ".\n";
  return text;
}

std::string covariate_lines(const CovariateEffect& effect) {
  std::string name = effect.name;
  name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
  if (!effect.significant())
    return fmt::format("{}: the rate does not answer to it beyond the noise.\n", name);
  return fmt::format(
      "{}: {:.3g} +- {:.2g} s/day per {}. Compensating would have {} the time error\n"
      "  of the half of the log that was not used to find it, {:.3g} s to {:.3g} s.\n",
      name, seconds_per_day * effect.coefficient, seconds_per_day * effect.sigma,
      effect.unit.substr(effect.unit.find('/') + 1), effect.helps() ? "lowered" : "raised",
      effect.without_s, effect.with_s);
}

// The two strongest; facts of the numbering have lines of their own.
std::string suspicion_lines(const Analysis& data) {
  const bool told = !data.diary.changes.empty() || !data.diary.interruptions.empty();
  if (data.suspicions.empty())
    return data.beats.size() < 2000 ? ""
                                    : fmt::format("Nothing {}is wrong that this log would show.\n",
                                                  told ? "beside what the diary tells " : "");
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(2, data.suspicions.size()); ++i) {
    const Suspicion& s = data.suspicions[i];
    text += fmt::format("{} cause: {}:\n  {}.\n", i == 0 ? "Most likely" : "Next likely",
                        name_of(s.cause), s.evidence);
    std::vector<std::string_view> others;
    for (const Cause other : s.alternatives)
      others.push_back(name_of(other));
    if (!others.empty())
      text += fmt::format("  This log cannot tell it from: {}.\n", fmt::join(others, ", "));
    if (!s.advice.empty())
      text += fmt::format("  Consider: {}{}\n", s.advice, s.advice.ends_with('?') ? "" : ".");
  }
  return text;
}

std::string stability_line(DeviationTable table) {
  std::erase_if(table.rows, [](const DeviationRow& row) { return !std::isfinite(row.value); });
  if (table.rows.empty()) return {};
  // The longest times rest on one or two differences; four spans of the log are the least to speak
  // of.
  const auto last = std::find_if(table.rows.begin() + 1, table.rows.end(),
                                 [](const DeviationRow& row) { return row.n < 2 * row.m; });
  const auto best = std::min_element(
      table.rows.begin(), last, [](const auto& a, const auto& b) { return a.value < b.value; });
  std::string text = fmt::format("Stability (OADEV): {:.3g} over {}", table.rows.front().value,
                                 span_of(table.rows.front().tau_s));
  text += fmt::format(", best {:.3g} over {}.\n", best->value, span_of(best->tau_s));
  if (best + 1 < last && best->tau_s < 0.3 * std::prev(last)->tau_s)
    text += fmt::format("  Averaging helps up to {}; beyond, slow causes rule: look for those.\n",
                        span_of(best->tau_s));
  return text;
}

} // namespace

std::string report_text(const Analysis& data) {
  std::string text = fmt::format("{}\n", printable(data.log.source));
  text += beats_line(data);
  text += rate_lines(data);
  if (data.nut) text += nut_line(*data.nut, data.stretches.size() > 1);
  text += amplitude_line(data);
  text += diary_lines(data);
  text += fit_lines(data.fit, data.diary);
  text += drive_lines(data);
  text += suspicion_lines(data);
  for (const CovariateEffect& effect : data.covariates)
    text += covariate_lines(effect);
  text += stability_line(data.deviation);
  constexpr std::size_t terminal = 80;
  return wrapped(text, terminal, 2);
}

} // namespace goingrate
