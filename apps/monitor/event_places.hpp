// Places the events of a source in the calendar.
#pragma once

#include "archive.hpp"
#include "arrivals.hpp"
#include "moment.hpp"

#include <optional>
#include <vector>

namespace goingrate::apps {

/// How the times of a source are to be placed.
struct PlaceOptions {
  std::optional<Instant> start; ///< when a source without dates counts from
  bool source_is_live = true;   ///< its events are heard as they happen
};

/// Times with dates are taken as they are. Others count from an origin, which is found from the
/// time at which the first events are heard, noted in the archive, and kept as long as the source
/// continues from the stored events.
class EventPlaces {
public:
  using Arrival = Arrivals::Arrival;

  EventPlaces(Archive& archive, const PlaceOptions& options)
      : archive_(archive), options_(options) {}

  /// The first event of a run. Returns the last event stored, with the time that the source would
  /// have given it, if the new event may continue from there. `may_be_read_again`: the source may
  /// repeat stored events.
  std::optional<Beat> meet(const HeardEvent& event, const ClockLog& log, bool may_be_read_again);
  /// Whether the event is stored already, as when a file is read again.
  [[nodiscard]] bool is_stored(const HeardEvent& event, const ClockLog& log);
  /// Seconds that a date of a live source is after the computer's, if it is more than a day from
  /// it: a satellite receiver that does not know the date yet gives a wrong one.
  [[nodiscard]] std::optional<double> date_error_s(const Beat& event, const ClockLog& log,
                                                   const Moment& now) const;
  /// An event that was accepted.
  void add(const Arrival& arrival, const ClockLog& log, const Moment& now);
  [[nodiscard]] bool is_empty() const { return waiting_.empty(); }
  /// Whether more must be heard first: lines that a source wrote before it was listened to come in
  /// a burst, and only the last of them tells the time.
  [[nodiscard]] bool is_in_burst(const ClockLog& log, const Moment& now) const;

  /// The events that were added: with their places, and those that can have none.
  struct Placed {
    std::vector<Arrival> events;      ///< times count from 1970, as the archive keeps them
    std::vector<HeardEvent> left_out; ///< as the source gave them
  };
  /// `heard_at`: when the last event was heard.
  [[nodiscard]] Placed take(const ClockLog& log, const Instant& heard_at, double period_s);

private:
  [[nodiscard]] Instant absolute(const Beat& event, const ClockLog& log) const;
  void choose_origin(const Instant& heard_at, double period_s);

  Archive& archive_;
  PlaceOptions options_;
  /// Whether the computer's calendar was set since the last call.
  [[nodiscard]] bool was_set(const Moment& now);

  bool origin_holds_ = false; // times without a date count from the archive's origin
  bool is_unsure_ = false;    // no event of this run has been accepted yet
  bool skips_stored_ = false;
  std::vector<Arrival> waiting_;
  double waiting_since_s_ = 0.0;
  std::optional<double> wall_less_steady_s_;
  bool goes_on_elsewhere_ = false; // the source continued, but at another place in time
};

} // namespace goingrate::apps
