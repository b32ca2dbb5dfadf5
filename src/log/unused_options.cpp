// Reports options given to a reader that do not apply to this kind of log.
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
             "the angle at rest is given, but this log does not hold samples of an angle",
             Setting::rest_angle},
        Told{told.counter_hz.has_value(), log.format == LogFormat::ticktock,
             "the rate of a counter is given, but this log does not count its cycles",
             Setting::counter_rate},
        Told{told.clock_ppm != usual_clock_ppm, sound && !told.pps_channel,
             "the error of a sampling rate is given, but this log is not a recording that needs it",
             Setting::clock_ppm},
        Told{told.pps_channel.has_value(), sound,
             "a channel with a reference is given, but this log is not a recording",
             Setting::pps_channel},
        Told{!told.channel.empty(), ticc, "a channel is given, but this log is not from a TICC",
             Setting::channel},
        Told{told.beat_channel != 1, sound,
             "a channel with the clock is given, but this log is not a recording",
             Setting::channel},
        Told{told.wrap_s.has_value(), !sound && !log.grid,
             "a wrap of the times is given, but the times of this log do not wrap", Setting::wrap}})
    if (one.given && !one.used)
      log.assumptions.push_back({fmt::format("{}: not used", one.what), one.setting});
}

} // namespace goingrate
