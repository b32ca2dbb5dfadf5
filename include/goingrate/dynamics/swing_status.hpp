// How a stretch of motion ended.
#pragma once

#include <string_view>

namespace goingrate {

/// How a half swing, a period or a run ended.
enum class SwingStatus {
  crossed,    ///< back at the vertical
  stalled,    ///< turned round, or came to rest, before reaching the vertical
  overturned, ///< passed the top
  not_finite, ///< the numbers overflowed
};

/// In words, for messages: "the clock stalled", ...
constexpr std::string_view words_for(SwingStatus status) {
  switch (status) {
  case SwingStatus::crossed:
    return "the pendulum swings";
  case SwingStatus::stalled:
    return "the clock stalled";
  case SwingStatus::overturned:
    return "the pendulum passed the top";
  case SwingStatus::not_finite:
    break;
  }
  return "the numbers overflowed";
}

/// In one word, for tables.
constexpr std::string_view short_name(SwingStatus status) {
  switch (status) {
  case SwingStatus::crossed:
    return "goes";
  case SwingStatus::stalled:
    return "stalls";
  case SwingStatus::overturned:
    return "overturns";
  case SwingStatus::not_finite:
    break;
  }
  return "overflows";
}

} // namespace goingrate
