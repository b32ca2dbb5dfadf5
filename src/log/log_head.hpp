// The beginning of a log, cut into comments, header and rows, for recognising its layout.
#pragma once

#include "calendar.hpp"
#include "fields.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// One line of the head.
struct HeadLine {
  std::string_view text;
  std::uint32_t number = 0;
};

/// Statistics of the values of one column over the rows of the head.
struct ColumnSample {
  std::size_t numbers = 0;   ///< rows with a number
  std::size_t calendars = 0; ///< rows with a date or a time of day
  std::size_t dates = 0;     ///< rows with a date alone
  std::size_t edges = 0;     ///< rows with a word for a direction: "tick", "down"
  std::size_t rows = 0;
  bool whole = true; ///< all numbers without decimals
  bool has_date = false;
  bool even = false;         ///< all steps are of one size
  double rising = 0.0;       ///< share of the steps that go up
  double falling = 0.0;      ///< share of those that go down
  double typical_step = 0.0; ///< median size of a step that is not zero
  double median = 0.0;
  double spread = 0.0; ///< median absolute deviation from the median
  double least = 0.0, most = 0.0;
  std::size_t crossings = 0; ///< changes of sign about the middle of the range
  bool smooth = false;       ///< neighbours are alike, as samples of a swing are
};

/// Where the dates of a log stand.
struct DateColumns {
  std::size_t time = 0;              ///< of the times of day, or of dates with them
  std::optional<std::size_t> date{}; ///< of the dates, if they have a column of their own
  bool days_alone = false;           ///< `time` holds dates without a time of day
};

struct LogHead {
  std::vector<HeadLine> comments; ///< '#' or '%' lines before and among the data
  std::vector<HeadLine> titles;   ///< other lines before the data
  std::vector<HeadLine> rows;     ///< lines of data
  char separator = ' ';
  char point = '.';
  bool comma_was_guessed = false;
  std::size_t columns = 0;        ///< of most rows
  std::vector<std::string> names; ///< of the columns, where the head has them; else empty

  /// The fields of the first row that has all columns.
  [[nodiscard]] std::vector<Field> whole_row() const;
  /// The value of the comment "key: value"; nothing if there is none.
  [[nodiscard]] std::optional<std::string_view> value_of(std::string_view key) const;
  [[nodiscard]] ColumnSample sample(std::size_t column) const;
  /// The same of dates, whose day and month come in a known order.
  [[nodiscard]] ColumnSample sample_of_dates(const DateColumns& from, DateOrder order) const;
};

/// Cuts `text`; unless it is `whole`, its last line may be incomplete and is then left out. With
/// `decimal_comma` the comma is known to be the decimal point; otherwise that is worked out. Throws
/// InputError for text that is empty, binary or UTF-16, has no line of data, or too many columns.
LogHead cut_head(std::string_view text, bool whole, const std::string& source, bool decimal_comma);

} // namespace goingrate
