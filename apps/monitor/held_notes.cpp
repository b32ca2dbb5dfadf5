#include "held_notes.hpp"

#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <sstream>
#include <string_view>

namespace goingrate::apps {

namespace {

constexpr std::string_view waiting_words = "waits for others to go on from it: ";
constexpr std::string_view left_out_words = "left out, its time fits nothing: ";

std::string words_of(const Beat& event) {
  std::string words = format_instant(event.time, 9);
  if (event.edge == Edge::down) words += " down";
  if (!std::isnan(event.amplitude_rad)) words += fmt::format(" {:.9g}", event.amplitude_rad);
  return words;
}

} // namespace

std::string waiting_note(const Beat& event) { return std::string(waiting_words) + words_of(event); }

std::string left_out_note(const Beat& event) {
  return std::string(left_out_words) + words_of(event);
}

std::string misdated_note(const Beat& event, double error_s) {
  return fmt::format("left out, its date is {:+.0f} s from the computer's: {}", error_s,
                     words_of(event));
}

std::vector<Beat> still_waiting(const std::vector<std::string>& notes) {
  std::vector<Beat> events;
  for (const std::string& note : notes) {
    if (note.starts_with(left_out_words)) events.clear(); // those that waited
    if (!note.starts_with(waiting_words)) continue;
    std::istringstream words(note.substr(waiting_words.size()));
    std::string word;
    words >> word;
    const auto time = parse_instant(word);
    if (!time) continue;
    Beat event = event_at(*time);
    while (words >> word)
      if (word == "down")
        event.edge = Edge::down;
      else
        event.amplitude_rad = std::strtod(word.c_str(), nullptr);
    events.push_back(event);
  }
  return events;
}

} // namespace goingrate::apps
