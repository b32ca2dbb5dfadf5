#include "follow.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/report/tables.hpp"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>

namespace goingrate::apps {

namespace {

using Clock = std::chrono::steady_clock;

// Says when the clock has stopped, and when it goes again.
class Alarm {
public:
  Alarm(double patience_s, const GlobalOptions& global)
      : patience_s_(patience_s), fixed_(patience_s > 0.0), global_(global) {}

  void beat(double period_s) {
    constexpr double patience_in_periods = 5.0;
    const double silence_s = silence();
    if (ringing_)
      say(global_, fmt::format("the clock goes again after {:.3g} s without a beat", silence_s));
    ringing_ = false;
    if (!fixed_ && period_s > 0.0) patience_s_ = patience_in_periods * period_s;
    last_ = Clock::now();
    heard_ = true;
  }

  // Called while nothing comes.
  void wait() {
    if (!heard_ || ringing_ || patience_s_ <= 0.0 || silence() < patience_s_) return;
    ringing_ = true;
    // Not a note that --quiet silences: it is what the command was asked for.
    std::fputs(
        fmt::format("alarm: no beat for {:.3g} s: has the clock stopped?\n", silence()).c_str(),
        stderr);
  }

private:
  [[nodiscard]] double silence() const {
    return std::chrono::duration<double>(Clock::now() - last_).count();
  }
  double patience_s_;
  bool fixed_;
  const GlobalOptions& global_;
  Clock::time_point last_ = Clock::now();
  bool ringing_ = false;
  bool heard_ = false;
};

// Numbers each new event together with the last few hundred, which cost some microseconds, so that
// what is printed is what a run over the whole log would say of its last beat.
class RollingNumbers {
public:
  explicit RollingNumbers(const LogOptions& options) : options_(options) {}

  // The rows that the event makes; empty until there are enough events to number.
  std::string add(const Beat& event, const ClockLog& log) {
    window_.push_back(event);
    constexpr std::size_t enough = 8, most = 400;
    if (window_.size() < enough) return {};
    if (window_.size() > most) window_.erase(window_.begin(), window_.begin() + most / 2);
    return rows(log);
  }

  // What was held back, at the end of a short log.
  std::string rest(const ClockLog& log) {
    constexpr std::size_t fewest = 3;
    return table_ || window_.size() < fewest ? std::string() : rows(log);
  }

  [[nodiscard]] double period_s() const { return period_s_; }

private:
  std::string rows(const ClockLog& log) {
    const Beats numbered =
        number_beats(std::vector<Beat>(window_), log.source, {options_.gap_probability});
    period_s_ = numbered.typical_period_s;
    std::string text;
    std::size_t from = window_.size() - 1;
    if (!table_) {
      std::vector<std::string> unused;
      const double nominal = nominal_period(log, numbered, unused);
      table_.emplace(RateTable::Options{nominal, false, 0}, no_columns_, no_gaps_);
      text = table_->header();
      from = 0;
    }
    const std::int64_t shift = shift_of(numbered);
    for (std::size_t i = from; i < window_.size(); ++i) {
      Beat beat = numbered.beats[i];
      beat.cycle += shift;
      beat.segment = static_cast<std::uint16_t>(beat.segment + segment_shift_);
      table_->append(text, beat, 0);
      if (beat.flag == BeatFlag::good) last_ = beat;
    }
    return text;
  }

  // How far the window's own cycles are from those printed so far.
  std::int64_t shift_of(const Beats& numbered) {
    if (!last_) return 0;
    for (const Beat& beat : numbered.beats)
      if (beat.flag == BeatFlag::good && beat.time == last_->time) {
        segment_shift_ = last_->segment - beat.segment;
        return last_->cycle - beat.cycle;
      }
    return last_->cycle; // seen otherwise by now: go on from there
  }

  const LogOptions& options_;
  std::vector<Beat> window_;
  std::optional<RateTable> table_;
  EventColumns no_columns_;
  std::vector<Gap> no_gaps_;
  std::optional<Beat> last_;
  int segment_shift_ = 0;
  double period_s_ = 0.0;
};

void print(const std::string& text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0)
    return;
  if (errno == EPIPE) throw ClosedPipe("standard output", std::strerror(errno));
  throw OutputError("standard output", std::strerror(errno));
}

} // namespace

void follow(const LogOptions& options, double alarm_s, const GlobalOptions& global) {
  Alarm alarm(alarm_s, global);
  const ReadingOptions reading = reading_options(options);
  LogFollower log(options.path, reading, [&] {
    alarm.wait();
    return true;
  });
  for (const std::string& line : log.log().assumptions)
    say(global, "assumed: " + line);
  RollingNumbers numbers(options);
  std::size_t told = 0;
  while (const auto event = log.next()) {
    print(numbers.add(*event, log.log()));
    alarm.beat(numbers.period_s());
    for (; told < log.log().issues.size(); ++told)
      say(global, words_for(log.log().issues[told], options.path));
  }
  print(numbers.rest(log.log()));
}

} // namespace goingrate::apps
