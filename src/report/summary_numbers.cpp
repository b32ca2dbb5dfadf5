// The table of numbers of a summary.
#include "goingrate/report/report.hpp"

#include "fault_counts.hpp"
#include "listed_clocks.hpp"
#include "logbook_words.hpp"
#include "mean_amplitude.hpp"
#include "parameter_words.hpp"
#include "rms_words.hpp"
#include "wording.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

namespace goingrate {

namespace {

bool is_noise_of_drive(std::string_view name) {
  return name == "drive_rms" || name == "slow_rms" || name == "slow_time";
}

// The friction to which Q belongs: that after the last change of it.
const FittedParameter* last_friction(const FitSummary& fit) {
  const FittedParameter* last = nullptr;
  for (const FittedParameter& p : fit.parameters)
    if (p.name == "epsilon" || p.name.starts_with("epsilon@")) last = &p;
  return last;
}

std::string number(double value) { return with_sigma(value, 0.0, 3); }

/// Gathers the rows for one log.
class Numbers {
public:
  explicit Numbers(const Analysis& data) : data_(data), words_(data) {}

  std::vector<SummaryNumber> all() {
    add_going();
    add_amplitudes();
    add_fit();
    add_drive();
    for (const CovariateEffect& effect : data_.covariates)
      add_covariate(effect);
    add_isochronism();
    add_deviation();
    return std::move(rows_);
  }

private:
  void add(std::string quantity, std::string value) {
    rows_.push_back({std::move(quantity), std::move(value)});
  }

  void add_going();
  void add_stretches();
  void add_logbook();
  [[nodiscard]] double cut_at(double begin_s) const;
  void add_amplitudes();
  void add_fit();
  void add_drive();
  void add_mean_period();
  void add_covariate(const CovariateEffect& effect);
  void add_isochronism();
  void add_deviation();
  [[nodiscard]] std::string value_of(const FittedParameter& parameter) const;
  [[nodiscard]] std::string name_of_parameter(const FittedParameter& parameter) const;
  [[nodiscard]] std::string name_of_q(const FittedParameter* friction) const;
  [[nodiscard]] std::string deviation(const DeviationRow& row) const;

  const Analysis& data_;
  Wording words_;
  std::vector<SummaryNumber> rows_;
};

void Numbers::add_going() {
  const RateSummary& rate = data_.rate;
  const bool no_period = has_no_period(data_.log);
  add(event_word(no_period, rate.nominal_period_s) + " in " + words_.duration(rate.duration_s),
      fmt::format("{}; {}", rate.crossings, fault_counts(data_.numbered)));
  if (data_.numbered.segments > 1)
    add("parts that could not be joined",
        fmt::format("{}, the longest is analysed", data_.numbered.segments));
  if (!no_period) add_mean_period();
  if (swings_freely(data_)) return;
  if (const auto& error = data_.sensor.beat_error_s)
    add("beat error, tick − tock", short_time(std::abs(error->value), error->sigma));
  if (!rate.nominal_is_known) return;
  add(fmt::format("rate over the whole {}, end to end",
                  data_.numbered.segments > 1 ? "part" : "log"),
      words_.rate(rate.rate_excess, rate.rate_excess_sigma));
  add_stretches();
  add_logbook();
}

void Numbers::add_mean_period() {
  const RateSummary& rate = data_.rate;
  const std::string mean = with_sigma(rate.mean_period_s, rate.mean_period_sigma_s, 12) + " s";
  add(rate.nominal_is_known ? fmt::format("mean period, against {:.9g} s", rate.nominal_period_s)
                            : "mean period",
      mean);
}

// What was planned, compared with what the log shows.
void Numbers::add_logbook() {
  if (!data_.logbook) return;
  for (const EntryFinding& finding : data_.logbook->entries) {
    const LogbookEntry& entry = finding.entry;
    const std::string planned = value_in_words(entry.what, entry.value, entry.sigma, words_);
    const std::string found =
        value_in_words(entry.what, finding.found, finding.found_sigma, words_);
    if (planned.empty() && found.empty()) continue;
    add(fmt::format("  {} noted for {}", in_words(entry.what), words_.short_moment(finding.at_s)),
        fmt::format("{}{}", planned.empty() ? "" : planned + " planned, ",
                    found.empty() ? std::string(name_of(finding.verdict)) : found + " found"));
  }
}

// The change at which a stretch begins; the stretch begins with the beat after the change.
double Numbers::cut_at(double begin_s) const {
  const auto& changes = data_.diary.changes;
  const auto nearest =
      std::min_element(changes.begin(), changes.end(), [&](const Change& a, const Change& b) {
        return std::abs(a.at_s - begin_s) < std::abs(b.at_s - begin_s);
      });
  return nearest == changes.end() ? begin_s : nearest->at_s;
}

void Numbers::add_stretches() {
  const auto& stretches = data_.stretches;
  const Instant first = data_.beats.front().time;
  for (std::size_t i = 0; i < stretches.size() && stretches.size() > 1; ++i) {
    const PartRate& part = stretches[i];
    const double from_s = i > 0 ? cut_at(part.start - first) : 0.0;
    const double to_s = i + 1 < stretches.size() ? cut_at(stretches[i + 1].start - first) : 0.0;
    const std::string name =
        i == 0 ? "  until " + words_.short_moment(to_s)
        : i + 1 < stretches.size()
            ? fmt::format("  from {} to {}", words_.short_moment(from_s), words_.short_moment(to_s))
            : "  from " + words_.short_moment(from_s) + " on";
    add(name, words_.rate(part.rate.rate_excess, part.rate.rate_excess_sigma));
  }
  const PartRate& now = data_.now;
  if (!stretches.empty() && now.from_cycle > stretches.back().from_cycle)
    add(fmt::format("  in the last {}", words_.duration(now.rate.duration_s)),
        words_.rate(now.rate.rate_excess, now.rate.rate_excess_sigma));
}

void Numbers::add_amplitudes() {
  for (const bool end : {false, true}) {
    const MeanAmplitude mean = amplitude_at(data_.beats, end);
    if (std::isfinite(mean.rad))
      add(fmt::format("amplitude, mean of the {} {} beats", end ? "last" : "first", mean.beats),
          words_.angle(mean.rad, mean.sigma_rad));
  }
  for (const Interruption& event : data_.diary.interruptions) {
    if (event.decay)
      add("free decay while interrupted, time constant",
          with_sigma(event.decay->time_constant_s, event.decay->sigma_s) + " s");
    if (event.recovery)
      add(event.recovery->exponential ? "recovery, time constant"
                                      : "recovery (no single exponential), about",
          with_sigma(event.recovery->time_constant_s, event.recovery->sigma_s) + " s");
  }
}

std::string Numbers::name_of_parameter(const FittedParameter& parameter) const {
  const std::string& name = parameter.name;
  const bool is_heard = name == "offset" && data_.log.sound;
  const std::string_view meaning =
      is_heard ? "angle from the vertical at which the clock ticks" : meaning_of(name);
  const std::size_t at = name.find('@');
  std::string text(meaning.empty() ? std::string_view(name) : meaning);
  constexpr double wide_rad = 0.2; // from here on the speed differs from the angle by 0.2 %
  if (name == "lambda0" && parameter.value > wide_rad) text += ", as the speed 2 sin(angle/2)";
  const std::string base = name.substr(0, at);
  if (has_symbol(base)) text += fmt::format(" {}", symbol_of(base));
  if (at == std::string::npos) return text;
  const auto event = static_cast<std::size_t>(std::stoi(name.substr(at + 1)));
  if (event == 0 || event > data_.fit.events.size()) return text;
  const std::int64_t cycle = data_.beats.front().cycle + data_.fit.events[event - 1].cycle;
  const auto beat = std::find_if(data_.beats.begin(), data_.beats.end(),
                                 [&](const Beat& b) { return b.cycle >= cycle; });
  if (beat == data_.beats.end()) return text;
  return fmt::format("{} from {} on", text,
                     words_.short_moment(beat->time - data_.beats.front().time));
}

std::string Numbers::value_of(const FittedParameter& p) const {
  const double sigma = p.status == ParameterStatus::fixed ? 0.0 : p.sigma;
  if (p.unit == "rad") return words_.angle(p.value, sigma);
  const FittedParameter shown = in_shown_unit(words_.angle_unit(), p);
  return with_sigma(shown.value, p.status == ParameterStatus::fixed ? 0.0 : shown.sigma) +
         (shown.unit.empty() ? "" : " " + shown.unit);
}

// `friction` is not used for the Q of a free swing, which no law of friction is assumed for.
std::string Numbers::name_of_q(const FittedParameter* friction) const {
  const FitSummary& fit = data_.fit;
  if (fit.decay)
    return fmt::format("quality factor Q at {}, whichever law of friction",
                       words_.angle(fit.decay->amplitude_rad, 0.0));
  if (fit.model.friction() != "linear") return "quality factor Q " + fit.q_factor.expression;
  if (friction == fit.find("epsilon")) return "quality factor of that friction, Q = 1/2ε";
  return fmt::format("quality factor Q = 1/2ε of the {}", name_of_parameter(*friction));
}

void Numbers::add_fit() {
  const FitSummary& fit = data_.fit;
  if (!fit.has_result()) return;
  for (const FittedParameter& p : fit.parameters) {
    const bool is_open =
        p.status == ParameterStatus::free && !(std::isfinite(p.low95) && std::isfinite(p.high95));
    if (is_open) continue;    // a ± would mislead
    const bool is_covariate = // has a row of its own, in s/day
        std::any_of(data_.covariates.begin(), data_.covariates.end(),
                    [&](const CovariateEffect& effect) { return effect.name == p.name; });
    const bool told = is_covariate || (data_.drive.split && is_noise_of_drive(p.name));
    if (told || p.status == ParameterStatus::undetermined || !std::isfinite(p.value)) continue;
    const std::string_view known = p.status == ParameterStatus::fixed ? ", given"
                                   : p.status == ParameterStatus::prior
                                       ? ", from the log and what was known before"
                                       : "";
    add(name_of_parameter(p), value_of(p).append(known));
  }
  for (const ListedClock& clock : listed_clocks(fit, words_.angle_unit()))
    add(clock.odds.empty() ? "a clock that explains this log" : "  another, " + clock.odds,
        clock.parameters);
  const FittedParameter* friction = last_friction(fit);
  const bool knows_friction = friction != nullptr && std::isfinite(friction->value);
  if ((fit.decay || knows_friction) && std::isfinite(fit.q_factor.value))
    add(name_of_q(friction), with_sigma(fit.q_factor.value, fit.q_factor.sigma));
  if (fit.decay && std::isfinite(fit.decay_time.value))
    add("  decay time there",
        with_sigma(fit.decay_time.value, fit.decay_time.sigma) + " s");
}

void Numbers::add_drive() {
  if (!data_.drive.split) return;
  const DriveSplit& split = *data_.drive.split;
  add("fast variation of the drive, rms", rms_words(split.fast, 100.0, "%", number));
  add("slow variation of the drive, rms", rms_words(split.slow, 100.0, "%", number));
  constexpr double week_s = 7.0 * seconds_per_day;
  const auto cost = [](const RmsEstimate& rms) {
    return rms.low68 > 0.0 ? number(rms.rms) + " s" : rms_words(rms, 1.0, "s", number);
  };
  for (const DriveCost& week : split.costs)
    if (week.after_s == week_s)
      add("  time error of the two in a week, rms",
          fmt::format("{} and {}", cost(week.fast_s), cost(week.slow_s)));
}

void Numbers::add_covariate(const CovariateEffect& effect) {
  if (effect.name == "tide")
    return add("response to Moon and Sun, share of the theoretical",
               with_sigma(effect.coefficient, effect.sigma, 3));
  const std::string per = unit_of_covariate(effect);
  add(fmt::format("rate per {} of {}", per, effect.name),
      words_.rate(effect.coefficient, effect.sigma) + "/" + per);
  const FittedParameter* fitted = data_.fit.find(effect.name);
  if (fitted != nullptr && fitted->status == ParameterStatus::free)
    add("  by the fitted pendulum, at its amplitude",
        words_.rate(fitted->value, fitted->sigma) + "/" + per);
  if (!effect.significant()) return;
  for (const EffectPart& part : effect.parts)
    add(fmt::format("  {}", words_of(part.way)),
        words_.rate(part.coefficient, part.sigma) + "/" + per);
  if (effect.part(EffectWay::at_once) != nullptr)
    add("  the rest follows with a lag of", fmt::format("{} s", number(effect.lag_s)));
  add(fmt::format("  time error, rms, with {} left in", effect.name),
      number(effect.without_s) + " s");
  add("    subtracted, by the result of the other half", number(effect.with_s) + " s");
}

void Numbers::add_isochronism() {
  if (!data_.isochronism) return;
  const Isochronism& found = *data_.isochronism;
  const std::string_view unit = words_.angle_unit().name;
  const double per = 1.0 / words_.angle_unit().factor;
  add(fmt::format("rate per {} of amplitude, near {}", unit,
                  words_.angle(found.amplitude_rad, 0.0)),
      fmt::format("{}/{}", words_.rate(per * found.slope, per * found.sigma), unit));
  if (found.fitted_slope)
    add("  of the fitted pendulum, all else steady",
        fmt::format("{:+.3g} {}/{}", words_.rate_unit().factor * per * *found.fitted_slope,
                    words_.rate_unit().name, unit));
}

std::string Numbers::deviation(const DeviationRow& row) const {
  const double sigma =
      row.interval ? 0.5 * (row.high - row.low) : std::numeric_limits<double>::quiet_NaN();
  const DisplayUnit& unit = words_.deviation_unit();
  return fmt::format("{} {}", with_sigma(unit.factor * row.value, unit.factor * sigma, 4),
                     unit.name);
}

// The longest averaging times rest on one or two differences, so the least deviation is looked for
// among times that fit into the log four times. The rate of a free swing changes with its
// amplitude, and a deviation would show only that.
void Numbers::add_deviation() {
  if (swings_freely(data_)) return;
  std::vector<DeviationRow> rows = data_.deviation.rows;
  std::erase_if(rows, [](const DeviationRow& row) { return !std::isfinite(row.value); });
  if (rows.empty()) return;
  const auto last = std::find_if(rows.begin() + 1, rows.end(),
                                 [](const DeviationRow& row) { return row.n < 2 * row.m; });
  const auto best = std::min_element(
      rows.begin(), last, [](const auto& a, const auto& b) { return a.value < b.value; });
  const auto name = [](const DeviationRow& row) {
    return fmt::format("Allan deviation over τ = {:.6g} s", row.tau_s);
  };
  add(name(rows.front()), deviation(rows.front()));
  if (best != rows.begin())
    add("  least, over τ = " + fmt::format("{:.6g} s", best->tau_s), deviation(*best));
}

} // namespace

std::vector<SummaryNumber> summary_numbers(const Analysis& data) { return Numbers(data).all(); }

} // namespace goingrate
