// The options that describe a fit, and their translation into a FitRequest.
#include "common.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/fit/par_file.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate::apps {

namespace {

void add_parameter_options(CLI::App& command, ModelOptions& options) {
  std::vector<std::string> names = parameter_names();
  for (std::string& name : names)
    name += '=';
  auto* fix = command.add_option(
      "--fix", options.fixed,
      "hold a parameter: NAME=VALUE (T0 in s, epsilon, mu, phi0, lambda0, mu@1 ...)");
  offers(fix, names)->allow_extra_args(false);
  auto* free =
      command
          .add_option("--free", options.freed,
                      "fit these as well: NAME[,NAME]. For any log: quadratic_drag, dry_friction, "
                      "gravity_share, offset (of the sensor, rad), drift (of the rate, 1/day). "
                      "Where the log has the columns: temperature (1/K), pressure (1/mbar), "
                      "humidity (1/%), all fitted anyway where the rate responds by 5 sigma, and "
                      "from temperature and pressure density (of air, m^3/kg). With dates and "
                      "--site: tide (share of theory). Also any parameter that a --from file "
                      "holds")
          ->delimiter(',');
  offers(free, optional_parameter_names())->allow_extra_args(false);
  auto* prior = command.add_option("--prior", options.priors,
                                   "a value known from elsewhere: NAME=VALUE+-SIGMA");
  offers(prior, names)->allow_extra_args(false);
  auto* event = command.add_option(
      "--event", options.events,
      "a change of mu, epsilon, phi0 or T0. CYCLE:NAME[,NAME]: at that crossing. ~CYCLE:NAME: at "
      "some moment of the swings around it. 300s:mu: at that time. auto: search for changes. none: "
      "no changes. The k-th event gives mu@k [auto, or those of --from]");
  offers(event, {"auto", "none"})->allow_extra_args(false);
}

} // namespace

void add_model_options(CLI::App& command, ModelOptions& options) {
  add_parameter_options(command, options);
  command
      .add_option("--model", options.model,
                  "averaged1 (the paper's first order), averaged2 (second order), map (the full "
                  "equation of motion) or auto (the simplest that is accurate enough) [auto]")
      ->check(one_of({"averaged1", "averaged2", "map", "auto"}));
  command
      .add_option("--noise", options.noise,
                  "jitter: sensor jitter only; drive: drive noise only, times exact; both; slow: "
                  "both plus a slowly wandering drive; auto: jitter, plus more where the BIC "
                  "favours it [auto]")
      ->check(one_of({"jitter", "drive", "both", "slow", "auto"}));
  command
      .add_option("--escapement", options.escapement,
                  "constant-torque (mu, phi0), single-impulse (impulse, impulse_angle), none (a "
                  "free pendulum) or auto (constant-torque, or none if that explains the log) "
                  "[auto]")
      ->check(one_of({"constant-torque", "single-impulse", "none", "auto"}));
  command.add_option("--from", options.from,
                     "parameter file written by `fit --par`: held values, start values, events, "
                     "priors, model; options given here override it");
}

void tell_events(std::span<const FitEvent> events, std::span<const Beat> good,
                 const GlobalOptions& global) {
  for (const FitEvent& event : events) {
    const auto at = std::find_if(good.begin(), good.end(), [&](const Beat& beat) {
      return beat.cycle - good.front().cycle >= event.cycle;
    });
    say(global, fmt::format("change found at cycle {}, {:.6g} s after the first beat: the fit lets "
                            "{} change there",
                            event.cycle + good.front().cycle, at->time - good.front().time,
                            event.names.front()));
  }
}

FitRequest fit_request(const ModelOptions& options) {
  FitRequest request;
  for (const std::string& text : options.fixed)
    request.fixed.push_back(parse_fixed(text));
  for (const std::string& text : options.priors)
    request.priors.push_back(parse_prior(text));
  request.freed = options.freed;
  request.events = options.events;
  request.model = options.model;
  request.noise = options.noise;
  request.escapement = options.escapement;
  request.from = options.from;
  return request;
}

LogOptions with_held_share(LogOptions log, const ModelOptions& options) {
  for (const auto& [name, value] : fit_request(options).fixed)
    if (name == "gravity_share") log.gravity_share = value;
  return log;
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
