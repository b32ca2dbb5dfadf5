#include "goingrate/report/paper.hpp"

#include "report/markup.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

const PaperNumber& number(const PaperResults& results, const std::string& what) {
  for (const PaperNumber& n : results.numbers)
    if (n.what == what) return n;
  throw std::runtime_error("no number " + what);
}

// Some seconds: once for all tests.
const PaperResults& short_run() {
  static const PaperResults results = recompute_paper({.periods = 20000});
  return results;
}

TEST(PaperTest, NumbersAreThoseOfTheReferences) {
  const PaperResults& results = short_run();
  EXPECT_NEAR(number(results, "gain at A").ours, 1.133264436573979e-4, 1e-14); // limit_cycle's own
  EXPECT_NEAR(number(results, "gain at B").ours, 1.960046634308295e-4, 1e-14);
  const PaperNumber& c = number(results, "gain at C without variability");
  EXPECT_NEAR(c.ours, 1.844068077230375e-8, 1e-14);
  EXPECT_NEAR(c.by_paper, 1.136e-8, 2e-10); // 3600 periods, interpolated crossings of 5e-7
  const PaperNumber& jump = number(results, "rate just after the jump from A to B");
  EXPECT_NEAR(jump.ours, 3.2201382327e-4, 1e-13);
  EXPECT_NEAR(jump.by_paper, 3.2e-4, 0.05e-4); // as the paper prints it
  const PaperNumber& phase = number(results, "phase gained after the jump");
  EXPECT_NEAR(phase.ours, 0.29437831, 2e-8); // the digits of the reference
  EXPECT_NEAR(phase.by_paper, 0.2945374,
              1e-4); // the circular error in full changes the fifth digit
  EXPECT_NEAR(number(results, "friction at which μ = 1.5e-5 keeps nominal time (C)").by_paper,
              1.167245e-4, 5e-11); // the digits printed
}

TEST(PaperTest, TheBudgetAddsUp) {
  const PaperResults& results = short_run();
  const auto& budget = results.budget;
  ASSERT_EQ(budget.size(), 11u);
  double sum = 0.0;
  for (std::size_t i = 0; i < 6; ++i)
    sum += budget[i].rate;
  EXPECT_NEAR(sum, budget[6].rate, 1e-16);                              // rounding of 1e-8
  EXPECT_NEAR(budget[1].rate, std::pow(0.0495410, 4) / 384.0, 1e-11);   // the next order, lambda^6
  EXPECT_NEAR(budget[2].rate, -0.5 * 1.167245e-4 * 1.167245e-4, 1e-13); // epsilon^4
  // Parts and whole come of different runs; third order is what second order is known to lack, some
  // 2e-12, and what half of gravity's share leaves of it.
  EXPECT_NEAR(budget[6].rate, budget[7].rate, 2e-11);
  EXPECT_NEAR(budget[7].rate, 1.844068077230375e-8, 1e-14); // limit_cycle's own
}

TEST(PaperTest, WordsAreMeasured) {
  const PaperResults& results = short_run();
  // The square of the change, 46 ppm, and the 1e-11 of the amplitude's answer over it.
  EXPECT_NEAR(number(results, "change of the rate per relative change of length").ours, -0.5, 5e-5);
  // Second order is some 3e-8 at C.
  EXPECT_LT(std::abs(number(results, "what a torque of μ cos 2 ψ adds to the rate").ours), 1e-7);
  const PaperNumber& moments = number(results, "rate with a single impulse that has C's moments");
  EXPECT_LT(std::abs(moments.ours - moments.by_paper), 1e-7);
  const PaperNumber& noise =
      number(results, "rms gain by the driving noise, 1000 runs of 20,000 periods");
  // The first relaxation time, a 30th of the run, answers with the fast gain, four times the slow.
  EXPECT_NEAR(noise.ours / noise.by_paper, 1.1, 0.1);
  EXPECT_NEAR(noise.sigma / noise.ours, 1.0 / std::sqrt(2000.0), 1e-12); // of 1000 runs
}

TEST(PaperTest, ThePageHoldsEveryNumberAndFigure) {
  const PaperResults& results = short_run();
  const std::string page = paper_page(results);
  const auto holds = [&](const std::string& text) {
    const bool found = page.find(escape_markup(text)) != std::string::npos;
    EXPECT_TRUE(found) << text;
  };
  for (const PaperNumber& n : results.numbers)
    holds(n.what);
  for (const BudgetPart& part : results.budget)
    holds(part.what);
  for (const PaperFigure& figure : results.figures)
    holds(figure.figure.title);
  EXPECT_EQ(page.find("nan"), std::string::npos);
  for (const char* asks : {"src=", "href=", "@import", "url("})
    EXPECT_EQ(page.find(asks), std::string::npos) << "it asks no network";
}

TEST(PaperTest, EveryFigureHasItsData) {
  const PaperResults& results = short_run();
  ASSERT_EQ(results.figures.size(), 6u);
  for (const PaperFigure& figure : results.figures)
    for (const Series& series : figure.figure.series) {
      EXPECT_GT(series.x.size(), 1u) << figure.name << " " << series.label;
      EXPECT_EQ(series.x.size(), series.y.size());
    }
  const std::string text = paper_text(results);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_THROW((void)recompute_paper({.periods = 100}), ArgumentError);
}

} // namespace
} // namespace goingrate
