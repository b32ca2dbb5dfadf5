// Figures of what the paper states in words: single impulse, best place of the drive, equal
// moments, harmonics, length.
#include "paper_rates.hpp"
#include "paper_variants.hpp"

#include "goingrate/dynamics/operating_point.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate::paper {

namespace {

void add_point(Series& series, double x, double y) {
  series.x.push_back(x);
  series.y.push_back(y);
}

Series line(std::string label, int colour) {
  return {Series::Style::line, std::move(label), {}, {}, {}, {}, colour};
}

Series points(std::string label, int colour) {
  return {Series::Style::points, std::move(label), {}, {}, {}, {}, colour};
}

Figure impulse_figure() {
  Figure figure{"impulse",
                "The rate with a single impulse",
                "Lines: eq. C6; dots: the full equation of motion. The earlier in the "
                "swing, the faster the clock; more energy adds circular error.",
                {"angle φ1 of the impulse", "rad"},
                {"rate excess", ""},
                {}};
  int colour = blue;
  for (const double energy : {0.5, 1.0, 2.0}) {
    Series theory = line(fmt::format("{} times C's energy", energy), colour);
    Series ours = points(fmt::format("{} times, full equation", energy), colour);
    const double lambda = *stationary_amplitude(single_impulse(energy, 0.0));
    constexpr int steps = 40;
    for (int i = -steps; i <= steps; ++i) {
      const ClockParameters clock = single_impulse(energy, 0.8 * lambda * i / steps);
      add_point(theory, clock.impulse_angle, first_order_rate(clock));
      if (i % 8 == 0) add_point(ours, clock.impulse_angle, exact_rate(clock));
    }
    figure.series.push_back(std::move(theory));
    figure.series.push_back(std::move(ours));
    ++colour;
  }
  return figure;
}

// The rate due to a push, divided by epsilon: by the averaged equations and from the limit cycle.
double by_theory(double centre, double width) {
  const ClockParameters c = point_c();
  return escapement_error(c.epsilon, *stationary_amplitude(c), centre, width) / c.epsilon;
}

double by_cycle(double centre, double width) {
  return escapement_error_of(push(centre, width)) / point_c().epsilon;
}

Figure place_figure() {
  Figure figure{"optdriv_place",
                "Escapement error against the place of the push",
                "Lines: eqs. 9 and 10; dots: limit cycles of the full equation less a free "
                "swing as fast at the vertical. Widths from 0.002 to 0.04 rad make nearly one "
                "line: it is the "
                "place that counts.",
                {"middle of the push", "rad"},
                {"escapement error over ε", ""},
                {}};
  int colour = blue;
  for (const double width : {0.002, 0.02, 0.04}) {
    Series theory = line(fmt::format("{} rad wide", width), colour);
    Series ours = points(fmt::format("{} rad, full equation", width), colour);
    constexpr int steps = 20;
    for (int i = -steps; i <= steps; ++i) {
      const double centre = 0.02 * i / steps;
      add_point(theory, centre, by_theory(centre, width));
      if (i % 5 == 0) add_point(ours, centre, by_cycle(centre, width));
    }
    figure.series.push_back(std::move(theory));
    figure.series.push_back(std::move(ours));
    ++colour;
  }
  return figure;
}

Figure width_figure() {
  Series claim = line("the paper's ε δψ, drawn downwards", vermilion),
         centred = line("middle at the vertical", blue),
         begins = line("begins at the vertical", green);
  Series centred_cycles = points("middle there, full equation", blue),
         begins_cycles = points("begins there, full equation", green);
  const double lambda = *stationary_amplitude(point_c());
  for (int i = 1; i <= 18; ++i) {
    const double width = 0.0025 * i;
    add_point(claim, width, -width / lambda);
    add_point(centred, width, by_theory(0.0, width));
    add_point(begins, width, by_theory(0.5 * width, width));
    if (i % 3 != 0) continue;
    add_point(centred_cycles, width, by_cycle(0.0, width));
    add_point(begins_cycles, width, by_cycle(0.5 * width, width));
  }
  return {"optdriv_width",
          "Escapement error against the width of the push",
          "The paper's estimate ε δψ is that, within a factor of two, of a push that is off by "
          "half its width. One whose middle is at the vertical has none, however wide.",
          {"width of the push", "rad"},
          {"escapement error over ε", ""},
          {claim, centred, centred_cycles, begins, begins_cycles}};
}

Figure moments_figure() {
  const double nominal = first_order_rate(point_c());
  Series same = points("C's moments", blue),
         middle = points("C's work, at the vertical", vermilion);
  for (const double width : {0.0, 0.003, 0.006, 0.009, 0.012, 0.015}) {
    add_point(same, width, std::abs(exact_rate(same_moments(width)) - nominal));
    const ClockParameters clock = width == 0.0 ? single_impulse(1.0, 0.0) : push(0.0, width);
    add_point(middle, width, std::abs(exact_rate(clock) - nominal));
  }
  Series c = line("C itself", green);
  for (const double width : {0.0, 0.015})
    add_point(c, width, std::abs(exact_rate(point_c()) - nominal));
  return {"moments",
          "Escapements with equal moments keep equal time",
          "How far the full equation is from the rate of C by eq. 20, for an impulse (width "
          "0) and for pushes. With C's two moments what is left is of second order; with C's work "
          "but not its moment b the whole escapement error is missing.",
          {"width of the push", "rad"},
          {"difference of the rate", "", true},
          {same, middle, c}};
}

Figure harmonics_figure() {
  const double plain = exact_rate(point_c());
  Series cosines = points("μ cos nψ", blue), sines = points("μ sin nψ", vermilion);
  for (int n = 0; n <= 6; ++n) {
    add_point(cosines, n, std::abs(with_harmonic(n, false).rate - plain));
    if (n > 0) add_point(sines, n, std::abs(with_harmonic(n, true).rate - plain));
  }
  return {"harmonics",
          "What harmonics of the torque add to the rate of C",
          "Only n = 1 has moments. The others, as large as C's own torque, leave (μ/λ)², of second "
          "order; a constant torque, n = 0, only shifts the middle of the swing.",
          {"n", ""},
          {"change of the rate, absolute", "", true},
          {cosines, sines}};
}

Figure length_figure() {
  const Lengthened plain = lengthened(0.0);
  Series theory = line("-δℓ/2ℓ0", blue), rate = points("rate, full equation", blue),
         lambda = points("amplitude λ", vermilion), angle = points("largest angle", green);
  for (int i = -5; i <= 5; ++i) {
    const double change = 0.002 * i;
    const Lengthened clock = lengthened(change);
    add_point(theory, change, -0.5 * change);
    add_point(rate, change, clock.rate - plain.rate);
    add_point(lambda, change, clock.amplitude / plain.amplitude - 1.0);
    add_point(angle, change, clock.angle / plain.angle - 1.0);
  }
  return {"length",
          "What a change of length does",
          "Gravity over length changes, friction and torque do not. The rate follows by half of "
          "it; λ, whose square is the mean of φ² + φ'², stays, while the largest angle "
          "grows by a quarter of it and φ' at the vertical falls by as much.",
          {"relative change of length", ""},
          {"relative change", ""},
          {theory, rate, lambda, angle}};
}

} // namespace

std::vector<PaperFigure> statement_figures() {
  return {{"impulse", impulse_figure()},     {"optdriv_place", place_figure()},
          {"optdriv_width", width_figure()}, {"moments", moments_figure()},
          {"harmonics", harmonics_figure()}, {"length", length_figure()}};
}

} // namespace goingrate::paper
