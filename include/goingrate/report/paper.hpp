// The figures and the numbers of P. Hoyng, "Dynamics and performance of clock pendulums", computed
// again: by the paper's method and by this library, side by side.
#pragma once

#include "goingrate/report/figure.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace goingrate {

/// One number the paper quotes.
struct PaperNumber {
  std::string what;
  std::string where;     ///< section or figure
  std::string printed;   ///< as the paper prints it
  double by_paper = 0.0; ///< by the paper's method, computed now; NaN if it has none
  double ours = 0.0;     ///< by the full equation of motion, or measured here
  std::string unit;
  std::string why; ///< what the difference is, in a line
};

/// A part of the rate at point C that first order lacks.
struct BudgetPart {
  std::string what;
  double rate = 0.0;
};

/// A figure of the paper.
struct PaperFigure {
  std::string name; ///< rate, jump_zoom, jump_rate, jump_amplitude, quasistat_gain, quasistat_model
  Figure figure;
};

/// Everything that was recomputed.
struct PaperResults {
  std::vector<PaperNumber> numbers;
  std::vector<BudgetPart> budget; ///< sums to the last part: what the paper saw as 1e-8
  std::vector<PaperFigure> figures;
};

/// The noisy run.
struct PaperOptions {
  std::int64_t periods = 4774648; ///< of the noisy run: 1e9 steps of 0.03; 10,000 at least
  std::uint64_t seed = 1;
};

/// Computes all of it; some ten seconds. Point C: mu 1.5e-5, epsilon 1.167245e-4, phi0 0.03.
/// PaperTest.NumbersAreThoseOfTheReferences holds them against 128-bit values. Throws ArgumentError
/// for fewer periods.
PaperResults recompute_paper(const PaperOptions& options = {});

/// The numbers and the budget as a Markdown text.
std::string paper_text(const PaperResults& results);
std::string paper_json(const PaperResults& results);

} // namespace goingrate
