#include "held_notes.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <sstream>
#include <string_view>

namespace goingrate::apps {

namespace {

constexpr std::string_view waiting_words = "waits for others to go on from it: ";
constexpr std::string_view left_out_words = "left out, its time fits nothing: ";

std::string told_words(const HeardEvent& event) {
  std::string words = format_instant(event.time, 9);
  if (event.edge == Edge::down) words += " down";
  if (!std::isnan(event.amplitude_rad)) words += fmt::format(" {:.9g}", event.amplitude_rad);
  return words + words_of(event.values);
}

struct NamedValue {
  std::string_view name; // as the native format has it
  double EventValues::*value;
};
constexpr std::array named_values{NamedValue{"width_s", &EventValues::width_s},
                                  NamedValue{"temperature_c", &EventValues::temperature_c},
                                  NamedValue{"pressure_mbar", &EventValues::pressure_mbar},
                                  NamedValue{"humidity_percent", &EventValues::humidity_percent}};

// Takes one word NAME=VALUE of words_of(); false if it has no '='. An unknown name is ignored.
bool take_word(EventValues& values, const std::string& word) {
  const std::size_t sign = word.find('=');
  if (sign == word.npos) return false;
  for (const auto& [name, value] : named_values)
    if (word.compare(0, sign, name) == 0)
      values.*value = std::strtod(word.c_str() + sign + 1, nullptr);
  return true;
}

} // namespace

std::string words_of(const EventValues& values) {
  std::string words;
  for (const auto& [name, value] : named_values)
    if (!std::isnan(values.*value)) words += fmt::format(" {}={:.9g}", name, values.*value);
  return words;
}

std::string waiting_note(const HeardEvent& event) {
  return std::string(waiting_words) + told_words(event);
}

std::string left_out_note(const HeardEvent& event) {
  return std::string(left_out_words) + told_words(event);
}

std::string misdated_note(const HeardEvent& event, double error_s) {
  return fmt::format("left out, its date is {:+.0f} s from the computer's: {}", error_s,
                     told_words(event));
}

std::vector<HeardEvent> still_waiting(const std::vector<std::string>& notes) {
  std::vector<HeardEvent> events;
  for (const std::string& note : notes) {
    if (note.starts_with(left_out_words))
      events.clear(); // a rejected event ends the wait of those before it
    if (!note.starts_with(waiting_words)) continue;
    std::istringstream words(note.substr(waiting_words.size()));
    std::string word;
    words >> word;
    const auto time = parse_instant(word);
    if (!time) continue;
    HeardEvent event = event_at(*time);
    while (words >> word)
      if (word == "down")
        event.edge = Edge::down;
      else if (!take_word(event.values, word))
        event.amplitude_rad = std::strtod(word.c_str(), nullptr);
    events.push_back(event);
  }
  return events;
}

} // namespace goingrate::apps
