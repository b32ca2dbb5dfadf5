#include "labx.hpp"

#include "fields.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <optional>
#include <vector>

namespace goingrate {

namespace {

/// Goes through the elements in the order of the text. It needs no stack, so a deeply nested file
/// does no harm.
class Elements {
public:
  explicit Elements(std::string_view text) : rest_(text) {}

  /// The text between the next <name ...> and </name>; empty for <name ... />; nullopt at the end.
  std::optional<std::string_view> next(std::string_view name) {
    for (std::size_t at = rest_.find('<'); at != std::string_view::npos; at = rest_.find('<')) {
      rest_.remove_prefix(at + 1);
      if (!rest_.starts_with(name) || rest_.size() == name.size()) continue;
      const char after = rest_[name.size()];
      if (after != '>' && after != '/' && std::isspace(static_cast<unsigned char>(after)) == 0)
        continue;
      return content(name);
    }
    return {};
  }

private:
  std::optional<std::string_view> content(std::string_view name) {
    const std::size_t open_end = rest_.find('>');
    if (open_end == std::string_view::npos) return {};
    const bool is_empty = rest_[open_end - 1] == '/';
    rest_.remove_prefix(open_end + 1);
    if (is_empty) return std::string_view{};
    const std::size_t close = rest_.find(fmt::format("</{}>", name));
    if (close == std::string_view::npos) return {};
    const std::string_view inside = rest_.substr(0, close);
    rest_.remove_prefix(close);
    return inside;
  }

  std::string_view rest_;
};

// The text as one line, without field separators.
std::string plain(std::string_view text) {
  std::string result(text.substr(0, text.find('<')));
  std::replace_if(
      result.begin(), result.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; },
      ' ');
  const std::size_t first = result.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return result.substr(first, result.find_last_not_of(' ') - first + 1);
}

struct Channel {
  std::string name;
  std::vector<std::string> values;
};

Channel channel_in(std::string_view text) {
  Channel channel;
  channel.name = plain(Elements(text).next("quantity").value_or(""));
  const std::string unit = plain(Elements(text).next("unit").value_or(""));
  if (!unit.empty()) channel.name += fmt::format(" ({})", unit);
  Elements values(Elements(text).next("values").value_or(""));
  while (const auto value = values.next("value"))
    channel.values.push_back(plain(*value));
  return channel;
}

} // namespace

bool is_labx(std::string_view beginning) {
  return beginning.find("<cassylab") != std::string_view::npos;
}

std::string table_of_labx(std::string_view text, const std::string& name) {
  std::vector<Channel> channels;
  std::size_t rows = 0;
  Elements all(Elements(text).next("channels").value_or(""));
  while (const auto one = all.next("channel")) {
    Channel channel = channel_in(*one);
    const bool has_numbers =
        std::any_of(channel.values.begin(), channel.values.end(),
                    [](const std::string& value) { return parse_number(value).has_value(); });
    if (!has_numbers) continue;
    rows = std::max(rows, channel.values.size());
    channels.push_back(std::move(channel));
  }
  // A channel of a few values, such as a calibration, is not a column among those of thousands.
  std::erase_if(channels, [&](const Channel& channel) { return 2 * channel.values.size() < rows; });
  if (channels.empty() || channels.size() > most_fields)
    throw InputError({name, 0, 0}, fmt::format("{} channels with values", channels.size()),
                     fmt::format("a CASSY measurement with 1 to {}", most_fields));
  std::string table(1, ' '); // so that a channel's name is not taken for the head of a sound file
  for (const Channel& channel : channels)
    table += channel.name + (&channel == &channels.back() ? '\n' : '\t');
  for (std::size_t row = 0; row < rows; ++row)
    for (const Channel& channel : channels) {
      if (row < channel.values.size()) table += channel.values[row];
      table += &channel == &channels.back() ? '\n' : '\t';
    }
  return table;
}

} // namespace goingrate
