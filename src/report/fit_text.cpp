#include "goingrate/report/tables.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

std::string parameter_line(const FittedParameter& p) {
  if (p.status == ParameterStatus::undetermined)
    return fmt::format("  {:<10} undetermined by this log\n", p.name);
  if (p.status == ParameterStatus::fixed)
    return fmt::format("  {:<10} {:.10g} {} (fixed)\n", p.name, p.value, p.unit);
  std::string line = fmt::format("  {:<10} {} {} ({:.2g} %)", p.name, with_sigma(p.value, p.sigma),
                                 p.unit, 100.0 * p.sigma / std::abs(p.value));
  if (p.status == ParameterStatus::prior) line += " with prior";
  if (std::abs(p.model_shift) >= 0.1)
    line += fmt::format("   [first order alone: {:+.2g} sigma]", p.model_shift);
  return line + "\n";
}

std::string derived_line(const DerivedQuantity& quantity) {
  return fmt::format("  {:<22} {} {}   = {}\n", quantity.name,
                     with_sigma(quantity.value, quantity.sigma, 10), quantity.unit,
                     quantity.expression);
}

std::string correlation_lines(const FitSummary& fit) {
  constexpr double least = 0.1; // smaller ones change no conclusion
  std::string text;
  for (std::size_t i = 0; i < fit.correlated.size(); ++i)
    for (std::size_t k = i + 1; k < fit.correlated.size(); ++k)
      if (std::abs(fit.correlation[i][k]) >= least)
        text += fmt::format("  {:<10} {:<10} {:+.3f}\n", fit.correlated[i], fit.correlated[k],
                            fit.correlation[i][k]);
  return text;
}

std::string quality_lines(const FitSummary& fit) {
  const FitQuality& q = fit.quality;
  std::string text = fmt::format("[statistics]\n  {} beats; residual rms {:.3g} s; chi-squared "
                                 "against jitter alone {:.5g} for {:.0f} degrees of "
                                 "freedom (p = {:.2g})\n  noise: jitter {}",
                                 fit.residual_s.size(), q.rms_s, q.chi2, q.dof, q.p_value,
                                 fit.jitter_relative_sigma < 1.0 / 3.0
                                     ? fmt::format("{:.3g} s", fit.timing_noise.jitter_s)
                                     : std::string("undetermined"));
  if (fit.timing_noise.walk_s > 0.0)
    text += fmt::format(", random walk {:.3g} s a period", fit.timing_noise.walk_s);
  if (std::isfinite(q.amplitude_rms_rad))
    text += fmt::format("; amplitude residual rms {:.3g} mrad", q.amplitude_rms_rad * 1e3);
  text += fmt::format("\n  whitened residuals are white with p = {:.2g}; BIC {:.6g}, AIC {:.6g}\n",
                      q.whiteness_p, q.bic, q.aic);
  const double widest = std::max(fit.time_widening, fit.amplitude_widening);
  if (widest > 1.05)
    text += fmt::format(
        "  sigmas are widened by up to {:.3g} for correlation left in the residuals\n", widest);
  if (q.whiteness_p < 1e-3)
    text +=
        "  the residuals are not white: the model misses something, take the values with care\n";
  return text;
}

} // namespace

std::string fit_text(const FitSummary& fit) {
  if (fit.status == FitStatus::no_valid_model) return "no fit: " + fit.termination + "\n";
  std::string text = fmt::format(
      "[model]\n  dynamics {}, escapement {}, linear friction, noise {}\n  chosen: {}\n  {}\n",
      fit.dynamics, fit.escapement, fit.noise, fit.chosen_by, fit.termination);
  text += quality_lines(fit);
  text += "[parameters]\n";
  for (const FittedParameter& p : fit.parameters)
    text += parameter_line(p);
  text += "[determined by this log]\n";
  for (const DerivedQuantity& quantity : fit.combinations)
    text += derived_line(quantity);
  if (std::isfinite(fit.q_factor.value)) text += derived_line(fit.q_factor);
  if (const std::string lines = correlation_lines(fit); !lines.empty())
    text += "[correlations above 0.1]\n" + lines;
  text += "[models tried]\n";
  for (const FitAlternative& a : fit.alternatives)
    text += fmt::format("  {:<38} BIC {:.6g}: {}\n", a.model, a.bic, a.verdict);
  return text;
}

} // namespace goingrate
