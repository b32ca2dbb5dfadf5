// Options given to a reader that do not apply to this kind of log.
#include "log/unused_options.hpp"

#include <fmt/format.h>

namespace goingrate {

void tell_unused(ClockLog& log, const ReadingOptions& told) {
  const bool sound = log.format == LogFormat::sound;
  const bool ticc = log.format == LogFormat::ticc || log.format == LogFormat::ticc_interval;
  struct Told {
    bool given, used;
    const char* what;
    Setting setting;
  };
  for (const Told& one :
       {Told{told.rest_angle_rad.has_value(), log.format == LogFormat::angle,
             "where the pendulum hangs is told, but these are no samples of an angle",
             Setting::rest_angle},
        Told{told.counter_hz.has_value(), log.format == LogFormat::ticktock,
             "a counter's rate is told, but this log is not in cycles of one",
             Setting::counter_rate},
        Told{told.clock_ppm != usual_clock_ppm, sound && !told.pps_channel,
             "the error of a sampling rate is told, but this log is no recording that needs it",
             Setting::clock_ppm},
        Told{told.pps_channel.has_value(), sound,
             "a channel with a reference is told, but this log is no recording",
             Setting::pps_channel},
        Told{!told.channel.empty(), ticc, "a channel is told, but this log is not from a TICC",
             Setting::channel},
        Told{told.beat_channel != 1, sound,
             "a channel with the clock is told, but this log is no recording", Setting::channel},
        Told{told.wrap_s.has_value(), !sound && !log.grid,
             "times that begin again are told, but this log has no such times", Setting::wrap}})
    if (one.given && !one.used)
      log.assumptions.push_back({fmt::format("{}: not used", one.what), one.setting});
}

} // namespace goingrate
