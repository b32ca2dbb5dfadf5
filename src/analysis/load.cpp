#include "goingrate/analysis/load.hpp"

#include "base/readable.hpp"
#include "base/time_grain.hpp"
#include "log/typical_period.hpp"
#include "log/unused_options.hpp"
#include "log/usual_step.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/log/rates.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>

namespace goingrate {

namespace {

constexpr double largest_rate_excess = 0.05; // no pendulum clock is off by an hour a day

class Loading {
public:
  Loading(ClockLog log, const LoadRequest& request) : request_(request) {
    loaded_.log = std::move(log);
    loaded_.sensor.gravity_share = request.gravity_share;
  }

  NumberedLog run() {
    tell_unused(loaded_.log, request_.reading);
    join_weather(loaded_.log, request_.weather);
    if (request_.site) loaded_.log.site = request_.site;
    if (loaded_.log.grid)
      take_grid();
    else
      number_events();
    if (request_.phases_will_do && loaded_.log.grid) return std::move(loaded_);
    choose_good();
    loaded_.sensor.amplitude = summarise_amplitudes(loaded_.good);
    refuse_if_numbered_wrong();
    say_if_times_are_coarse();
    say_if_every_second_is_missing();
    if (loaded_.good.size() < 3)
      throw NumericsError(fmt::format(
          "{}: no run of three beats that could be numbered together, of {} events about "
          "{} s apart",
          request_.path, loaded_.beats.beats.size(), readable(loaded_.beats.typical_period_s, 4)));
    return std::move(loaded_);
  }

private:
  void assume(std::string text, Setting setting = Setting::none) {
    loaded_.log.assumptions.push_back({std::move(text), setting});
  }

  // Whole swings of the pendulum between two values of a grid.
  static std::int64_t swings_in(double tau0_s, double period_s) {
    const double swings = std::round(tau0_s / period_s);
    constexpr double rounding = 1e-9;
    if (!(swings >= 1.0 && std::abs(tau0_s - swings * period_s) <= rounding * tau0_s))
      throw ArgumentError(
          "nominal_period", period_s,
          fmt::format("a whole part of the interval of the values, {:.6g} s", tau0_s));
    return static_cast<std::int64_t>(swings);
  }

  // The places of grid data are given: there is nothing to number.
  void take_grid() {
    const GridData& grid = *loaded_.log.grid;
    loaded_.nominal_period_s = grid.tau0_s;
    if (request_.phases_will_do) return;
    refuse_phases_of_no_clock(grid);
    loaded_.log.nominal_period_s = request_.reading.nominal_period_s; // of the swing, if stated
    loaded_.nominal_period_s = loaded_.log.nominal_period_s.value_or(grid.tau0_s);
    loaded_.beats = beats_on_grid(std::move(loaded_.log.events), loaded_.log.source);
    count_swings(swings_in(grid.tau0_s, loaded_.nominal_period_s), loaded_.beats);
    loaded_.log.events.clear();
  }

  // Periods from one good upward crossing to the next; unknown where one is missing.
  static std::vector<double> periods_of(std::span<const Beat> beats) {
    std::vector<double> periods;
    const Beat* before = nullptr;
    for (const Beat& beat : beats) {
      if (beat.flag != BeatFlag::good) continue;
      const bool follows =
          before != nullptr && before->segment == beat.segment && before->cycle + 1 == beat.cycle;
      periods.push_back(follows ? beat.time - before->time
                                : std::numeric_limits<double>::quiet_NaN());
      before = &beat;
    }
    return periods;
  }

  // The mean period of the numbered beats must be about the typical interval between events. If
  // most events are false ones, it is not, and the count is not that of a clock. The period of a
  // wide swing that dies away changes, but smoothly.
  void refuse_if_numbered_wrong() const {
    if (loaded_.log.grid || loaded_.good.size() < 3) return;
    const double cycles =
        static_cast<double>(loaded_.good.back().cycle - loaded_.good.front().cycle);
    const double mean = (loaded_.good.back().time - loaded_.good.front().time) / cycles;
    const double typical = loaded_.beats.typical_period_s;
    if (std::abs(mean / typical - 1.0) <= largest_rate_excess) return;
    if (have_a_course(periods_of(loaded_.good))) return;
    throw ImpossibleReading(
        loaded_.log.place(loaded_.good.front().line),
        fmt::format("events about {:.6g} s apart that make beats {:.6g} s apart", typical, mean),
        "the beats of one clock", readings_for_period(mean, typical));
  }

  // Reports a logger's steps that hide more than a second a day from one beat to the next, and make
  // most of the beats' scatter.
  void say_if_times_are_coarse() {
    if (loaded_.log.grid || loaded_.good.size() < 3) return;
    const std::span<const Beat> good = loaded_.good;
    const double period_s = loaded_.beats.typical_period_s;
    const double grain_s = time_grain(std::min(good.size(), times_for_grain), period_s,
                                      [&](std::size_t i) { return good[i].time - good[0].time; });
    constexpr double coarse_share = 1e-5; // of a period: 0.9 s/day
    if (!(grain_s > coarse_share * period_s &&
          2.0 * rounding_sigma(grain_s) > loaded_.beats.scatter_s))
      return;
    assume(fmt::format("the times are whole multiples of {:.6g} s: each is rounded by {:.2g} s rms",
                       grain_s, rounding_sigma(grain_s)));
  }

  void say_if_every_second_is_missing() {
    if (loaded_.log.grid || usual_step(loaded_.good) != 2) return;
    assume(fmt::format("every second beat is missing: a period is there and back, tick and tock; "
                       "if that takes {:.6g} s, that is the nominal period",
                       2.0 * loaded_.nominal_period_s),
           Setting::nominal_period);
  }

  // What was guessed, not given, must be possible.
  void refuse_phases_of_no_clock(const GridData& grid) const {
    if (request_.reading.format || loaded_.log.format != LogFormat::phase) return;
    std::size_t far = 0, all = 0;
    for (std::size_t i = 1; i < grid.phase_s.size(); ++i) {
      const double step = std::abs(grid.phase_s[i] - grid.phase_s[i - 1]);
      if (std::isnan(step)) continue;
      ++all;
      far += step > largest_rate_excess * grid.tau0_s ? 1 : 0;
    }
    if (2 * far <= all) return;
    throw ImpossibleReading(loaded_.log.place(loaded_.log.events.front().line),
                            fmt::format("phases that move by more than {:.0f} % of the interval",
                                        100.0 * largest_rate_excess),
                            "those of a clock", readings_for_phases(grid));
  }

  void number_events() {
    ClockLog& log = loaded_.log;
    mark_bounces(log, request_.dead_time_s);
    const bool labelled = label_alternate_edges(log, request_.both_edges, log.nominal_period_s);
    if (log.directions_are_open && !labelled)
      assume("each event is one period, and not a passage in either direction",
             Setting::both_edges);
    number();
    settle_nominal_period();
    use_flag();
    use_sensor_offset();
  }

  // How many swings a wheel that closes a contact takes from one contact to the next, as once a
  // minute: too many to count as missed beats, which are counted one by one.
  [[nodiscard]] std::int64_t swings_between_contacts() const {
    const ClockLog& log = loaded_.log;
    if (!log.nominal_period_s) return 1;
    constexpr double most_missed = 8.0, whole_within = 0.1;
    constexpr double most_swings = 128.0; // in a minute, of half a second; more is a wrong unit
    const double swings = typical_period(log.events, log.source, {}).mean_s / *log.nominal_period_s;
    const double whole = std::round(swings);
    const bool is_wheel =
        whole > most_missed && whole <= most_swings && std::abs(swings - whole) < whole_within;
    return is_wheel ? static_cast<std::int64_t>(whole) : 1;
  }

  void number() {
    NumberingOptions options{request_.gap_probability, loaded_.log.nominal_period_s};
    const std::int64_t swings = swings_between_contacts();
    if (swings > 1) *options.nominal_period_s *= static_cast<double>(swings);
    loaded_.beats = number_beats(std::move(loaded_.log.events), loaded_.log.source, options);
    count_swings(swings, loaded_.beats);
    loaded_.log.events.clear();
  }

  void settle_nominal_period() {
    ClockLog& log = loaded_.log;
    const double typical = loaded_.beats.typical_period_s;
    if (request_.dead_time_s && *request_.dead_time_s > 0.5 * typical)
      throw ArgumentError(
          "dead-time", *request_.dead_time_s,
          fmt::format("at most half of what is then the period, {} s", readable(typical, 4)));
    loaded_.nominal_period_s = nominal_period(log, loaded_.beats, log.assumptions);
    loaded_.nominal_is_known = log.nominal_period_s || loaded_.nominal_period_s != typical ||
                               rounded_period(typical) == std::round(typical * 4.0) / 4.0;
    // A period that is given is believed; one that the log states must be that of its beats.
    const bool possible = std::abs(typical / loaded_.nominal_period_s - 1.0) <= largest_rate_excess;
    if (possible || request_.reading.nominal_period_s) return;
    if (may_be_wide_swings(typical, loaded_.nominal_period_s) &&
        have_a_course(periods_of(loaded_.beats.beats)))
      return;
    throw ImpossibleReading(
        log.place(loaded_.beats.beats.front().line), fmt::format("beats {:.6g} s apart", typical),
        fmt::format("those of a clock whose nominal period is {:.6g} s", loaded_.nominal_period_s),
        readings_for_period(typical, loaded_.nominal_period_s));
  }

  // Corrections change times and amplitudes of numbered events; these are numbered again only if
  // the times moved.
  void with_events(const std::function<void(ClockLog&)>& change) {
    loaded_.log.events = std::move(loaded_.beats.beats);
    change(loaded_.log);
    number();
  }

  void use_flag() {
    ClockLog& log = loaded_.log;
    const double width = request_.flag_width_rad.value_or(log.flag_width_rad.value_or(0.0));
    const bool widths = !log.columns.width_s.empty();
    if (widths && width == 0.0)
      assume("the widths give no amplitude: the flag's own width is not known",
             Setting::flag_width);
    if (widths && width > 0.0) {
      log.events = std::move(loaded_.beats.beats);
      const double period_s =
          log.nominal_period_s
              ? *log.nominal_period_s
              : small_swing_period(log, width, loaded_.nominal_period_s, request_.gravity_share);
      set_amplitudes_from_widths(log, width, period_s, request_.gravity_share);
      correct_widths_for_friction(log, width, period_s);
      loaded_.beats.beats = std::move(log.events);
    } else if (width > 0.0 && !log.has_amplitude) {
      assume("the times are those of a flag's leading edge, and without amplitudes cannot be moved "
             "to the vertical: where the amplitude changes, the rate is biased");
    } else if (width > 0.0) {
      with_events([&](ClockLog& moved) {
        move_to_vertical(moved, -0.5 * width, 0.5 * width, loaded_.nominal_period_s);
      });
    }
  }

  std::optional<double> found_offset() {
    auto& found = loaded_.sensor.offset_rad;
    found = sensor_offset(loaded_.beats.beats, loaded_.nominal_period_s);
    if (found) {
      assume(fmt::format("the sensor stands at {:.4g} ± {:.2g} mrad, estimated from the log",
                         found->value * 1e3, found->sigma * 1e3));
      return found->value;
    }
    if (!loaded_.sensor.beat_error_s)
      throw NumericsError(
          request_.path +
          ": the log does not tell where the sensor stands: it needs amplitudes and "
          "either both directions or 30 beats");
    assume("without amplitudes the beat error does not tell where the sensor stands: times stay "
           "those of the sensor, whose place is a parameter of the fit");
    return {};
  }

  void use_sensor_offset() {
    ClockLog& log = loaded_.log;
    auto& beats = loaded_.beats.beats;
    loaded_.sensor.beat_error_s = beat_error(beats);
    loaded_.sensor.sides_are_unknown = log.sound.has_value();
    if (loaded_.sensor.beat_error_s && log.sound)
      loaded_.sensor.beat_error_s->sigma =
          2.0 * std::hypot(0.5 * loaded_.sensor.beat_error_s->sigma, log.sound->tick.rise_s,
                           log.sound->tock.rise_s);
    if (!request_.find_sensor_offset && !request_.sensor_offset_rad) return;
    const auto place = request_.find_sensor_offset ? found_offset() : request_.sensor_offset_rad;
    if (!place) return;
    const double offset = *place;
    if (!log.has_amplitude) {
      set_amplitudes_from_halves(beats, offset, loaded_.nominal_period_s);
      log.has_amplitude = std::any_of(beats.begin(), beats.end(), [](const Beat& beat) {
        return !std::isnan(beat.amplitude_rad);
      });
    }
    with_events([&](ClockLog& moved) {
      move_to_vertical(moved, offset, offset, loaded_.nominal_period_s);
    });
    loaded_.sensor.at_vertical = true;
  }

  // The longest segment; no second copy of a log in which every event is good.
  void choose_good() {
    const auto& beats = loaded_.beats.beats;
    const bool all = loaded_.beats.segments == 1 &&
                     std::all_of(beats.begin(), beats.end(),
                                 [](const Beat& beat) { return beat.flag == BeatFlag::good; });
    if (!all) loaded_.chosen = loaded_.beats.longest_segment();
    loaded_.good = all ? std::span<const Beat>(beats) : std::span<const Beat>(loaded_.chosen);
  }

  const LoadRequest& request_;
  NumberedLog loaded_;
};

} // namespace

NumberedLog load(const LoadRequest& request) {
  std::vector<std::string> paths{request.path};
  paths.insert(paths.end(), request.more.begin(), request.more.end());
  return Loading(read_log_files(paths, request.reading), request).run();
}

NumberedLog load_text(std::string_view text, const LoadRequest& request) {
  return Loading(read_log(text, request.path, request.reading), request).run();
}

NumberedLog load_events(ClockLog log, const LoadRequest& request) {
  constexpr std::size_t fewest_events = 3; // two periods: the least from which a rate has a scatter
  if (log.events.size() < fewest_events)
    throw InputError({log.source, 0, 0}, fmt::format("{} events", log.events.size()),
                     fmt::format("at least {}", fewest_events));
  if (!log.nominal_period_s) log.nominal_period_s = request.reading.nominal_period_s;
  constexpr double years_s = 1e8; // three years: a larger time counts from 1970, not from a start
  if (log.origin == TimeOrigin::none && log.events.front().time.to_double() > years_s)
    log.origin = TimeOrigin::epoch;
  LoadRequest named = request;
  named.path = log.source;
  return Loading(std::move(log), named).run();
}

RateSummary mean_rate(const NumberedLog& loaded) {
  RateSummary summary = summarise_rates(loaded.good, loaded.nominal_period_s);
  summary.nominal_is_known = loaded.nominal_is_known;
  add_time_base(summary, loaded.log.time_base_sigma);
  return summary;
}

PhaseSeries phase_series(const NumberedLog& loaded) {
  if (loaded.log.grid) return {loaded.log.grid->phase_s, loaded.log.grid->tau0_s};
  const auto error = clock_error(loaded.good, loaded.nominal_period_s);
  return {on_every_cycle(loaded.good, error), loaded.nominal_period_s};
}

} // namespace goingrate
