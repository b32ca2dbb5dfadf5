#include "loading.hpp"

#include "base/readable.hpp"
#include "base/time_grain.hpp"
#include "log/file_parts.hpp"
#include "log/typical_period.hpp"
#include "sound/recording.hpp"
#include "log/unused_options.hpp"
#include "log/usual_step.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/log/rates.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <utility>

namespace goingrate {

namespace {

constexpr double largest_rate_excess = 0.05; // 72 min a day: no pendulum clock is so far off

class Loading {
public:
  Loading(ClockLog log, const LoadRequest& request) : request_(request) {
    loaded_.log = std::move(log);
    loaded_.sensor.gravity_share =
        request.gravity_share.value_or(loaded_.log.gravity_share.value_or(1.0));
  }

  NumberedLog run() {
    tell_unused(loaded_.log, request_.reading);
    const bool needs_events = !(request_.phases_will_do && loaded_.log.grid);
    if (needs_events) join_weather(loaded_.log, request_.weather);
    if (request_.site) loaded_.log.site = request_.site;
    if (loaded_.log.grid)
      take_grid();
    else
      number_events();
    if (!needs_events) return std::move(loaded_);
    choose_good(loaded_);
    if (loaded_.log.has_amplitude)
      loaded_.sensor.amplitude = summarise_amplitudes(loaded_.good);
    refuse_if_numbered_wrong();
    say_if_times_are_coarse();
    say_if_every_second_is_missing();
    if (loaded_.good.size() < 3)
      throw NumericsError(fmt::format(
          "{}: no three consecutive beats could be numbered, although the log has {} events, "
          "typically {} s apart: check the unit of its times and the nominal period",
          request_.path, loaded_.beats.beats.size(), readable(loaded_.beats.typical_period_s, 4)));
    return std::move(loaded_);
  }

private:
  void assume(std::string text, Setting setting = Setting::none) {
    loaded_.log.assumptions.push_back({std::move(text), setting});
  }

  // The number of whole swings between two values that are `tau0_s` apart.
  static std::int64_t swings_in(double tau0_s, double period_s) {
    const double swings = std::round(tau0_s / period_s);
    constexpr double rounding = 1e-9;
    if (!(swings >= 1.0 && std::abs(tau0_s - swings * period_s) <= rounding * tau0_s))
      throw ArgumentError(
          "nominal_period", period_s,
          fmt::format("the sampling interval, {:.6g} s, divided by a whole number", tau0_s));
    return static_cast<std::int64_t>(swings);
  }

  // The cycle of each value follows from its position on the grid: there is nothing to number.
  void take_grid() {
    const GridData& grid = *loaded_.log.grid;
    loaded_.nominal_period_s = grid.tau0_s;
    refuse_times_for_phases(grid);
    if (request_.phases_will_do) return;
    refuse_phases_of_no_clock(grid);
    loaded_.log.nominal_period_s = request_.reading.nominal_period_s; // of a swing, not of the grid
    loaded_.nominal_period_s = loaded_.log.nominal_period_s.value_or(grid.tau0_s);
    loaded_.beats = beats_on_grid(std::move(loaded_.log.events), loaded_.log.source);
    count_swings(swings_in(grid.tau0_s, loaded_.nominal_period_s), loaded_.beats);
    loaded_.log.events.clear();
  }

  // Periods from one good upward crossing to the next; NaN where a crossing is missing.
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

  // Refuses beats whose mean period differs from the typical interval between events: most events
  // are then false, and their numbers mean nothing. The two may also differ for wide free swings
  // that die away; their period changes smoothly, and they are accepted.
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
        fmt::format("events typically {:.6g} s apart but numbered beats {:.6g} s apart on average",
                    typical, mean),
        "nearly equal intervals, as from one clock", readings_for_period(mean, typical));
  }

  // Reports times that the logger rounded, if a step exceeds 1e-5 of a period and rounding explains
  // most of the scatter of the beats.
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
    assume(fmt::format("the times are whole multiples of {:.6g} s: rounding gives each time an "
                       "error of {:.2g} s rms",
                       grain_s, rounding_sigma(grain_s)));
  }

  void say_if_every_second_is_missing() {
    if (loaded_.log.grid || usual_step(loaded_.good) != 2) return;
    assume(fmt::format("every second beat is missing; a period is one full swing (tick and tock): "
                       "if a full swing takes {:.6g} s, set the nominal period to that",
                       2.0 * loaded_.nominal_period_s),
           Setting::nominal_period);
  }

  // Phases that rise with every value by nearly the same, as times do, are times, whoever declares
  // them phases: no error of a clock grows by a twentieth of the time.
  void refuse_times_for_phases(const GridData& grid) const {
    if (loaded_.log.format != LogFormat::phase || loaded_.log.events.empty()) return;
    const double least_step_s = largest_rate_excess * grid.tau0_s;
    std::vector<double> long_steps;
    std::size_t steps = 0;
    for (std::size_t i = 1; i < grid.phase_s.size(); ++i) {
      const double step = grid.phase_s[i] - grid.phase_s[i - 1];
      steps += std::isfinite(step) ? 1 : 0;
      if (std::isfinite(step) && step > least_step_s) long_steps.push_back(step);
    }
    if (long_steps.empty()) return;
    constexpr double day_s = 86400.0;
    const double usual_s = median(long_steps);
    constexpr double most_scatter = 0.1; // of the step: beats are more even
    const auto alike = std::count_if(long_steps.begin(), long_steps.end(), [&](double step) {
      return std::abs(step - usual_s) < most_scatter * usual_s;
    });
    constexpr double least_share = 0.9; // of the steps: the others are gaps and false beats
    if (static_cast<double>(alike) < least_share * static_cast<double>(steps)) return;
    throw ImpossibleReading(
        loaded_.log.place(loaded_.log.events.front().line),
        fmt::format("phases that rise by {:.6g} s from one to the next, {:.6g} s apart", usual_s,
                    grid.tau0_s),
        "the error of a clock, which does not go with the time",
        {{.words = "they are the times of beats", .format = LogFormat::timestamps},
         {.words = "they lie further apart, a day for instance", .tau0_s = day_s}});
  }

  // Phases that were recognised as such, not declared, must be possible as the error of a clock.
  void refuse_phases_of_no_clock(const GridData& grid) const {
    if (request_.reading.format || loaded_.log.format != LogFormat::phase) return;
    std::size_t large_steps = 0, known_steps = 0;
    for (std::size_t i = 1; i < grid.phase_s.size(); ++i) {
      const double step = std::abs(grid.phase_s[i] - grid.phase_s[i - 1]);
      if (std::isnan(step)) continue;
      ++known_steps;
      large_steps += step > largest_rate_excess * grid.tau0_s ? 1 : 0;
    }
    if (2 * large_steps <= known_steps) return;
    throw ImpossibleReading(
        loaded_.log.place(loaded_.log.events.front().line),
        fmt::format("{} of {} steps between phases larger than {:.0f} % of the sampling interval",
                    large_steps, known_steps, 100.0 * largest_rate_excess),
        "smaller steps, as in the error of a clock", readings_for_phases(grid));
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

  // The number of swings from one event to the next where a wheel closes a contact, say once a
  // minute; 1 for a sensor that sees the swings themselves. Up to 8 swings count as missed beats,
  // which the numbering finds by itself.
  [[nodiscard]] std::int64_t swings_between_contacts() const {
    const ClockLog& log = loaded_.log;
    if (!log.nominal_period_s) return 1;
    constexpr double max_missed_swings = 8.0, whole_tolerance_swings = 0.1;
    // A little more than the half-second swings of a minute; a larger number is a wrong unit.
    constexpr double max_swings_per_contact = 128.0;
    const double swings = typical_period(log.events, log.source, {}).mean_s / *log.nominal_period_s;
    const double whole = std::round(swings);
    const bool is_wheel = whole > max_missed_swings && whole <= max_swings_per_contact &&
                          std::abs(swings - whole) < whole_tolerance_swings;
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
          fmt::format("at most half of the period found with it, {} s", readable(typical, 4)));
    loaded_.nominal_period_s = nominal_period(log, loaded_.beats, log.assumptions);
    loaded_.nominal_is_known = log.nominal_period_s || usual_period(typical);
    // A period given in the request is believed; one that the log states must match its beats.
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

  // Applies a correction that moves the times of numbered events, and numbers them again.
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
      assume("the widths in the log give no amplitudes: the width of the flag itself is not known",
             Setting::flag_width);
    if (widths && width > 0.0) {
      const double share = loaded_.sensor.gravity_share;
      log.events = std::move(loaded_.beats.beats);
      const double period_s =
          log.nominal_period_s
              ? *log.nominal_period_s
              : small_swing_period(log, width, loaded_.nominal_period_s, share);
      set_amplitudes_from_widths(log, width, period_s, share);
      correct_widths_for_friction(log, width, period_s);
      loaded_.beats.beats = std::move(log.events);
    } else if (width > 0.0 && !log.has_amplitude) {
      log.flag_width_rad = width;
      assume("the times are those of the flag's leading edge; without amplitudes they cannot be "
             "moved to the vertical, and a change of the amplitude biases the rate; the fit takes "
             "the sensor to be half of the flag's width before the vertical");
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
      assume(fmt::format("the sensor is {:.4g} ± {:.2g} mrad off the vertical, estimated from the "
                         "log",
                         found->value * 1e3, found->sigma * 1e3));
      return found->value;
    }
    if (!loaded_.sensor.beat_error_s)
      throw NumericsError(request_.path +
                          ": cannot find the sensor's offset from the vertical: the log needs "
                          "amplitudes, and either crossings in both directions or at least 30 "
                          "beats whose amplitudes scatter");
    assume("without amplitudes the beat error does not give the sensor's offset: the times are "
           "left uncorrected, and the fit treats the offset as a parameter");
    return {};
  }

  void use_sensor_offset() {
    ClockLog& log = loaded_.log;
    auto& beats = loaded_.beats.beats;
    if (loaded_.beats.has_downward) loaded_.sensor.beat_error_s = beat_error(beats);
    loaded_.sensor.sides_are_unknown = log.sound.has_value();
    if (loaded_.sensor.beat_error_s && log.sound)
      loaded_.sensor.beat_error_s->sigma =
          2.0 * std::hypot(0.5 * loaded_.sensor.beat_error_s->sigma, log.sound->tick.rise_s,
                           log.sound->tock.rise_s);
    if (!request_.find_sensor_offset && !request_.sensor_offset_rad) return;
    const auto known = request_.find_sensor_offset ? found_offset() : request_.sensor_offset_rad;
    if (!known) return;
    const double offset = *known;
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

  const LoadRequest& request_;
  NumberedLog loaded_;
};

// The request with another reading of the log.
LoadRequest read_as(LoadRequest request, const OtherReading& other) {
  const auto take = [](const auto& from, auto& to) {
    if (from) to = from;
  };
  take(other.format, request.reading.format);
  take(other.nominal_period_s, request.reading.nominal_period_s);
  take(other.tau0_s, request.reading.tau0_s);
  take(other.wrap_s, request.reading.wrap_s);
  if (!other.unit.empty()) request.reading.unit = unit_named(other.unit);
  for (const std::string& column : other.columns)
    request.reading.columns.push_back(column);
  request.both_edges |= other.both_edges;
  return request;
}

// Loads, and offers no other reading that would be refused as well.
template <class Load> NumberedLog or_what_can_be_read(const LoadRequest& request, Load&& load_as) {
  try {
    return load_as(request);
  } catch (const ImpossibleReading& error) {
    std::vector<OtherReading> others = error.others();
    std::erase_if(others, [&](const OtherReading& other) {
      try {
        return load_as(read_as(request, other)).good.empty();
      } catch (const InputError&) {
        return true;
      } catch (const ArgumentError&) { // an option of the request that does not go with it
        return true;
      }
    });
    throw error.with_others(std::move(others));
  }
}

} // namespace

void choose_good(NumberedLog& loaded) {
  const Beats& numbers = loaded.beats;
  const std::vector<Beat>& beats = numbers.beats;
  const auto is_good = [](const Beat& beat) { return beat.flag == BeatFlag::good; };
  const bool no_faults = numbers.spurious + numbers.rivals + numbers.bounces == 0;
  const bool all = numbers.segments == 1 &&
                   ((no_faults && !numbers.has_downward) ||
                    std::all_of(beats.begin(), beats.end(), is_good));
  if (!all) loaded.chosen = loaded.beats.longest_segment();
  loaded.good = all ? std::span<const Beat>(beats) : std::span<const Beat>(loaded.chosen);
}

NumberedLog loaded_from(ClockLog log, const LoadRequest& request) {
  return Loading(std::move(log), request).run();
}

NumberedLog load(const LoadRequest& request, const LogVisitor& visit) {
  std::vector<std::string> paths{request.path};
  paths.insert(paths.end(), request.more.begin(), request.more.end());
  const bool is_one = paths.size() == 1 && !holds_files(request.path);
  const LogVisitor nobody;
  bool is_first = true; // others are only tried
  const auto load_as = [&](LoadRequest as) {
    const LogVisitor& visitor = std::exchange(is_first, false) ? visit : nobody;
    as.reading.phases_alone = is_one && as.phases_will_do;
    if (is_one && !is_sound_on_disk(as.path)) return load_in_parts(as, visitor);
    NumberedLog whole = loaded_from(read_log_files(paths, as.reading), as);
    if (visitor) visitor({whole, 0, whole.beats.beats.size(), 0});
    return whole;
  };
  const bool can_be_read_again = std::all_of(paths.begin(), paths.end(), [](const auto& path) {
    return std::filesystem::is_regular_file(path);
  });
  return can_be_read_again ? or_what_can_be_read(request, load_as) : load_as(request);
}

NumberedLog load_text(std::string_view text, const LoadRequest& request) {
  return or_what_can_be_read(request, [&](LoadRequest as) {
    as.reading.phases_alone = as.phases_will_do;
    return loaded_from(read_log(text, as.path, as.reading), as);
  });
}

NumberedLog load_events(ClockLog log, const LoadRequest& request) {
  constexpr std::size_t fewest_events = 3; // two periods, the fewest that show a scatter
  if (log.events.size() < fewest_events)
    throw InputError({log.source, 0, 0}, fmt::format("{} events", log.events.size()),
                     fmt::format("at least {}", fewest_events));
  if (!log.nominal_period_s) log.nominal_period_s = request.reading.nominal_period_s;
  // Three years. A log whose times begin later counts from 1970, not from its own start.
  constexpr double longest_first_time_s = 1e8;
  if (log.origin == TimeOrigin::none && log.events.front().time.to_double() > longest_first_time_s)
    log.origin = TimeOrigin::epoch;
  LoadRequest named = request;
  named.path = log.source;
  return loaded_from(std::move(log), named);
}

RateSummary mean_rate(const NumberedLog& loaded) {
  RateSummary summary = summarise_rates(loaded.good, loaded.nominal_period_s);
  if (loaded.crossings > 0) summary.crossings = loaded.crossings;
  summary.nominal_is_known = loaded.nominal_is_known;
  add_time_base(summary, loaded.log.time_base_sigma);
  return summary;
}

PhaseSeries phase_series(NumberedLog&& loaded) {
  if (loaded.log.grid) return {std::move(loaded.log.grid->phase_s), loaded.log.grid->tau0_s};
  return phase_series(loaded);
}

PhaseSeries phase_series(const NumberedLog& loaded) {
  if (loaded.log.grid) return {loaded.log.grid->phase_s, loaded.log.grid->tau0_s};
  const auto error = clock_error(loaded.good, loaded.nominal_period_s);
  const std::int64_t step = loaded.beats.step;
  return {on_every_cycle(loaded.good, error, step),
          static_cast<double>(step) * loaded.nominal_period_s};
}

} // namespace goingrate
