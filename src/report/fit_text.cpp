#include "goingrate/report/tables.hpp"

#include "figure_axes.hpp"
#include "impulse_words.hpp"
#include "listed_clocks.hpp"
#include "markup.hpp"
#include "parameter_words.hpp"
#include "wording.hpp"

#include "base/readable.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <vector>

namespace goingrate {

namespace {

constexpr double least_correlation = 0.1; // a smaller one changes a sigma by less than 1 %

std::string interval(double low, double high, double value) {
  const auto end = [&](double at) {
    if (!std::isfinite(at)) return std::string("open");
    return fmt::format("{}{}", at < value ? '-' : '+', with_sigma(std::abs(at - value), 0.0, 2));
  };
  return fmt::format("{} {}", end(low), end(high));
}

// Whether the parameter may be zero, so that only an upper limit is known.
bool is_at_lower_bound(const FittedParameter& p) {
  return p.at_bound && p.low95 >= p.value && std::isfinite(p.high95);
}

// A line with a parameter's name, its value with the unit, and remarks, in columns.
std::string value_text(const FittedParameter& p) {
  if (p.status == ParameterStatus::undetermined) return "undetermined by this log";
  const std::string unit = p.unit.empty() ? "" : " " + p.unit;
  if (p.status == ParameterStatus::fixed) return with_sigma(p.value, 0.0, 10) + unit + " (fixed)";
  if (is_at_lower_bound(p))
    return fmt::format("{}{}, at most {} (95 %)", with_sigma(p.value, 0.0, 4), unit,
                       with_sigma(p.high95, 0.0, 2));
  return with_sigma(p.value, p.sigma) + unit;
}

std::string remarks_on(const FittedParameter& p) {
  if (p.status == ParameterStatus::undetermined || p.status == ParameterStatus::fixed) return {};
  std::vector<std::string> remarks;
  if (!is_at_lower_bound(p)) {
    if (p.sigma < std::abs(p.value))
      remarks.push_back(plain_number(100.0 * p.sigma / std::abs(p.value), 2) + " %");
    if (is_lopsided(p))
      remarks.push_back(fmt::format("95 %: {}", interval(p.low95, p.high95, p.value)));
  }
  if (p.status == ParameterStatus::prior) remarks.emplace_back("with prior");
  constexpr double least_widening = 1.05; // a smaller one does not show in two digits of sigma
  if (p.sigma_by_law > 0.0 && p.sigma > least_widening * p.sigma_by_law)
    remarks.push_back(fmt::format("whichever law of friction, ± {} by that of the model",
                                  with_sigma(p.sigma_by_law, 0.0, 2)));
  if (p.at_bound) remarks.emplace_back("at the edge of what is allowed");
  const std::string all = fmt::format("{}", fmt::join(remarks, "; "));
  if (!(std::abs(p.model_shift) >= 0.1)) return all;
  return all + fmt::format("{}[first order: {} σ]", all.empty() ? "" : " ",
                           readable_signed(p.model_shift, 2));
}

std::string parameter_lines(const FitSummary& fit, const DisplayUnit& angle) {
  std::vector<FittedParameter> parameters;
  for (const FittedParameter& p : fit.parameters)
    parameters.push_back(in_shown_unit(angle, p));
  std::size_t name_width = 14, value_width = 0;
  for (const FittedParameter& p : parameters) {
    name_width = std::max(name_width, characters(symbol_and_name(p.name)));
    if (!remarks_on(p).empty()) value_width = std::max(value_width, characters(value_text(p)));
  }
  std::string text;
  for (const FittedParameter& p : parameters) {
    const std::string remarks = remarks_on(p);
    text += fmt::format("  {:<{}} ", symbol_and_name(p.name), name_width);
    text += remarks.empty() ? value_text(p)
                            : fmt::format("{:<{}}  {}", value_text(p), value_width, remarks);
    text += "\n";
  }
  return text;
}

std::string twin_lines(const FitSummary& fit, const DisplayUnit& angle) {
  const std::vector<ListedClock> clocks = listed_clocks(fit, angle);
  if (clocks.empty()) return "";
  std::string text = "[clocks that explain this log: it is of one of them]\n";
  int number = 0;
  for (const ListedClock& clock : clocks)
    text += fmt::format("  {}{}: {}\n", ++number, clock.odds.empty() ? "" : " (" + clock.odds + ")",
                        clock.parameters);
  return text;
}

std::string derived_lines(const FitSummary& fit, const DisplayUnit& angle) {
  std::vector<DerivedQuantity> all = fit.combinations;
  if (std::isfinite(fit.q_factor.value)) all.push_back(fit.q_factor);
  std::string text;
  for (DerivedQuantity& known : all) {
    const DerivedQuantity quantity = as_shown(angle, fit, std::move(known));
    text += fmt::format("  {:<22} {}{}{}\n    {}\n", in_symbols(quantity.name),
                        with_sigma(quantity.value, quantity.sigma, 10),
                        quantity.unit.empty() ? "" : " ", quantity.unit,
                        in_symbols(quantity.expression));
  }
  return text;
}

bool has_value(const FitSummary& fit, const std::string& name) {
  const FittedParameter* found = fit.find(name);
  return found && std::isfinite(found->value);
}

// Only parameters that have a value: without one, the correlation would be the prior's.
std::string correlation_lines(const FitSummary& fit) {
  std::string text;
  for (std::size_t i = 0; i < fit.correlated.size(); ++i)
    for (std::size_t k = i + 1; k < fit.correlated.size(); ++k) {
      if (!has_value(fit, fit.correlated[i]) || !has_value(fit, fit.correlated[k])) continue;
      if (std::abs(fit.correlation[i][k]) >= least_correlation)
        text += fmt::format("  {:<14} {:<14} {:+.3f}\n", symbol_of(fit.correlated[i]),
                            symbol_of(fit.correlated[k]), fit.correlation[i][k]);
    }
  return text;
}

std::string chi2_lines(const FitQuality& q) {
  if (!std::isfinite(q.p_value)) return "  too few beats for a χ² test\n";
  return fmt::format("  χ² {} for {} degrees of freedom (p = {:.2g}) {}\n", readable(q.chi2, 5),
                     readable(q.dof, 9), q.p_value,
                     q.of_innovations
                         ? "of the innovations"
                         : "against the jitter of neighbouring beats; p allows for that "
                           "being known to some per cent only");
}

std::string statistics_lines(const FitSummary& fit) {
  const FitQuality& q = fit.quality;
  std::string text =
      fmt::format("[statistics]\n  beats {}, free parameters {}\n  residual rms {}\n",
                  fit.residual_s.size(), fit.correlated.size(), short_time(q.rms_s, 0.0));
  text += chi2_lines(q);
  if (std::isfinite(q.amplitude_rms_rad))
    text += fmt::format("  amplitude residual rms {}\n", small_angle(q.amplitude_rms_rad));
  text += fmt::format("  BIC {:.8g}, AIC {:.8g}\n", q.bic, q.aic);
  if (fit.thinning.beats > 0) {
    text += fmt::format("  {} of the beats were used", fit.thinning.beats);
    text += std::isfinite(fit.thinning.information_lost)
                ? fmt::format("; the loss of information by that is {:.2g} %\n",
                              100.0 * fit.thinning.information_lost)
                : std::string("; how much the others would add is not known\n");
  }
  return text;
}

std::string test_lines(const FitSummary& fit) {
  std::string text = "[tests on the residuals]\n";
  text += std::isfinite(fit.quality.whiteness_p)
              ? fmt::format("  innovations of the times are white with p = {:.2g} (Ljung-Box, 20 "
                            "lags)\n",
                            fit.quality.whiteness_p)
              : "  the times are met to rounding: there is no noise to test\n";
  const double widest = std::max(fit.time_widening, fit.amplitude_widening);
  if (widest > 1.05)
    text += fmt::format(
        "  σ is widened up to {:.3g}-fold, because the residuals are still correlated\n", widest);
  if (fit.quality.whiteness_p < 1e-3)
    text += "  they are not white: the model misses something, take the values with care "
            "(`spectrum` finds lines)\n";
  return text;
}

std::string experiment_lines(const FitSummary& fit) {
  if (fit.experiments.empty()) return "";
  std::string text = "[what would tell more, and the σ to expect]\n";
  for (const Experiment& experiment : fit.experiments) {
    text += fmt::format("  {}:", experiment.what);
    for (const auto& [name, sigma] : experiment.relative_sigma)
      text += fmt::format(" {} {:.2g} %", symbol_of(name), 100.0 * sigma);
    text += "\n";
  }
  return text;
}

} // namespace

std::string fit_text(const FitSummary& fit) {
  if (fit.status == FitStatus::no_valid_model) return "no fit: " + fit.termination + "\n";
  const DisplayUnit angle = angle_unit(fit);
  std::string text = fmt::format(
      "[model]\n  dynamics {}, escapement {}, friction {}, noise {}\n  chosen: {}\n  search {}\n",
      name_of(fit.dynamics), name_of(fit.model.escapement), fit.model.friction(), fit.model.noise(),
      in_symbols(fit.chosen_by), fit.termination);
  text += statistics_lines(fit);
  text += "[parameters]\n" + parameter_lines(fit, angle);
  text += twin_lines(fit, angle);
  text += "[determined by this log]\n" + derived_lines(fit, angle);
  if (fit.decay) text += "[decay of the swing]\n" + decay_text(*fit.decay);
  if (fit.impulses)
    text += "[pushes]\n" + impulse_text(*fit.impulses, angle);
  else if (!fit.decay)
    text += fmt::format("[pushes]\n  once in how many swings is undetermined: no saw-tooth stands out{}\n",
                        fit.model.escapement == Escapement::none
                            ? ""
                            : "; what is fitted is the mean drive");
  text += experiment_lines(fit);
  if (const std::string lines = correlation_lines(fit); !lines.empty())
    text += "[correlations above 0.1]\n" + lines;
  text += test_lines(fit);
  text += "[models tried]\n";
  for (const FitAlternative& a : fit.alternatives)
    text += fmt::format("  {}\n    BIC {:.8g}: {}\n", a.model, a.bic, in_symbols(a.verdict));
  for (const FitNote& note : fit.notes)
    text += "note: " + in_symbols(note.text) + "\n";
  return wrapped(text, line_columns, 2);
}

} // namespace goingrate
