#include "going.hpp"

#include "base/robust.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace goingrate::apps {

namespace {

std::optional<double> mean(double sum, std::int64_t count) {
  return count > 0 ? std::optional(sum / static_cast<double>(count)) : std::nullopt;
}

double mean_of(const std::vector<double>& x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

// Standard deviation of the mean of x, from the scatter of x.
double sigma_of_mean(const std::vector<double>& x) {
  const double middle = mean_of(x);
  double squares = 0.0;
  for (const double v : x)
    squares += (v - middle) * (v - middle);
  const auto n = static_cast<double>(x.size());
  return std::sqrt(squares / (n - 1.0) / n);
}

constexpr std::size_t fewest_rates = 4; // to tell a scatter

double sigma_with_wander(std::vector<double> rates) {
  double sigma = 0.0;
  for (; rates.size() >= fewest_rates;) {
    sigma = std::max(sigma, sigma_of_mean(rates));
    std::vector<double> pairs;
    for (std::size_t i = 0; i + 1 < rates.size(); i += 2)
      pairs.push_back(0.5 * (rates[i] + rates[i + 1]));
    rates = std::move(pairs);
  }
  return sigma;
}

} // namespace

void ClockMarks::add(const ClockMark& beat) {
  constexpr std::size_t most_beats = 7; // each has six slopes, of which two may be wrong
  beats_.push_back(beat);
  if (beats_.size() > most_beats) beats_.pop_front();
}

ClockMark ClockMarks::get() const {
  constexpr std::size_t fewest_beats = 3;
  if (beats_.size() < fewest_beats) return beats_.back();
  const ClockMark& middle = beats_[beats_.size() / 2];
  const auto cycles_from = [](const ClockMark& from, const ClockMark& beat) {
    return static_cast<double>(beat.cycle - from.cycle);
  };
  std::vector<double> periods, of_one, errors;
  for (const ClockMark& from : beats_) {
    of_one.clear();
    for (const ClockMark& beat : beats_)
      if (beat.cycle != from.cycle)
        of_one.push_back((beat.time - from.time) / cycles_from(from, beat));
    periods.push_back(median(of_one));
  }
  const double period_s = median(periods);
  for (const ClockMark& beat : beats_)
    errors.push_back((beat.time - middle.time) - period_s * cycles_from(middle, beat));
  std::sort(errors.begin(), errors.end());
  const auto spared = static_cast<std::ptrdiff_t>(errors.size() / 3); // at either end
  errors.erase(errors.end() - spared, errors.end());
  errors.erase(errors.begin(), errors.begin() + spared);
  return {middle.time + mean_of(errors), middle.cycle};
}

std::optional<double> GoingBlock::amplitude_rad() const { return mean(amplitude_sum, amplitudes); }
std::optional<double> GoingBlock::beat_error_s() const { return mean(beat_error_sum, beat_errors); }

bool GoingBlocks::open(const Instant& time) {
  const std::int64_t start = time.seconds / length_s_ * length_s_;
  const auto is_last = [&] {
    return !blocks_.empty() && start <= blocks_.back().start_s &&
           start >= blocks_.back().start_s - length_s_;
  };
  if (is_last()) return false;
  while (!blocks_.empty() && blocks_.back().start_s > start)
    blocks_.pop_back();
  if (is_last() && blocks_.back().start_s == start) return false;
  GoingBlock block;
  block.start_s = start;
  blocks_.push_back(block);
  if (blocks_.size() > most_) blocks_.pop_front();
  return true;
}

std::optional<double> GoingBlocks::rate_of(std::size_t i, double nominal_period_s) const {
  if (i == 0 || nominal_period_s <= 0.0) return {};
  const GoingBlock &before = blocks_[i - 1], &block = blocks_[i];
  const std::int64_t cycles = block.mark_cycle - before.mark_cycle;
  if (before.beats == 0 || block.beats == 0 || before.run != block.run || cycles <= 0) return {};
  return static_cast<double>(cycles) * nominal_period_s / (block.mark_time - before.mark_time) -
         1.0;
}

std::optional<Measured> GoingBlocks::rate_over(std::size_t count, double nominal_period_s,
                                               double silence_s) const {
  if (blocks_.size() < 2) return {};
  const auto now_s = blocks_.back().mark_time.seconds + static_cast<std::int64_t>(silence_s);
  const std::int64_t since_s = (now_s / length_s_ - static_cast<std::int64_t>(count)) * length_s_;
  const std::size_t end = blocks_.size() - 1; // the last is not complete
  std::vector<double> rates;
  for (std::size_t i = end - std::min(end, count); i < end; ++i)
    if (const auto rate = rate_of(i, nominal_period_s);
        rate && blocks_[i].run == blocks_[end].run && blocks_[i].start_s >= since_s)
      rates.push_back(*rate);
  if (rates.size() < fewest_rates) return {};
  return Measured{mean_of(rates), sigma_with_wander(rates), rates.size()};
}

void GoingBlocks::merge(const GoingBlock& part) {
  open({part.start_s, 0.0});
  GoingBlock& block = last();
  block.beats += part.beats;
  block.missed += part.missed;
  block.spurious += part.spurious;
  block.amplitude_sum += part.amplitude_sum;
  block.amplitudes += part.amplitudes;
  block.beat_error_sum += part.beat_error_sum;
  block.beat_errors += part.beat_errors;
  block.last_cycle = part.last_cycle;
  block.mark_time = part.mark_time;
  block.mark_cycle = part.mark_cycle;
  block.run = part.run;
}

void Going::restore(const std::vector<GoingBlock>& hours, const std::optional<Beat>& first_of_run) {
  for (const GoingBlock& hour : hours) {
    hours_.merge(hour);
    days_.merge(hour);
    beats_ += hour.beats;
    run_ = hour.run;
  }
  first_of_run_ = first_of_run;
  if (first_of_run_) run_of_first_ = run_;
}

// The downward crossing lies between the upward one before it and this one.
void Going::add_beat_error(const Beat& up) {
  if (!last_ || !last_down_ || up.cycle != last_->cycle + 1 || !(last_down_->time > last_->time))
    return;
  const double error = (last_down_->time - last_->time) - (up.time - last_down_->time);
  each_length([&](GoingBlocks& blocks) {
    blocks.last().beat_error_sum += error;
    ++blocks.last().beat_errors;
  });
}

void Going::add_spurious() {
  if (last_) each_length([](GoingBlocks& blocks) { ++blocks.last().spurious; });
}

void Going::add(const Beat& beat, std::int64_t missed_before) {
  minute_is_new_ = false;
  if (beat.flag == BeatFlag::down) {
    last_down_ = beat;
    return;
  }
  if (beat.flag != BeatFlag::good) return add_spurious();
  minute_is_new_ = minutes_.open(beat.time);
  hours_.open(beat.time);
  days_.open(beat.time);
  add_beat_error(beat);
  if (minute_is_new_ || (last_ && run_of_last_ != run_)) marks_.begin_anew();
  run_of_last_ = run_;
  marks_.add({beat.time, beat.cycle});
  const ClockMark mark = marks_.get();
  each_length([&](GoingBlocks& blocks) {
    GoingBlock& block = blocks.last();
    ++block.beats;
    block.missed += missed_before;
    block.last_cycle = beat.cycle;
    block.mark_time = mark.time;
    block.mark_cycle = mark.cycle;
    block.run = run_;
    if (!std::isnan(beat.amplitude_rad)) {
      block.amplitude_sum += beat.amplitude_rad;
      ++block.amplitudes;
    }
  });
  if (run_of_first_ != run_) {
    first_of_run_ = beat;
    run_of_first_ = run_;
  }
  last_ = beat;
  ++beats_;
}

double Going::missed_share() const {
  constexpr std::size_t hours_a_day = 24;
  double beats = 1.0, missed = 0.5;
  const auto& all = hours_.all();
  for (std::size_t i = all.size() - std::min(all.size(), hours_a_day); i < all.size(); ++i) {
    missed += static_cast<double>(all[i].missed);
    beats += static_cast<double>(all[i].beats + all[i].missed);
  }
  return missed / beats;
}

std::optional<double> Going::deviation_s(double nominal_period_s) const {
  if (!last_ || !first_of_run_ || nominal_period_s <= 0.0) return {};
  const double late_s = residual_from_grid(last_->time, first_of_run_->time,
                                           last_->cycle - first_of_run_->cycle, nominal_period_s);
  return 0.0 - late_s; // unlike -late_s, never -0.0
}

} // namespace goingrate::apps
