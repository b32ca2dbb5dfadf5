#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr double least_correlation = 0.1; // smaller ones change no conclusion

std::string interval(double low, double high, double value) {
  const auto end = [&](double at) {
    return std::isfinite(at) ? fmt::format("{:+.2g}", at - value) : std::string("open");
  };
  return fmt::format("{} {}", end(low), end(high));
}

std::string parameter_line(const FittedParameter& p) {
  if (p.status == ParameterStatus::undetermined)
    return fmt::format("  {:<14} undetermined by this log\n", p.name);
  if (p.status == ParameterStatus::fixed)
    return fmt::format("  {:<14} {:.10g} {} (fixed)\n", p.name, p.value, p.unit);
  std::string line = fmt::format("  {:<14} {} {}", p.name, with_sigma(p.value, p.sigma), p.unit);
  if (p.sigma < std::abs(p.value))
    line += fmt::format(" ({:.2g} %)", 100.0 * p.sigma / std::abs(p.value));
  if (p.at_bound && p.low95 >= p.value && std::isfinite(p.high95))
    line =
        fmt::format("  {:<14} {:.4g} {}, at most {:.2g} (95 %)", p.name, p.value, p.unit, p.high95);
  else if (is_lopsided(p))
    line += fmt::format("  95 %: {}", interval(p.low95, p.high95, p.value));
  if (p.status == ParameterStatus::prior) line += " with prior";
  if (p.at_bound) line += " at the edge of what is allowed";
  if (std::abs(p.model_shift) >= 0.1)
    line += fmt::format("   [first order alone: {:+.2g} sigma]", p.model_shift);
  return line + "\n";
}

std::string derived_line(const DerivedQuantity& quantity) {
  return fmt::format("  {:<22} {} {}   = {}\n", quantity.name,
                     with_sigma(quantity.value, quantity.sigma, 10), quantity.unit,
                     quantity.expression);
}

bool has_value(const FitSummary& fit, const std::string& name) {
  return std::any_of(fit.parameters.begin(), fit.parameters.end(), [&](const FittedParameter& p) {
    return p.name == name && std::isfinite(p.value);
  });
}

// Of parameters that have a value; the correlation of one that has none is that of its prior.
std::string correlation_lines(const FitSummary& fit) {
  std::string text;
  for (std::size_t i = 0; i < fit.correlated.size(); ++i)
    for (std::size_t k = i + 1; k < fit.correlated.size(); ++k) {
      if (!has_value(fit, fit.correlated[i]) || !has_value(fit, fit.correlated[k])) continue;
      if (std::abs(fit.correlation[i][k]) >= least_correlation)
        text += fmt::format("  {:<14} {:<14} {:+.3f}\n", fit.correlated[i], fit.correlated[k],
                            fit.correlation[i][k]);
    }
  return text;
}

std::string statistics_lines(const FitSummary& fit) {
  const FitQuality& q = fit.quality;
  std::string text =
      fmt::format("[statistics]\n  beats {}, free parameters {}\n  residual rms {:.3g} s",
                  fit.residual_s.size(), fit.correlated.size(), q.rms_s);
  text += std::isfinite(q.p_value)
              ? fmt::format("; chi-squared {} {:.5g} for {:.0f} degrees of freedom (p = {:.2g})\n",
                            q.of_innovations ? "of the innovations"
                                             : "against the jitter of neighbouring beats",
                            q.chi2, q.dof, q.p_value)
              : "; too few beats to test it\n";
  if (std::isfinite(q.amplitude_rms_rad))
    text += fmt::format("  amplitude residual rms {:.3g} mrad\n", q.amplitude_rms_rad * 1e3);
  text += fmt::format("  BIC {:.8g}, AIC {:.8g}\n", q.bic, q.aic);
  if (fit.thinning.beats > 0)
    text +=
        fmt::format("  {} of the beats were used; what that loses of the information: {:.2g} %\n",
                    fit.thinning.beats, 100.0 * fit.thinning.information_lost);
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
    text +=
        fmt::format("  sigmas are widened by up to {:.3g} for correlation that is left\n", widest);
  if (fit.quality.whiteness_p < 1e-3)
    text += "  they are not white: the model misses something, take the values with care "
            "(`spectrum` finds lines)\n";
  return text;
}

std::string experiment_lines(const FitSummary& fit) {
  if (fit.experiments.empty()) return "";
  std::string text = "[what would tell more, and the sigma to expect]\n";
  for (const Experiment& experiment : fit.experiments) {
    text += fmt::format("  {}:", experiment.what);
    for (const auto& [name, sigma] : experiment.relative_sigma)
      text += fmt::format(" {} {:.2g} %", name, 100.0 * sigma);
    text += "\n";
  }
  return text;
}

} // namespace

std::string fit_text(const FitSummary& fit) {
  if (fit.status == FitStatus::no_valid_model) return "no fit: " + fit.termination + "\n";
  std::string text = fmt::format(
      "[model]\n  dynamics {}, escapement {}, friction {}, noise {}\n  chosen: {}\n  search {}\n",
      fit.dynamics, fit.escapement, fit.friction, fit.noise, fit.chosen_by, fit.termination);
  text += statistics_lines(fit);
  text += "[parameters]\n";
  for (const FittedParameter& p : fit.parameters)
    text += parameter_line(p);
  text += "[determined by this log]\n";
  for (const DerivedQuantity& quantity : fit.combinations)
    text += derived_line(quantity);
  if (std::isfinite(fit.q_factor.value)) text += derived_line(fit.q_factor);
  text += experiment_lines(fit);
  if (const std::string lines = correlation_lines(fit); !lines.empty())
    text += "[correlations above 0.1]\n" + lines;
  text += test_lines(fit);
  text += "[models tried]\n";
  for (const FitAlternative& a : fit.alternatives)
    text += fmt::format("  {}\n      BIC {:.8g}: {}\n", a.model, a.bic, a.verdict);
  for (const std::string& note : fit.notes)
    text += "note: " + note + "\n";
  return text;
}

} // namespace goingrate
