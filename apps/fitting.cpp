// From the command line's words to the options of a fit.
#include "common.hpp"

#include "goingrate/base/errors.hpp"

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

Prior parse_prior(const std::string& text) {
  const auto [name, rest] = named("prior", text);
  const std::size_t sign = rest.find("+-");
  if (sign == std::string::npos) throw ArgumentError("prior", text, "NAME=VALUE+-SIGMA");
  return {name, number_in("prior", rest.substr(0, sign)),
          number_in("prior", rest.substr(sign + 2))};
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

std::vector<FitEvent> events_found(const NumberedLog& loaded, const GlobalOptions& global) {
  constexpr std::size_t most = 4; // each costs a parameter
  const auto changes = strongest_changes(keep_diary(loaded.good, loaded.nominal_period_s), most);
  std::vector<FitEvent> events;
  for (const Change& change : changes) {
    say(global, fmt::format("found a change at cycle {} ({:.6g} s): mu may change there",
                            change.cycle, change.at_s));
    events.push_back({change.cycle - loaded.good.front().cycle, {"mu"}, true});
  }
  return events;
}

} // namespace

void add_model_options(CLI::App& command, ModelOptions& options) {
  command
      .add_option("--fix", options.fixed,
                  "hold a parameter: NAME=VALUE (T0 in s, epsilon, mu, phi0, "
                  "lambda0, mu@1 ...)")
      ->allow_extra_args(false);
  command.add_option("--prior", options.priors, "knowledge from elsewhere: NAME=VALUE+-SIGMA")
      ->allow_extra_args(false);
  command
      .add_option(
          "--event", options.events,
          "parameters that change: CYCLE:NAME[,NAME], or by time 300s:mu, or auto to search; "
          "the k-th gives mu@k")
      ->allow_extra_args(false)
      ->capture_default_str();
  command
      .add_option("--model", options.model,
                  "averaged1 (the paper's first order), averaged2 (second order), map (the full "
                  "equation of "
                  "motion) or auto")
      ->check(CLI::IsMember({"averaged1", "averaged2", "map", "auto"}))
      ->capture_default_str();
}

FitOptions fit_options(const ModelOptions& options, const NumberedLog& loaded,
                       const GlobalOptions& global) {
  FitOptions result;
  for (const std::string& text : options.fixed) {
    const auto [name, value] = named("fix", text);
    result.fixed[name] = number_in("fix", value);
  }
  for (const std::string& text : options.priors)
    result.priors.push_back(parse_prior(text));
  if (options.events == std::vector<std::string>{"auto"}) {
    result.events = events_found(loaded, global);
  } else {
    for (const std::string& text : options.events)
      result.events.push_back(event_in(text, loaded));
  }
  if (options.model == "averaged1") result.dynamics = FitDynamics::averaged1;
  if (options.model == "averaged2") result.dynamics = FitDynamics::averaged2;
  if (options.model == "map") result.dynamics = FitDynamics::map;
  return result;
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
