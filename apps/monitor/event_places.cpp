#include "event_places.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace goingrate::apps {

namespace {

bool has_dates(const ClockLog& log) { return log.origin != TimeOrigin::none; }

Instant as_stored_at(const Instant& time, const EventValues& values = {}) {
  return as_stored({event_at(time), values}).time;
}

// The source's own second 0, if it told `event` at that time.
Instant origin_for(const Beat& event, const Instant& at) {
  return Instant{at.seconds - event.time.seconds, 0.0} + (at.fraction - event.time.fraction);
}

} // namespace

Instant EventPlaces::absolute(const Beat& event, const ClockLog& log) const {
  if (has_dates(log))
    return {event.time.seconds - seconds_before_1970(log.origin), event.time.fraction};
  const Instant origin = *archive_.origin();
  return Instant{event.time.seconds + origin.seconds, event.time.fraction} + origin.fraction;
}

std::optional<Beat> EventPlaces::meet(const HeardEvent& event, const ClockLog& log,
                                      bool may_be_read_again) {
  const auto last_stored = archive_.last_time();
  if (!last_stored || (!has_dates(log) && !archive_.origin())) return {};
  const Instant at = as_stored_at(absolute(event, log), event.values);
  origin_holds_ = true;
  is_unsure_ = !has_dates(log) && options_.source_is_live;
  skips_stored_ = may_be_read_again && !(at > *last_stored) && archive_.holds(at);
  Beat last = event;
  last.time = event.time + (*last_stored - at);
  last.edge = archive_.last_edge();
  return last;
}

bool EventPlaces::is_stored(const HeardEvent& event, const ClockLog& log) {
  skips_stored_ =
      skips_stored_ && !(as_stored_at(absolute(event, log), event.values) > *archive_.last_time());
  return skips_stored_;
}

std::optional<double> EventPlaces::date_error_s(const Beat& event, const ClockLog& log,
                                                const Moment& now) const {
  constexpr double a_day_s = 86400.0; // more than any time zone
  if (!has_dates(log) || !options_.source_is_live) return {};
  const double error_s = absolute(event, log) - now.wall;
  return std::abs(error_s) > a_day_s ? std::optional(error_s) : std::nullopt;
}

bool EventPlaces::was_set(const Moment& now) {
  constexpr double rounding_s = 0.01; // NTP sets a clock that is off by more than 0.128 s
  const double difference_s = now.wall_less_steady_s();
  const bool was =
      wall_less_steady_s_ && std::abs(difference_s - *wall_less_steady_s_) > rounding_s;
  wall_less_steady_s_ = difference_s;
  return was;
}

void EventPlaces::add(const Arrival& arrival, const ClockLog& log, const Moment& now) {
  // No source drifts by an hour: either it was restarted while no monitor ran, or the computer's
  // calendar was corrected.
  constexpr double longest_drift_s = 3600.0;
  const bool was = was_set(now), is_placed = !has_dates(log) && origin_holds_;
  const bool is_unsure =
      std::exchange(is_unsure_, false) || (was && is_placed && options_.source_is_live);
  const bool is_elsewhere =
      is_unsure && std::abs(now.wall - absolute(arrival.event, log)) > longest_drift_s;
  if (arrival.begins_anew || is_elsewhere) origin_holds_ = false;
  if (was && is_elsewhere) goes_on_elsewhere_ = true;
  if (waiting_.empty()) waiting_since_s_ = now.steady_s;
  waiting_.push_back(arrival);
}

bool EventPlaces::is_in_burst(const ClockLog& log, const Moment& now) const {
  constexpr double longest_burst_s = 0.2; // a beat takes longer
  return !has_dates(log) && !origin_holds_ && options_.source_is_live && !options_.start &&
         now.steady_s - waiting_since_s_ < longest_burst_s;
}

// Places the last event when it was heard, or the first one at `start`; not before what is stored.
void EventPlaces::choose_origin(const Instant& heard_at, double period_s) {
  Instant origin = origin_for(waiting_.back().event, heard_at);
  if (!archive_.origin() && options_.start) origin = *options_.start;
  const Beat& first = waiting_.front().event;
  const auto last_stored = archive_.last_time();
  if (last_stored && !(origin_for(first, *last_stored) < origin))
    origin = origin_for(first, *last_stored + period_s);
  archive_.set_origin(as_stored_at(origin)); // as a later run will read it
  origin_holds_ = true;
}

EventPlaces::Placed EventPlaces::take(const ClockLog& log, const Instant& heard_at,
                                      double period_s) {
  Placed placed;
  if (waiting_.empty()) return placed;
  if (!has_dates(log) && !origin_holds_) {
    // If the source was restarted in between, the times of the events before that cannot be known.
    const auto anew = std::find_if(waiting_.rbegin(), waiting_.rend(),
                                   [](const Arrival& arrival) { return arrival.begins_anew; });
    if (anew != waiting_.rend()) {
      const auto first = std::prev(anew.base());
      for (auto arrival = waiting_.begin(); arrival != first; ++arrival)
        placed.left_out.push_back(arrival->event);
      waiting_.erase(waiting_.begin(), first);
    }
    choose_origin(heard_at, period_s);
  }
  for (const Arrival& arrival : waiting_) {
    HeardEvent event = arrival.event;
    event.time = absolute(arrival.event, log);
    constexpr std::int64_t latest_s = 9'223'372'036; // in the year 2262
    if (event.time.seconds < 0 || event.time.seconds > latest_s)
      placed.left_out.push_back(arrival.event);
    else
      placed.events.push_back({as_stored(event), (has_dates(log) && arrival.begins_anew) ||
                                                     std::exchange(goes_on_elsewhere_, false)});
  }
  waiting_.clear();
  return placed;
}

} // namespace goingrate::apps
