// The figures that need no run of the pendulum over time.
#include "paper_rates.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/dynamics/operating_point.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace goingrate::paper {

namespace {

using std::numbers::pi;

// The curve on which the clock's rate is `rate`: up to two torques for each friction, joined at the
// fold.
Series contour(double s_per_day, int colour) {
  Series line{Series::Style::line, fmt::format("{:+.0f} s/day", s_per_day), {}, {}, {}, {}, colour};
  std::vector<std::pair<double, double>> lower, upper;
  for (double epsilon = 5e-6; epsilon <= 5e-4; epsilon *= 1.005) {
    KnownPair known;
    known.epsilon = epsilon;
    known.rate_excess = s_per_day / seconds_per_day;
    const auto points = operating_points(known, 0.03, Equations::first_order);
    if (points.empty()) continue;
    upper.emplace_back(epsilon, points.back().mu);
    if (points.size() > 1) lower.emplace_back(epsilon, points.front().mu);
  }
  std::reverse(lower.begin(), lower.end());
  lower.insert(lower.end(), upper.begin(), upper.end());
  constexpr double most = 5e-5; // the drawing's edge
  for (const auto& [epsilon, mu] : lower) {
    line.x.push_back(epsilon);
    line.y.push_back(mu <= most ? mu : std::nan(""));
  }
  return line;
}

Figure rate_figure() {
  Figure figure{"rate",
                "Stationary rate over friction and torque",
                "Lines of equal rate by eq. 20, φ0 = 0.03. Below the lowest straight line "
                "the clock stalls; A, B, C are the paper's points.",
                {"friction ε", ""},
                {"torque μ", ""},
                {}};
  for (const double rate : {-20.0, -10.0, -5.0})
    figure.series.push_back(contour(rate, blue));
  figure.series.push_back(contour(0.0, vermilion));
  for (const double rate : {5.0, 10.0, 17.0})
    figure.series.push_back(contour(rate, green));
  for (const double times : {1.0, 2.0, 3.0}) {
    Series line{Series::Style::line, fmt::format("λ = {:.0f} φ0", times), {}, {}, {}, {}, purple};
    for (const double epsilon : {0.0, 5e-4}) {
      const double mu = 0.5 * pi * epsilon * 0.03 * times * times;
      const double reach = std::min(1.0, mu > 0.0 ? 5e-5 / mu : 1.0);
      line.x.push_back(epsilon * reach);
      line.y.push_back(mu * reach);
    }
    figure.series.push_back(std::move(line));
  }
  figure.series.push_back({Series::Style::points,
                           "A, B, C",
                           {point_c().epsilon, point_a().epsilon, point_b().epsilon},
                           {point_c().mu, point_a().mu, point_b().mu},
                           {},
                           {},
                           orange});
  return figure;
}

// Fig. pslaph: a vector of length lambda that turns with psi, and its height over time. The
// friction is far above a clock's; otherwise the decay would not show.
Figure amplitude_phase_figure() {
  constexpr double epsilon = 0.02, shown = 0.7, right = 1.5; // psi of the vector; where time begins
  const auto lambda = [](double psi) { return std::exp(-epsilon * psi); };
  Series circle{Series::Style::line, "end of the vector (λ, ψ)", {}, {}, {}, {}, blue};
  Series height{Series::Style::line, "its height, φ = λ sin ψ", {}, {}, {}, {}, vermilion};
  for (double psi = 0.0; psi <= 4.0 * pi; psi += 0.05) {
    circle.x.push_back(lambda(psi) * std::cos(psi));
    circle.y.push_back(lambda(psi) * std::sin(psi));
    height.x.push_back(right + psi / pi);
    height.y.push_back(circle.y.back());
  }
  const double x = lambda(shown) * std::cos(shown), y = lambda(shown) * std::sin(shown);
  const Series vector{Series::Style::line, "the vector", {0.0, x}, {0.0, y}, {}, {}, green};
  const Series across{
      Series::Style::line, "the same height", {x, right + shown / pi}, {y, y}, {}, {}, purple};
  return {"amplitude_phase",
          "Amplitude and phase",
          "The end of a vector of length λ that turns at the rate of ψ, drawn over the velocity; "
          "to the right its height φ over time. Friction is drawn a hundred times too large.",
          {"velocity; from 1.5 on time, in half swings", ""},
          {"angle φ", ""},
          {circle, height, vector, across}};
}

// The torque as a function of the phase at A, eq. defdel: the part of fig. modesc that can be
// computed.
Figure escapement_figure() {
  const ClockParameters a = point_a();
  const double lambda = *stationary_amplitude(a), switches = std::asin(a.phi0 / lambda) / pi;
  Series torque{Series::Style::line, "torque, m/μ", {}, {}, {}, {}, vermilion};
  double m = 1.0;
  torque.x.push_back(-0.5);
  torque.y.push_back(m);
  for (const double at : {switches, 1.0 + switches}) {
    torque.x.insert(torque.x.end(), {at, at});
    torque.y.insert(torque.y.end(), {m, -m});
    m = -m;
  }
  torque.x.push_back(2.0);
  torque.y.push_back(m);
  Series angle{Series::Style::line, "angle, φ/λ", {}, {}, {}, {}, blue};
  for (double psi = -0.5; psi <= 2.0; psi += 0.01) {
    angle.x.push_back(psi);
    angle.y.push_back(std::sin(pi * psi));
  }
  return {"modesc",
          "The model escapement",
          fmt::format("The torque turns against the motion where the angle reaches φ0, at A {:.2f} "
                      "of the amplitude, and again at -φ0.",
                      a.phi0 / lambda),
          {"phase ψ", "π"},
          {"angle and torque", ""},
          {angle, torque},
          {{switches, "φ0"}, {1.0 + switches, "-φ0"}}};
}

} // namespace

std::vector<PaperFigure> figures(const NoisyRun& noisy, const NoiseStatistics& noise) {
  std::vector<PaperFigure> all{{"amplitude_phase", amplitude_phase_figure()},
                               {"modesc", escapement_figure()},
                               {"rate", rate_figure()}};
  const auto add = [&](std::vector<PaperFigure> more) {
    for (PaperFigure& figure : more)
      all.push_back(std::move(figure));
  };
  add(jump_figures());
  add(long_run_figures(noisy));
  all.push_back(noise_figure(noise));
  add(statement_figures());
  return all;
}

} // namespace goingrate::paper
