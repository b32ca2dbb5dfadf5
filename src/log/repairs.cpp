#include "repairs.hpp"

#include "typical_period.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

namespace goingrate {

namespace {

bool earlier(const Beat& a, const Beat& b) { return a.time < b.time; }

// The median time between successive events; steps back do not count.
double usual_step(const std::vector<Beat>& events) {
  std::vector<double> steps;
  for (const Stretch& stretch : sample_stretches(events.size()))
    for (std::size_t i = stretch.first + 1; i < stretch.last; ++i)
      if (events[i - 1].time < events[i].time) steps.push_back(events[i].time - events[i - 1].time);
  return steps.empty() ? 0.0 : median(steps);
}

// Finds the blocks of a log. Where the time goes back and continues from there, the logger was
// restarted or another log follows. Lines that are late by a few places, a stray line between two
// neighbours, and repeated lines begin no block.
class BlockFinder {
public:
  explicit BlockFinder(const std::vector<Beat>& events)
      : events_(events), usual_step_(usual_step(events)) {}

  // Indices at which blocks begin, 0 included.
  std::vector<std::size_t> find() {
    std::vector<std::size_t> starts{0};
    if (is_shuffled()) return starts;
    std::size_t latest = 0; // the latest event of the block
    for (std::size_t i = 1; i < events_.size(); ++i) {
      if (earlier(events_[i], events_[i - 1]) && begins_block(i, starts.back(), latest))
        starts.push_back(latest = i);
      if (!earlier(events_[i], events_[latest])) latest = i;
    }
    return starts;
  }

private:
  static constexpr std::size_t most_late = 64; // places by which a line may come late

  // If more than a quarter of the steps go back, the log has no order in which to find blocks.
  [[nodiscard]] bool is_shuffled() const {
    std::size_t back = 0;
    for (std::size_t i = 1; i < events_.size(); ++i)
      back += earlier(events_[i], events_[i - 1]) ? 1 : 0;
    return 4 * back > events_.size();
  }

  [[nodiscard]] bool begins_block(std::size_t i, std::size_t first, std::size_t latest) const {
    std::size_t before = i; // the last event that is not later than event i
    while (before > first && i - before < most_late && earlier(events_[i], events_[before - 1]))
      --before;
    // Back to the first eighth of the block: runs of one logger do not begin at exactly the same
    // time.
    const bool far_back = 8 * (before - first) <= i - first + 8 || i - before == most_late;
    return goes_on(i, latest, far_back) && !is_repeated(i, first);
  }

  // Whether at least three events follow in order before the former time is passed by an ordinary
  // step. After a step far back, fewer suffice if the log ends or goes back again.
  [[nodiscard]] bool goes_on(std::size_t i, std::size_t latest, bool far_back) const {
    constexpr std::size_t fewest_rows = 3, sufficient_rows = 16;
    std::size_t end = i + 1;
    while (end < events_.size() && end - i < sufficient_rows &&
           !earlier(events_[end], events_[end - 1]) && earlier(events_[end], events_[latest]))
      ++end;
    const bool goes_back = end < events_.size() && earlier(events_[end], events_[end - 1]);
    if (goes_back && far_back) return true;
    if (end - i < fewest_rows) return false;
    const bool passes = end < events_.size() && !earlier(events_[end], events_[latest]);
    if (!passes) return far_back;
    return events_[end].time - events_[end - 1].time < 1.5 * usual_step_;
  }

  // The next three times all stand earlier in the block.
  [[nodiscard]] bool is_repeated(std::size_t i, std::size_t first) const {
    const auto begin = events_.begin() + static_cast<std::ptrdiff_t>(first),
               end = events_.begin() + static_cast<std::ptrdiff_t>(i);
    return std::all_of(end, std::min(end + 3, events_.end()), [&](const Beat& event) {
      return std::binary_search(begin, end, event, earlier);
    });
  }

  const std::vector<Beat>& events_;
  double usual_step_;
};

// Whether no two blocks overlap in time.
bool are_apart(const std::vector<Beat>& events, const std::vector<std::size_t>& starts) {
  std::vector<std::pair<Instant, Instant>> spans;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const std::size_t end = k + 1 < starts.size() ? starts[k + 1] : events.size();
    const auto [low, high] =
        std::minmax_element(events.begin() + static_cast<std::ptrdiff_t>(starts[k]),
                            events.begin() + static_cast<std::ptrdiff_t>(end), earlier);
    spans.emplace_back(low->time, high->time);
  }
  std::sort(spans.begin(), spans.end());
  return std::adjacent_find(spans.begin(), spans.end(), [](const auto& a, const auto& b) {
           return !(a.second < b.first);
         }) == spans.end();
}

// Sorts each block, with the columns.
void sort_blocks(ClockLog& log, const std::vector<std::size_t>& starts) {
  auto& events = log.events;
  std::vector<std::uint32_t> order(events.size());
  std::iota(order.begin(), order.end(), 0U);
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const std::size_t end = k + 1 < starts.size() ? starts[k + 1] : events.size();
    std::stable_sort(
        order.begin() + static_cast<std::ptrdiff_t>(starts[k]),
        order.begin() + static_cast<std::ptrdiff_t>(end),
        [&](std::uint32_t a, std::uint32_t b) { return earlier(events[a], events[b]); });
  }
  // In place, one cycle of the permutation after the other: a long log has no room for a copy.
  const auto put_in_order = [&](auto& values) {
    std::vector<bool> done(order.size(), false);
    for (std::size_t start = 0; start < order.size(); ++start) {
      if (done[start]) continue;
      const auto first = values[start];
      std::size_t at = start;
      for (; order[at] != start; at = order[at]) {
        values[at] = values[order[at]];
        done[at] = true;
      }
      values[at] = first;
      done[at] = true;
    }
  };
  for (std::vector<double>* column : log.columns.all())
    if (!column->empty()) put_in_order(*column);
  put_in_order(events);
}

// Events equal to the one before in every digit of time and amplitude.
void leave_out_copies(ClockLog& log, IssueList& issues) {
  auto& events = log.events;
  const auto is_same = [](const Beat& a, const Beat& b) {
    const bool same_amplitude = a.amplitude_rad == b.amplitude_rad ||
                                (std::isnan(a.amplitude_rad) && std::isnan(b.amplitude_rad));
    return a.time == b.time && a.edge == b.edge && same_amplitude;
  };
  const auto columns = log.columns.all();
  std::size_t kept = 1;
  for (std::size_t i = 1; i < events.size(); ++i) {
    if (is_same(events[kept - 1], events[i])) {
      issues.add(events[i].line, 1, IssueKind::repeated,
                 fmt::format("the same as line {}", log.place(events[kept - 1].line).line),
                 "copy left out");
      continue;
    }
    for (std::vector<double>* column : columns)
      if (!column->empty()) (*column)[kept] = (*column)[i];
    events[kept++] = events[i];
  }
  for (std::vector<double>* column : columns)
    if (!column->empty()) column->resize(kept);
  events.resize(kept);
}

} // namespace

namespace {

// The date of the oldest value of a grid whose newest line came first; 0 without dates.
Instant oldest_of(const ClockLog& log) {
  const auto& [tau0_s, phase_s] = *log.grid;
  const Beat& first = log.events.front();
  const auto lines = static_cast<double>(first.cycle);
  const Instant newest =
      first.time + (phase_s[static_cast<std::size_t>(first.cycle)] - lines * tau0_s);
  constexpr double years_s = 1e8;
  if (newest.to_double() < years_s) return {};
  return newest + -tau0_s * static_cast<double>(phase_s.size() - 1);
}

} // namespace

void turn_round(ClockLog& log) {
  const Instant begin = log.grid && !log.events.empty() ? oldest_of(log) : Instant{};
  std::reverse(log.events.begin(), log.events.end());
  for (std::vector<double>* column : log.columns.all())
    std::reverse(column->begin(), column->end());
  if (!log.grid) return;
  auto& [tau0_s, phase_s] = *log.grid;
  std::reverse(phase_s.begin(), phase_s.end());
  for (Beat& event : log.events) {
    event.cycle = static_cast<std::int64_t>(phase_s.size()) - 1 - event.cycle;
    const double late = residual_from_grid(Instant{}, Instant{}, event.cycle, tau0_s);
    const Instant elapsed =
        Instant::from_seconds(-late) + -phase_s[static_cast<std::size_t>(event.cycle)];
    event.time = Instant{begin.seconds + elapsed.seconds, elapsed.fraction} + begin.fraction;
  }
}

namespace {

// Labels in order of time, as seconds after the log's first, the clock's errors there, the event of
// each, and the grid to which they are moved.
struct Labels {
  std::vector<double> after_s, errors_s;
  std::vector<std::size_t> event;
  double step_s, begin_s; ///< of the grid
  [[nodiscard]] double place(std::size_t i) const {
    return std::round((after_s[i] - begin_s) / step_s);
  }
  [[nodiscard]] double off_s(std::size_t i) const {
    return after_s[i] - begin_s - place(i) * step_s;
  }
};

// A reading at a time of the grid: on the straight line through readings `before` and the next.
struct Moved {
  std::size_t event, before; ///< the nearest one's; the reading's place among the labels
  double by_s;               ///< what its time is later than that of the nearest
};

// Nothing where no reading is near, unless the grid time lies between two that are three steps
// apart at most, or no farther than those of an evening and the next morning.
std::optional<Moved> reading_at(const Labels& labels, double place) {
  const std::vector<double>& after = labels.after_s;
  const double at_s = labels.begin_s + place * labels.step_s;
  const auto next = std::upper_bound(after.begin(), after.end(), at_s);
  const auto last = static_cast<std::ptrdiff_t>(after.size()) - 2;
  const auto before = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(std::distance(after.begin(), next) - 1, 0, last));
  const bool is_first = std::abs(after[before] - at_s) <= std::abs(after[before + 1] - at_s);
  const std::size_t nearest = is_first ? before : before + 1;
  constexpr double longest_night_s = 57600.0;
  const double gap_s = after[before + 1] - after[before];
  const bool is_between = at_s >= after[before] && at_s <= after[before + 1];
  if (labels.place(nearest) != place && !(is_between && gap_s <= longest_night_s)) return {};
  const double late_s = at_s - after[nearest];
  const double gained_s =
      gap_s > 0.0 ? late_s * (labels.errors_s[before + 1] - labels.errors_s[before]) / gap_s : 0.0;
  return Moved{labels.event[nearest], before, late_s - gained_s};
}

// The step of a grid: a week, a day or another regular interval that the usual step is close to; of
// several readings a day, as many as on a day that has any.
double even_step(const std::vector<double>& after_s, double usual_s) {
  constexpr double day_s = 86400.0, largest_departure = 0.25;
  if (usual_s < 0.5 * day_s && after_s.back() - after_s.front() > 2.0 * day_s) {
    double days = 1.0, begun_s = after_s.front(); // a day ends with a night
    for (const double at_s : after_s)
      if (at_s >= begun_s + 0.75 * day_s) {
        begun_s = at_s;
        ++days;
      }
    return day_s / std::round(static_cast<double>(after_s.size()) / days);
  }
  for (const double step_s : {604800.0, day_s, 43200.0, 21600.0, 3600.0, 1800.0, 600.0, 60.0})
    if (std::abs(usual_s / step_s - 1.0) < largest_departure) return step_s;
  return usual_s;
}

void put_in_place(ClockLog& log, const std::vector<Moved>& readings) {
  const auto take = [&](auto& values) {
    if (values.empty()) return;
    std::remove_reference_t<decltype(values)> taken;
    for (const Moved& moved : readings)
      taken.push_back(values[moved.event]);
    values = std::move(taken);
  };
  take(log.events);
  for (std::vector<double>* column : log.columns.all())
    take(*column);
  for (std::size_t i = 0; i < readings.size(); ++i)
    log.events[i].time = log.events[i].time + readings[i].by_s;
}

// The labels of all events, whatever the order of the lines.
Labels sorted_labels(const std::vector<Beat>& events, std::span<const double> after_s,
                     std::span<const double> errors_s, IssueList& issues) {
  Labels labels{};
  labels.event.resize(events.size());
  std::iota(labels.event.begin(), labels.event.end(), std::size_t{0});
  std::stable_sort(labels.event.begin(), labels.event.end(),
                   [&](std::size_t a, std::size_t b) { return after_s[a] < after_s[b]; });
  for (const std::size_t i : labels.event) {
    labels.after_s.push_back(after_s[i]);
    labels.errors_s.push_back(errors_s[i]);
  }
  for (std::size_t i = 1; i < events.size(); ++i)
    if (after_s[i] < after_s[i - 1])
      issues.add(
          events[i].line, 1, IssueKind::out_of_order,
          fmt::format("a time {:.9g} s before the line above's", after_s[i - 1] - after_s[i]),
          "sorted by time");
  return labels;
}

} // namespace

double level_labels(ClockLog& log, std::span<const double> clock_errors_s, double label_step_s,
                    IssueList& issues) {
  auto& events = log.events;
  if (clock_errors_s.size() != events.size() || events.size() < 2) return label_step_s;
  std::vector<double> after_s;
  for (std::size_t i = 0; i < events.size(); ++i)
    after_s.push_back(events[i].time - events.front().time + clock_errors_s[i] -
                      clock_errors_s.front());
  constexpr double label_grain_s = 2.0; // labels of whole seconds, at either end of a step
  std::size_t uneven = 0;
  for (std::size_t i = 1; i < events.size(); ++i)
    uneven += std::abs(std::remainder(after_s[i] - after_s[i - 1], label_step_s)) > label_grain_s;
  if (2 * uneven <= events.size()) return label_step_s;
  // Times without a date that go back are those of another segment, not lines out of order.
  const bool is_dated = log.origin != TimeOrigin::none;
  if (!is_dated && !std::is_sorted(after_s.begin(), after_s.end())) return label_step_s;
  Labels labels = sorted_labels(events, after_s, clock_errors_s, issues);
  labels.step_s = even_step(labels.after_s, label_step_s);
  for (std::size_t i = 0; i < events.size(); ++i) // the events bear the times of the clock's beats
    log.readings.push_back({events[labels.event[i]].time + labels.errors_s[i], labels.errors_s[i]});
  std::vector<double> off;
  for (std::size_t i = 0; i < events.size(); ++i)
    off.push_back(labels.off_s(i));
  labels.begin_s = median(off);
  std::vector<Moved> readings;
  std::vector<bool> is_used(events.size());
  for (double place = labels.place(0); place <= labels.place(events.size() - 1); ++place)
    if (const auto moved = reading_at(labels, place)) {
      readings.push_back(*moved);
      is_used[moved->before] = is_used[moved->before + 1] = true;
    }
  const auto unused = std::count(is_used.begin(), is_used.end(), false);
  log.assumptions.push_back({fmt::format(
      "readings at uneven times moved to one every {} s, by the straight line between "
      "neighbours{}",
      labels.step_s,
      unused > 0 ? fmt::format("; {} of them not used, being next to none of these", unused)
                 : "")});
  put_in_place(log, readings);
  return labels.step_s;
}

void mend_label_jitter(ClockLog& log, double label_step_s, IssueList& issues) {
  auto& events = log.events;
  // Labels of one second: if they stay wrong for more than a minute, the logger's clock was set.
  constexpr std::size_t longest_run = 60;
  const auto step_is = [&](std::size_t i, double labels) {
    return std::abs((events[i].time - events[i - 1].time) / label_step_s - labels) < 0.5;
  };
  // The end of a run from event i on that `ending` closes, or i if there is none.
  const auto end_of_run = [&](std::size_t i, double ending) {
    for (std::size_t k = i + 1; k < events.size() && k - i <= longest_run; ++k) {
      if (step_is(k, ending)) return k;
      if (!step_is(k, 1.0)) break;
    }
    return i;
  };
  for (std::size_t i = 1; i + 1 < events.size(); ++i) {
    const bool early = step_is(i, 0.0), late = step_is(i, 2.0);
    if (!early && !late) continue;
    const std::size_t end = end_of_run(i, early ? 2.0 : 0.0);
    const double move_s = early ? label_step_s : -label_step_s;
    for (std::size_t k = i; k < end; ++k) {
      events[k].time = events[k].time + move_s;
      issues.add(events[k].line, 1, IssueKind::label_jitter,
                 fmt::format("a label one step {}", early ? "early" : "late"),
                 fmt::format("label moved by {} s", move_s));
    }
    if (end > i) i = end; // the closing step is now correct
  }
}

void restore_order(ClockLog& log, bool dated, IssueList& issues) {
  const auto& events = log.events;
  if (std::is_sorted(events.begin(), events.end(), earlier)) return;
  std::vector<std::size_t> starts = BlockFinder(events).find();
  if (dated && are_apart(events, starts)) starts.resize(1);
  auto start = starts.begin();
  std::size_t latest = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const bool begins = start != starts.end() && *start == i;
    if (begins) ++start;
    if (i > 0 && earlier(events[i], events[latest]))
      issues.add(events[i].line, 1, IssueKind::out_of_order,
                 fmt::format("a time {:.9g} s before an earlier line's",
                             events[latest].time - events[i].time),
                 begins ? "a new segment" : "sorted by time");
    if (begins || !earlier(events[i], events[latest])) latest = i;
  }
  sort_blocks(log, starts);
  leave_out_copies(log, issues);
}

} // namespace goingrate
