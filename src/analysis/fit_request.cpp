#include "goingrate/analysis/fit_request.hpp"

#include "goingrate/analysis/analyse.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/fit/par_file.hpp"
#include "goingrate/log/reading.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate {

namespace {

// Splits "NAME=REST"; `form` is what messages say the text must be.
std::pair<std::string, std::string> named(const char* option, const std::string& text,
                                          const char* form) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw ArgumentError(option, text, form);
  return {text.substr(0, equals), text.substr(equals + 1)};
}

// Throws unless the event lies between the first and the last beat; `legal` says so in the words of
// whoever named it.
void check_inside(const FitEvent& event, const NumberedLog& loaded, const std::string& text,
                  const std::string& legal) {
  const std::int64_t length = loaded.good.back().cycle - loaded.good.front().cycle;
  if (event.cycle <= 0 || event.cycle >= length)
    throw ArgumentError("event", text, "inside the log, between " + legal);
}

// "300s:mu" is an event by time. Otherwise the text gives a cycle as `rate` prints it, and the
// result counts cycles from the first good beat.
FitEvent event_in(const std::string& text, const NumberedLog& loaded) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || colon == 0 || text[colon - 1] != 's') {
    FitEvent event = parse_fit_event(text);
    const std::int64_t first = loaded.good.front().cycle;
    event.cycle -= first;
    check_inside(event, loaded, text,
                 fmt::format("cycles {} and {}", first, loaded.good.back().cycle));
    return event;
  }
  FitEvent event = parse_fit_event(std::string("0").append(text, colon));
  const auto time_s = parse_instant(std::string_view(text).substr(0, colon - 1));
  if (!time_s) throw ArgumentError("event", text, "a time in seconds, such as 300s:mu");
  event.cycle = cycle_at(loaded.good, time_s->to_double());
  check_inside(event, loaded, text,
               fmt::format("0s and {:.9g}s", loaded.good.back().time - loaded.good.front().time));
  event.movable = true; // a time need not be exact to the beat: the fit may shift the event
  return event;
}

// What the log lacks for this parameter; empty if it lacks nothing.
std::string missing_for(const std::string& parameter, const ClockLog& log) {
  const EventColumns& columns = log.columns;
  const bool needs_both = parameter == "density";
  if ((parameter == "temperature" || needs_both) && columns.temperature_c.empty())
    return "temperature column";
  if ((parameter == "pressure" || needs_both) && columns.pressure_mbar.empty())
    return "pressure column";
  if (parameter == "humidity" && columns.humidity_percent.empty()) return "humidity column";
  if (parameter == "tide" && log.origin == TimeOrigin::none) return "date";
  if (parameter == "tide" && !log.site) return "location of the clock";
  return {};
}

void check_for(const char* role, const std::string& parameter, const ClockLog& log) {
  if (const std::string missing = missing_for(parameter, log); !missing.empty())
    throw ArgumentError(role, parameter, fmt::format("left out: this log has no {}", missing));
}

void check_terms(const FitRequest& request, const ClockLog& log) {
  for (const std::string& name : request.freed)
    check_for("free", name, log);
  for (const auto& [name, value] : request.fixed)
    check_for("fix", name, log);
  for (const Prior& prior : request.priors)
    check_for("prior", prior.name, log);
}

// Throws where a file asks for what this log cannot give; the message gives the file's line.
void check_against(const ParFile& file, const NumberedLog& loaded) {
  const std::int64_t first = loaded.good.front().cycle, last = loaded.good.back().cycle;
  for (std::size_t k = 0; k < file.event_places.size(); ++k) {
    const std::int64_t cycle = file.options.events[k].cycle;
    if (cycle <= first || cycle >= last)
      throw InputError(file.event_places[k], fmt::format("cycle {}", cycle),
                       fmt::format("one inside the log, between {} and {}", first, last));
  }
  for (const auto& [name, place] : file.parameter_places)
    if (const std::string missing = missing_for(name, loaded.log); !missing.empty())
      throw InputError(place, fmt::format("'{}'", name), fmt::format("a log with a {}", missing));
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

// Replaces the events of a parameter file, and everything it says of them, by those that the
// request names or the diary finds. Without events in the request, those of the file stay.
void put_events(const FitRequest& request, const NumberedLog& loaded, FitOptions& result) {
  if (request.events.empty()) return;
  const auto asks_for = [&](const char* word) {
    return request.events == std::vector<std::string>{word};
  };
  const auto is_of_event = [](const auto& entry) {
    return entry.first.find('@') != std::string::npos;
  };
  std::erase_if(result.fixed, is_of_event);
  std::erase_if(result.start, is_of_event);
  std::erase_if(result.priors,
                [](const Prior& prior) { return prior.name.find('@') != std::string::npos; });
  result.events.clear();
  if (asks_for("none")) return;
  if (asks_for("auto")) {
    ask_for_changes(diary_of(loaded, fit_data(loaded)), loaded.good.front().cycle, result);
    return;
  }
  for (const std::string& text : request.events)
    result.events.push_back(event_in(text, loaded));
}

void drop_prior(FitOptions& options, const std::string& name) {
  std::erase_if(options.priors, [&](const Prior& prior) { return prior.name == name; });
}

// Frees a parameter that is held; the search starts at the held value.
void set_free(FitOptions& options, const std::string& name) {
  if (const auto held = options.fixed.extract(name))
    options.start.insert_or_assign(name, held.mapped());
}

bool is_fixed(const FitRequest& request, const std::string& name) {
  return std::any_of(request.fixed.begin(), request.fixed.end(),
                     [&](const auto& fixed) { return fixed.first == name; });
}

void put_fixed(const FitRequest& request, FitOptions& result) {
  for (const auto& [name, value] : request.fixed) {
    result.fixed[name] = value;
    result.start.erase(name);
    std::erase(result.freed, name);
    drop_prior(result, name);
  }
}

void put_freed(const FitRequest& request, FitOptions& result) {
  for (const std::string& name : request.freed) {
    if (is_fixed(request, name)) throw ArgumentError("free", name, "a parameter that is not fixed");
    set_free(result, name);
    result.freed.push_back(name);
  }
}

// A prior frees a parameter that the file holds, but not one that the request fixes: the fit
// refuses that pair. Must run after put_fixed().
void put_priors(const FitRequest& request, FitOptions& result) {
  for (const Prior& prior : request.priors) {
    if (!is_fixed(request, prior.name)) set_free(result, prior.name);
    drop_prior(result, prior.name);
  }
  result.priors.insert(result.priors.end(), request.priors.begin(), request.priors.end());
}

// Holds gravity_share at the value the log was read with, unless the request or the file names it.
void put_gravity_share(const NumberedLog& loaded, FitOptions& result) {
  const std::string name = "gravity_share";
  const auto& freed = result.freed;
  const bool is_named = result.fixed.contains(name) || result.start.contains(name) ||
                        std::find(freed.begin(), freed.end(), name) != freed.end();
  if (!is_named && loaded.sensor.gravity_share != 1.0)
    result.fixed[name] = loaded.sensor.gravity_share;
}

// Sets an option that takes one of a few words; throws if `word` is none of them.
void put_word(const char* name, const std::string& word, const char* legal,
              bool (*set)(FitOptions&, std::string_view), FitOptions& result) {
  if (!word.empty() && !set(result, word)) throw ArgumentError(name, word, legal);
}

} // namespace

bool finds_events(const FitRequest& request) {
  const bool none_given = request.events.empty() && request.from.empty();
  return none_given || request.events == std::vector<std::string>{"auto"};
}

FitRequest searching(FitRequest request) {
  if (finds_events(request)) request.events = {"auto"};
  return request;
}

FitOptions fit_options(const FitRequest& request, const NumberedLog& loaded) {
  FitOptions result = request.from.empty() ? FitOptions{} : options_of_file(request.from, loaded);
  put_word("model", request.model, "averaged1, averaged2, map or auto", set_dynamics, result);
  put_word("noise", request.noise, "jitter, drive, both, slow or auto", set_noise, result);
  put_word("escapement", request.escapement, "constant-torque, single-impulse, none or auto",
           set_escapement, result);
  check_terms(request, loaded.log);
  put_events(request, loaded, result);
  put_fixed(request, result);
  put_freed(request, result);
  put_priors(request, result);
  put_gravity_share(loaded, result);
  drop_partial_start(result);
  return with_seen_weather(with_seen_offset(std::move(result), loaded), loaded);
}

namespace {

double number_of(std::string_view text, std::string_view request, std::string_view legal) {
  const auto value = parse_instant(text); // takes the whole text or fails
  if (!value) throw ArgumentError(request, text, legal);
  return value->to_double();
}

double number_for(std::string_view parameter, std::string_view request, std::string_view text) {
  return number_of(text, request, fmt::format("a number, for {}", parameter));
}

} // namespace

std::pair<std::string, double> parse_fixed(const std::string& text) {
  const auto [name, value] = named("fix", text, "NAME=VALUE");
  return {name, number_for(name, "fix", value)};
}

Prior parse_prior(const std::string& text) {
  constexpr const char* form = "NAME=VALUE+-SIGMA";
  const auto [name, rest] = named("prior", text, form);
  for (const std::string_view sign : {"+-", "±"})
    if (const std::size_t at = rest.find(sign); at != std::string::npos)
      return {name, number_for(name, "prior", rest.substr(0, at)),
              number_for(name, "prior", rest.substr(at + sign.size()))};
  throw ArgumentError("prior", text, form);
}

double number_in(std::string_view name, std::string_view text) {
  return number_of(text, name, "a number");
}

} // namespace goingrate
