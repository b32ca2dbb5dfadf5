#include "sound_log.hpp"

#include "sound/pulses.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr double per_million = 1e-6;

// A watch's train makes a whole number of beats an hour, two to a period.
std::optional<double> watch_period(double period_s) {
  constexpr std::array beats_an_hour{14400.0, 16200.0, 18000.0, 19800.0, 21600.0,
                                     25200.0, 28800.0, 36000.0, 43200.0};
  constexpr double largest_difference = 0.005; // seven minutes a day
  for (const double beats : beats_an_hour)
    if (const double usual = 7200.0 / beats; std::abs(period_s / usual - 1.0) < largest_difference)
      return usual;
  return {};
}

/// Turns samples into seconds.
class TimeBase {
public:
  TimeBase(Recording& recording, const ReadingOptions& options, const std::string& name,
           ClockLog& log)
      : rate_hz_(recording.rate_hz()) {
    if (!options.pps_channel) {
      log.time_base_sigma = per_million * options.clock_ppm;
      log.assumptions.push_back(
          {fmt::format("the recorder's {} samples per second are right to ±{:.4g} parts in 10⁶, "
                       "which is ±{:.3g} s a day of the clock's rate",
                       rate_hz_, options.clock_ppm, log.time_base_sigma * 86400.0),
           Setting::clock_ppm});
      return;
    }
    pulses_.emplace(recording.channel(*options.pps_channel, options.unpacked_limit));
    constexpr double fewest_periods = 3.0;
    const double seconds = log.sound->duration_s;
    if (static_cast<double>(pulses_->count()) < std::max(fewest_periods, 0.5 * seconds))
      throw InputError(
          {name},
          fmt::format("{} pulses that are whole seconds apart in channel {}, in {:.4g} s",
                      pulses_->count(), *options.pps_channel, seconds),
          "one per second, in half of them at least");
    log.time_base_sigma = pulses_->rate_sigma();
    log.sound->has_pps = true;
    log.assumptions.push_back(
        {fmt::format("channel {} tells the seconds: {} pulses, by which the recorder takes "
                     "{:.9g} ± {:.2g} samples per second",
                     *options.pps_channel, pulses_->count(), pulses_->rate_hz(),
                     pulses_->rate_hz() * pulses_->rate_sigma()),
         Setting::pps_channel});
  }

  [[nodiscard]] double time_of(double place) const {
    return pulses_ ? pulses_->time_at(place) : place / rate_hz_;
  }
  [[nodiscard]] bool covers(double place) const { return !pulses_ || pulses_->covers(place); }
  [[nodiscard]] double sigma_s() const { return pulses_ ? pulses_->time_sigma_s() : 0.0; }

private:
  double rate_hz_;
  std::optional<SecondPulses> pulses_;
};

void check_rate(const Recording& recording, const std::string& name) {
  constexpr double lowest_hz = 4e3, highest_hz = 4e5;
  if (recording.rate_hz() < lowest_hz || recording.rate_hz() > highest_hz)
    throw InputError({name}, fmt::format("{} samples per second", recording.rate_hz()),
                     fmt::format("between {} and {}", lowest_hz, highest_hz));
}

void check_channel(std::string_view name, std::size_t channel, const Recording& recording) {
  if (channel < 1 || channel > recording.channels())
    throw ArgumentError(name, static_cast<double>(channel),
                        fmt::format("a channel of the recording, 1 to {}", recording.channels()));
}

void settle_nominal_period(ClockLog& log, double period_s, const ReadingOptions& options) {
  constexpr double longest_of_a_watch = 0.55; // s: a pendulum of half a second is 6 cm long
  log.nominal_period_s = options.nominal_period_s;
  if (log.nominal_period_s || period_s > longest_of_a_watch) return;
  log.nominal_period_s = watch_period(period_s);
  if (log.nominal_period_s)
    log.assumptions.push_back({fmt::format("nominal period {:.6g} s, a watch of {:.0f} beats an "
                                           "hour",
                                           *log.nominal_period_s, 7200.0 / *log.nominal_period_s),
                               Setting::nominal_period});
}

void say_what_is_heard(ClockLog& log, const TickTrain& train) {
  log.assumptions.push_back({fmt::format(
      "{} ticks{} are heard in {:.6g} s{}", train.ticks.size(), train.has_tocks ? " and tocks" : "",
      log.sound->duration_s,
      train.drowned > 0 ? fmt::format(", {} more are not", train.drowned) : std::string())});
  const double period_s = train.period / log.sound->rate_hz;
  if (train.is_even)
    log.assumptions.push_back(
        {fmt::format("the sounds come at equal intervals: tick and tock of a clock of {:.4g} s; if "
                     "each is a period, the nominal period is {:.4g} s",
                     period_s, 0.5 * period_s),
         Setting::nominal_period});
  else if (train.has_tocks)
    log.assumptions.push_back(
        {"ticks and tocks in turn; which of the two is the tick cannot be heard"});
  else
    log.assumptions.push_back({"one sound per period"});
}

} // namespace

ClockLog read_recording(Recording recording, const std::string& name,
                        const ReadingOptions& options) {
  if (!(options.clock_ppm >= 0.0 && options.clock_ppm <= 1e5))
    throw ArgumentError("clock-ppm", options.clock_ppm, "between 0 and 1e5");
  check_rate(recording, name);
  if (options.pps_channel == options.beat_channel)
    throw ArgumentError("pps channel", static_cast<double>(options.beat_channel),
                        "another channel than that of the beats");
  check_channel("beat channel", options.beat_channel, recording);
  if (options.pps_channel) check_channel("pps channel", *options.pps_channel, recording);
  ClockLog log;
  log.source = name;
  log.format = LogFormat::sound;
  const SoundSamples sound = recording.channel(options.beat_channel, options.unpacked_limit);
  log.sound.emplace();
  log.sound->rate_hz = sound.rate_hz;
  log.sound->duration_s = static_cast<double>(sound.count) / sound.rate_hz;
  if (recording.missing_bytes() > 0)
    log.assumptions.push_back(
        {fmt::format("the recording breaks off: its head states {} bytes more; what is there is "
                     "read",
                     recording.missing_bytes())});
  const TimeBase time_base(recording, options, name, log);
  TickTrain train = find_ticks(sound, options.nominal_period_s, options.progress);
  constexpr std::size_t fewest_beats = 6; // three periods
  if (train.ticks.size() < fewest_beats)
    throw InputError(
        {name},
        train.period > 0.0
            ? fmt::format("{} beats that stand out of the noise in {:.4g} s", train.ticks.size(),
                          log.sound->duration_s)
            : fmt::format("{:.4g} s of sound in which nothing repeats", log.sound->duration_s),
        "the ticks of one clock with a period between 0.15 and 3.6 s");
  std::size_t left_out = 0;
  for (const Tick& tick : train.ticks) {
    if (!time_base.covers(tick.at)) {
      ++left_out;
      continue;
    }
    log.events.push_back(event_at(Instant::from_seconds(time_base.time_of(tick.at)),
                                  tick.is_tock ? Edge::down : Edge::up,
                                  static_cast<std::uint32_t>(log.events.size() + 1)));
    log.columns.sigma_s.push_back(std::hypot(tick.sigma / sound.rate_hz, time_base.sigma_s()));
  }
  if (left_out > 0)
    log.assumptions.push_back(
        {fmt::format("{} beats are left out: no pulse of the reference is near them", left_out)});
  if (log.events.size() < fewest_beats)
    throw InputError({name},
                     fmt::format("{} beats near pulses of the reference", log.events.size()),
                     fmt::format("at least {}", fewest_beats));
  log.sound->drowned = train.drowned;
  log.sound->has_tocks = train.has_tocks;
  log.sound->tick = std::move(train.tick);
  log.sound->tock = std::move(train.tock);
  settle_nominal_period(log, train.period / sound.rate_hz, options);
  say_what_is_heard(log, train);
  return log;
}

} // namespace goingrate
