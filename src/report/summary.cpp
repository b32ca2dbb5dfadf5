// The report in words, for a terminal.
#include "goingrate/report/report.hpp"

#include "figure_axes.hpp"
#include "wording.hpp"

#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr std::size_t terminal = 80; // columns

// Names on the left, values in a column of their own.
std::string table_of(const std::vector<SummaryNumber>& numbers) {
  std::size_t widest = 0;
  for (const SummaryNumber& number : numbers)
    widest = std::max(widest, characters(number.quantity));
  std::string text = "Numbers (± one standard deviation; a positive rate gains)\n";
  for (const SummaryNumber& number : numbers)
    text += wrapped(fmt::format("  {:<{}}  {}", number.quantity, widest, number.value), terminal,
                    widest + 2) +
            "\n";
  return text;
}

} // namespace

std::string report_text(const Analysis& data) {
  std::string text = file_name(data.log.source) + "\n\n";
  for (const std::string& sentence : report_sentences(data))
    text += wrapped(sentence, terminal, 2) + "\n";
  return text + "\n" + table_of(summary_numbers(data));
}

} // namespace goingrate
