#include "goingrate/log/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace goingrate {

namespace {
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
}

Sensor::Sensor(const SensorSettings& settings, std::uint64_t seed)
    : settings_(settings), jitter_(seed, StreamPurpose::jitter),
      amplitude_noise_(seed, StreamPurpose::amplitude_noise), missed_(seed, StreamPurpose::missed),
      spurious_(seed, StreamPurpose::spurious) {}

void Sensor::see(const Period& period) {
  double amplitude = unknown;
  if (settings_.amplitude_rms)
    amplitude = period.amplitude_rad + *settings_.amplitude_rms * amplitude_noise_.normal();
  if (settings_.edges == SensorEdges::both && period.cycle > 0)
    report(period.down_s, 0.5 * period.period_s, unknown, Edge::down);
  report(period.time_s, period.period_s, amplitude, Edge::up);
  latest_crossing_s_ = period.time_s.hi;
}

std::vector<Beat> Sensor::take(bool at_end) {
  // Jitter beyond 40 sigma does not happen; a resolution shifts by half of itself.
  const double certain_s =
      latest_crossing_s_ - 40.0 * settings_.jitter_rms_s - settings_.resolution_s;
  std::stable_sort(events_.begin(), events_.end(),
                   [](const Beat& a, const Beat& b) { return a.time < b.time; });
  const auto end =
      at_end ? events_.end() : std::find_if(events_.begin(), events_.end(), [&](const Beat& e) {
        return e.time.to_double() >= certain_s;
      });
  std::vector<Beat> ready(events_.begin(), end);
  events_.erase(events_.begin(), end);
  return ready;
}

Instant Sensor::measured(const TwoPart<double>& time_s, double extra_s) {
  Instant time = Instant::from_seconds(time_s.hi) + time_s.lo + extra_s;
  if (settings_.resolution_s > 0.0) {
    // The nearest multiple of the resolution: what is left of it is taken off.
    const auto multiple = std::llround(time.to_double() / settings_.resolution_s);
    time = time + -residual_from_grid(time, Instant{}, multiple, settings_.resolution_s);
  }
  return time;
}

void Sensor::report(const TwoPart<double>& time_s, double period_s, double amplitude_rad,
                    Edge edge) {
  // Each fault has a stream of its own, drawn from at every crossing if it occurs at all, so that
  // one fault's probability does not change the pattern of another.
  const double jitter =
      settings_.jitter_rms_s > 0.0 ? settings_.jitter_rms_s * jitter_.normal() : 0.0;
  const bool seen = settings_.missed == 0.0 || missed_.uniform() >= settings_.missed;
  double chance = 1.0, moment = 0.0;
  if (settings_.spurious > 0.0) {
    chance = spurious_.uniform();
    moment = spurious_.uniform();
  }
  if (seen) events_.push_back(event_at(measured(time_s, jitter), edge, 0, amplitude_rad));
  if (chance < settings_.spurious)
    events_.push_back(event_at(measured(time_s, moment * period_s), edge));
}

ClockLog Sensor::log(double nominal_period_s) const {
  ClockLog log;
  log.format = LogFormat::native;
  log.events = events_;
  log.has_amplitude = settings_.amplitude_rms.has_value();
  log.nominal_period_s = nominal_period_s;
  std::stable_sort(log.events.begin(), log.events.end(),
                   [](const Beat& a, const Beat& b) { return a.time < b.time; });
  return log;
}

int decimals_for(const SensorSettings& settings) {
  const double finest = std::max(settings.jitter_rms_s, settings.resolution_s);
  if (finest <= 0.0) return 15; // the fraction of a second to the rounding of a double
  return std::clamp(3 + static_cast<int>(std::ceil(-std::log10(finest))), 6, 15);
}

} // namespace goingrate
