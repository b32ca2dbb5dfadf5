#include "goingrate/report/json.hpp"

#include "base/scaled_time.hpp"
#include "base/special_values.hpp"
#include "fit/push_shapes.hpp"
#include "goingrate/report/tables.hpp"
#include "json_parts.hpp"
#include "wording.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace goingrate {

namespace {

Json estimate_object(const std::optional<SensorEstimate>& estimate) {
  if (!estimate) return nullptr;
  return {{"value", json_number(estimate->value)}, {"sigma", json_number(estimate->sigma)}};
}

// Without a nominal period a rate would be taken against the log's own mean period, and be a
// meaningless zero.
Json rate_or_null(double rate, bool nominal_is_known) {
  return nominal_is_known ? json_number(rate) : Json(nullptr);
}

} // namespace

Json part_object(const PartRate& part, bool nominal_is_known) {
  const auto rate = [&](double value) { return rate_or_null(value, nominal_is_known); };
  return {{"segment", part.segment},
          {"from_cycle", part.from_cycle},
          {"to_cycle", part.to_cycle},
          {"duration_s", json_number(part.rate.duration_s)},
          {"mean_period_s", json_number(part.rate.mean_period_s)},
          {"rate_excess", rate(part.rate.rate_excess)},
          {"rate_s_per_day", rate(seconds_gained_per_day(part.rate.rate_excess))},
          {"rate_sigma_s_per_day", rate(seconds_gained_per_day(part.rate.rate_excess_sigma))},
          {"amplitude_rad", json_number(part.amplitude_rad)}};
}

namespace {

Json sound_object(const SoundFindings& sound, double time_base_sigma) {
  return {{"sampling_rate_hz", json_number(sound.rate_hz)},
          {"duration_s", json_number(sound.duration_s)},
          {"tocks", sound.has_tocks},
          {"drowned", sound.drowned},
          {"pps", sound.has_pps},
          {"time_base_sigma_ppm", json_number(1e6 * time_base_sigma)}};
}

// Of a log that is not split it is the rate of the log.
std::vector<PartRate> rates_of_segments(const ClockLog& log, const Beats& beats,
                                        const RateSummary& summary, const SensorFindings& sensor) {
  constexpr std::int64_t fewest_for_scatter = 5; // see PartRate
  const bool knows_amplitude = sensor.amplitude || !log.has_amplitude;
  if (beats.segments > 1 || summary.crossings < fewest_for_scatter || !knows_amplitude) {
    std::vector<PartRate> parts = segment_rates(beats.beats, summary.nominal_period_s);
    for (PartRate& part : parts)
      add_time_base(part.rate, summary.time_base_sigma);
    return parts;
  }
  const auto is_good = [](const Beat& beat) { return beat.flag == BeatFlag::good; };
  const auto& all = beats.beats;
  PartRate whole;
  const Beat& first = *std::find_if(all.begin(), all.end(), is_good);
  whole.from_cycle = first.cycle;
  whole.to_cycle = first.cycle + summary.periods;
  whole.start = first.time;
  whole.rate = summary;
  if (sensor.amplitude) whole.amplitude_rad = sensor.amplitude->mean_rad;
  return {whole};
}

} // namespace

Json rate_object(const ClockLog& log, const Beats& beats, const RateSummary& summary,
                 const SensorFindings& sensor) {
  Json json = json_with_schema("goingrate.rate");
  const auto rate = [&](double value) { return rate_or_null(value, summary.nominal_is_known); };
  json["source"] =
      file_name(log.source); // without folders, which a page for others should not show
  if (!log.files.empty()) {
    json["files"] = Json::array();
    for (const LogFile& file : log.files)
      json["files"].push_back(file.name);
  }
  json["crossings"] = summary.crossings;
  json["periods"] = summary.periods;
  json["missed"] = beats.missed;
  json["spurious"] = beats.spurious;
  json["rivals"] = beats.rivals;
  json["bounces"] = beats.bounces;
  json["segments"] = beats.segments;
  json["gaps"] = Json::array();
  for (const Gap& gap : beats.gaps)
    json["gaps"].push_back({{"after_cycle", gap.after_cycle},
                            {"length", gap.length},
                            {"probability", json_number(gap.probability)},
                            {"bridged", gap.bridged},
                            {"kind", name_of(gap.kind)}});
  json["longest_countable_gap"] = beats.longest_countable_gap;
  json["segment_rates"] = Json::array();
  for (const PartRate& part : rates_of_segments(log, beats, summary, sensor))
    json["segment_rates"].push_back(part_object(part, summary.nominal_is_known));
  json["format"] = name_of(log.format);
  json["beat_error_s"] = estimate_object(sensor.beat_error_s);
  json["sound"] = log.sound ? sound_object(*log.sound, log.time_base_sigma) : Json(nullptr);
  json["sensor_offset_rad"] = estimate_object(sensor.offset_rad);
  if (sensor.amplitude) {
    const AmplitudeSummary& amplitude = *sensor.amplitude;
    json["amplitude_rad"] = {{"mean", json_number(amplitude.mean_rad)},
                             {"sigma_of_one", json_number(amplitude.sigma_rad)}};
    json["rate_excess_at_zero_amplitude"] = rate(
        rate_without_circular_error(summary.rate_excess, amplitude.rms_rad, sensor.gravity_share));
  }
  json["nominal_period_known"] = summary.nominal_is_known;
  json["nominal_period_s"] = json_number(summary.nominal_period_s);
  json["mean_period_s"] = json_number(summary.mean_period_s);
  json["mean_period_sigma_s"] = json_number(summary.mean_period_sigma_s);
  json["last_period_s"] = json_number(summary.last_period_s);
  json["duration_s"] = json_number(summary.duration_s);
  json["rate_excess"] = rate(summary.rate_excess);
  json["rate_s_per_day"] = rate(seconds_gained_per_day(summary.rate_excess));
  json["rate_sigma_s_per_day"] = rate(seconds_gained_per_day(summary.rate_excess_sigma));
  json["slope_rate_s_per_day"] = rate(seconds_gained_per_day(summary.slope_rate_excess));
  json["assumptions"] = Json::array();
  for (const Assumption& assumption : log.assumptions)
    json["assumptions"].push_back(assumption.text);
  json["issues"] = Json::array();
  for (const LineIssue& issue : log.issues) {
    const std::size_t last_line = std::max(issue.line, issue.last_line);
    json["issues"].push_back({{"line", log.place(issue.line).line},
                              {"last_line", log.place(last_line).line},
                              {"lines", issue.lines},
                              {"scattered", issue.scattered},
                              {"kind", name_of(issue.kind)},
                              {"column", issue.column},
                              {"found", issue.found},
                              {"action", issue.action}});
    if (!log.files.empty()) json["issues"].back()["file"] = log.place(issue.line).file;
  }
  return json;
}

namespace {

Json impulse_object(const ImpulseCycle& pushes) {
  const auto estimate = [](const ImpulseCycle::Estimate& e) { // a sigma of 0: was not looked for
    return e.sigma > 0.0 ? Json{{"value", json_number(e.value)}, {"sigma", json_number(e.sigma)}}
                         : Json(nullptr);
  };
  return {{"periods", pushes.periods},
          {"regular", pushes.is_regular},
          {"gain_2logL", json_number(pushes.gain)},
          {"amplitude_step_rad",
           pushes.amplitude_step ? estimate(*pushes.amplitude_step) : Json(nullptr)},
          {"lateness_between_s", estimate(pushes.lateness)},
          {"later_by_push_s", estimate(push_shapes::kick_alone(pushes))},
          {"crossing_in_push_late_s", estimate(pushes.middle)},
          {"epsilon_if_all_drive", pushes.epsilon ? estimate(*pushes.epsilon) : Json(nullptr)}};
}

// An undetermined parameter has neither value nor interval; an open end of an interval is null.
Json parameter_object(const FittedParameter& p) {
  return {{"name", p.name},
          {"value", json_number(p.value)},
          {"sigma", json_number(p.sigma)},
          {"low68", json_number(p.low68)},
          {"high68", json_number(p.high68)},
          {"low95", json_number(p.low95)},
          {"high95", json_number(p.high95)},
          {"unit", p.unit},
          {"status", name_of(p.status)},
          {"at_bound", p.at_bound},
          {"first_order_shift_sigma", json_number(p.model_shift)}};
}

Json experiment_object(const Experiment& experiment) {
  Json sigmas = Json::object();
  for (const auto& [name, sigma] : experiment.relative_sigma)
    sigmas[name] = json_number(sigma);
  return {{"what", experiment.what}, {"relative_sigma", sigmas}};
}

Json twin_object(const ClockTwin& twin) {
  Json parameters = Json::object(), sigma = Json::object();
  for (const auto& [name, value] : twin.parameters)
    parameters[name] = json_number(value);
  for (const auto& [name, value] : twin.sigma)
    sigma[name] = json_number(value);
  return {{"parameters", parameters},
          {"sigma", sigma},
          {"delta_2logL", json_number(twin.delta_2logL)}};
}

Json derived_object(const DerivedQuantity& quantity) {
  return {{"value", json_number(quantity.value)}, {"sigma", json_number(quantity.sigma)}};
}

} // namespace

Json fit_object(const FitSummary& fit) {
  Json json = json_with_schema("goingrate.fit");
  json["termination"] = fit.termination;
  json["status"] = name_of(fit.status);
  json["converged"] =
      fit.status == FitStatus::converged || fit.status == FitStatus::contradicts_log;
  if (!fit.has_result()) return json;
  json["model"] = {{"dynamics", name_of(fit.dynamics)},
                   {"escapement", name_of(fit.model.escapement)},
                   {"friction", fit.model.friction()},
                   {"noise", fit.model.noise()},
                   {"chosen_by", fit.chosen_by}};
  json["parameters"] = Json::array();
  for (const FittedParameter& p : fit.parameters)
    json["parameters"].push_back(parameter_object(p));
  json["combinations"] = Json::array();
  for (const DerivedQuantity& c : fit.combinations)
    json["combinations"].push_back({{"name", c.name},
                                    {"expression", c.expression},
                                    {"value", json_number(c.value)},
                                    {"sigma", json_number(c.sigma)},
                                    {"unit", c.unit}});
  json["correlation"] = {{"names", fit.correlated}, {"matrix", fit.correlation}};
  json["derived"] = {{"Q", derived_object(fit.q_factor)},
                     {"stationary_amplitude", derived_object(fit.stationary_amplitude)},
                     {"rate_s_per_day", derived_object(fit.rate_s_per_day)},
                     {"decay_time_s", derived_object(fit.decay_time)}};
  if (fit.decay) json["decay"] = decay_object(*fit.decay);
  const FitQuality& q = fit.quality;
  json["quality"] = {{"chi2", json_number(q.chi2)},
                     {"dof", json_number(q.dof)},
                     {"p_value", json_number(q.p_value)},
                     {"whiteness_p", json_number(q.whiteness_p)},
                     {"rms_s", json_number(q.rms_s)},
                     {"amplitude_rms_rad", json_number(q.amplitude_rms_rad)},
                     {"aic", json_number(q.aic)},
                     {"bic", json_number(q.bic)},
                     {"time_widening", json_number(fit.time_widening)},
                     {"amplitude_widening", json_number(fit.amplitude_widening)}};
  json["alternatives"] = Json::array();
  for (const FitAlternative& a : fit.alternatives)
    json["alternatives"].push_back(
        {{"model", a.model}, {"bic", json_number(a.bic)}, {"verdict", a.verdict}});
  json["events"] = Json::array();
  for (const FitEvent& event : fit.events)
    json["events"].push_back({{"cycle", event.cycle}, {"names", event.names}});
  json["impulses"] = fit.impulses ? impulse_object(*fit.impulses) : Json(nullptr);
  json["twins"] = Json::array();
  for (const ClockTwin& twin : fit.twins)
    json["twins"].push_back(twin_object(twin));
  json["likeliest_twin"] = fit.likeliest_twin ? twin_object(*fit.likeliest_twin) : Json(nullptr);
  json["experiments"] = Json::array();
  for (const Experiment& experiment : fit.experiments)
    json["experiments"].push_back(experiment_object(experiment));
  json["thinning"] = {{"beats_used", fit.thinning.beats},
                      {"information_lost", json_number(fit.thinning.information_lost)}};
  json["notes"] = Json::array();
  for (const FitNote& note : fit.notes)
    json["notes"].push_back(note.text);
  return json;
}

namespace {

Json rms_object(const RmsEstimate& rms) {
  return {{"rms", json_number(rms.rms)},
          {"low68", json_number(rms.low68)},
          {"high68", json_number(rms.high68)}};
}

Json cost_object(const DriveCost& cost) {
  return {{"after_s", json_number(cost.after_s)},
          {"fast_s", rms_object(cost.fast_s)},
          {"slow_s", rms_object(cost.slow_s)}};
}

// The amplitude of a line is the drive's, or the rate's if the response of the clock to its drive
// is not known.
Json line_object(const SpectralLine& line, const std::optional<DriveResponse>& response) {
  return {{"period_s", json_number(1.0 / line.frequency_hz)},
          {"amplitude", json_number(response ? drive_of(line, *response) : line.amplitude)},
          {"amplitude_of", response ? "relative drive" : "rate"},
          {"rate_amplitude", json_number(line.amplitude)},
          {"rate_amplitude_sigma", json_number(line.amplitude_sigma)},
          {"phase_rad", json_number(line.phase_rad)},
          {"false_alarm", json_number(line.false_alarm)}};
}

Json split_object(const std::optional<DriveSplit>& split) {
  DriveSplit parts;
  parts.split_hz = parts.slow_time_s = not_known;
  parts.fast = parts.slow = parts.jitter_s = {not_known, not_known, not_known};
  parts.note = "the log does not determine the clock's response";
  if (split) parts = *split;
  Json json = {{"split_hz", json_number(parts.split_hz)},
               {"fast", rms_object(parts.fast)},
               {"slow", rms_object(parts.slow)},
               {"slow_time_s", json_number(parts.slow_time_s)},
               {"jitter_rms_s", json_number(parts.jitter_s.rms)},
               {"jitter_s", rms_object(parts.jitter_s)},
               {"note", parts.note}};
  json["costs"] = Json::array();
  for (const DriveCost& cost : parts.costs)
    json["costs"].push_back(cost_object(cost));
  return json;
}

} // namespace

Json spectrum_object(const DriveAnalysis& drive) {
  const auto& response = drive.response;
  Json json = json_with_schema("goingrate.spectrum");
  json["corner_hz"] = response ? json_number(response->corner_hz) : Json(nullptr);
  json["fast_gain"] = response ? json_number(response->fast_gain) : Json(nullptr);
  json["slow_gain"] = response ? json_number(response->slow_gain) : Json(nullptr);
  json.update(split_object(drive.split));
  json["lines"] = Json::array();
  for (const SpectralLine& line : drive.lines) {
    json["lines"].push_back(line_object(line, response));
    json["lines"].back()["sideband_of_period_s"] =
        line.sideband_of ? json_number(1.0 / drive.lines[*line.sideband_of].frequency_hz)
                         : Json(nullptr);
  }
  json["unit"] = "1/Hz, one-sided density of the relative rate";
  json["frequency_hz"] = Json::array();
  json["density"] = Json::array();
  if (drive.rate_spectrum) {
    json["frequency_hz"] = drive.rate_spectrum->frequency_hz;
    json["density"] = drive.rate_spectrum->density;
  }
  return json;
}

Json stability_object(const DeviationTable& table) {
  Json json = json_with_schema("goingrate.stability");
  json["kind"] = name_of(table.kind);
  json["tau0_s"] = json_number(table.tau0_s);
  json["rows"] = Json::array();
  for (const DeviationRow& row : table.rows)
    json["rows"].push_back({{"tau_s", json_number(row.tau_s)},
                            {"m", row.m},
                            {"n", row.n},
                            {"value", json_number(row.value)},
                            {"low", row.interval ? json_number(row.low) : Json(nullptr)},
                            {"high", row.interval ? json_number(row.high) : Json(nullptr)},
                            {"alpha", row.alpha}});
  return json;
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string rate_json(const ClockLog& log, const Beats& beats, const RateSummary& summary,
                      const SensorFindings& sensor) {
  return json_text(rate_object(log, beats, summary, sensor));
}

std::string fit_json(const FitSummary& fit) { return json_text(fit_object(fit)); }

std::string spectrum_json(const DriveAnalysis& drive) { return json_text(spectrum_object(drive)); }

std::string stability_json(const DeviationTable& table) {
  return json_text(stability_object(table));
}

} // namespace goingrate
