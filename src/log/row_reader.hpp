// Turns lines into events, by a known layout.
#pragma once

#include "calendar.hpp"
#include "fields.hpp"
#include "issue_list.hpp"
#include "lines.hpp"
#include "unwrapper.hpp"
#include "weather_quantities.hpp"

#include "goingrate/base/sums.hpp"
#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/reading.hpp"
#include "log/angle_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace goingrate {

/// Reads lines, one after the other, into `log.events` and its columns, or into samples().
class RowReader {
public:
  RowReader(const Layout& layout, const ReadingOptions& options, ClockLog& log);

  /// Makes room for the events or samples of `lines` lines.
  void reserve(std::size_t lines);
  void add(const Line& line);

  struct Taken {
    std::size_t bytes = 0;
    std::uint32_t lines = 0;
  };
  /// Adds the lines at the beginning of `text` up to the first that is not just a good time in
  /// seconds, or a good phase, as nearly all lines of most logs are. `number` is that of the first
  /// line. Has the same effect as add() for each line, but is faster. Adds nothing unless the log
  /// has only that column.
  Taken add_plain(std::string_view text, std::uint32_t number);
  /// Tells the reader that another text of the same layout follows, whose data begin in this line.
  void begin_anew(std::uint32_t first_line) { layout_.first_line = first_line; }
  /// Makes what `before` read of the same log, with another layout, count as read by this reader.
  void go_on_from(const RowReader& before);
  /// Reports what can be reported only at the end.
  void finish();

  [[nodiscard]] const std::vector<AngleSample>& samples() const { return samples_; }
  /// One per sample, where the log has the position of the bob; else empty.
  [[nodiscard]] const std::vector<double>& heights() const { return heights_; }
  /// The clock's error, s, at each event; empty unless the log is one of labels and errors.
  [[nodiscard]] std::vector<double>& clock_errors() { return clock_errors_; }
  /// Events that are in the log at present.
  [[nodiscard]] std::size_t events() const { return log_.events.size(); }
  /// Lines that should have held data, and those of them that gave nothing.
  [[nodiscard]] std::size_t data_lines() const { return data_lines_; }
  [[nodiscard]] std::size_t rejected() const { return rejected_; }
  /// Whether no event came before an earlier one.
  [[nodiscard]] bool in_order() const { return in_order_; }
  /// Lines of channels that are not read.
  [[nodiscard]] std::size_t other_channels() const { return other_channels_; }

private:
  using Place = std::optional<std::size_t>;       // the column of a role
  static constexpr double longest_period_s = 1e6; // no pendulum takes so long
  static constexpr std::size_t events_of_phases_alone = 3; // so many show that there are values
  // Thirty years: a clock that is further off was never set.
  static bool is_possible_error(double error_s) { return std::abs(error_s) < 1e9; }

  Taken add_plain_times(std::string_view text, std::uint32_t number);
  Taken add_plain_phases(std::string_view text, std::uint32_t number);
  void reject(const Line& line, std::size_t column, IssueKind kind, std::string found);
  void reject_field(const Line& line, const Field& field, std::string_view expected);
  [[nodiscard]] bool only_a_comment(const Line& line) const;
  bool row_fits(const Line& line);

  // Times (row_times.cpp). Each rejects the line and returns nothing if there is no time.
  std::optional<Instant> time_of(const Line& line);
  std::optional<Instant> written_time(const Line& line);
  std::optional<Instant> accumulated_time(const Line& line, std::size_t column);
  Instant pause_before(const Instant& period);
  void wait(const Instant& interval);
  [[nodiscard]] Instant accumulated() const;
  void begin_grid();
  void add_phase(std::uint32_t line, double error_s);
  void add_on_grid(const Line& line, std::size_t column);
  void leave_place(const Line& line, std::size_t column, IssueKind kind, std::string found);
  // Intervals of a light gate, s, as gate_intervals orders them (gate_rows.cpp).
  using Oscillation = std::array<double, 4>;
  void add_oscillation(const Line& line);
  void pass_oscillation();
  [[nodiscard]] bool is_begun_row() const;
  std::optional<Oscillation> oscillation_at(const Line& line);
  double counter_rate_at(const Line& line);

  [[nodiscard]] Field time_field();
  [[nodiscard]] DateOrder date_order() const;
  [[nodiscard]] std::string_view expected_time(std::string_view text) const;
  std::optional<Instant> parsed_time(std::string_view text);
  [[nodiscard]] bool is_sentinel(std::string_view text, const Instant& time) const;
  bool is_cut_short(const Line& line, std::string_view text);
  [[nodiscard]] std::optional<Instant> time_before(std::size_t back) const;
  [[nodiscard]] double typical_step_s() const;

  // The other columns: NaN where there is nothing to read.
  double number_at(const Line& line, const Place& place, std::string_view expected);
  bool is_mark(std::size_t column, std::string_view text, double value);
  double amplitude_at(const Line& line);
  bool read_edge(const Line& line, Beat& beat);

  void add_sample(const Line& line, const Instant& time);
  void accept(const Line& line, Beat beat);
  void push(const Beat& beat);
  void append(const Line& line, const Beat& beat, double width_s);
  void accept_gate_edge(const Line& line, const Beat& beat, bool enters);

  Layout layout_;
  ClockLog& log_;
  IssueList issues_;
  Unwrapper unwrap_;
  Place time_, date_, period_, half_period_, error_, phase_, frequency_, amplitude_, angle_, height_,
      width_, edge_, channel_;
  std::array<Place, weather_quantities.size()> weather_;
  struct Range {
    double least = 0.0, most = 0.0;
    std::size_t values = 0;
    void widen_to(double value) {
      least = values == 0 ? value : std::min(least, value);
      most = values == 0 ? value : std::max(most, value);
      ++values;
    }
  };
  std::vector<Range> ranges_; // of each column's values so far
  std::vector<Field> fields_;
  std::string date_and_time_; // of two columns, or of a date alone and midnight
  double zone_s_;             // of dates that name none, east of Greenwich
  std::vector<AngleSample> samples_;
  std::vector<double> heights_;
  std::vector<double> clock_errors_;
  double clock_error_s_ = 0.0; // of the line at hand
  std::size_t data_lines_ = 0, rejected_ = 0, other_channels_ = 0;
  std::size_t time_length_ = 0; // of the text of the time in the line before
  std::int64_t row_ = 0;        // of half-periods
  std::int64_t whole_s_ = 0;    // what was accumulated: whole seconds and the rest
  TwoPart<double> part_s_{};
  double last_period_s_ = 0.0;
  Instant grid_begin_; // where its values have dates
  std::optional<Oscillation> oscillation_; // of the row before
  std::optional<Instant> stamp_; // the coarse time of the line before
  bool gate_state_;              // the column of edges says whether the flag is in the gate
  bool days_alone_;              // the times are dates without a time of day
  bool phases_alone_;            // a grid needs no events
  bool plain_;                   // nothing but seconds, one number per line
  bool in_order_ = true;
  std::optional<Beat> entered_; // the first of a gate's two edges
};

} // namespace goingrate
