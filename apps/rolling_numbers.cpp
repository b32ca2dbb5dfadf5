#include "rolling_numbers.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate::apps {

namespace {
constexpr std::size_t fewest_beats = 3;    // two periods
constexpr std::size_t settling_beats = 8;  // show what they are
constexpr std::size_t many_beats = 40;     // some of which have a period
constexpr std::size_t kept_beats = 200;    // judge a new one; they are numbered again each time
constexpr std::size_t older_beats = 16384; // at least, that judge a long gap: 2 MB at most
constexpr std::size_t backlog_beats =
    4096; // of a backlog: so many that numbering the kept ones again costs little
} // namespace

void RollingNumbers::add(const Beat& event) { window_.push_back(event); }

bool RollingNumbers::is_full() const { return window_.size() - handed_out_ >= backlog_beats; }

bool RollingNumbers::is_settling() const {
  return handed_out_ == 0 && !window_.empty() && window_.size() < settling_beats;
}

void RollingNumbers::begin_anew() {
  older_.clear();
  window_.clear();
  handed_out_ = 0;
}

void RollingNumbers::go_on_from(std::vector<Beat> numbered) {
  older_.clear();
  window_ = std::move(numbered);
  handed_out_ = window_.size();
  for (const Beat& beat : window_)
    if (beat.flag == BeatFlag::good) last_ = beat;
}

std::vector<Beat> RollingNumbers::numbered(const ClockLog& log) {
  if (handed_out_ == window_.size() || window_.size() < settling_beats) return {};
  return number_new(log);
}

std::vector<Beat> RollingNumbers::rest(const ClockLog& log) {
  if (handed_out_ == window_.size() || window_.size() < fewest_beats) return {};
  return number_new(log);
}

Beats RollingNumbers::number(std::vector<Beat> events, const ClockLog& log) const {
  ClockLog part;
  part.events = std::move(events);
  mark_bounces(part, options_.dead_time_s);
  return number_beats(std::move(part.events), log.source,
                      {options_.gap_probability, log.nominal_period_s});
}

Beats RollingNumbers::numbered_window(const ClockLog& log) const {
  Beats few = number(window_, log);
  const bool splits =
      handed_out_ > 0 && few.beats[handed_out_ - 1].segment != few.beats.back().segment;
  if (!splits || older_.empty()) return few;
  std::vector<Beat> all = older_;
  all.insert(all.end(), window_.begin(), window_.end());
  Beats many = number(std::move(all), log);
  many.beats.erase(many.beats.begin(),
                   many.beats.begin() + static_cast<std::ptrdiff_t>(older_.size()));
  return many;
}

std::vector<Beat> RollingNumbers::number_new(const ClockLog& log) {
  std::vector<Beat> fresh;
  try {
    const Beats numbered = numbered_window(log);
    period_s_ = numbered.typical_period_s;
    if (nominal_period_s_ == 0.0) take_nominal_period(log, numbered);
    const Shift shift = shift_of(numbered.beats);
    const std::int64_t last_cycle = last_ ? last_->cycle : numbered.beats.front().cycle;
    for (; handed_out_ < window_.size(); ++handed_out_) {
      Beat& beat = window_[handed_out_] = numbered.beats[handed_out_];
      beat.cycle += shift.cycles;
      beat.segment = static_cast<std::uint16_t>(beat.segment + shift.segments);
      fresh.push_back(judged(beat));
    }
    keep_gaps(numbered, shift, last_cycle);
    failure_.clear();
  } catch (const InputError& error) { // no period in these: the next ones may have one
    if (window_.size() - handed_out_ >= many_beats) failure_ = error.what();
    if (window_.size() > kept_beats) begin_anew();
  }
  forget_old();
  return fresh;
}

// Without a stated period and without labels, only a beat error shows that the log has both
// directions.
void RollingNumbers::take_nominal_period(const ClockLog& log, const Beats& numbered) {
  nominal_period_s_ = nominal_period(log, numbered, assumptions_);
  const bool is_labelled =
      options_.both_edges || std::any_of(window_.begin(), window_.end(),
                                         [](const Beat& beat) { return beat.edge == Edge::down; });
  if (!log.nominal_period_s && !is_labelled) {
    ClockLog heard;
    heard.events = window_;
    const bool alternate = label_alternate_edges(heard, false, {});
    assumptions_.push_back(
        {fmt::format("every event is a crossing in the same direction{}",
                     alternate ? ", though intervals alternate, as those between both do"
                               : "; if every other one is in the other, the period is twice that"),
         Setting::both_edges});
  }
  name_options(assumptions_);
}

void RollingNumbers::keep_gaps(const Beats& numbered, const Shift& shift, std::int64_t from_cycle) {
  for (Gap gap : numbered.gaps) {
    gap.after_cycle += shift.cycles;
    if (gap.after_cycle >= from_cycle) gaps_.push_back(gap);
  }
}

// By the last beat that was handed out as good and still is; if there is none, they go on after it.
RollingNumbers::Shift RollingNumbers::shift_of(const std::vector<Beat>& numbered) const {
  for (std::size_t i = handed_out_; i-- > 0;)
    if (window_[i].flag == BeatFlag::good && numbered[i].flag == BeatFlag::good)
      return {window_[i].cycle - numbered[i].cycle, window_[i].segment - numbered[i].segment};
  if (!last_) return {};
  const auto first =
      std::find_if(numbered.begin() + static_cast<std::ptrdiff_t>(handed_out_), numbered.end(),
                   [](const Beat& beat) { return beat.flag == BeatFlag::good; });
  if (first == numbered.end()) return {last_->cycle - numbered.back().cycle, 0};
  return {last_->cycle + 1 - first->cycle, last_->segment + 1 - first->segment};
}

Beat RollingNumbers::judged(Beat beat) {
  if (beat.flag != BeatFlag::good) return beat;
  // Another was handed out with this cycle: which of them was the beat cannot be told any more.
  if (last_ && beat.cycle <= last_->cycle)
    beat.flag = BeatFlag::rival;
  else
    last_ = beat;
  return beat;
}

void RollingNumbers::forget_old() {
  if (window_.size() < 2 * kept_beats || handed_out_ < window_.size()) return;
  const auto kept = window_.end() - static_cast<std::ptrdiff_t>(kept_beats);
  older_.insert(older_.end(), window_.begin(), kept);
  if (older_.size() > 2 * older_beats)
    older_.erase(older_.begin(), older_.end() - static_cast<std::ptrdiff_t>(older_beats));
  window_.erase(window_.begin(), kept);
  handed_out_ = kept_beats;
}

} // namespace goingrate::apps
