#include "goingrate/report/paper.hpp"

#include "report/markup.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>
#include <set>

namespace goingrate {
namespace {

const PaperNumber& number(const PaperResults& results, const std::string& what) {
  for (const PaperNumber& n : results.numbers)
    if (n.what == what) return n;
  throw std::runtime_error("no number " + what);
}

const Figure& figure(const PaperResults& results, const std::string& name) {
  for (const PaperFigure& f : results.figures)
    if (f.name == name) return f.figure;
  throw std::runtime_error("no figure " + name);
}

const Series& series(const Figure& of, const std::string& label) {
  for (const Series& s : of.series)
    if (s.label == label) return s;
  throw std::runtime_error("no series " + label);
}

// Slope of a straight line through the points beyond x = `from`, x in turns of 2 pi.
double slope_from(const Series& points, double from) {
  double n = 0.0, x1 = 0.0, y1 = 0.0, x2 = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    if (points.x[i] <= from) continue;
    const double x = 2.0 * std::numbers::pi * points.x[i], y = points.y[i];
    n += 1.0;
    x1 += x;
    y1 += y;
    x2 += x * x;
    xy += x * y;
  }
  return (n * xy - x1 * y1) / (n * x2 - x1 * x1);
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
  // RK4's clock locks to its grid: the mean of 20,000 periods still depends on where they begin.
  EXPECT_NEAR(c.by_paper, 1.136e-8, 1e-10);
  EXPECT_NEAR(number(results, "gain at C by RK4, the torque chosen once a step").by_paper, -5.42e-6,
              0.005e-6); // the digits of the reference
  EXPECT_NEAR(number(results,
                     "gain at C by RK4, the torque chosen at the switch, where the step is "
                     "cut")
                  .by_paper,
              1.200e-8, 1e-11); // interpolated crossings: 5e-7 over 20,000 periods; the digits
  EXPECT_NEAR(number(results, "friction at which μ = 1.5e-5 keeps nominal time (C)").by_paper,
              1.167245e-4, 5e-11); // the digits printed
}

TEST(PaperTest, TheJumpIsThatOfTheReferences) {
  const PaperResults& results = short_run();
  const PaperNumber& jump = number(results, "rate just after the jump from A to B");
  EXPECT_NEAR(jump.ours, 3.2201382327e-4, 1e-13);
  EXPECT_NEAR(jump.by_paper, 3.2e-4, 0.05e-4); // as the paper prints it
  const PaperNumber& phase = number(results, "phase gained after the jump");
  EXPECT_NEAR(phase.ours, 0.29437831, 2e-8);      // the digits of the reference
  EXPECT_NEAR(phase.by_paper, 0.2945374, 5.1e-8); // the digits of the reference
  // lambda^2 heads for twice what it is at the rate 2 epsilon: lambda by 2 pi epsilon in a period.
  const PaperNumber& growth = number(results, "relative growth of λ in that period");
  for (const double grew : {growth.by_paper, growth.ours})
    EXPECT_NEAR(grew, 2.0 * std::numbers::pi * 2.5e-4, 5e-6); // its square, and relaxation in it
  const PaperNumber& later = number(results, "λ 300 periods after the jump");
  EXPECT_NEAR(later.ours / later.by_paper, 1.0, 1e-4); // v*/lambda0 - 1 is up to 9e-5 at A and B
  // The diamonds are the paper's own equation, -lambda^2/16 and no more: eq. statrate, at A.
  const Series& diamonds = series(figure(results, "jump_rate"), "theory, eq. 16");
  EXPECT_NEAR(diamonds.y.front(), 1.133210552128862e-4, 1e-13); // the sum of 100 excesses
}

TEST(PaperTest, TheRateFollowsAChangeOfFrictionSlowly) {
  const PaperResults& results = short_run();
  const PaperNumber& torque =
      number(results, "share of its change that the rate shows in the first period "
                      "after the torque jumps from A to B");
  EXPECT_NEAR(torque.ours, (3.2201382327e-4 - 1.1332644e-4) / (1.9600466e-4 - 1.1332644e-4),
              1e-6); // the digits of the references
  const PaperNumber& friction = number(results, "the same, the friction of A halved");
  // lambda^2 goes 2 pi epsilon of its way in half a period; the rate, less steep there than in the
  // mean, goes less.
  for (const double share : {friction.by_paper, friction.ours}) {
    EXPECT_GT(share, 0.0);
    EXPECT_LT(share, 2.0 * std::numbers::pi * 1.25e-4);
  }
  const PaperNumber& half = number(results, "periods until the rate has gone half of that way");
  EXPECT_EQ(half.ours, half.by_paper);
  // lambda^2 takes ln 2/(4 pi epsilon) = 441 periods for half its way, the rate longer, as it is
  // less steep at first; lambda itself would relax in twice that.
  EXPECT_GT(half.ours, 441.0);
  EXPECT_LT(half.ours, 882.0);
}

TEST(PaperTest, CrossingsAlongAStraightLineAreNoisy) {
  const PaperResults& results = short_run();
  const PaperNumber& free =
      number(results, "rms noise of a period's rate by RK4, without drive and friction");
  // The free swing is 1.5e-4 slow, so its crossings fall on other places of their steps.
  EXPECT_NEAR(free.by_paper / free.ours, 1.0, 0.03);
  const PaperNumber& driven = number(results, "the same at C, the torque chosen in each stage");
  EXPECT_GT(driven.by_paper, 2.0 * free.by_paper);
  EXPECT_LT(driven.ours, 1e-11); // periods of a limit cycle, known to 1e-14 or better
}

TEST(PaperTest, ThePartsOfTheBudgetMakeTheWhole) {
  const auto& budget = short_run().budget;
  ASSERT_EQ(budget.size(), 11u);
  const double lambda4 = std::pow(0.0495410, 4), epsilon = 1.167245e-4;
  EXPECT_NEAR(budget[1].rate, -3.0 * lambda4 / 1024.0, 1e-11);  // the next order, lambda^6
  EXPECT_NEAR(budget[2].rate, -0.5 * epsilon * epsilon, 1e-13); // epsilon^4
  // Parts and whole come of different runs; third order is left: epsilon^2 lambda^2 = 3e-11 and
  // lambda^6 = 1.5e-8 with coefficients of a few thousandths.
  EXPECT_NEAR(budget[5].rate, budget[6].rate, 2e-11);
  EXPECT_NEAR(budget[6].rate, 1.844068077230375e-8, 1e-14); // limit_cycle's own
  // Interpolated crossings, 5e-7 over 20,000 periods, and the circular error of what RK4 loses.
  EXPECT_NEAR(budget[8].rate, -std::pow(0.03, 4) / 120.0, 1e-11);
  // The stages displace a switch by up to dt/3; over many periods an rms of 2.4e-9 is left at most.
  EXPECT_NEAR(budget[9].rate, budget[6].rate + budget[8].rate, 1e-9);
}

TEST(PaperTest, TheNoiseIsThatOfTheAveragedEquations) {
  const PaperResults& results = short_run();
  const PaperNumber& rms =
      number(results, "rms gain by the driving noise in 24000 periods, 1000 runs");
  EXPECT_NEAR(rms.sigma / rms.ours, 1.0 / std::sqrt(2.0 * 999.0), 1e-12); // of 1000 runs
  EXPECT_NEAR(rms.ours, rms.by_paper, 3.0 * rms.sigma);                   // one seed in 400
  const PaperNumber& carried =
      number(results, "the same in the paper's 4.3e6 periods, from the growth of the variance");
  EXPECT_NEAR(carried.ours, carried.by_paper, 3.0 * carried.sigma); // one seed in 400
  EXPECT_LT(carried.sigma, 0.05 * carried.ours);                    // else that says nothing
  // The start, an eighth of the variance of so short a run, is not part of a long one's.
  EXPECT_LT(carried.ours, 0.97 * rms.ours * std::sqrt(24000.0 / 4.3e6));
  const Figure& growth = figure(results, "noise_growth");
  const Series& measured = series(growth, "1000 runs, 95 %");
  const Series& theory = series(growth, "averaged equations, small noise");
  int held = 0;
  for (std::size_t k = 0; k < measured.x.size(); ++k) {
    const double y = theory.y[10 * (k + 1)]; // its points are 100 periods apart, ours 1000
    held += measured.low[k] <= y && y <= measured.high[k] ? 1 : 0;
  }
  EXPECT_GE(held, 20); // of 24: the same runs at every length, so a stray one strays for a while
}

TEST(PaperTest, TheSecularDifferenceIsOfSecondOrder) {
  const PaperResults& results = short_run();
  const PaperNumber& before = number(results, "secular ψp - ψm before the noise begins");
  EXPECT_NEAR(before.ours, 1.844068e-8 + 3.468306e-11, 1e-12); // the digits; statrate is -3.5e-11
  const PaperNumber& under = number(results, "secular ψp - ψm under the noise");
  const PaperNumber& many = number(results, "what the noise adds to the secular ψp - ψm, 100 runs");
  EXPECT_LT(many.ours, -100.0 * many.sigma);
  const Series& unsolved = series(figure(results, "quasistat_model"), "return map less eq. 16");
  EXPECT_NEAR(under.ours, slope_from(unsolved, 2000.0), 1e-14); // rounding of 2e-3 in 1e5
  // One run of 18,000 periods scatters by 4.5e-11, and its first 700 periods are on their way.
  EXPECT_NEAR(under.ours - before.ours, many.ours, 3e-10);
  const PaperNumber& half = number(results, "the same with half the noise");
  EXPECT_NEAR(many.ours, 4.0 * half.ours, 3.0 * std::hypot(many.sigma, 4.0 * half.sigma));
  // Third order: what second order lacks at C without noise is 1.6e-12.
  EXPECT_LT(std::abs(number(results, "the same, the model of second order").ours), 5e-12);
}

TEST(PaperTest, EqualMomentsKeepEqualTime) {
  const PaperResults& results = short_run();
  for (const char* what : {"rate of C, nominal", "rate with a single impulse that has C's moments",
                           "rate with pushes 0.01 rad wide that have C's moments"}) {
    const PaperNumber& clock = number(results, what);
    // The edges of a push, 1e-7 rad wide, by the square of their part in it.
    EXPECT_NEAR(clock.by_paper, -3.468305925583591e-11, 1e-13) << what;
    EXPECT_LT(std::abs(clock.ours - clock.by_paper), 5e-8) << what; // second order is some 2e-8
  }
  for (const double y : series(figure(results, "moments"), "C's work, at the vertical").y)
    EXPECT_GT(y, 1e-4); // the same work without the moment b: the whole escapement error
}

TEST(PaperTest, OnlyTheFirstHarmonicActs) {
  const PaperResults& results = short_run();
  for (const char* shape :
       {"μ all the time, n = 0,", "μ cos 2ψ", "μ sin 2ψ", "μ cos 3ψ", "μ sin 3ψ"})
    // Second order, (mu/lambda)^2 = 9e-8.
    EXPECT_LT(
        std::abs(
            number(results, std::string("what a torque of ") + shape + " adds to the rate").ours),
        9e-8)
        << shape;
  for (const char* label : {"μ cos nψ", "μ sin nψ"}) {
    const Series& harmonics = series(figure(results, "harmonics"), label);
    for (std::size_t i = 0; i < harmonics.x.size(); ++i) {
      if (harmonics.x[i] == 1.0) {
        EXPECT_GT(harmonics.y[i], 1e-4) << label; // mu/(2 lambda) = 1.5e-4
      } else {
        EXPECT_LT(harmonics.y[i], 9e-8) << label; // as above
      }
    }
  }
}

TEST(PaperTest, LengthActsOnTheRateAlone) {
  const PaperResults& results = short_run();
  // The circular and the escapement error, some 1.5e-4 each, change by parts of the change too.
  EXPECT_NEAR(number(results, "change of the rate per relative change of length").ours, -0.5, 2e-4);
  EXPECT_NEAR(number(results, "relative change of λ per relative change of length").ours, 0.0,
              2e-4);
  // Were it the scale of time that changes, the angle would not.
  const Series& angle = series(figure(results, "length"), "largest angle");
  EXPECT_NEAR(angle.y.back(), 0.25 * angle.x.back(), 3e-5); // its square, 1e-4, by some tenths
}

TEST(PaperTest, ThePlaceOfAPushCountsNotItsWidth) {
  const PaperResults& results = short_run();
  const auto push = [&](const std::string& what) {
    const PaperNumber& n = number(results, "escapement error over ε of pushes " + what);
    EXPECT_NEAR(n.ours, n.by_paper, 2e-3) << what; // second order over ε: some 1e-7/1.2e-4
    return n.ours;
  };
  for (const char* width : {"0.002", "0.01", "0.06"})
    EXPECT_LT(std::abs(push(std::string(width) + " rad wide with their middle at the vertical")),
              1e-3); // as above; the paper's estimate is 0.04 to 1.2
  EXPECT_LT(push("0.01 rad wide that begin at the vertical"), -0.1);
  EXPECT_GT(push("0.002 rad wide with their middle 0.015 rad before the vertical"), 0.3);
  EXPECT_LT(push("0.002 rad wide with their middle 0.015 rad beyond the vertical"), -0.3);
}

TEST(PaperTest, ASingleImpulseIsThatOfBlow6) {
  // It has C's energy, hence C's amplitude; at the vertical there is no escapement error.
  EXPECT_NEAR(number(short_run(), "rate with a single impulse of C's energy at 0 rad").by_paper,
              -std::pow(0.0495410, 2) / 16.0, 1e-9); // the digits of the amplitude
  const Figure& impulse = figure(short_run(), "impulse");
  ASSERT_EQ(impulse.series.size(), 6u);
  for (std::size_t k = 0; k < 6; k += 2) {
    const Series& theory = impulse.series[k];
    const Series& ours = impulse.series[k + 1];
    for (std::size_t i = 0; i < ours.x.size(); ++i) {
      EXPECT_EQ(theory.x[8 * i], ours.x[i]);
      // Second order: -3 lambda^4/1024 is up to 7e-8, and the escapement adds as much.
      EXPECT_NEAR(theory.y[8 * i], ours.y[i], 1.5e-7);
    }
    EXPECT_LT(ours.y.back(), ours.y.front() - 1e-4); // before the vertical it gains
  }
}

TEST(PaperTest, ThePageHoldsEveryNumberAndFigure) {
  const PaperResults& results = short_run();
  const std::string page = paper_page(results);
  const auto holds = [&](const std::string& text) {
    const bool found = page.find(text) != std::string::npos;
    EXPECT_TRUE(found) << text;
  };
  for (const PaperNumber& n : results.numbers)
    holds(escape_markup(n.what));
  for (const BudgetPart& part : results.budget)
    holds(escape_markup(part.what));
  for (const PaperFigure& figure : results.figures)
    holds(escape_markup(figure.figure.caption));
  for (int equation = 1; equation <= 23; ++equation)
    if (equation != 12 && equation != 13) holds(fmt::format("<span>({})</span>", equation));
  for (const char* number : {"12, 13", "A1", "C1", "C2, C3", "C4", "C5", "C6"})
    holds(fmt::format("<span>({})</span>", number));
  EXPECT_EQ(page.find("nan"), std::string::npos);
  for (const char* asks : {"src=", "href=", "@import", "url("})
    EXPECT_EQ(page.find(asks), std::string::npos) << "it asks no network";
}

TEST(PaperTest, EveryFigureHasItsData) {
  const PaperResults& results = short_run();
  std::set<std::string> names;
  for (const PaperFigure& figure : results.figures)
    names.insert(figure.name);
  EXPECT_EQ(names,
            (std::set<std::string>{"amplitude_phase", "modesc", "rate", "jump_zoom", "jump_rate",
                                   "jump_amplitude", "jump_friction", "quasistat_gain",
                                   "quasistat_model", "noise_growth", "impulse", "optdriv_place",
                                   "optdriv_width", "moments", "harmonics", "length"}));
  for (const PaperFigure& figure : results.figures)
    for (const Series& series : figure.figure.series) {
      EXPECT_GT(series.x.size(), 1u) << figure.name << " " << series.label;
      EXPECT_EQ(series.x.size(), series.y.size());
      if (figure.name == "rate") continue; // its lines end at the edge of the drawing
      for (const double y : series.y)
        EXPECT_TRUE(std::isfinite(y)) << figure.name << " " << series.label;
    }
  const std::string text = paper_text(results);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_THROW((void)recompute_paper({.periods = 100}), ArgumentError);
}

} // namespace
} // namespace goingrate
