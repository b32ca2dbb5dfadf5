// From the command line's words to the options of a fit.
#include "common.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/fit/par_file.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate::apps {

namespace {

double number_in(const std::string& option, const std::string& text) {
  const auto value = parse_instant(text); // the one reader of decimal text; nothing is left over
  if (!value) throw ArgumentError(option, text, "a number");
  return value->to_double();
}

// "NAME=REST"
std::pair<std::string, std::string> named(const std::string& option, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw ArgumentError(option, text, "NAME=VALUE");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

// The sign is "+-", or "±" as results print it.
Prior parse_prior(const std::string& text) {
  const auto [name, rest] = named("prior", text);
  for (const std::string_view sign : {"+-", "±"})
    if (const std::size_t at = rest.find(sign); at != std::string::npos)
      return {name, number_in("prior", rest.substr(0, at)),
              number_in("prior", rest.substr(at + sign.size()))};
  throw ArgumentError("prior", text, "NAME=VALUE+-SIGMA");
}

// "300s:mu" is an event by time; otherwise the cycle is the one `rate` prints.
FitEvent event_in(const std::string& text, const NumberedLog& loaded) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || colon == 0 || text[colon - 1] != 's') {
    FitEvent event = parse_fit_event(text);
    event.cycle -= loaded.good.front().cycle;
    return event;
  }
  FitEvent event = parse_fit_event("0" + text.substr(colon));
  event.cycle = cycle_at(loaded.good, number_in("event", text.substr(0, colon - 1)));
  event.movable = true; // who gives a time means the beat next to it, one way or the other
  return event;
}

// A file that asks for what this log cannot give is the file's fault; said where it asks.
void check_against(const ParFile& file, const NumberedLog& loaded) {
  const std::int64_t first = loaded.good.front().cycle, last = loaded.good.back().cycle;
  for (std::size_t k = 0; k < file.event_places.size(); ++k) {
    const std::int64_t cycle = file.options.events[k].cycle;
    if (cycle <= first || cycle >= last)
      throw InputError(file.event_places[k], fmt::format("cycle {}", cycle),
                       fmt::format("one inside the log, between {} and {}", first, last));
  }
  const EventColumns& columns = loaded.log.columns;
  for (const auto& [name, place] : file.parameter_places)
    if ((name == "temperature" && columns.temperature_c.empty()) ||
        (name == "pressure" && columns.pressure_mbar.empty()) ||
        (name == "density" && (columns.temperature_c.empty() || columns.pressure_mbar.empty())))
      throw InputError(place, fmt::format("'{}'", name), "a log with a column of it");
}

FitOptions options_of_file(const std::string& path, const NumberedLog& loaded) {
  if (path == "-" && loaded.log.source == "-")
    throw ArgumentError("from", path, "a file: standard input is the log");
  ParFile file = parse_par(read_text(path), path);
  check_against(file, loaded);
  for (FitEvent& event : file.options.events)
    event.cycle -= loaded.good.front().cycle;
  return std::move(file.options);
}

// The events of the command line, or those that are found; what a file says of its own goes.
void put_events(const ModelOptions& options, const NumberedLog& loaded, FitOptions& result) {
  if (options.events.empty()) return;
  const auto asks_for = [&](const char* word) {
    return options.events == std::vector<std::string>{word};
  };
  const auto of_event = [](const auto& entry) {
    return entry.first.find('@') != std::string::npos;
  };
  std::erase_if(result.fixed, of_event);
  std::erase_if(result.start, of_event);
  std::erase_if(result.priors,
                [](const Prior& prior) { return prior.name.find('@') != std::string::npos; });
  result.events.clear();
  if (asks_for("none")) return;
  if (asks_for("auto")) {
    ask_for_changes(diary_of(loaded, fit_data(loaded)), loaded.good.front().cycle, result);
    return;
  }
  for (const std::string& text : options.events)
    result.events.push_back(event_in(text, loaded));
}

void drop_prior(FitOptions& options, const std::string& name) {
  std::erase_if(options.priors, [&](const Prior& prior) { return prior.name == name; });
}

// What is held no longer; the search starts where it was held.
void set_free(FitOptions& options, const std::string& name) {
  if (const auto held = options.fixed.extract(name))
    options.start.insert_or_assign(name, held.mapped());
}

void put_fixed(const ModelOptions& options, FitOptions& result) {
  for (const std::string& text : options.fixed) {
    const auto [name, value] = named("fix", text);
    result.fixed[name] = number_in("fix", value);
    result.start.erase(name);
    std::erase(result.freed, name);
    drop_prior(result, name);
  }
}

void put_freed(const ModelOptions& options, FitOptions& result) {
  for (const std::string& name : options.freed) {
    const auto is_name = [&](const std::string& text) { return text.starts_with(name + "="); };
    if (std::any_of(options.fixed.begin(), options.fixed.end(), is_name))
      throw ArgumentError("free", name, "a parameter that --fix does not hold");
    set_free(result, name);
    result.freed.push_back(name);
  }
}

// After --fix, so that a prior on what is held on the command line is refused by the fit; a prior
// on what the file holds frees it.
void put_priors(const ModelOptions& options, FitOptions& result) {
  std::vector<Prior> priors;
  for (const std::string& text : options.priors) {
    priors.push_back(parse_prior(text));
    const auto is_name = [&](const std::string& fixed) {
      return fixed.starts_with(priors.back().name + "=");
    };
    if (std::none_of(options.fixed.begin(), options.fixed.end(), is_name))
      set_free(result, priors.back().name);
  }
  for (const Prior& prior : priors)
    drop_prior(result, prior.name);
  result.priors.insert(result.priors.end(), priors.begin(), priors.end());
}

void add_parameter_options(CLI::App& command, ModelOptions& options) {
  command
      .add_option("--fix", options.fixed,
                  "hold a parameter: NAME=VALUE (T0 in s, epsilon, mu, phi0, lambda0, mu@1 ...)")
      ->allow_extra_args(false);
  command
      .add_option("--free", options.freed,
                  "fit these too: NAME[,NAME] of quadratic_drag, dry_friction, offset (of the "
                  "sensor, rad), drift (of the rate, 1/day), and, where the log has such columns, "
                  "temperature (1/K), pressure (1/mbar), and with both density (of air, m^3/kg); "
                  "or what a --from file holds")
      ->delimiter(',')
      ->allow_extra_args(false);
  command.add_option("--prior", options.priors, "knowledge from elsewhere: NAME=VALUE+-SIGMA")
      ->allow_extra_args(false);
  command
      .add_option(
          "--event", options.events,
          "parameters that change: CYCLE:NAME[,NAME], the names of mu, epsilon, phi0, T0; or by "
          "time 300s:mu; or auto to search, or none; the k-th gives mu@k [auto, or those of "
          "--from]")
      ->allow_extra_args(false);
}

} // namespace

void add_model_options(CLI::App& command, ModelOptions& options) {
  add_parameter_options(command, options);
  command
      .add_option("--model", options.model,
                  "averaged1 (the paper's first order), averaged2 (second order), map (the full "
                  "equation of motion) or auto (the simplest that is accurate enough) [auto]")
      ->check(CLI::IsMember({"averaged1", "averaged2", "map", "auto"}));
  command
      .add_option("--noise", options.noise,
                  "jitter of the sensor; drive: noise of the drive and exact times; both; slow: "
                  "these two and a drive that wanders; auto: jitter, and more if BIC asks for it "
                  "[auto]")
      ->check(CLI::IsMember({"jitter", "drive", "both", "slow", "auto"}));
  command
      .add_option("--escapement", options.escapement,
                  "constant-torque (mu, phi0), single-impulse (impulse, impulse_angle), none (a "
                  "free pendulum) or auto (constant-torque, or none if that explains the log) "
                  "[auto]")
      ->check(CLI::IsMember({"constant-torque", "single-impulse", "none", "auto"}));
  command.add_option("--from", options.from,
                     "parameters as `fit --par` writes them: what is held, where the search "
                     "starts, events, priors, model; other options win over the file");
}

void tell_events(std::span<const FitEvent> events, std::span<const Beat> good,
                 const GlobalOptions& global) {
  for (const FitEvent& event : events) {
    const auto at = std::find_if(good.begin(), good.end(), [&](const Beat& beat) {
      return beat.cycle - good.front().cycle >= event.cycle;
    });
    say(global, fmt::format("found a change at cycle {} ({:.6g} s): {} may change there",
                            event.cycle + good.front().cycle, at->time - good.front().time,
                            event.names.front()));
  }
}

bool finds_events(const ModelOptions& options) {
  const bool names_none = options.events.empty() && options.from.empty();
  return names_none || options.events == std::vector<std::string>{"auto"};
}

ModelOptions searching(ModelOptions options) {
  if (finds_events(options)) options.events = {"auto"};
  return options;
}

FitOptions fit_options(const ModelOptions& options, const NumberedLog& loaded) {
  FitOptions result = options.from.empty() ? FitOptions{} : options_of_file(options.from, loaded);
  if (!options.model.empty()) set_dynamics(result, options.model);
  if (!options.noise.empty()) set_noise(result, options.noise);
  if (!options.escapement.empty()) set_escapement(result, options.escapement);
  put_events(options, loaded, result);
  put_fixed(options, result);
  put_freed(options, result);
  put_priors(options, result);
  drop_partial_start(result);
  return with_seen_offset(std::move(result), loaded);
}

std::vector<double> numbers_in(const std::string& option, const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    numbers.push_back(number_in(option, text.substr(begin, comma - begin)));
    begin = comma + 1;
  }
  return numbers;
}

} // namespace goingrate::apps
