// Beats heard by a sound card, as lines.
#pragma once

#include <string>

namespace goingrate::apps {

/// Longest time from a beat to its line: the first window begins with a beat.
inline constexpr double sound_lateness_s = 60.0;

/// Runs arecord on a device and writes a native log of the beats to a descriptor until either ends;
/// returns an exit status. Beats are looked for in windows of a minute, the last half of which is
/// heard again in the next, so lines come every half a minute, up to
/// three quarters of a minute late, the first ones a minute. Times are the sound card's.
int write_sound_events(const std::string& device, int to);

} // namespace goingrate::apps
