#include "page.hpp"

#include "goingrate/report/tables.hpp"

#include "markup.hpp"
#include "parameter_words.hpp"
#include "rms_words.hpp"
#include "rounded.hpp"
#include "wording.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate::page {

namespace {

std::string meaning_in_table(const std::string& name) {
  std::string meaning(meaning_of(name));
  const std::size_t at = name.find('@');
  if (at != std::string::npos) meaning += ", from change " + name.substr(at + 1) + " on";
  return meaning;
}

bool has_value(const FittedParameter& parameter) {
  return parameter.status != ParameterStatus::undetermined && std::isfinite(parameter.value);
}

std::string status_text(ParameterStatus status) {
  switch (status) {
  case ParameterStatus::free:
    return "fitted";
  case ParameterStatus::fixed:
    return "held fixed";
  case ParameterStatus::prior:
    return "fitted, with a value known from elsewhere";
  case ParameterStatus::undetermined:
    break;
  }
  return "this log does not determine it";
}

std::string parameter_table(const FitSummary& fit, const DisplayUnit& angle) {
  Table table("Parameters of the model",
              {"parameter", "value ± σ", "unit", "status", "meaning", "shift by first order, σ"});
  for (const FittedParameter& fitted : fit.parameters) {
    const FittedParameter p = in_shown_unit(angle, fitted);
    const bool known = has_value(p);
    constexpr int digits_of_fixed = 10;
    table.row({symbol_and_name(p.name),
               known ? measured(p.value, p.sigma, digits_of_fixed) : "undetermined",
               p.unit.empty() ? "–" : p.unit, status_text(p.status), meaning_in_table(p.name),
               known && std::isfinite(p.model_shift)
                   ? typeset(fmt::format("{:+.2g}", p.model_shift))
                   : "–"});
  }
  return table.empty() ? "" : table.html();
}

std::string combination_table(const FitSummary& fit, const DisplayUnit& angle) {
  Table table("What the log determines", {"quantity", "value ± σ", "unit", "from"});
  const auto add = [&](const DerivedQuantity& known) {
    if (!std::isfinite(known.value)) return;
    const DerivedQuantity quantity = as_shown(angle, fit, known);
    table.row({in_symbols(quantity.name), measured(quantity.value, quantity.sigma, 10),
               quantity.unit.empty() ? "–" : quantity.unit, in_symbols(quantity.expression)});
  };
  for (const DerivedQuantity& quantity : fit.combinations)
    add(quantity);
  if (!fit.q_factor.name.empty()) add(fit.q_factor); // the rate is one of the key figures
  return table.empty() ? "" : table.html();
}

bool is_undetermined(const FitSummary& fit, const std::string& name) {
  const FittedParameter* found = fit.find(name);
  return found && !has_value(*found);
}

// Only parameters that have a value: without one, the correlation would be the prior's.
std::string correlation_table(const FitSummary& fit) {
  constexpr double least_correlation = 0.1; // smaller ones change no conclusion
  Table table("Correlations above 0.1 in size", {"parameter", "with", "correlation"});
  for (std::size_t i = 0; i < fit.correlation.size() && i < fit.correlated.size(); ++i) {
    const auto& row = fit.correlation[i];
    for (std::size_t k = i + 1; k < row.size() && k < fit.correlated.size(); ++k) {
      if (!(std::abs(row[k]) > least_correlation)) continue;
      if (is_undetermined(fit, fit.correlated[i]) || is_undetermined(fit, fit.correlated[k]))
        continue;
      table.row({symbol_of(fit.correlated[i]), symbol_of(fit.correlated[k]),
                 typeset(fmt::format("{:+.3f}", row[k]))});
    }
  }
  return table.empty() ? "" : table.html();
}

std::string probability(double p) {
  if (!std::isfinite(p)) return "not known";
  return p < 1e-4 ? "below 0.0001" : fmt::format("{:.2g}", p);
}

std::string decay_part(const FitSummary& fit, const DisplayUnit& unit) {
  if (!fit.decay) return "";
  Table table("Quality factor of the swing, whichever law the friction has",
              {fmt::format("amplitude, {}", unit.name), "Q ± σ", "68 %", "95 %"});
  const auto range = [](double low, double high, double sigma) {
    return typeset(to_the_digits_of(low, sigma)) +
           (std::isfinite(high) ? " to " + typeset(to_the_digits_of(high, sigma))
                                : std::string(" or more"));
  };
  const auto& all = fit.decay->q_at_amplitude;
  for (auto at = all.rbegin(); at != all.rend(); ++at) {
    if (!std::isfinite(at->q.value)) continue;
    table.row({plain_number(unit.factor * at->amplitude_rad, 4), measured(at->q.value, at->q.sigma),
               range(at->q.low68, at->q.high68, at->q.sigma),
               range(at->q.low95, at->q.high95, at->q.sigma)});
  }
  return table.empty() ? "" : table.html(); // the summary has it in words
}

std::string quality_table(const FitSummary& fit) {
  const FitQuality& q = fit.quality;
  Table table("How good the fit is", {"measure", "value", "how to read it"});
  table.row({"χ² / degrees of freedom", plain_number(q.chi2, 5) + " / " + plain_number(q.dof, 7),
             "near 1 if the residuals are no larger than the jitter between neighbouring beats"});
  table.row({"probability of that χ²", probability(q.p_value),
             q.of_innovations
                 ? "below 0.01: the times hold more than the model and the jitter"
                 : "below 0.01: the times hold more than the model and the jitter, which itself is "
                   "known to some per cent only; that is allowed for"});
  table.row(
      {"whiteness of the residuals", probability(q.whiteness_p),
       q.of_innovations
           ? "of the part of each beat that the earlier beats do not predict; below 0.001: it "
             "has a shape, read the values as rough"
           : "below 0.001: the residuals have a shape, read the values as rough"});
  table.row({"residual of the times, rms", short_time(q.rms_s, 0.0),
             q.of_innovations ? "includes the wander of the drive or the rate" : ""});
  if (std::isfinite(q.amplitude_rms_rad))
    table.row({"residual of the amplitudes, rms", small_angle(q.amplitude_rms_rad), ""});
  table.row({"σ widened by", plain_number(std::max(fit.time_widening, fit.amplitude_widening)),
             "for correlation left in the residuals; 1 is none"});
  table.row({"BIC, AIC", plain_number(q.bic, 7) + ", " + plain_number(q.aic, 7),
             "only differences between models count; the smaller is the better"});
  return table.html();
}

std::string alternatives_table(const FitSummary& fit) {
  Table table("Models tried", {"model", "BIC", "verdict"});
  for (const FitAlternative& tried : fit.alternatives)
    table.row({tried.model, plain_number(tried.bic, 7), in_symbols(tried.verdict)});
  return table.empty() ? "" : table.html();
}

std::string rms_text(const RmsEstimate& rms, double factor, std::string_view unit) {
  return rms_words(rms, factor, unit, [](double value) { return plain_number(value); });
}

std::string cost_table(const DriveAnalysis& drive) {
  if (!drive.split) return "";
  Table table("What the drive's variations cost: time error to expect, rms (68 %)",
              {"after", "from fast variations", "from slow ones"});
  for (const DriveCost& cost : drive.split->costs)
    table.row({duration_text(cost.after_s), rms_text(cost.fast_s, 1.0, "s"),
               rms_text(cost.slow_s, 1.0, "s")});
  return table.empty() ? "" : table.html();
}

std::string line_table(const DriveAnalysis& drive) {
  Table table("Strictly periodic parts of the rate",
              {"period", "amplitude of the rate", "of the drive", "chance that noise does it"});
  for (std::size_t i = 0; i < drive.lines.size(); ++i) {
    const SpectralLine& line = drive.lines[i];
    if (line.sideband_of) continue;
    const std::string sidebands = sideband_text(drive.lines, i);
    table.row({plain_number(1.0 / line.frequency_hz, 5) + " s" +
                   (sidebands.empty() ? "" : ", " + sidebands),
               plain_number(line.amplitude),
               drive.response ? plain_number(100.0 * drive_of(line, *drive.response)) + " %" : "",
               plain_number(line.false_alarm, 2)});
  }
  return table.empty() ? "" : table.html();
}

// A row for the effect of a covariate, and one for each of the ways in which it acts.
std::string ways_text(const CovariateEffect& effect, const Wording& words) {
  const std::string per = fmt::format("/{}", unit_of_covariate(effect));
  std::string text = typeset(words.rate(effect.coefficient, effect.sigma)) + per;
  for (const EffectPart& part : effect.parts)
    text += fmt::format("; {} {}{}", words_of(part.way),
                        typeset(words.rate(part.coefficient, part.sigma)), per);
  return text;
}

// The effects of temperature and pressure, judged on the half of the log that was not used to find
// them.
std::string covariate_table(const Analysis& data) {
  const Wording words(data);
  Table table("What surrounds the clock",
              {"of the rate on", "coefficient", "lag", "time error without and with it, rms",
               "compensating would"});
  for (const CovariateEffect& effect : data.covariates)
    table.row(
        {effect.name,
         effect.name == "tide" ? typeset(with_sigma(effect.coefficient, effect.sigma, 3)) +
                                     " of the theoretical effect"
                               : ways_text(effect, words),
         effect.lag_s > 0.0 ? plain_number(effect.lag_s) + " s" : "none",
         fmt::format("{} and {} s", plain_number(effect.without_s), plain_number(effect.with_s)),
         !effect.significant() ? "have no effect that stands out from the noise"
         : effect.helps()      ? "have helped"
                               : "not have helped"});
  return table.empty() ? "" : table.html();
}

} // namespace

std::string fit(const Analysis& data) {
  const FitSummary& fit = data.fit;
  std::string body;
  if (!fit.has_result()) {
    body = fmt::format(
        "<p class=\"warning\">No model of this kind fits the log: there are no values to "
        "report. {}</p>\n",
        escape_markup(fit.termination.empty() ? "" : "(" + fit.termination + ")"));
    return section("fit", "Fit of the pendulum model", body + alternatives_table(fit));
  }
  if (fit.parameters.empty())
    return section("fit", "Fit of the pendulum model", paragraph("No fit was made."));
  body = paragraph(fmt::format("Equations: {}; escapement: {}; noise: {}. Chosen because: {}.",
                               name_of(fit.dynamics), name_of(fit.model.escapement),
                               fit.model.noise(), in_symbols(fit.chosen_by)));
  const DisplayUnit angle = Wording(data).angle_unit();
  body += decay_part(fit, angle) + parameter_table(fit, angle) + combination_table(fit, angle) +
          correlation_table(fit) + quality_table(fit) + alternatives_table(fit);
  return section("fit", "Fit of the pendulum model", body);
}

std::string drive(const Analysis& data) {
  std::string body;
  if (!data.drive.response)
    body =
        paragraph("The log does not determine how the rate answers a change of the drive, so fast "
                  "and slow variations of the drive cannot be told apart.");
  Table table("Variations of the drive", {"quantity", "value", "meaning"});
  if (data.drive.response) {
    const DriveResponse& response = *data.drive.response;
    table.row({"rate per relative change of drive, at once", plain_number(response.fast_gain, 4),
               "before the amplitude has answered"});
    table.row({"the same, in the long run", plain_number(response.slow_gain, 4),
               "after the amplitude has settled"});
    table.row({"corner between the two", plain_number(response.corner_hz) + " Hz",
               "a variation that takes " + duration_text(1.0 / response.corner_hz)});
  }
  if (data.drive.split) {
    const DriveSplit& split = *data.drive.split;
    table.row({"fast drive, rms", rms_text(split.fast, 100.0, "%"),
               "of the drive, new at every period (68 %)"});
    table.row({"slow drive, rms", rms_text(split.slow, 100.0, "%"),
               std::isfinite(split.slow_time_s) ? "of the drive, with a memory of " +
                                                      duration_text(split.slow_time_s) + " (68 %)"
                                                : "of the drive, with a memory (68 %)"});
    table.row(
        {"jitter of the sensor", rms_text(split.jitter_s, 1e6, "µs"), "of every time (68 %)"});
  }
  if (!table.empty()) body += table.html();
  body += cost_table(data.drive) + line_table(data.drive);
  body += covariate_table(data);
  if (data.drive.split && !data.drive.split->note.empty())
    body += paragraph("Note: " + data.drive.split->note + ".");
  return section("drive", "Drive, fast and slow", body);
}

} // namespace goingrate::page
