#include "follow.hpp"

#include "arrivals.hpp"
#include "rolling_numbers.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/report/tables.hpp"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <vector>

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

void print(const std::string& text) {
  if (text.empty()) return;
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0)
    return;
  if (errno == EPIPE) throw ClosedPipe("standard output", std::strerror(errno));
  throw OutputError("standard output", std::strerror(errno));
}

// Numbers and prints what came once nothing more comes for the moment, or much has come.
class Following {
public:
  Following(const LogOptions& options, double alarm_s, const GlobalOptions& global)
      : options_(options), global_(global), alarm_(alarm_s, global), numbers_(options) {}

  void add(const Beat& event, const ClockLog& log) {
    log_ = &log;
    take(arrivals_.add(event));
    if (numbers_.is_full()) print_new();
    alarm_.beat(numbers_.period_s());
  }
  // Called while nothing comes.
  void wait() {
    print_new();
    alarm_.wait();
  }
  void end(const ClockLog& log) {
    log_ = &log;
    take(arrivals_.rest());
    print_new();
    print_rows(numbers_.rest(log));
  }
  void tell_assumptions(const ClockLog& log) {
    std::vector<Assumption> fresh(log.assumptions.begin() +
                                      static_cast<std::ptrdiff_t>(assumptions_told_),
                                  log.assumptions.end());
    assumptions_told_ = log.assumptions.size();
    name_options(fresh);
    for (const Assumption& assumption : fresh)
      say(global_, "assumed: " + assumption.text);
  }

private:
  void take(const std::vector<Arrivals::Arrival>& arrivals) {
    for (const auto& [event, begins_anew] : arrivals) {
      if (begins_anew) {
        print_rows(numbers_.rest(*log_));
        numbers_.begin_anew();
        say(global_, fmt::format("{}:{}: the times begin again: a new segment",
                                 options_.paths.front(), event.line));
      }
      numbers_.add(event);
    }
    for (const Beat& event : arrivals_.take_left_out())
      say(global_, fmt::format("{}:{}: a time far from those around it: left out",
                               options_.paths.front(), event.line));
  }

  void print_rows(const std::vector<Beat>& beats) {
    if (beats.empty()) return;
    std::string text;
    if (!table_) {
      table_.emplace(RateTable::Options{numbers_.nominal_period_s(), false, 0}, no_columns_,
                     no_gaps_);
      text = table_->header();
    }
    for (const Beat& beat : beats)
      table_->append(text, beat, 0);
    print(text);
  }

  void print_new() {
    if (log_ == nullptr) return;
    print_rows(numbers_.numbered(*log_));
    tell_assumptions(*log_);
    for (; issues_told_ < log_->issues.size(); ++issues_told_)
      say(global_, words_for(log_->issues[issues_told_], *log_));
  }

  const LogOptions& options_;
  const GlobalOptions& global_;
  Alarm alarm_;
  static constexpr std::size_t shown_events = 3; // that show a logger began again: soon told
  Arrivals arrivals_{shown_events};
  RollingNumbers numbers_;
  std::optional<RateTable> table_;
  EventColumns no_columns_;
  std::vector<Gap> no_gaps_;
  const ClockLog* log_ = nullptr; // none before the first event
  std::size_t assumptions_told_ = 0, issues_told_ = 0;
};

} // namespace

void follow(const LogOptions& options, double alarm_s, const GlobalOptions& global) {
  if (options.paths.size() > 1)
    throw ArgumentError("log", options.paths[1], "a single file where it is followed as it grows");
  Following following(options, alarm_s, global);
  LogFollower log(options.paths.front(), reading_options(options), [&](std::string_view) {
    following.wait();
    return true;
  });
  following.tell_assumptions(log.log());
  while (const auto event = log.next())
    following.add(*event, log.log());
  following.end(log.log());
}

} // namespace goingrate::apps
