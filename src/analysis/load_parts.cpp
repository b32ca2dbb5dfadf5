// Logs of too many events to be held at once.
#include "loading.hpp"

#include "base/special_values.hpp"
#include "base/workers.hpp"
#include "log/lines.hpp"
#include "log/log_parts.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <utility>

namespace goingrate {

namespace {

// Events that a part has in common with the next; of a shorter part it is a quarter. Half of so
// many tell the period well enough to count the cycles of a long gap.
constexpr std::size_t usual_overlap = 1 << 15;

// The first part, by which the others are read, is so many times as long as they are.
constexpr std::size_t parts_in_first = 4;

// Appends row i to the columns that have `rows` rows, or, as they begin later, none.
void append_row(std::size_t i, EventColumns& from, std::size_t rows, EventColumns& to) {
  const auto of = from.all(), into = to.all();
  for (std::size_t k = 0; k < of.size(); ++k) {
    if (of[k]->empty() && into[k]->empty()) continue;
    into[k]->resize(rows, not_known);
    into[k]->push_back(of[k]->empty() ? not_known : (*of[k])[i]);
  }
}

// What a log says of itself: not its events, nor what was found in reading them.
ClockLog statements_of(const ClockLog& log) {
  ClockLog part;
  part.source = log.source;
  part.format = log.format;
  part.origin = log.origin;
  part.site = log.site;
  part.zone_s = log.zone_s;
  part.time_base_sigma = log.time_base_sigma;
  part.has_amplitude = log.has_amplitude;
  part.directions_are_open = log.directions_are_open;
  part.nominal_period_s = log.nominal_period_s;
  part.flag_width_rad = log.flag_width_rad;
  part.gravity_share = log.gravity_share;
  return part;
}

// Leaves out the events of the lines before this one.
void begin_with_line(std::uint32_t line, ClockLog& part) {
  const auto first = std::find_if(part.events.begin(), part.events.end(),
                                  [&](const Beat& event) { return event.line >= line; });
  const auto count = first - part.events.begin();
  part.events.erase(part.events.begin(), first);
  for (std::vector<double>* column : part.columns.all())
    if (!column->empty()) column->erase(column->begin(), column->begin() + count);
}

// Whether directions were found that the log itself does not tell.
bool has_found_directions(const NumberedLog& part) {
  const auto& beats = part.beats.beats;
  return part.log.directions_are_open &&
         std::any_of(beats.begin(), beats.end(),
                     [](const Beat& beat) { return beat.edge == Edge::down; });
}

// Keeps every k-th beat of those it is given, k being the smallest power of two that leaves no more
// than `most`, and the last.
class ThinnedBeats {
public:
  explicit ThinnedBeats(std::size_t most) : most_(most) {}

  void add(std::size_t i, NumberedLog& part) {
    const Beat& beat = part.beats.beats[i];
    if (is_left_out(beat, part.beats.step)) return;
    if (beats_.size() == most_) thin(part.beats.step);
    if (is_left_out(beat, part.beats.step)) return;
    append_row(i, part.log.columns, beats_.size(), columns_);
    beats_.push_back(beat);
  }
  // The last of all is kept in any case.
  void end_with(std::size_t i, NumberedLog& part) {
    last_ = part.beats.beats[i];
    last_columns_ = {};
    append_row(i, part.log.columns, 0, last_columns_);
  }
  void hand_over(NumberedLog& log) {
    if (last_ && !beats_.empty() && beats_.back().line != last_->line) {
      append_row(0, last_columns_, beats_.size(), columns_);
      beats_.push_back(*last_);
    }
    log.beats.beats = std::move(beats_);
    log.beats.step *= every_;
    log.log.columns = std::move(columns_);
  }
  [[nodiscard]] std::int64_t every() const { return every_; }

private:
  [[nodiscard]] bool is_left_out(const Beat& beat, std::int64_t step) const {
    const std::int64_t number = step == 1 ? beat.cycle : beat.cycle / step; // divisions are slow
    return (number & (every_ - 1)) != 0;
  }

  void thin(std::int64_t step) {
    every_ *= 2;
    EventColumns columns;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < beats_.size(); ++i) {
      if (is_left_out(beats_[i], step)) continue;
      append_row(i, columns_, kept, columns);
      beats_[kept++] = beats_[i];
    }
    beats_.resize(kept);
    columns_ = std::move(columns);
  }

  std::size_t most_;
  std::int64_t every_ = 1;
  std::vector<Beat> beats_;
  EventColumns columns_;
  std::optional<Beat> last_;
  EventColumns last_columns_;
};

// Numbers the parts of a log one after the other, each together with the end of the one before, and
// joins them.
class PartJoiner {
public:
  PartJoiner(LogParts& parts, const LoadRequest& request, const LogVisitor& visit)
      : parts_(parts), request_(request), visit_(visit),
        overlap_(std::min(usual_overlap, request.part_events / parts_in_first / 4)),
        kept_(request.most_beats) {}

  // After the first part was read. While one part is numbered, the next is read.
  NumberedLog run() {
    for (bool is_last = false;;) {
      ClockLog part = take_part(is_last);
      bool ended = true;
      share(is_last ? 1 : 2, [&](std::size_t job) {
        if (job == 1)
          ended = parts_.read(overlap_ + request_.part_events / parts_in_first);
        else
          add(std::move(part), is_last);
      });
      if (is_last) return joined();
      is_last = ended;
    }
  }

private:
  struct Place {
    std::uint32_t line = 0;
    std::int64_t cycle = 0;
    std::uint16_t segment = 0;
  };
  // Difference between the cycles and segments of a part and those of the log.
  struct Shift {
    std::int64_t cycles = 0;
    int segments = 0;
  };

  // Takes the events that were read, and leaves a copy of the last ones for the next part.
  ClockLog take_part(bool is_last) {
    ClockLog& whole = parts_.log();
    if (!is_last) parts_.put_in_order();
    ClockLog part = statements_of(whole);
    EventColumns columns;
    spare_.clear();
    const std::size_t size = whole.events.size();
    for (std::size_t i = is_last ? size : size - std::min(size, overlap_); i < size; ++i) {
      append_row(i, whole.columns, spare_.size(), columns);
      spare_.push_back(whole.events[i]);
    }
    part.events = std::exchange(whole.events, std::move(spare_));
    part.columns = std::exchange(whole.columns, std::move(columns));
    return part;
  }

  void add(ClockLog part, bool is_last) {
    if (first_line_ > 0) begin_with_line(first_line_, part);
    if (last_given_) part.nominal_period_s = request_.reading.nominal_period_s;
    NumberedLog numbered = loaded_from(std::move(part), request_);
    std::vector<Beat>& beats = numbered.beats.beats;
    const std::size_t first = first_fresh(beats);
    const std::size_t held_back = is_last ? 0 : std::min(beats.size(), overlap_ / 2);
    const std::size_t end = std::max(first, beats.size() - held_back);
    if (!last_given_) begin(numbered);
    has_amplitude_ = has_amplitude_ || numbered.log.has_amplitude;
    move_by(shift_of(beats, first), first, numbered);
    take(first, end, numbered);
    if (visit_) visit_({numbered, first, end, parts_.lines_expected()});
    if (alternates_) first_line_ = first_upward_line(beats);
    if (end > 0) last_given_ = beats[end - 1];
    for (std::size_t i = first; i < beats.size(); ++i)
      last_line_ = std::max(last_line_, beats[i].line);
    spare_ = std::move(beats);
  }

  // The event after the last that was given out. Events that were read since and put in order
  // before it came too late to be given out in their place: they count as spurious.
  std::size_t first_fresh(const std::vector<Beat>& beats) {
    if (!last_given_) return 0;
    const auto last = std::find_if(beats.begin(), beats.end(), [&](const Beat& beat) {
      return beat.line == last_given_->line && beat.edge == last_given_->edge;
    });
    if (last == beats.end()) { // left out as a copy of another
      const auto later = std::find_if(beats.begin(), beats.end(),
                                      [&](const Beat& beat) { return beat.line > last_line_; });
      return static_cast<std::size_t>(later - beats.begin());
    }
    result_.beats.spurious += std::count_if(
        beats.begin(), last, [&](const Beat& beat) { return beat.line > last_line_; });
    return static_cast<std::size_t>(last - beats.begin()) + 1;
  }

  // What the first part tells about a log is taken as known for the others.
  void begin(const NumberedLog& first) {
    alternates_ = has_found_directions(first);
    request_.reading.nominal_period_s = first.nominal_period_s;
    request_.both_edges = request_.both_edges || alternates_;
    if (first.sensor.offset_rad) request_.sensor_offset_rad = first.sensor.offset_rad->value;
    request_.find_sensor_offset = false;
    result_.sensor = first.sensor;
    result_.nominal_period_s = first.nominal_period_s;
    result_.nominal_is_known = first.nominal_is_known;
    assumptions_ = first.log.assumptions;
    site_ = first.log.site;
    flag_width_rad_ = first.log.flag_width_rad;
    result_.beats.typical_period_s = first.beats.typical_period_s;
    result_.beats.scatter_s = first.beats.scatter_s;
    result_.beats.longest_countable_gap = first.beats.longest_countable_gap;
    result_.beats.step = first.beats.step;
  }

  // The next part begins with a passage upwards, as the first did.
  [[nodiscard]] std::uint32_t first_upward_line(const std::vector<Beat>& beats) const {
    const auto overlap = static_cast<std::ptrdiff_t>(std::min(beats.size(), overlap_));
    const auto upward = std::find_if(beats.end() - overlap, beats.end(), [](const Beat& beat) {
      return beat.edge == Edge::up && beat.flag != BeatFlag::bounce;
    });
    return upward == beats.end() ? 0 : upward->line;
  }

  // By the last beat that was handed out as good and still is; if there is none, they go on after
  // it as a segment of their own.
  [[nodiscard]] Shift shift_of(const std::vector<Beat>& beats, std::size_t first) const {
    if (places_.empty()) return {};
    auto place = places_.begin(); // the last is the first of them
    for (std::size_t i = first; i-- > 0 && place != places_.end();) {
      while (place != places_.end() && place->line > beats[i].line)
        ++place;
      if (place != places_.end() && place->line == beats[i].line && beats[i].flag == BeatFlag::good)
        return {place->cycle - beats[i].cycle, place->segment - beats[i].segment};
    }
    const Place& last = places_.front();
    const auto good = std::find_if(beats.begin() + static_cast<std::ptrdiff_t>(first), beats.end(),
                                   [](const Beat& beat) { return beat.flag == BeatFlag::good; });
    const Beat& next = good == beats.end() ? beats.back() : *good;
    return {last.cycle + result_.beats.step - next.cycle, last.segment + 1 - next.segment};
  }

  void move_by(const Shift& shift, std::size_t first, NumberedLog& part) const {
    auto& beats = part.beats.beats;
    if (beats.back().segment + shift.segments > std::numeric_limits<std::uint16_t>::max())
      throw InputError({request_.path, beats.back().line, 1},
                       "more than 65536 segments: the beats cannot be followed",
                       "a log with longer steady stretches");
    for (std::size_t i = first; i < beats.size() && (shift.cycles != 0 || shift.segments != 0);
         ++i) {
      beats[i].cycle += shift.cycles;
      beats[i].segment = static_cast<std::uint16_t>(beats[i].segment + shift.segments);
    }
    for (Gap& gap : part.beats.gaps)
      gap.after_cycle += shift.cycles;
  }

  // Counts the events from `first` to before `end`, and keeps some of the beats, and the gaps.
  void take(std::size_t first, std::size_t end, NumberedLog& part) {
    Beats& all = result_.beats;
    const auto& beats = part.beats.beats;
    for (std::size_t i = first; i < end; ++i) {
      const Beat& beat = beats[i];
      all.spurious += beat.flag == BeatFlag::spurious ? 1 : 0;
      all.rivals += beat.flag == BeatFlag::rival ? 1 : 0;
      all.bounces += beat.flag == BeatFlag::bounce ? 1 : 0;
      if (beat.flag != BeatFlag::good) continue;
      if (beat.segment >= crossings_.size()) crossings_.resize(beat.segment + 1U);
      ++crossings_[beat.segment];
      kept_.add(i, part);
    }
    for (std::size_t i = end; i-- > first;)
      if (beats[i].flag == BeatFlag::good) {
        kept_.end_with(i, part);
        break;
      }
    const std::int64_t from =
        places_.empty() ? std::numeric_limits<std::int64_t>::min() : places_.front().cycle;
    remember_places(first, end, beats);
    for (const Gap& gap : part.beats.gaps) {
      if (places_.empty() || gap.after_cycle < from || gap.after_cycle >= places_.front().cycle)
        continue;
      all.gaps.push_back(gap);
      if (gap.bridged) all.missed += gap.length / part.beats.step;
    }
  }

  // Of the last good beats before `end`.
  void remember_places(std::size_t first, std::size_t end, const std::vector<Beat>& beats) {
    constexpr std::size_t most_places = 1000; // some of which are good in the next part too
    std::vector<Place> places;
    for (std::size_t i = end; i-- > first && places.size() < most_places;)
      if (beats[i].flag == BeatFlag::good)
        places.push_back({beats[i].line, beats[i].cycle, beats[i].segment});
    if (!places.empty()) places_ = std::move(places);
  }

  NumberedLog joined() {
    const std::int64_t every = kept_.every();
    result_.log = std::move(parts_.log());
    result_.log.events = {}; // with the memory
    result_.log.has_amplitude = has_amplitude_;
    result_.log.site = site_;
    result_.log.flag_width_rad = flag_width_rad_;
    for (Assumption& assumption : assumptions_)
      result_.log.assumptions.push_back(std::move(assumption));
    kept_.hand_over(result_);
    result_.beats.segments =
        static_cast<std::uint32_t>(std::max<std::size_t>(1, crossings_.size()));
    choose_good(result_);
    result_.sensor.amplitude = summarise_amplitudes(result_.good);
    if (!result_.good.empty()) result_.crossings = crossings_[result_.good.front().segment];
    if (every > 1)
      result_.log.assumptions.push_back({fmt::format(
          "the log is long: what does not use all of its beats uses one in {}", every)});
    return std::move(result_);
  }

  LogParts& parts_;
  LoadRequest request_;
  const LogVisitor& visit_;
  std::size_t overlap_;
  std::vector<Beat> spare_; // memory for the next part
  bool alternates_ = false; // directions do, and the log does not tell them
  bool has_amplitude_ = false;
  std::uint32_t first_line_ = 0, last_line_ = 0; // of the next part; of what was numbered
  std::optional<Beat> last_given_;
  std::vector<Place> places_;           // of the last beats that were handed out, backwards
  std::vector<std::int64_t> crossings_; // good beats of each segment
  ThinnedBeats kept_;
  std::vector<Assumption> assumptions_;
  std::optional<Site> site_;
  std::optional<double> flag_width_rad_;
  NumberedLog result_;
};

} // namespace

NumberedLog load_in_parts(const LoadRequest& request, const LogVisitor& visit) {
  constexpr std::size_t least_part = 1000; // events
  if (request.part_events < least_part)
    throw ArgumentError("part_events", static_cast<double>(request.part_events), "at least 1000");
  LineReader lines(open_source(request.path, request.reading.unpacked_limit), request.path);
  LogParts parts(lines, request.reading);
  // Weather from elsewhere is judged by all events.
  const bool divides = request.weather.files.empty();
  const std::size_t most = divides ? request.part_events : std::numeric_limits<std::size_t>::max();
  if (!parts.read(most)) return PartJoiner(parts, request, visit).run();
  NumberedLog whole = loaded_from(std::move(parts.log()), request);
  if (visit) visit({whole, 0, whole.beats.beats.size(), parts.lines_expected()});
  return whole;
}

} // namespace goingrate
