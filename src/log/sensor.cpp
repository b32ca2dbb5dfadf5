#include "goingrate/log/sensor.hpp"

#include "base/scaled_time.hpp"
#include "dynamics/passage.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/direct.hpp"
#include "goingrate/dynamics/intermittent.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {

namespace {

bool is_sensed_before(const SensedEvent& a, const SensedEvent& b) {
  return a.beat.time < b.beat.time;
}

// The factor by which the drive of a period was multiplied.
double factor_of(const ClockParameters& clock, double mu) {
  const double strength = drive_strength(clock);
  return strength > 0.0 ? mu / strength : 1.0;
}

} // namespace

Sensor::Sensor(const Scenario& scenario, std::uint64_t seed)
    : scenario_(scenario), settings_(scenario.sensor), clock_(scenario.clock),
      in_parts_(action_parts(clock_).has_value()), jitter_(seed, StreamPurpose::jitter),
      amplitude_noise_(seed, StreamPurpose::amplitude_noise), missed_(seed, StreamPurpose::missed),
      spurious_(seed, StreamPurpose::spurious),
      temperature_noise_(seed, StreamPurpose::temperature_noise) {}

void Sensor::see(const Period& period) {
  const double let_in = factor_of(clock_, period.mu);
  // An action that begins before a crossing continues after it with the same factor.
  const double factor = in_parts_ ? let_in_before_ : let_in;
  let_in_before_ = let_in;
  if (pending_) {
    pending_->after = clock_;
    pending_->factor_after = factor;
    const double speed_before = pending_->speed;
    report(*pending_);
    if (settings_.edges != SensorEdges::up) {
      Passage down{period.down_s, speed_before, 0.5 * period.period_s, period.nominal_period_s};
      if (settings_.offset_rad != 0.0 || settings_.flag_width_rad != 0.0)
        down.speed = speed_after_half(clock_, speed_before, factor);
      down.edge = Edge::down;
      down.before = down.after = clock_;
      down.factor_before = down.factor_after = factor;
      report(down);
    }
  }
  Passage up{period.time_s, period.velocity, period.period_s, period.nominal_period_s};
  if (settings_.amplitude_rms)
    up.amplitude_rad = period.amplitude_rad + *settings_.amplitude_rms * amplitude_noise_.normal();
  up.before = clock_;
  up.factor_before = period.cycle > 0 ? let_in : 1.0;
  std::erase_if(scenario_.events, [&](const ClockEvent& event) {
    const bool due =
        event.at_period ? period.cycle >= *event.at_period : period.time_s.value() >= *event.at_s;
    if (due) clock_ = event.applied_to(clock_);
    if (due) in_parts_ = action_parts(clock_).has_value();
    return due;
  });
  up.after = clock_;
  pending_ = up;
  latest_crossing_s_ = period.time_s.hi;
}

void Sensor::finish() {
  if (!pending_) return;
  report(*pending_);
  pending_.reset();
}

std::vector<SensedEvent> Sensor::take(bool at_end) {
  if (at_end) finish();
  // Jitter beyond 40 sigma does not happen; a resolution shifts by half of itself; an edge before
  // the vertical by less than a quarter of a period.
  const double early_s = pending_ ? 0.25 * pending_->period_s : 0.0;
  const double certain_s =
      latest_crossing_s_ - 40.0 * settings_.jitter_rms_s - settings_.resolution_s - early_s;
  std::stable_sort(events_.begin(), events_.end(), is_sensed_before);
  const auto end =
      at_end ? events_.end() : std::find_if(events_.begin(), events_.end(), [&](const auto& e) {
        return e.beat.time.to_double() >= certain_s;
      });
  std::vector<SensedEvent> ready(events_.begin(), end);
  events_.erase(events_.begin(), end);
  return ready;
}

Instant Sensor::measured(const TwoPart<double>& time_s, double extra_s) const {
  Instant time = Instant::from_seconds(time_s.hi) + time_s.lo + extra_s;
  if (settings_.resolution_s > 0.0) {
    // The nearest multiple of the resolution, by subtracting the remainder.
    const auto multiple = std::llround(time.to_double() / settings_.resolution_s);
    time = time + -residual_from_grid(time, Instant{}, multiple, settings_.resolution_s);
  }
  return time;
}

double Sensor::jitter() {
  return settings_.jitter_rms_s > 0.0 ? settings_.jitter_rms_s * jitter_.normal() : 0.0;
}

// Time from the vertical to the angle, s; NaN if the swing does not reach it.
double Sensor::delay(const Passage& passage, double angle) const {
  if (angle == 0.0) return 0.0;
  const bool rising = passage.edge == Edge::up;
  const bool later = (angle > 0.0) == rising;
  const double scaled =
      time_from_vertical(later ? passage.after : passage.before, passage.speed, rising,
                         later ? passage.factor_after : passage.factor_before, angle);
  return TimeScale(passage.nominal_s).seconds(scaled);
}

void Sensor::report(const Passage& passage) {
  const double half =
      passage.edge == Edge::up ? 0.5 * settings_.flag_width_rad : -0.5 * settings_.flag_width_rad;
  const double leading = delay(passage, settings_.offset_rad - half);
  const double trailing = half == 0.0 ? leading : delay(passage, settings_.offset_rad + half);
  // Each fault has a stream of its own, drawn from at every crossing if it occurs at all, so that
  // one fault's probability does not change the pattern of another.
  const double leading_s = leading + jitter();
  const bool two = settings_.edges == SensorEdges::gate || settings_.edges == SensorEdges::four;
  const double trailing_s = two ? trailing + jitter() : trailing;
  const bool seen = settings_.missed == 0.0 || missed_.uniform() >= settings_.missed;
  double chance = 1.0, moment = 0.0;
  if (settings_.spurious > 0.0) {
    chance = spurious_.uniform();
    moment = spurious_.uniform();
  }
  if (seen && !std::isnan(leading_s) && !(two && std::isnan(trailing_s)))
    report_edges(passage, leading_s, trailing_s);
  if (chance < settings_.spurious) {
    const double width = two ? std::abs(trailing - leading) : 0.0;
    Passage nothing = passage;
    nothing.amplitude_rad = std::numeric_limits<double>::quiet_NaN();
    const double start = moment * passage.period_s;
    report_edges(nothing, start, start + 0.5 * width);
  }
}

void Sensor::report_edges(const Passage& passage, double leading_s, double trailing_s) {
  using Part = SensedEvent::Part;
  const double no_width = std::numeric_limits<double>::quiet_NaN();
  const Instant in = measured(passage.time_s, leading_s);
  if (settings_.edges == SensorEdges::gate) {
    add(passage, in, Part::whole, measured(passage.time_s, trailing_s) - in);
  } else if (settings_.edges == SensorEdges::four) {
    add(passage, in, Part::in, no_width);
    add(passage, measured(passage.time_s, trailing_s), Part::out, no_width);
  } else {
    add(passage, in, Part::whole, no_width);
  }
}

void Sensor::add(const Passage& passage, const Instant& time, SensedEvent::Part part,
                 double width_s) {
  SensedEvent event;
  event.beat = event_at(time, passage.edge, 0, passage.amplitude_rad);
  event.part = part;
  event.width_s = width_s;
  if (settings_.temperature_rms)
    event.temperature_c = scenario_.temperature.at(passage.time_s.value()) +
                          *settings_.temperature_rms * temperature_noise_.normal();
  events_.push_back(event);
}

ClockLog Sensor::log(double nominal_period_s) {
  if (settings_.edges == SensorEdges::four)
    throw ArgumentError("sensor.edges", "four", "up, both or gate, to be had without a file");
  ClockLog log;
  log.format = LogFormat::native;
  log.has_amplitude = settings_.amplitude_rms.has_value();
  log.nominal_period_s = nominal_period_s;
  if (settings_.flag_width_rad > 0.0) log.flag_width_rad = settings_.flag_width_rad;
  const bool gate = settings_.edges == SensorEdges::gate;
  for (SensedEvent& event : take(true)) {
    if (gate) {
      event.beat.time = event.beat.time + 0.5 * event.width_s;
      log.columns.width_s.push_back(event.width_s);
    }
    if (settings_.temperature_rms) log.columns.temperature_c.push_back(event.temperature_c);
    log.events.push_back(event.beat);
  }
  return log;
}

int decimals_for(const SensorSettings& settings) {
  const double finest = std::max(settings.jitter_rms_s, settings.resolution_s);
  if (finest <= 0.0) return 15; // the fraction of a second to the rounding of a double
  return std::clamp(3 + static_cast<int>(std::ceil(-std::log10(finest))), 6, 15);
}

} // namespace goingrate
