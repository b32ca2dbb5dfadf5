#include "goingrate/report/tables.hpp"

#include "goingrate/base/scaled_time.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace goingrate {

namespace {
constexpr std::int64_t rows_per_gap = 20; // a longer gap is told in one row
}

std::string with_sigma(double value, double sigma, int digits) {
  if (!(sigma > 0.0) || !std::isfinite(sigma)) return fmt::format("{:.{}g}", value, digits);
  const int first = static_cast<int>(std::floor(std::log10(sigma))); // place of sigma's first digit
  const double size = std::max(std::abs(value), sigma);
  const int top = static_cast<int>(std::floor(std::log10(size)));
  if (top < -3 || top > 6) { // in powers of ten, one exponent for both
    const double unit = std::pow(10.0, top);
    const int decimals = std::max(0, top - first + 1);
    return fmt::format("({:.{}f} +- {:.{}f})e{}", value / unit, decimals, sigma / unit, decimals,
                       top);
  }
  const int decimals = std::max(0, 1 - first);
  return fmt::format("{:.{}f} +- {:.{}f}", value, decimals, sigma, decimals);
}

namespace {

class RateTable {
public:
  RateTable(double nominal_period_s, const std::vector<Gap>& gaps)
      : nominal_period_s_(nominal_period_s), gap_(gaps.begin()), gaps_end_(gaps.end()) {}

  void add(const Beat& beat) {
    if (beat.flag == BeatFlag::good) return add_good(beat);
    const std::string cycle =
        beat.flag == BeatFlag::down ? fmt::format("{}.5", beat.cycle) : std::string();
    fmt::format_to(out_, "{},{},,,,,{}\n", cycle, format_instant(beat.time, 9), name_of(beat.flag));
  }

  std::string text = "cycle,time_s,period_s,rate_excess,rate_s_per_day,amplitude_rad,flags\n";

private:
  void add_good(const Beat& beat) {
    const bool follows = last_ != nullptr && last_->segment == beat.segment;
    if (last_ != nullptr) add_missing(last_->cycle, beat.cycle);
    fmt::format_to(out_, "{},{},", beat.cycle, format_instant(beat.time, 9));
    if (follows) {
      const std::array<Beat, 2> pair{*last_, beat};
      const double rate = rate_per_period(pair, nominal_period_s_).front();
      const double period =
          (beat.time - last_->time) / static_cast<double>(beat.cycle - last_->cycle);
      fmt::format_to(out_, "{:.12g},{:.6e},{:.6f},", period, rate, seconds_gained_per_day(rate));
    } else {
      text += ",,,";
    }
    if (!std::isnan(beat.amplitude_rad)) fmt::format_to(out_, "{:.9g}", beat.amplitude_rad);
    if (last_ != nullptr && !follows)
      fmt::format_to(out_, ",{}\n", is_step_after(last_->cycle) ? "step" : "split");
    else
      text += ",\n";
    last_ = &beat;
  }

  void add_missing(std::int64_t from, std::int64_t to) {
    if (to - from - 1 > rows_per_gap) {
      fmt::format_to(out_, "{},,,,,,gap of {}\n", from + 1, to - from - 1);
      return;
    }
    for (std::int64_t cycle = from + 1; cycle < to; ++cycle)
      fmt::format_to(out_, "{},,,,,,missed\n", cycle);
  }

  // Gaps and beats are both in order of cycles.
  bool is_step_after(std::int64_t cycle) {
    while (gap_ != gaps_end_ && gap_->after_cycle < cycle)
      ++gap_;
    return gap_ != gaps_end_ && gap_->after_cycle == cycle && gap_->kind == GapKind::step;
  }

  double nominal_period_s_;
  std::vector<Gap>::const_iterator gap_, gaps_end_;
  const Beat* last_ = nullptr;
  std::back_insert_iterator<std::string> out_{text};
};

} // namespace

std::string rate_table(const Beats& beats, double nominal_period_s) {
  RateTable table(nominal_period_s, beats.gaps);
  for (const Beat& beat : beats.beats)
    table.add(beat);
  return std::move(table.text);
}

std::string rate_text(const Beats& beats, const RateSummary& summary) {
  const double rate = seconds_gained_per_day(summary.rate_excess);
  const double sigma = seconds_gained_per_day(summary.rate_excess_sigma);
  std::string text = fmt::format("{} beats over {:.6g} s; {} missed, {} spurious, {} segment{}\n",
                                 summary.crossings, summary.duration_s, beats.missed,
                                 beats.spurious, beats.segments, beats.segments == 1 ? "" : "s");
  if (beats.rivals > 0)
    text += fmt::format("{} cycles have a second event that could as well be the crossing\n",
                        beats.rivals);
  if (beats.longest_countable_gap > 0)
    text += fmt::format("a break of up to {} cycles could be counted in such a log\n",
                        beats.longest_countable_gap);
  text += fmt::format("mean period {} s against {} s: {} by {} s a day (end to end); "
                      "a straight line fitted to the clock's error gives {:+.4g} s a day",
                      with_sigma(summary.mean_period_s, summary.mean_period_sigma_s, 12),
                      summary.nominal_period_s, rate < 0 ? "losing" : "gaining",
                      with_sigma(std::abs(rate), sigma),
                      seconds_gained_per_day(summary.slope_rate_excess));
  return text;
}

} // namespace goingrate
