#include "rolling_numbers.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>

namespace goingrate::apps {

namespace {
constexpr std::size_t fewest_beats = 3;   // two periods
constexpr std::size_t settling_beats = 8; // show what they are
constexpr std::size_t kept_beats = 200;   // judge a new one; they are numbered again each time
constexpr std::size_t backlog_beats =
    4096; // of a backlog: so many more make those that are kept no matter
} // namespace

void RollingNumbers::add(const Beat& event) { window_.push_back(event); }

bool RollingNumbers::is_full() const { return window_.size() - printed_ >= backlog_beats; }

void RollingNumbers::begin_anew() {
  window_.clear();
  printed_ = 0;
}

std::string RollingNumbers::rows(const ClockLog& log) {
  if (printed_ == window_.size() || window_.size() < settling_beats) return {};
  return numbered_rows(log);
}

std::string RollingNumbers::rest(const ClockLog& log) {
  if (printed_ == window_.size() || window_.size() < fewest_beats) return {};
  return numbered_rows(log);
}

std::string RollingNumbers::numbered_rows(const ClockLog& log) {
  std::string text;
  try {
    ClockLog part;
    part.events = window_;
    mark_bounces(part, options_.dead_time_s);
    const Beats numbered = number_beats(std::move(part.events), log.source,
                                        {options_.gap_probability, log.nominal_period_s});
    period_s_ = numbered.typical_period_s;
    if (!table_) open_table(log, numbered, text);
    const Shift shift = shift_of(numbered.beats);
    for (; printed_ < window_.size(); ++printed_) {
      Beat& beat = window_[printed_] = numbered.beats[printed_];
      beat.cycle += shift.cycles;
      beat.segment = static_cast<std::uint16_t>(beat.segment + shift.segments);
      print(beat, text);
    }
  } catch (const InputError&) { // no period in these: the next ones may have one
    if (window_.size() > kept_beats) begin_anew();
  }
  forget_old();
  return text;
}

void RollingNumbers::open_table(const ClockLog& log, const Beats& numbered, std::string& text) {
  std::vector<Assumption> unused;
  const double nominal = nominal_period(log, numbered, unused);
  table_.emplace(RateTable::Options{nominal, false, 0}, no_columns_, no_gaps_);
  text = table_->header();
}

// From the last beat that was printed as a good one and is one still; else they go on behind it.
RollingNumbers::Shift RollingNumbers::shift_of(const std::vector<Beat>& numbered) const {
  for (std::size_t i = printed_; i-- > 0;)
    if (window_[i].flag == BeatFlag::good && numbered[i].flag == BeatFlag::good)
      return {window_[i].cycle - numbered[i].cycle, window_[i].segment - numbered[i].segment};
  if (!last_) return {};
  const auto first =
      std::find_if(numbered.begin() + static_cast<std::ptrdiff_t>(printed_), numbered.end(),
                   [](const Beat& beat) { return beat.flag == BeatFlag::good; });
  if (first == numbered.end()) return {last_->cycle - numbered.back().cycle, 0};
  return {last_->cycle + 1 - first->cycle, last_->segment + 1 - first->segment};
}

void RollingNumbers::print(Beat beat, std::string& text) {
  if (beat.flag == BeatFlag::good) {
    // Another has this cycle in print: which of them was the beat cannot be told any more.
    if (last_ && beat.cycle <= last_->cycle)
      beat.flag = BeatFlag::rival;
    else
      last_ = beat;
  }
  table_->append(text, beat, 0);
}

void RollingNumbers::forget_old() {
  if (window_.size() < 2 * kept_beats || printed_ < window_.size()) return;
  window_.erase(window_.begin(), window_.end() - static_cast<std::ptrdiff_t>(kept_beats));
  printed_ = kept_beats;
}

} // namespace goingrate::apps
