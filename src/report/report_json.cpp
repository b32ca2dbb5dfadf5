// Everything about one log as one JSON value.
#include "goingrate/report/json.hpp"

#include "json_parts.hpp"
#include "mean_amplitude.hpp"
#include "report_figures.hpp"

namespace goingrate {

namespace {

Json change_object(const Change& change) {
  return {{"cycle", change.cycle},
          {"at_s", json_number(change.at_s)},
          {"kind", name_of(change.kind)},
          {"kind_gain_2logL", json_number(change.kind_gain)},
          {"noted", change.noted},
          {"rate_change", json_number(change.rate_change)},
          {"rate_change_sigma", json_number(change.rate_change_sigma)},
          {"rate_excess_before", json_number(change.rate_before)},
          {"rate_excess_before_sigma", json_number(change.rate_before_sigma)},
          {"rate_excess_after", json_number(change.rate_after)},
          {"rate_excess_after_sigma", json_number(change.rate_after_sigma)},
          {"amplitude_slope_change_rad_per_s", json_number(change.amplitude_slope_change)}};
}

Json relaxation_object(const std::optional<Relaxation>& relaxation) {
  if (!relaxation) return nullptr;
  return {{"time_constant_s", json_number(relaxation->time_constant_s)},
          {"sigma_s", json_number(relaxation->sigma_s)},
          {"window_s", json_number(relaxation->window_s)},
          {"limit_rad", json_number(relaxation->limit_rad)},
          {"rms_rad", json_number(relaxation->rms_rad)},
          {"exponential", relaxation->exponential},
          {"three_quarter_window_s", json_number(relaxation->shorter_window_s)},
          {"five_quarter_window_s", json_number(relaxation->longer_window_s)}};
}

Json diary_object(const Diary& diary) {
  Json json;
  json["changes"] = Json::array();
  for (const Change& change : diary.changes)
    json["changes"].push_back(change_object(change));
  json["interruptions"] = Json::array();
  for (const Interruption& event : diary.interruptions)
    json["interruptions"].push_back(
        {{"from_s", json_number(event.begin.at_s)},
         {"to_s", json_number(event.end.at_s)},
         {"rate_change", json_number(event.rate_change)},
         {"amplitude_before_rad", json_number(event.amplitude_before_rad)},
         {"amplitude_after_rad", json_number(event.amplitude_after_rad)},
         {"decay", relaxation_object(event.decay)},
         {"recovery", relaxation_object(event.recovery)}});
  return json;
}

Json stretch_object(const PartRate& stretch, const Analysis& data) {
  Json part = part_object(stretch, data.rate.nominal_is_known);
  part["from_s"] = json_number(stretch.start - data.beats.front().time);
  part["to_s"] = json_number(stretch.start - data.beats.front().time + stretch.rate.duration_s);
  part["sigma"] = part["rate_sigma_s_per_day"];
  return part;
}

Json stretches_object(const Analysis& data) {
  Json json = Json::array();
  for (const PartRate& stretch : data.stretches)
    json.push_back(stretch_object(stretch, data));
  return json;
}

Json amplitude_object(const MeanAmplitude& mean) {
  return {{"mean_rad", json_number(mean.rad)},
          {"sigma_rad", json_number(mean.sigma_rad)},
          {"beats", mean.beats}};
}

Json numbers_object(const Analysis& data) {
  Json json = Json::array();
  for (const SummaryNumber& number : summary_numbers(data))
    json.push_back({{"quantity", number.quantity}, {"value", number.value}});
  return json;
}

Json parts_object(const CovariateEffect& effect) {
  Json parts = Json::array();
  for (const EffectPart& part : effect.parts)
    parts.push_back({{"way", name_of(part.way)},
                     {"coefficient", json_number(part.coefficient)},
                     {"sigma", json_number(part.sigma)}});
  return parts;
}

Json covariates_object(const std::vector<CovariateEffect>& effects) {
  Json json = Json::array();
  for (const CovariateEffect& effect : effects)
    json.push_back({{"name", effect.name},
                    {"unit", effect.unit},
                    {"coefficient", json_number(effect.coefficient)},
                    {"sigma", json_number(effect.sigma)},
                    {"lag_s", json_number(effect.lag_s)},
                    {"parts", parts_object(effect)},
                    {"amplitude", json_number(effect.amplitude)},
                    {"amplitude_sigma", json_number(effect.amplitude_sigma)},
                    {"interpolation_sigma", json_number(effect.interpolation_sigma)},
                    {"readings_step_s", json_number(effect.step_s)},
                    {"known_share", json_number(effect.known_share)},
                    {"significant", effect.significant()},
                    {"helps", effect.helps()},
                    {"time_error_without_s", json_number(effect.without_s)},
                    {"time_error_with_s", json_number(effect.with_s)}});
  return json;
}

// Long spectra are averaged in narrow bands so that the page stays small.
Json averaged_spectrum_object(const DriveAnalysis& drive) {
  Json json = spectrum_object(drive);
  constexpr std::size_t longest_spectrum = 4096;
  const bool averaged =
      drive.rate_spectrum && drive.rate_spectrum->frequency_hz.size() > longest_spectrum;
  json["averaged_in_bands"] = averaged;
  if (!averaged) return json;
  constexpr int per_decade = 300;
  const BinnedSpectrum binned =
      log_binned(drive.rate_spectrum->frequency_hz, drive.rate_spectrum->density, per_decade);
  json["frequency_hz"] = binned.frequency_hz;
  json["density"] = binned.density;
  return json;
}

Json causes_object(const std::vector<Suspicion>& suspicions) {
  Json json = Json::array();
  for (const Suspicion& suspicion : suspicions) {
    Json alternatives = Json::array();
    for (const Cause cause : suspicion.alternatives)
      alternatives.push_back(name_of(cause));
    json.push_back({{"cause", name_of(suspicion.cause)},
                    {"gain_2logL", json_number(suspicion.gain)},
                    {"for", suspicion.evidence},
                    {"against", std::move(alternatives)},
                    {"advice", suspicion.advice}});
  }
  return json;
}

Json entry_object(const LogbookEntry& entry, double at_s) {
  return {{"at_s", json_number(at_s)},
          {"what", name_of(entry.what)},
          {"value", json_number(entry.value)},
          {"sigma", json_number(entry.sigma)},
          {"note", entry.note}};
}

Json logbook_object(const LogbookCheck& check) {
  Json json{{"source", check.source}, {"entries", Json::array()}, {"unwritten", Json::array()}};
  for (const EntryFinding& finding : check.entries) {
    Json entry = entry_object(finding.entry, finding.at_s);
    entry["verdict"] = name_of(finding.verdict);
    entry["found"] = json_number(finding.found);
    entry["found_sigma"] = json_number(finding.found_sigma);
    entry["found_at_s"] = json_number(finding.found_at_s);
    json["entries"].push_back(std::move(entry));
  }
  for (const UnwrittenFinding& finding : check.unwritten)
    json["unwritten"].push_back(entry_object(finding.entry, finding.at_s));
  return json;
}

Json isochronism_object(const Isochronism& found) {
  Json json{{"amplitude_rad", json_number(found.amplitude_rad)},
            {"slope_per_rad", json_number(found.slope)},
            {"sigma", json_number(found.sigma)}};
  json["fitted_slope_per_rad"] =
      found.fitted_slope ? json_number(*found.fitted_slope) : Json(nullptr);
  if (found.curve)
    json["curve"] = {{"amplitude_rad", found.curve->amplitude_rad},
                     {"circular", found.curve->circular},
                     {"escapement", found.curve->escapement},
                     {"sum", found.curve->sum}};
  return json;
}

Json report_object(const Analysis& data) {
  Json json = json_with_schema("goingrate.report");
  json["summary"] = report_sentences(data);
  json["numbers"] = numbers_object(data);
  json["rate"] = rate_object(data.log, data.numbered, data.rate, data.sensor);
  json["segment_rates"] = stretches_object(data);
  json["rate_now"] = data.stretches.empty() ? Json(nullptr) : stretch_object(data.now, data);
  json["amplitude_at_start"] = amplitude_object(amplitude_at(data.beats, false));
  json["amplitude_at_end"] = amplitude_object(amplitude_at(data.beats, true));
  json["diary"] = diary_object(data.diary);
  if (data.logbook) json["kept_diary"] = logbook_object(*data.logbook);
  json["causes"] = causes_object(data.suspicions);
  json["covariates"] = covariates_object(data.covariates);
  if (data.isochronism) json["isochronism"] = isochronism_object(*data.isochronism);
  json["fit"] = fit_object(data.fit);
  if (data.fit.decay) json["decay"] = decay_object(*data.fit.decay);
  json["spectrum"] = averaged_spectrum_object(data.drive);
  json["stability"] = stability_object(data.deviation);
  if (data.nut)
    json["rating_nut"] = {{"turns_up", json_number(data.nut->turns)},
                          {"sigma", json_number(data.nut->sigma)},
                          {"raise_mm", json_number(1e3 * data.nut->raise_m)}};
  return json;
}

} // namespace

std::string report_json(const Analysis& data) { return json_text(report_object(data)); }

std::string report_json_for_script(const Analysis& data) {
  return safe_in_script(report_object(data).dump(-1, ' ', false, Json::error_handler_t::replace));
}

} // namespace goingrate
