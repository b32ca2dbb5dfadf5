#include "separators.hpp"

#include "calendar.hpp"
#include "column_names.hpp"

#include <algorithm>
#include <map>

namespace goingrate {

std::size_t count_fields(std::string_view line, char separator) {
  std::vector<Field> fields;
  split_fields(line, separator, fields);
  return fields.size();
}

namespace {

// "12,25", "16:02:04,25" or "24.11.2025 16:02:04,25": a number or a time with a decimal comma.
bool has_decimal_comma(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || comma == 0) return false;
  if (parse_calendar(text, ',')) return true;
  return text.find('.') == std::string_view::npos && parse_number(text, ',').has_value();
}

// "12.25" or "16:02:04.25": a decimal point, which the points of a date are not.
bool has_decimal_point(std::string_view text) {
  if (text.find(',') != std::string_view::npos) return false;
  const std::size_t colon = text.rfind(':');
  const std::string_view last = colon == std::string_view::npos ? text : text.substr(colon + 1);
  return last.find('.') != std::string_view::npos &&
         (parse_number(text) || (colon != std::string_view::npos && parse_calendar(text)));
}

bool any_digit(std::string_view line) {
  return line.find_first_of("0123456789") != std::string_view::npos;
}

// Whether nine in ten lines with digits are cut into the same number of fields.
bool cuts_alike(const std::vector<HeadLine>& lines, char separator) {
  std::map<std::size_t, std::size_t> counts;
  std::size_t all = 0, most = 0;
  for (const HeadLine& line : lines) {
    if (!any_digit(line.text)) continue;
    ++all;
    most = std::max(most, ++counts[count_fields(line.text, separator)]);
  }
  return most * 10 >= all * 9;
}

std::string_view without_blanks_behind(std::string_view line) {
  const std::size_t last = line.find_last_not_of(" \t");
  return line.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

// Whether the lines are times that blanks would cut elsewhere than between a date and a time of
// day: AM or PM or a zone stand behind, or the month is named.
bool are_whole_times(const std::vector<HeadLine>& lines) {
  std::size_t whole = 0, all = 0;
  for (const HeadLine& line : lines) {
    if (!any_digit(line.text)) continue;
    ++all;
    const std::string_view text = without_blanks_behind(line.text);
    const bool has_half = text.find_first_of("Mm") != text.npos;
    const bool is_cut = has_half || count_fields(text, ' ') > 2;
    whole += is_cut && (parse_calendar(text) || parse_calendar(text, ',')) ? 1 : 0;
  }
  return whole * 10 >= all * 9 && whole > 0;
}

// The first separator that cuts most lines into two or more.
char find_separator(const std::vector<HeadLine>& lines) {
  for (const char candidate : {'\t', ';', ',', '|'}) {
    std::size_t with = 0, all = 0;
    for (const HeadLine& line : lines) {
      if (!any_digit(line.text)) continue;
      ++all;
      with += count_fields(without_blanks_behind(line.text), candidate) >= 2 ? 1 : 0;
    }
    if (all == 0 || with * 10 < all * 9) continue;
    const bool mixed = // tabs here, blanks there
        candidate == '\t' && !cuts_alike(lines, candidate) && cuts_alike(lines, ' ');
    return mixed ? ' ' : candidate;
  }
  return are_whole_times(lines) ? '|' : ' ';
}

bool names_a_role(const Field& field) {
  return column_named(field.text).column.role != ColumnRole::ignored;
}

// The text in front of an exponent: "234" of "234E-05".
std::string_view mantissa(std::string_view text) {
  return text.substr(0, text.find_first_of("eE"));
}

bool are_digits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// Whether a header is the known name of one column: no separator cuts it, and blanks do not cut it
// into two names that are known.
bool is_one_name(std::string_view header) {
  for (const char separator : {'\t', ';', ',', '|'})
    if (count_fields(header, separator) > 1) return false;
  std::vector<Field> words;
  split_fields(header, ' ', words);
  const bool is_known = column_named(header).column.role != ColumnRole::ignored;
  return is_known && (words.size() != 2 || !names_a_role(words[0]) || !names_a_role(words[1]));
}

bool is_all_value(std::string_view line) {
  std::vector<Field> whole;
  split_fields(line, '\n', whole);
  const std::string_view text = whole.front().text;
  return has_decimal_comma(text) || parse_number(text) || parse_calendar(text);
}

// A header of one name over lines that a comma cuts in two: the lines are one number each. Whole
// numbers, whose zeros were left out, may stand between them.
bool one_name_stands_over_pairs(const std::vector<HeadLine>& lines) {
  const auto first = std::find_if(lines.begin(), lines.end(),
                                  [](const HeadLine& line) { return is_all_value(line.text); });
  if (first == lines.begin() || first == lines.end() || !is_one_name(std::prev(first)->text))
    return false;
  const auto rows = static_cast<std::size_t>(lines.end() - first);
  const auto values = static_cast<std::size_t>(std::count_if(
      first, lines.end(), [](const HeadLine& line) { return is_all_value(line.text); }));
  constexpr std::size_t fewest_rows = 3;
  return rows >= fewest_rows && values * 10 >= rows * 9;
}

// A comma that cuts every line into two whole numbers, the second of always the same length, stands
// for a decimal point; unless a header names two columns.
bool pairs_are_of_one_length(const std::vector<HeadLine>& lines) {
  std::size_t length = 0, rows = 0;
  for (const HeadLine& line : lines) {
    std::vector<Field> fields;
    split_fields(line.text, ',', fields);
    if (rows == 0 && !any_digit(line.text) && fields.size() == 1) continue; // a title
    if (fields.size() != 2) return false;
    const std::string_view whole = fields[0].text, decimals = mantissa(fields[1].text);
    const bool is_row =
        parse_number(fields[1].text) && are_digits(decimals) &&
        (are_digits(whole.substr(whole.starts_with('-') ? 1 : 0)) || parse_calendar(whole));
    if (!is_row) {
      const bool two_names = names_a_role(fields[0]) && names_a_role(fields[1]);
      if (rows == 0 && !two_names) continue; // a header
      return false;
    }
    if (rows++ == 0) length = decimals.size();
    if (decimals.size() != length) return false;
  }
  return rows >= 3 && length >= 3;
}

bool comma_is_point(const std::vector<HeadLine>& lines) {
  return one_name_stands_over_pairs(lines) || pairs_are_of_one_length(lines);
}

} // namespace

void settle_separators(LogHead& head, const std::vector<HeadLine>& lines, bool decimal_comma) {
  head.separator = find_separator(lines);
  if (decimal_comma) head.point = ',';
  if (head.separator == ',') {
    head.comma_was_guessed = !decimal_comma && comma_is_point(lines);
    if (decimal_comma || head.comma_was_guessed) {
      head.point = ',';
      head.separator = ' ';
    }
    return;
  }
  std::size_t commas = 0, points = 0;
  for (const HeadLine& line : lines) {
    std::vector<Field> fields;
    split_fields(line.text, head.separator, fields);
    for (const Field& field : fields) {
      commas += has_decimal_comma(field.text) ? 1 : 0;
      points += has_decimal_point(field.text) ? 1 : 0;
    }
  }
  if (decimal_comma || commas <= points) return;
  head.point = ',';
  head.comma_was_guessed = true;
}

} // namespace goingrate
