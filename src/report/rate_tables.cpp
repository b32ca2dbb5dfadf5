// The tables and the text of `goingrate rate`.
#include "goingrate/report/tables.hpp"

#include "fault_counts.hpp"

#include "base/decimal.hpp"
#include "base/readable.hpp"
#include "base/scaled_time.hpp"
#include "base/special_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace goingrate {

namespace {

constexpr std::int64_t rows_per_gap = 20; // a longer gap gets one row

// A number, or nothing if it is not known.
void append_number(DecimalText& line, double value, int digits) {
  line.put(',');
  if (!std::isnan(value)) append_general(line, value, digits);
}

struct NamedColumn {
  const char* name;
  const std::vector<double>* values;
  int digits; // fewer for a σ, whose last digits are rounding and differ between processors
};

std::array<NamedColumn, 5> named(const EventColumns& columns) {
  return {{{"sigma_s", &columns.sigma_s, 4},
           {"width_s", &columns.width_s, 9},
           {"temperature_c", &columns.temperature_c, 9},
           {"pressure_mbar", &columns.pressure_mbar, 9},
           {"humidity_percent", &columns.humidity_percent, 9}}};
}

} // namespace

RateTable::RateTable(const Options& options, const EventColumns& columns,
                     const std::vector<Gap>& gaps)
    : options_(options), columns_(&columns), gaps_(&gaps) {
  extras_ = (options.amplitudes ? 1U : 0U) + (options.running_cycles > 0 ? 1U : 0U);
  for (const NamedColumn& column : named(columns))
    extras_ += column.values->empty() ? 0 : 1;
}

void RateTable::go_on(const EventColumns& columns, const std::vector<Gap>& gaps) {
  columns_ = &columns;
  gaps_ = &gaps;
  gap_ = 0;
}

std::string RateTable::header() const {
  std::string text = "cycle,time_s,period_s,rate_excess,rate_s_per_day,amplitude_rad,flags";
  if (options_.amplitudes) text += ",rate_excess_at_zero_amplitude";
  if (options_.running_cycles > 0) text += ",running_rate_excess";
  for (const NamedColumn& column : named(*columns_))
    if (!column.values->empty()) text += fmt::format(",{}", column.name);
  return text + '\n';
}

void RateTable::append(std::string& text, const Beat& beat, std::size_t i) {
  DecimalText line;
  if (beat.flag == BeatFlag::good) {
    if (last_) append_missing(text, last_->cycle, beat.cycle);
    append_good(line, beat, i);
  } else {
    append_bad(line, beat, i);
  }
  line.put('\n');
  text += line.view();
}

void RateTable::append_bad(DecimalText& line, const Beat& beat, std::size_t i) {
  if (beat.flag == BeatFlag::down) {
    append_integer(line, beat.cycle);
    line.put(".5");
  }
  line.put(',');
  append_instant(line, beat.time, 9);
  line.put(",,,");
  append_number(line, beat.amplitude_rad, 9);
  line.put(',');
  line.put(name_of(beat.flag));
  append_extras(line, nullptr, not_known, i);
}

void RateTable::append_good(DecimalText& line, const Beat& beat, std::size_t i) {
  const bool follows = last_ && last_->segment == beat.segment;
  append_integer(line, beat.cycle);
  line.put(',');
  append_instant(line, beat.time, 9);
  line.put(',');
  const double rate = follows ? append_period(line, beat) : not_known;
  if (!follows) line.put(",,");
  append_number(line, beat.amplitude_rad, 9);
  line.put(',');
  if (last_ && !follows) line.put(is_step_after(last_->cycle) ? "step" : "split");
  append_extras(line, &beat, rate, i);
  last_ = beat;
}

// Writes the fields of the period since the last beat; returns its rate, which is not finite if
// both beats have the same time.
double RateTable::append_period(DecimalText& line, const Beat& beat) const {
  const double rate = rate_between(*last_, beat, options_.nominal_period_s);
  append_general(line, (beat.time - last_->time) / static_cast<double>(beat.cycle - last_->cycle),
                 12);
  line.put(',');
  if (std::isfinite(rate)) append_scientific(line, rate, 6);
  line.put(',');
  if (std::isfinite(rate)) append_fixed(line, seconds_gained_per_day(rate), 6);
  return rate;
}

void RateTable::append_extras(DecimalText& line, const Beat* beat, double rate, std::size_t i) {
  if (options_.amplitudes) {
    const bool known = beat != nullptr && !std::isnan(rate) && !std::isnan(beat->amplitude_rad);
    append_number(
        line,
        known ? rate_without_circular_error(rate, beat->amplitude_rad, options_.gravity_share)
              : not_known,
        7);
  }
  if (options_.running_cycles > 0)
    append_number(line, beat != nullptr ? running_rate(*beat) : not_known, 7);
  for (const NamedColumn& column : named(*columns_))
    if (!column.values->empty()) append_number(line, (*column.values)[i], column.digits);
}

// The rate up to this beat from the beat `running_cycles` ago, or from the last one before that.
double RateTable::running_rate(const Beat& beat) {
  if (!recent_.empty() && recent_.back().segment != beat.segment) recent_.clear();
  recent_.push_back(beat);
  while (recent_.size() > 1 && beat.cycle - recent_[1].cycle >= options_.running_cycles)
    recent_.pop_front();
  if (beat.cycle - recent_.front().cycle < options_.running_cycles) return not_known;
  return rate_between(recent_.front(), beat, options_.nominal_period_s);
}

void RateTable::append_missing(std::string& text, std::int64_t from, std::int64_t to) const {
  if (to - from == options_.step) return;
  const auto out = std::back_inserter(text);
  const std::string rest(extras_, ',');
  if (to - from - 1 > rows_per_gap) {
    fmt::format_to(out, "{},,,,,,gap of {}{}\n", from + 1, to - from - 1, rest);
    return;
  }
  for (std::int64_t cycle = from + 1; cycle < to; ++cycle)
    fmt::format_to(out, "{},,,,,,missed{}\n", cycle, rest);
}

// Gaps and beats are both in order of cycles.
bool RateTable::is_step_after(std::int64_t cycle) {
  while (gap_ < gaps_->size() && (*gaps_)[gap_].after_cycle < cycle)
    ++gap_;
  return gap_ < gaps_->size() && (*gaps_)[gap_].after_cycle == cycle &&
         (*gaps_)[gap_].kind == GapKind::step;
}

std::string rate_table(const Beats& beats, double nominal_period_s) {
  const EventColumns none;
  RateTable table({nominal_period_s, false, 0, beats.step}, none, beats.gaps);
  std::string text = table.header();
  for (std::size_t i = 0; i < beats.beats.size(); ++i)
    table.append(text, beats.beats[i], i);
  return text;
}

std::string block_table(const std::vector<PartRate>& blocks) {
  std::string text = "segment,from_cycle,to_cycle,time_s,duration_s,rate_excess,sigma,"
                     "rate_s_per_day,amplitude_rad\n";
  for (const PartRate& block : blocks) {
    DecimalText line;
    fmt::format_to(fmt::appender(line.characters()), "{},{},{},{},{:.9g},{:.7g}", block.segment,
                   block.from_cycle, block.to_cycle, format_instant(block.start, 9),
                   block.rate.duration_s, block.rate.rate_excess);
    append_number(line, block.rate.rate_excess_sigma, 3);
    append_number(line, seconds_gained_per_day(block.rate.rate_excess), 7);
    append_number(line, block.amplitude_rad, 9);
    line.put('\n');
    text += line.view();
  }
  return text;
}

namespace {

std::string rate_sentence(const RateSummary& summary, bool has_period) {
  const std::string mean = fmt::format(
      "mean period {} s", with_sigma(summary.mean_period_s, summary.mean_period_sigma_s, 12));
  if (!summary.nominal_is_known)
    return mean + "; what it gains or loses is not known, as no nominal period is";
  const double rate = seconds_gained_per_day(summary.rate_excess);
  const double sigma = seconds_gained_per_day(summary.rate_excess_sigma);
  return (has_period ? fmt::format("{} against {} s: ", mean, summary.nominal_period_s) : "") +
         fmt::format("{} {} s/day (end to end); a straight line fitted to the clock's error gives "
                     "{} s/day",
                     rate < 0 ? "losing" : "gaining", with_sigma(std::abs(rate), sigma),
                     readable_signed(seconds_gained_per_day(summary.slope_rate_excess), 4));
}

std::string part_rate_text(const PartRate& part, bool nominal_is_known) {
  if (!nominal_is_known)
    return fmt::format("mean period {} s",
                       with_sigma(part.rate.mean_period_s, part.rate.mean_period_sigma_s, 12));
  return with_sigma(seconds_gained_per_day(part.rate.rate_excess),
                    seconds_gained_per_day(part.rate.rate_excess_sigma)) +
         " s/day";
}

std::string segment_lines(const Beats& beats, const RateSummary& summary) {
  constexpr std::size_t most_rows = 6; // as an overview; --json has all
  auto segments = segment_rates(beats.beats, summary.nominal_period_s);
  for (PartRate& part : segments)
    add_time_base(part.rate, summary.time_base_sigma);
  std::string text;
  for (std::size_t i = 0; i < std::min(most_rows, segments.size()); ++i) {
    const PartRate& part = segments[i];
    text += fmt::format("  segment {}: cycles {} to {}, {} s, {}\n", part.segment, part.from_cycle,
                        part.to_cycle, readable(part.rate.duration_s, 6),
                        part_rate_text(part, summary.nominal_is_known));
  }
  if (segments.size() > most_rows)
    text += fmt::format("  and {} more\n", segments.size() - most_rows);
  return text;
}

std::string sensor_lines(const RateSummary& summary, const SensorFindings& sensor) {
  std::string text;
  if (const auto& error = sensor.beat_error_s; error && sensor.sides_are_unknown)
    text += fmt::format("beat error {} ms (half of it: {:.3g} ms), on either side\n",
                        with_sigma(1e3 * std::abs(error->value), 1e3 * error->sigma),
                        0.5e3 * std::abs(error->value));
  else if (error)
    text += fmt::format("beat error {} ms (half of it: {:.3g} ms), longer on the {}\n",
                        with_sigma(1e3 * std::abs(error->value), 1e3 * error->sigma),
                        0.5e3 * std::abs(error->value),
                        error->value > 0.0 ? "left (from down to up)" : "right (from up to down)");
  if (const auto& amplitude = sensor.amplitude) {
    text += fmt::format("amplitude {:.6g} mrad in the mean, each known to {:.2g} mrad",
                        1e3 * amplitude->mean_rad, 1e3 * amplitude->sigma_rad);
    if (summary.nominal_is_known)
      text += fmt::format("; without the circular error {:+.5g} s/day",
                          seconds_gained_per_day(rate_without_circular_error(
                              summary.rate_excess, amplitude->rms_rad, sensor.gravity_share)));
    text += '\n';
  }
  return text;
}

} // namespace

std::string rate_text(const Beats& beats, const RateSummary& summary, const SensorFindings& sensor,
                      bool has_period) {
  std::string text = fmt::format("{} {} over {} s; {}, {} segment{}\n", summary.crossings,
                                 event_word(!has_period, summary.nominal_period_s),
                                 readable(summary.duration_s, 6), fault_counts(beats),
                                 beats.segments, beats.segments == 1 ? "" : "s");
  if (beats.segments > 1) text += segment_lines(beats, summary);
  if (beats.rivals > 0)
    text += fmt::format("{} cycles have a second event that could as well be the crossing\n",
                        beats.rivals);
  if (beats.segments > 1 && beats.longest_countable_gap > 0)
    text += fmt::format("without a doubt about the count, only breaks of up to {} cycles can be "
                        "bridged in this log\n",
                        beats.longest_countable_gap);
  return text + sensor_lines(summary, sensor) + rate_sentence(summary, has_period);
}

} // namespace goingrate
