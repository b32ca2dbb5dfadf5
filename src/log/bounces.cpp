// Contact bounce: several events for one edge.
#include "beat_noise.hpp"
#include "typical_period.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/log/beats.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <vector>

namespace goingrate {

namespace {

// Median of the intervals, weighted by their length. Bounces take up almost none of the time,
// however many there are, and so hardly affect it.
double usual_interval(std::span<const Beat> events) {
  std::vector<double> intervals;
  double sum = 0.0;
  for (const Stretch& stretch : sample_stretches(events.size()))
    for (std::size_t i = stretch.first + 1; i < stretch.last; ++i) {
      const double interval = events[i].time - events[i - 1].time;
      if (!(interval > 0.0)) continue;
      intervals.push_back(interval);
      sum += interval;
    }
  std::sort(intervals.begin(), intervals.end());
  double passed = 0.0;
  for (const double interval : intervals)
    if ((passed += interval) >= 0.5 * sum) return interval;
  return 0.0;
}

// Calls `take` for each event within `dead_time_s` of an edge, with the time since that edge. An
// edge is the first event after such a dead time.
template <class Take> void for_each_bounce(std::span<Beat> events, double dead_time_s, Take take) {
  const Beat* edge = nullptr;
  for (Beat& event : events) {
    const double since = edge == nullptr ? -1.0 : event.time - edge->time;
    if (since >= 0.0 && since <= dead_time_s)
      take(event, since);
    else
      edge = &event;
  }
}

// The dead time that covers the bounces, or 0 if there are none. False events are equally frequent
// in both halves of the time examined, so the number in the second half is subtracted from the
// first.
double found_dead_time(std::span<Beat> events) {
  constexpr double looked_at_share = 0.1;   // of the usual interval
  constexpr double longest_s = 0.1;         // no contact bounces for longer
  constexpr std::size_t fewest_bounces = 5; // fewer may be chance
  const double reach = std::min(looked_at_share * usual_interval(events), longest_s);
  std::vector<double> early;
  std::size_t late = 0;
  constexpr std::size_t sample = 100'000; // events: bounces may be few
  for (const Stretch& stretch : sample_stretches(events.size(), sample))
    for_each_bounce(events.subspan(stretch.first, stretch.size()), reach,
                    [&](const Beat&, double since) {
                      if (since < 0.5 * reach)
                        early.push_back(since);
                      else
                        ++late;
                    });
  // So many events lie in a tenth of the time that, if they were false ones spread evenly, each
  // beat would have several.
  const bool crowded = 3 * (early.size() + late) > events.size();
  if (early.size() < fewest_bounces || (early.size() <= 4 * late && !crowded)) return 0.0;
  if (early.size() <= 4 * late) return reach;
  std::sort(early.begin(), early.end());
  constexpr double margin = 1.2; // longer bounces may occur outside the sample
  return margin * early[early.size() - 1 - late];
}

// The jitter of single times, s, from second differences of every other edge, in which a beat error
// cancels; 0 with too few edges.
double jitter_of(std::span<const Beat> edges) {
  std::vector<double> pairs;
  for (std::size_t i = 2; i < edges.size(); ++i)
    pairs.push_back(edges[i].time - edges[i - 2].time);
  if (pairs.size() < 3) return 0.0;
  std::vector<double> sorted = pairs;
  const double usual = median(sorted);
  const auto is_usual = [&](double pair) { return std::abs(pair - usual) < 0.1 * usual; };
  std::vector<double> second;
  for (std::size_t i = 2; i < pairs.size(); ++i)
    if (is_usual(pairs[i]) && is_usual(pairs[i - 2])) second.push_back(pairs[i] - pairs[i - 2]);
  return second.empty() ? 0.0 : std::sqrt(trimmed_mean_square(second) / 6.0);
}

// Whether the jitter is comparable with the dead time, so that the first edge need not be the beat,
// while few edges bounce and mostly by one event. The numbering then decides which of the two
// events is the more likely beat.
bool hides_in_jitter(std::span<const Beat> events, double dead_time_s) {
  std::vector<Beat> edges(events.begin(), events.end());
  std::size_t bounces = 0, bouncing = 0; // events, and the edges that they follow
  const Beat* before = nullptr;
  for_each_bounce(edges, dead_time_s, [&](Beat& event, double) {
    bouncing += before == nullptr || &event != before + 1 ? 1 : 0;
    before = &event;
    event.flag = BeatFlag::bounce;
    ++bounces;
  });
  std::erase_if(edges, [](const Beat& event) { return event.flag == BeatFlag::bounce; });
  const bool few = 4 * bounces < edges.size(), single = bounces < 2 * bouncing;
  if (!few || !single || edges.size() < 3) return false;
  constexpr double jitter_share = 0.05; // of the dead time: two sigmas are a tenth of it
  return jitter_of(edges) > jitter_share * dead_time_s;
}

// Whether the dead time would remove most crossings of one direction: near the turning point, the
// pendulum enters and leaves a light beam within a short time.
bool takes_a_direction(std::span<Beat> events, double dead_time_s) {
  std::size_t all[2] = {0, 0}, gone[2] = {0, 0};
  for (const Beat& event : events)
    ++all[event.edge == Edge::up ? 0 : 1];
  for_each_bounce(events, dead_time_s,
                  [&](const Beat& event, double) { ++gone[event.edge == Edge::up ? 0 : 1]; });
  return all[1] > 0 && (2 * gone[0] > all[0]) != (2 * gone[1] > all[1]);
}

} // namespace

double mark_bounces(ClockLog& log, std::optional<double> dead_time_s) {
  if (dead_time_s && !(*dead_time_s >= 0.0))
    throw ArgumentError("dead-time", *dead_time_s, "seconds from 0 on");
  const std::span<Beat> events(log.events);
  double dead_time = dead_time_s.value_or(0.0);
  if (!dead_time_s) {
    dead_time = found_dead_time(events);
    if (dead_time > 0.0 &&
        (takes_a_direction(events, dead_time) || hides_in_jitter(events, dead_time)))
      return 0.0;
  }
  if (dead_time == 0.0) return 0.0;
  std::size_t count = 0;
  for_each_bounce(events, dead_time, [&](Beat& event, double) {
    event.flag = BeatFlag::bounce;
    ++count;
  });
  if (count > 0)
    log.assumptions.push_back({fmt::format(
        "{} event{} within {:.2g} s of the one before {} part of it: the contact bounces, "
        "and the first edge is the beat",
        count, count == 1 ? "" : "s", dead_time, count == 1 ? "is" : "are")});
  return dead_time;
}

} // namespace goingrate
