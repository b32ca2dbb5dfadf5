// The figures and numbers of P. Hoyng, "Dynamics and performance of clock pendulums", computed
// again by the paper's method and by this library, side by side.
#pragma once

#include "goingrate/report/figure.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
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
  std::string why;    ///< the reason for the difference, in a line
  double sigma = 0.0; ///< of `ours`, if it comes from a number of random runs; else 0
};

/// A part of the rate at point C, or what it is compared with.
struct BudgetPart {
  std::string what;
  double rate = 0.0;
};

/// A figure of the paper, or a drawing of something that the paper states in words.
struct PaperFigure {
  std::string name; ///< modesc, rate, jump_zoom, jump_rate, jump_amplitude, quasistat_gain,
                    ///< quasistat_model; noise_growth, impulse, optdriv_place, optdriv_width,
                    ///< moments, harmonics, length
  Figure figure;
};

/// Everything that was recomputed.
struct PaperResults {
  std::vector<PaperNumber> numbers;
  std::vector<BudgetPart> budget; ///< its first five add up to the sixth
  std::vector<PaperFigure> figures;
};

/// The length and the random numbers of the noisy run, and a callback.
struct PaperOptions {
  std::int64_t periods = 4774648; ///< of the noisy run: 1e9 steps of 0.03; 10,000 at least
  std::uint64_t seed = 1;
  std::function<void(std::string_view)> now{}; ///< called with the step under way, in words
};

/// Recomputes the paper; some 45 s for the paper's own 1e9 steps of RK4. Point C: mu 1.5e-5,
/// epsilon 1.167245e-4, phi0 0.03. PaperTest.NumbersAreThoseOfTheReferences compares them with
/// 128-bit values. Throws ArgumentError for fewer periods.
PaperResults recompute_paper(const PaperOptions& options = {});

/// The numbers and the budget as Markdown.
std::string paper_text(const PaperResults& results);
std::string paper_json(const PaperResults& results);
/// A companion to the paper as one HTML page that needs no network: section by section the paper's
/// equations (MathML), its figures, and its numbers beside ours. Printed on A4, no figure is cut by
/// a page break. (PaperTest.ThePageHoldsEveryNumberAndFigure)
std::string paper_page(const PaperResults& results);

} // namespace goingrate
