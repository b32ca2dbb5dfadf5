// The steps by which the layout of a log is found. Private to layout_detection and its parts.
#pragma once

#include "calendar.hpp"
#include "layout_detection.hpp"

#include <optional>
#include <string>
#include <vector>

namespace goingrate {

/// The unit in which a beat takes between 0.01 s and 100 s, with narrower limits for other units
/// than seconds. Samples of an angle may be closer together.
std::optional<TimeUnit> unit_for_step(double step, const ColumnSample& sample);

/// Whether most of a column's numbers go one way, as times do.
bool is_steady(const ColumnSample& sample);

/// The layout of one log while it is being found. What comes from the names of columns is in
/// layout_detection.cpp, where the lines have a say in it in named_columns.cpp, what comes from the
/// lines alone in format_recognition.cpp, units and the check of times in column_units.cpp.
class Detection {
public:
  Detection(const LogHead& head, const ReadingOptions& options, ClockLog& log)
      : head_(head), options_(options), log_(log), first_(head.whole_row()) {
    layout_.separator = head.separator;
    layout_.point = head.point;
    layout_.first_line = head.rows.front().number;
    layout_.columns.resize(head.columns);
    names_ = head.names;
    samples_.reserve(head.columns);
    for (std::size_t i = 0; i < head.columns; ++i)
      samples_.push_back(head.sample(i));
  }

  /// Takes all steps; to be called once.
  Layout run();

private:
  void assume(std::string text, Setting setting = Setting::none, std::string value = {}) {
    log_.assumptions.push_back({std::move(text), setting, std::move(value)});
  }
  [[nodiscard]] bool is_number(std::size_t column) const {
    return column < samples_.size() && samples_[column].numbers * 2 > samples_[column].rows;
  }
  [[nodiscard]] bool is_calendar(std::size_t column) const {
    if (column >= samples_.size()) return false;
    return samples_[column].calendars * 2 > samples_[column].rows ||
           // Invalid dates further on are left to the reader, which reports their place.
           (column == 0 && !is_number(0) && parse_calendar(first_[0].text, layout_.point));
  }
  [[nodiscard]] bool are_days(std::size_t column) const {
    return column < samples_.size() && samples_[column].dates * 2 > samples_[column].rows;
  }
  [[nodiscard]] bool is_edge(std::size_t column) const {
    return column < samples_.size() && samples_[column].edges * 2 > samples_[column].rows;
  }
  void set(std::size_t column, ColumnRole role, double scale = 1.0) {
    layout_.columns[column].role = role;
    layout_.columns[column].scale = scale;
  }

  Layout weather();
  bool read_names();
  void settle_dates();
  void sample_dates(std::size_t time);
  [[nodiscard]] std::optional<std::size_t> named_days() const;
  [[nodiscard]] bool lacks_its_role() const;
  bool settle_dated_phases();
  void refuse_double_commas() const;
  std::size_t settle_gate_state();
  [[nodiscard]] bool is_covered_at_one(std::size_t time, std::size_t state) const;
  void settle_named_periods();
  void leave_out(std::size_t column);
  [[nodiscard]] bool has_intervals() const;
  [[nodiscard]] bool is_timed() const;
  std::size_t settle_intervals();
  void settle_counter();
  [[nodiscard]] LogFormat format_of_names() const;
  [[nodiscard]] LogFormat format_of_contents() const;
  [[nodiscard]] LogFormat format_of_one_column() const;
  /// Whether a column's numbers are of one size, and that of a period.
  [[nodiscard]] bool are_alike(const ColumnSample& sample) const;
  [[nodiscard]] bool looks_like_clock_error() const;
  [[nodiscard]] bool has_date_in_front() const;
  void fill_columns(bool named);
  void fill_time();
  void check_needed_columns();
  [[nodiscard]] std::optional<OtherReading> likely_timing() const;
  void settle_times();
  void settle_date_order(std::size_t column);
  [[nodiscard]] bool unit_is_given(ColumnRole role) const;
  void settle_unit(LogColumn& column, const ColumnSample& sample);
  void refuse_other_unit(const LogColumn& column, double step) const;
  void settle_angle_unit();
  void settle_weather_units();
  void settle_tau0();
  void refuse_fast_counter(const ColumnSample& sample) const;
  void refuse_what_was_not_measured(std::size_t time) const;
  void refuse_unread_samples(std::size_t time) const;
  void say_which_time();

  const LogHead& head_;
  const ReadingOptions& options_;
  ClockLog& log_;
  std::vector<Field> first_; // a row that has all columns
  std::vector<ColumnSample> samples_;
  bool days_alone_ = false;        // the times are dates without a time of day
  std::vector<std::string> names_; // of the columns, where the head has them
  std::vector<bool> stated_unit_;
  Layout layout_;
};

} // namespace goingrate
