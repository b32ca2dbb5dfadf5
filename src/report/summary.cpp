// The report in words, for a terminal.
#include "goingrate/report/report.hpp"

#include "figure_axes.hpp"
#include "wording.hpp"

#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr std::size_t widest_name = 48; // columns: leaves room for a value with its ± and unit

// A name that is too long is broken, and its value is put beside its last line.
std::string row_of(const SummaryNumber& number, std::size_t width) {
  const std::string name = wrapped(number.quantity, width, 2);
  const std::size_t last = name.rfind('\n') == std::string::npos ? 0 : name.rfind('\n') + 1;
  std::string text;
  for (std::size_t begin = 0; begin < last;) {
    const std::size_t end = name.find('\n', begin);
    text += "  " + name.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  return text + wrapped(fmt::format("  {:<{}}  {}", name.substr(last), width, number.value),
                        line_columns, width + 2);
}

// Names on the left, values in a column of their own.
std::string table_of(const std::vector<SummaryNumber>& numbers) {
  std::size_t widest = 0;
  for (const SummaryNumber& number : numbers)
    widest = std::max(widest, characters(number.quantity));
  std::string text = "Numbers (± one standard deviation; a positive rate gains)\n";
  for (const SummaryNumber& number : numbers)
    text += row_of(number, std::min(widest, widest_name)) + "\n";
  return text;
}

} // namespace

std::string report_text(const Analysis& data) {
  std::string text = file_name(data.log.source) + "\n\n";
  for (const std::string& sentence : report_sentences(data))
    text += wrapped(sentence, line_columns, 2) + "\n";
  return text + "\n" + table_of(summary_numbers(data));
}

} // namespace goingrate
