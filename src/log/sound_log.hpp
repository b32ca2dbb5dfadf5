// A recording of a clock as a log.
#pragma once

#include "sound/recording.hpp"

#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/reading.hpp"

#include <string>

namespace goingrate {

/// The beats of a recording: ticks are upward crossings, tocks downward ones, each with the
/// standard deviation of its time. Times count from the beginning of the recording by its own
/// sampling rate, or by the pulses of a second channel. Throws InputError where no clock is heard
/// or no pulses are found; ArgumentError for a channel that the recording does not have.
ClockLog read_recording(Recording recording, const std::string& name,
                        const ReadingOptions& options);

} // namespace goingrate
