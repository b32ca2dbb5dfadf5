#include "repairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace goingrate {

namespace {

std::array<std::vector<double>*, 4> all_columns(EventColumns& columns) {
  return {&columns.width_s, &columns.sigma_s, &columns.temperature_c, &columns.pressure_mbar};
}

bool earlier(const Beat& a, const Beat& b) { return a.time < b.time; }

// The order that sorts the events; only made if there are columns to be moved along.
std::vector<std::uint32_t> sorting_order(const std::vector<Beat>& events) {
  std::vector<std::uint32_t> order(events.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return earlier(events[a], events[b]); });
  return order;
}

} // namespace

void turn_round(ClockLog& log) {
  std::reverse(log.events.begin(), log.events.end());
  for (std::vector<double>* column : all_columns(log.columns))
    std::reverse(column->begin(), column->end());
}

void mend_label_jitter(ClockLog& log, double label_step_s, IssueList& issues) {
  auto& events = log.events;
  const auto steps = [&](std::size_t i) {
    return (events[i].time - events[i - 1].time) / label_step_s;
  };
  const auto is_double = [](double step) { return step > 1.5 && step < 2.5; };
  const auto is_none = [](double step) { return std::abs(step) < 0.5; };
  for (std::size_t i = 1; i + 1 < events.size(); ++i) {
    const double before = steps(i), after = steps(i + 1);
    const bool early = is_none(before) && is_double(after);
    const bool late = is_double(before) && is_none(after);
    if (!early && !late) continue;
    events[i].time = events[i].time + (early ? label_step_s : -label_step_s);
    issues.add(events[i].line, 1, IssueKind::label_jitter,
               fmt::format("a label {} step {}", "one", early ? "early" : "late"),
               fmt::format("label moved by {} s", early ? label_step_s : -label_step_s));
  }
}

void restore_order(ClockLog& log, IssueList& issues) {
  auto& events = log.events;
  if (std::is_sorted(events.begin(), events.end(), earlier)) return;
  Instant latest = events.front().time;
  for (const Beat& event : events) {
    if (event.time < latest)
      issues.add(event.line, 1, IssueKind::out_of_order,
                 fmt::format("a time {:.9g} s before an earlier line's", latest - event.time),
                 "sorted by time");
    latest = std::max(latest, event.time);
  }
  const auto columns = all_columns(log.columns);
  if (std::any_of(columns.begin(), columns.end(), [](const auto* c) { return !c->empty(); })) {
    const auto order = sorting_order(events);
    for (std::vector<double>* column : columns) {
      if (column->empty()) continue;
      std::vector<double> sorted;
      sorted.reserve(column->size());
      for (const std::uint32_t i : order)
        sorted.push_back((*column)[i]);
      *column = std::move(sorted);
    }
  }
  std::stable_sort(events.begin(), events.end(), earlier);
}

} // namespace goingrate
