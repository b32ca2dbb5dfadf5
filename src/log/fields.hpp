// Cuts lines into fields, and reads fields as numbers.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// One field of a line, without blanks and quotes around it; a field after the first also without a
/// key: "t=12.5" is 12.5.
struct Field {
  std::string_view text;
  std::size_t column = 1; ///< from 1
};

/// More than any logger writes; this many fields of a line and one more are kept, the rest is
/// dropped, since a field takes more memory than its separator.
constexpr std::size_t most_fields = 256;

/// Cuts `line` at each `separator` outside quotes, or, for ' ', at each run of blanks and tabs.
/// `fields` is overwritten, so that its memory serves for all lines.
void split_fields(std::string_view line, char separator, std::vector<Field>& fields);

/// A finite number with the given decimal point ('.' or ',') that is the whole text; a sign "+" is
/// allowed.
std::optional<double> parse_number(std::string_view text, char point = '.');

/// Reads a number at the beginning of `begin` to `end`; returns where it ends: `begin` if there is
/// none.
const char* number_in(const char* begin, const char* end, char point, double& value);

/// Whether a word is one by which programs mark a missing number: nan, NaN, NA, N/A, null, inf, --.
bool says_nothing(std::string_view text);

/// Whether a number is all nines, at least four, which instruments write for "no value": 9999.999,
/// -9999, 99999.9.
bool all_nines(std::string_view text);

/// Text for a message: quoted, cut to 40 characters, bytes outside ASCII as \xNN.
std::string shown(std::string_view text);

/// Whether a byte occurs in no text: a control character other than a tab, a form feed or a line
/// end.
bool is_binary(char c);
/// Whether the line has one.
bool has_binary(std::string_view line);

} // namespace goingrate
