// From the command line's words to the options of a fit.
#include "common.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>
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
  return {name, number_in("prior", rest.substr(0, sign)), number_in("prior", rest.substr(sign + 2))};
}

// "300s:mu" is the first beat at or after 300 s into the log; otherwise the cycle `rate` prints.
FitEvent event_in(const std::string& text, const NumberedLog& loaded) {
  const std::size_t colon = text.find(':');
  const std::int64_t first = loaded.good.front().cycle;
  if (colon == std::string::npos || colon == 0 || text[colon - 1] != 's') {
    FitEvent event = parse_fit_event(text);
    event.cycle -= first;
    return event;
  }
  const double at_s = number_in("event", text.substr(0, colon - 1));
  FitEvent event = parse_fit_event("0" + text.substr(colon));
  for (const Beat& beat : loaded.good) {
    event.cycle = beat.cycle - first;
    if (beat.time - loaded.good.front().time >= at_s) break;
  }
  return event;
}

std::vector<FitEvent> events_found(const NumberedLog& loaded, const GlobalOptions& global) {
  constexpr std::size_t most = 4; // each costs a parameter
  std::vector<Change> changes = keep_diary(loaded.good, loaded.nominal_period_s).changes;
  std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) {
    return a.significance > b.significance;
  });
  if (changes.size() > most) changes.resize(most);
  std::sort(changes.begin(), changes.end(),
            [](const Change& a, const Change& b) { return a.cycle < b.cycle; });
  std::vector<FitEvent> events;
  for (const Change& change : changes) {
    say(global, fmt::format("found a change at cycle {} ({:.6g} s): mu may change there", change.cycle,
                            change.at_s));
    events.push_back({change.cycle - loaded.good.front().cycle, {"mu"}});
  }
  return events;
}

} // namespace

void add_model_options(CLI::App& command, ModelOptions& options) {
  command.add_option("--fix", options.fixed, "hold a parameter: NAME=VALUE (T0 in s, epsilon, mu, phi0, "
                                             "lambda0, mu@1 ...)")
      ->allow_extra_args(false);
  command.add_option("--prior", options.priors, "knowledge from elsewhere: NAME=VALUE+-SIGMA")
      ->allow_extra_args(false);
  command.add_option("--event", options.events,
                     "parameters that change: CYCLE:NAME[,NAME], or by time 300s:mu, or auto to search; "
                     "the k-th gives mu@k")
      ->allow_extra_args(false)
      ->capture_default_str();
  command.add_option("--model", options.model,
                     "averaged1 (the paper's first order), direct (the full equation of motion) or auto")
      ->check(CLI::IsMember({"averaged1", "direct", "auto"}))
      ->capture_default_str();
}

FitOptions fit_options(const ModelOptions& options, const NumberedLog& loaded,
                       const GlobalOptions& global) {
  FitOptions result;
  for (const std::string& text : options.fixed) {
    const auto [name, value] = named("fix", text);
    result.fixed[name] = number_in("fix", value);
  }
  for (const std::string& text : options.priors) result.priors.push_back(parse_prior(text));
  if (options.events == std::vector<std::string>{"auto"}) {
    result.events = events_found(loaded, global);
  } else {
    for (const std::string& text : options.events) result.events.push_back(event_in(text, loaded));
  }
  if (options.model == "averaged1") result.dynamics = FitDynamics::averaged1;
  if (options.model == "direct") result.dynamics = FitDynamics::direct;
  return result;
}

DriveAnalysis analyse_drive(const NumberedLog& loaded, const FitSummary& fit, double split_hz) {
  DriveAnalysis drive;
  const auto rates = rate_about_fit(loaded.good, loaded.nominal_period_s, fit);
  // One segment, for the longest reach; a trend is a slow variation too and stays in.
  drive.rate_spectrum = welch_spectrum(rates, loaded.nominal_period_s,
                                       {.segment = rates.size(), .detrend_linear = false});
  const auto clock = fitted_clock(fit);
  if (clock) drive.response = drive_response(*clock);
  if (drive.response)
    drive.split = split_drive(drive.rate_spectrum, loaded.nominal_period_s, *drive.response, split_hz);
  return drive;
}

std::vector<std::size_t> listed_factors(const std::string& taus, std::size_t points, double tau0_s) {
  std::vector<std::size_t> factors;
  for (std::size_t begin = 0; begin <= taus.size();) {
    const std::size_t comma = std::min(taus.find(',', begin), taus.size());
    const double tau = number_in("taus", taus.substr(begin, comma - begin));
    const double m = std::round(tau / tau0_s);
    const bool multiple = std::abs(m * tau0_s - tau) <= 1e-6 * tau; // decimal text of a multiple
    if (!multiple || m < 1.0 || 2.0 * m >= static_cast<double>(points))
      throw ArgumentError("taus", tau, fmt::format("a multiple of {} s below half the data", tau0_s));
    factors.push_back(static_cast<std::size_t>(m));
    begin = comma + 1;
  }
  std::sort(factors.begin(), factors.end());
  factors.erase(std::unique(factors.begin(), factors.end()), factors.end());
  return factors;
}

} // namespace goingrate::apps
