// Columns of numbers, as phase and frequency data come.
#include "goingrate/log/reading.hpp"

#include "fields.hpp"
#include "lines.hpp"

#include "goingrate/base/errors.hpp"

#include <fmt/format.h>
#include <limits>

namespace goingrate {

std::vector<double> read_numbers(std::string_view text, const std::string& source) {
  if (text.empty()) throw InputError({source, 1, 1}, "an empty file", "one number a line");
  std::vector<double> numbers;
  std::vector<Field> fields;
  LineReader lines(text, source);
  while (const auto line = lines.next()) {
    split_fields(line->text, ' ', fields);
    if (fields.empty() || fields[0].text.front() == '#' || fields[0].text.front() == '%') continue;
    if (fields.size() > 1)
      throw InputError({source, line->number, fields[1].column}, shown(fields[1].text),
                       "one number a line");
    const Field& field = fields.front();
    const auto value = parse_number(field.text);
    if (!value && !says_nothing(field.text))
      throw InputError({source, line->number, field.column}, shown(field.text), "a number");
    numbers.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  constexpr std::size_t fewest = 3; // a second difference
  if (numbers.size() < fewest)
    throw InputError({source, 1, 1}, fmt::format("{} numbers", numbers.size()),
                     fmt::format("at least {}", fewest));
  return numbers;
}

std::string read_text(const std::string& path, std::uint64_t unpacked_limit) {
  const auto source = open_source(path, unpacked_limit);
  std::string text;
  constexpr std::size_t chunk = 1 << 16;
  while (true) {
    const std::size_t kept = text.size();
    text.resize(kept + chunk);
    const std::size_t count = source->read(text.data() + kept, chunk);
    text.resize(kept + count);
    if (count == 0) return text;
  }
}

} // namespace goingrate
