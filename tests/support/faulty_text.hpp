// Logs as text, with the faults that loggers and their users make, whose truth is known line by
// line.
#pragma once

#include "faulty_log.hpp"

#include "goingrate/analysis/load.hpp"

#include <fmt/format.h>
#include <string>

namespace goingrate::test {

/// What is wrong with a log, besides the 2 % of missed and 1 % of false events that all have.
enum class TextFault {
  bounce,       ///< every edge is followed by one to four more, 2 to 6 ms apart
  some_bounce,  ///< a third of the edges is
  bursts,       ///< one edge in fifty is followed by five to fifteen within 40 ms
  restart,      ///< the logger starts again at time zero, once to three times
  pasted,       ///< another sensor's log of the same hours follows
  hour_jump,    ///< the reference is set by an hour, forward or back
  lost,         ///< 70 % of the beats are missing, and the period is given
  lost_unknown, ///< the same without the period
  labels,       ///< labels a step early or late for some lines in a row, now and then
  lone_beats,   ///< one to three beats between gaps of 10 to 60 periods
};
inline constexpr std::array all_text_faults{
    TextFault::bounce, TextFault::some_bounce, TextFault::bursts, TextFault::restart,
    TextFault::pasted, TextFault::hour_jump,   TextFault::lost,   TextFault::lost_unknown,
    TextFault::labels, TextFault::lone_beats};
inline constexpr std::array text_fault_names{
    "every edge bounces", "a third bounces", "bursts",        "restarts", "same hours twice",
    "hour set",           "70 % lost",       "... no period", "labels",   "beats between gaps"};

struct FaultyText {
  std::string text;
  std::vector<TrueEvent> truth; ///< one per line
  std::optional<double> nominal_period_s;
};

/// A random log of 800 to 4000 periods of 0.8 to 3 s, jitter 1e-6 to 1e-3 of the period, noise of
/// the rate 1e-8 to 1e-5 and its random walk 1e-10 to 1e-8 per cycle (all log-uniform).
class FaultyTextMaker {
public:
  FaultyTextMaker(TextFault fault, std::uint64_t seed)
      : fault_(fault), noise_(seed, StreamPurpose::jitter), faults_(seed, StreamPurpose::missed) {}

  FaultyText make() {
    draw_clock();
    run();
    if (fault_ == TextFault::pasted) {
      ++epoch_;
      time_ = period_ * faults_.uniform();
      run();
    }
    FaultyText made;
    if (fault_ == TextFault::lost) made.nominal_period_s = nominal_;
    for (const Event& event : events_) {
      made.text += fault_ == TextFault::labels
                       ? fmt::format("{:.0f} {:.9f} 46.4\n", event.label, event.label - event.time)
                       : fmt::format("{:.9f}\n", start_ + event.time);
      made.truth.push_back(event.truth);
    }
    return made;
  }

private:
  struct Event {
    double time;
    TrueEvent truth;
    double label = 0.0;
  };

  double log_uniform(double low, double high) {
    return low * std::exp(std::log(high / low) * faults_.uniform());
  }
  bool with_chance(double chance) { return faults_.uniform() < chance; }
  std::int64_t whole(double low, double high) {
    return static_cast<std::int64_t>(low + (high + 1.0 - low) * faults_.uniform());
  }

  void draw_clock() {
    periods_ = whole(800, 4000);
    nominal_ = 0.25 * static_cast<double>(whole(4, 12));
    if (fault_ == TextFault::labels) nominal_ = static_cast<double>(whole(1, 3));
    period_ = nominal_ * (1.0 + 4e-4 * (faults_.uniform() - 0.5));
    if (fault_ != TextFault::labels && with_chance(0.5)) period_ *= 1.0 + 0.1 * faults_.uniform();
    if (fault_ == TextFault::lost) nominal_ = period_ * (1.0 + 1e-3 * (faults_.uniform() - 0.5));
    jitter_ = log_uniform(1e-6, 1e-3);
    rate_noise_ = log_uniform(1e-8, 1e-5);
    rate_walk_ = log_uniform(1e-10, 1e-8);
    // Times that count from the start of the log, or from 1970.
    const bool since_1970 = fault_ == TextFault::hour_jump && with_chance(0.5);
    start_ = since_1970 ? 1.6e9 : 0.0;
    lost_share_ = fault_ == TextFault::lost || fault_ == TextFault::lost_unknown ? 0.7 : 0.02;
    if (fault_ == TextFault::labels) time_ = 1e5;
  }

  void run() {
    // 100 to 400 beats before anything happens
    std::int64_t next = whole(100, 400);
    std::int64_t left_of_run = 0; // of lone beats or wrong labels
    double walk = 0.0, label_off = 0.0;
    int changes = 0;
    bool in_gap = false;
    for (std::int64_t n = 0; n < periods_; ++n) {
      if (n == next) {
        switch (fault_) {
        case TextFault::restart:
          if (changes++ < 3) restart();
          next = n + whole(100, 1000);
          break;
        case TextFault::hour_jump:
          if (changes++ == 0) {
            time_ +=
                with_chance(0.5) && static_cast<double>(n) * period_ > 3700.0 ? -3600.0 : 3600.0;
            ++epoch_;
          }
          break;
        case TextFault::lone_beats:
          in_gap = true;
          next = n + whole(10, 60);
          left_of_run = 0;
          if (gaps_in_a_row_++ > 0) n = skip_gap(n);
          next = n + (gaps_in_a_row_ > 3 ? whole(100, 400) : whole(1, 3));
          if (gaps_in_a_row_ > 3) gaps_in_a_row_ = 0;
          in_gap = false;
          break;
        case TextFault::labels:
          label_off = with_chance(0.5) ? -1.0 : 1.0;
          left_of_run = whole(1, 12);
          next = n + whole(30, 300);
          break;
        default:
          break;
        }
      }
      walk += rate_walk_ * noise_.normal();
      if (left_of_run > 0 && --left_of_run == 0) label_off = 0.0;
      if (!in_gap) cycle(n, label_off);
      time_ += period_ * (1.0 + walk + rate_noise_ * noise_.normal());
    }
  }

  std::int64_t skip_gap(std::int64_t n) {
    const std::int64_t length = std::min(whole(10, 60), periods_ - n - 1);
    time_ += period_ * static_cast<double>(length);
    return n + length;
  }

  void restart() {
    time_ = period_ * faults_.uniform();
    ++epoch_;
  }

  void cycle(std::int64_t n, double label_off) {
    const double label = nominal_ * std::round(time_ / nominal_) + label_off * nominal_;
    const bool is_label = fault_ == TextFault::labels;
    if (with_chance(is_label && label_off != 0.0 ? 0.0 : is_label ? 0.0 : lost_share_)) return;
    const double seen = time_ + jitter_ * period_ * noise_.normal();
    // A label that is early or late takes the time, which is told relative to it, along.
    events_.push_back({seen + label_off * nominal_, {n, epoch_, false}, label});
    if (is_label) return;
    bounces(n, seen);
    if (with_chance(0.01))
      events_.push_back(
          {seen + (0.05 + 0.9 * faults_.uniform()) * period_, {-1 - n, epoch_, false}});
  }

  void bounces(std::int64_t n, double seen) {
    const double share = fault_ == TextFault::bounce        ? 1.0
                         : fault_ == TextFault::some_bounce ? 0.33
                         : fault_ == TextFault::bursts      ? 0.02
                                                            : 0.0;
    if (!with_chance(share)) return;
    const bool burst = fault_ == TextFault::bursts;
    const std::int64_t count = burst ? whole(5, 15) : whole(1, 4);
    double time = seen;
    for (std::int64_t k = 0; k < count; ++k) {
      time += burst ? 0.0026 * faults_.uniform() : 0.002 + 0.004 * faults_.uniform();
      events_.push_back({time, {-1 - n, epoch_, false}});
    }
  }

  TextFault fault_;
  RandomStream noise_, faults_;
  std::int64_t periods_ = 0;
  double nominal_ = 2.0, period_ = 2.0, jitter_ = 0.0, rate_noise_ = 0.0, rate_walk_ = 0.0,
         start_ = 0.0, lost_share_ = 0.0, time_ = 0.0;
  int epoch_ = 0, gaps_in_a_row_ = 0;
  std::vector<Event> events_;
};

/// Loads the text as the command does and compares with the truth; false if it was refused.
inline bool judge_text(const FaultyText& made, NumberingJudge& judge) {
  LoadRequest request;
  request.path = "faulty";
  request.reading.nominal_period_s = made.nominal_period_s;
  try {
    const NumberedLog loaded = load_text(made.text, request);
    FaultyLog in_order; // as the reader put it
    for (const Beat& beat : loaded.beats.beats)
      in_order.truth.push_back(made.truth[beat.line - 1]);
    judge.add(in_order, loaded.beats);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

} // namespace goingrate::test
