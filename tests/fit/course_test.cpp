// The averaged course of a clock without a closed form, by power series, against even short steps.
#include "fit/course.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

namespace goingrate::timing_model {
namespace {

template <class T> AveragedLaws<T> dragging(const T& epsilon, const T& quadratic) {
  AveragedLaws<T> laws;
  laws.linear = false;
  laws.epsilon = epsilon;
  laws.mu = T(4e-5);
  laws.phi0 = T(0.03);
  laws.quadratic = quadratic;
  laws.dry = T(1e-7);
  return laws;
}

constexpr double epsilon = 2e-4, quadratic = 2e-3, start = 0.02;
constexpr double untouched = 1e-9;    // a switching angle that no swing comes down to, rad
constexpr double relaxation = 1000.0; // about 1/(slope of the growth), scaled time

// Steps of a thousandth of the relaxation: fourth order is then at rounding.
std::pair<double, double> by_even_steps(const AveragedLaws<double>& laws, double x, double t) {
  const int steps = static_cast<int>(std::ceil(1000.0 * t / relaxation));
  const double h = t / steps;
  double excess = 0.0;
  for (int k = 0; k < steps; ++k) {
    const double k1 = laws.growth(x), r1 = laws.rate(x);
    const double x2 = x + 0.5 * h * k1, k2 = laws.growth(x2), r2 = laws.rate(x2);
    const double x3 = x + 0.5 * h * k2, k3 = laws.growth(x3), r3 = laws.rate(x3);
    const double x4 = x + h * k3, k4 = laws.growth(x4), r4 = laws.rate(x4);
    x += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
    excess += h / 6.0 * (r1 + 2.0 * (r2 + r3) + r4);
  }
  return {x, excess};
}

AveragedLaws<double> struck() {
  AveragedLaws<double> laws;
  laws.escapement = Escapement::single_impulse;
  laws.epsilon = 2e-4;
  laws.mu = 2.5e-6;
  laws.phi0 = 0.01;
  return laws;
}

AveragedLaws<double> ringing_down() {
  auto laws = dragging<double>(epsilon, quadratic);
  laws.mu = 0.0;
  laws.phi0 = untouched;
  laws.dry = 0.0;
  return laws;
}

TEST(CourseTest, SeriesFollowEvenSteps) {
  for (const auto& laws : {dragging<double>(epsilon, quadratic), struck(), ringing_down()})
    for (const double relaxations : {0.3, 3.0, 12.0, 60.0}) {
      SCOPED_TRACE(relaxations);
      const double t = relaxations * relaxation;
      const auto [x, excess] = by_even_steps(laws, start, t);
      const auto state = Course<double>(laws, start).at(t);
      ASSERT_TRUE(state);
      // Rounding of up to 60,000 even steps; a step of the series adds 1e-15 rad.
      EXPECT_NEAR(state->amplitude2, x, 5e-13 * x);
      EXPECT_NEAR(state->phase_excess, excess, 1e-12 * start * relaxation);
      EXPECT_NEAR(state->rate, laws.rate(x), 1e-13);
    }
}

TEST(CourseTest, ItEndsWhereTheSwingComesDownToTheEscapement) {
  auto laws = dragging<double>(epsilon, quadratic);
  laws.mu = 1e-6; // too weak to keep the clock going
  const auto reaches = [&](double t) { return laws.reaches(by_even_steps(laws, start, t).first); };
  const auto goes = [&](double t) { return Course<double>(laws, start).at(t).has_value(); };
  double low = 1e3, high = 1e4;
  ASSERT_TRUE(reaches(low) && !reaches(high));
  for (int round = 0; round < 20; ++round)
    (reaches(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
  // The steps' bisection ends within 0.01; the series stop 1e-9 of a relaxation before.
  EXPECT_TRUE(goes(low - 0.1));
  EXPECT_FALSE(goes(high + 0.1));
}

TEST(CourseTest, AClockThatTurnsTooFastIsNone) {
  auto laws = dragging<double>(epsilon, quadratic);
  laws.phi0 = 1e-9; // a swing of 1e-5 rad, which this torque drives round 2.5 times too fast
  EXPECT_FALSE(Course<double>(laws, 1e-10).at(relaxation));
  laws.linear = true;
  laws.quadratic = laws.dry = 0.0;
  EXPECT_FALSE(Course<double>(laws, 1e-10).at(1e-3));
}

TEST(CourseTest, AClockThatRestsAtTheEdgeOfItsEscapementComesToAnEnd) {
  auto laws = dragging<double>(epsilon, quadratic);
  laws.quadratic = 0.0;
  const double pi = std::numbers::pi; // growth is 0 at phi0 itself, but for a part in 1e10
  laws.mu = (2.0 * laws.epsilon * laws.phi0 + laws.dry * 4.0 / pi) * pi / 4.0 * (1.0 + 1e-10);
  Course<double> course(laws, start);
  int asked = 0;
  while (asked < 1000 && course.at(asked * 100.0))
    ++asked;
  EXPECT_GT(asked, 100); // 10 relaxations: from there on the rate has no derivative
}

TEST(CourseTest, BeatByBeatItComesWhereOneLongWayLeads) {
  const auto laws = dragging<double>(epsilon, quadratic);
  Course<double> walked(laws, start);
  constexpr double step = 6.28;
  std::optional<Course<double>::State> last;
  for (int k = 1; k <= 20000; ++k)
    last = walked.at(step * k);
  EXPECT_TRUE(walked.settled());
  const auto jumped = Course<double>(laws, start).at(step * 20000);
  ASSERT_TRUE(last && jumped);
  EXPECT_NEAR(last->amplitude2, jumped->amplitude2, 1e-14 * start); // both at rest: rounding
  EXPECT_NEAR(last->phase_excess, jumped->phase_excess, 1e-12 * start * relaxation);
}

TEST(CourseTest, DerivativesAreThoseOfTheCourse) {
  using J = ceres::Jet<double, 1>;
  for (const double relaxations : {0.3, 3.0, 20.0, 60.0}) {
    SCOPED_TRACE(relaxations);
    const double t = relaxations * relaxation;
    const auto state = Course<J>(dragging<J>(J(epsilon), J(quadratic, 0)), J(start)).at(J(t));
    ASSERT_TRUE(state);
    const double h = 1e-4 * quadratic;
    const auto up = by_even_steps(dragging<double>(epsilon, quadratic + h), start, t);
    const auto down = by_even_steps(dragging<double>(epsilon, quadratic - h), start, t);
    const double of_x = (up.first - down.first) / (2.0 * h);
    const double of_phase = (up.second - down.second) / (2.0 * h);
    // The difference's own error is (1e-4)^2 and its rounding as much; that of the steps is far
    // below.
    EXPECT_NEAR(state->amplitude2.v[0], of_x, 1e-7 * std::abs(of_x));
    EXPECT_NEAR(state->phase_excess.v[0], of_phase, 1e-7 * std::abs(of_phase));
  }
}

TEST(CourseTest, AYearAtRestTakesNoSteps) {
  const auto laws = dragging<double>(epsilon, quadratic);
  Course<double> course(laws, start);
  const auto month = course.at(1e7), year = course.at(1e8); // steps of a fiftieth would be 5e6
  ASSERT_TRUE(month && year);
  EXPECT_EQ(month->amplitude2, year->amplitude2);
  EXPECT_NEAR(laws.growth(year->amplitude2), 0.0, 1e-17); // rounding of its terms, 1e-6
  EXPECT_NEAR(year->phase_excess - month->phase_excess, 9e7 * laws.rate(year->amplitude2), 1e-6);
}

} // namespace
} // namespace goingrate::timing_model
