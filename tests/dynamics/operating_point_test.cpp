#include "goingrate/dynamics/operating_point.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/rk4.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/quadrature/tanh_sinh.hpp>

namespace goingrate {
namespace {

using std::numbers::pi;

ClockParameters clock_of(double epsilon, double mu, double phi0) {
  ClockParameters clock;
  clock.epsilon = epsilon;
  clock.mu = mu;
  clock.phi0 = phi0;
  return clock;
}

// ---- stall line --------------------------------------------------------------------------------

TEST(StallTorqueTest, FirstOrderIsWhereTheAmplitudeIsPhi0) {
  const double stall = stall_torque(2.5e-4, 0.03);
  EXPECT_FALSE(stationary_amplitude(clock_of(2.5e-4, stall * (1 - 1e-12), 0.03)));
  // Phi0 times the excess of the torque.
  EXPECT_NEAR(*stationary_amplitude(clock_of(2.5e-4, stall * (1 + 3e-14), 0.03)), 0.03, 1e-12);
}

TEST(StallTorqueTest, ExactOneTendsToTheAreaOfTheFreeSwing) {
  // Friction takes 2 eps times the area under the swing that just reaches phi0; the torque gives
  // 2 mu phi0. Beyond that 0.32 eps^2.
  boost::math::quadrature::tanh_sinh<double> integrate;
  for (const double phi0 : {0.003, 0.03, 0.3, 1.0, 2.0, 3.0}) {
    const auto speed = [&](double phi) {
      return std::sqrt(4 * std::sin(0.5 * (phi0 - phi)) * std::sin(0.5 * (phi0 + phi)));
    };
    const double area = 2 * integrate.integrate(speed, 0.0, phi0);
    for (const double epsilon : {1e-6, 1e-4}) {
      const double of_area = epsilon * area / phi0;
      EXPECT_NEAR(*exact_stall_torque(epsilon, phi0) / of_area, 1.0,
                  3 * epsilon * epsilon + 2e-11); // 1e-17/epsilon
    }
  }
  const double first_order = stall_torque(1e-2, 0.03);
  EXPECT_NEAR(1 - *exact_stall_torque(1e-2, 0.03) / first_order, 5 * 0.03 * 0.03 / 96 + 0.3225e-4,
              1e-7); // phi0^4 and eps^2 phi0^2
}

TEST(StallTorqueTest, SeparatesClocksThatGoFromClocksThatStall) {
  const auto goes = [](double epsilon, double mu, double phi0) {
    Rk4Pendulum pendulum(1.2, 0.01, TorqueTiming::at_switches);
    for (int i = 0; i < 1000; ++i)
      if (pendulum.advance(epsilon, mu, phi0).status != SwingStatus::crossed) return false;
    return true;
  };
  for (const double epsilon : {0.02, 0.1}) {
    const double stall = *exact_stall_torque(epsilon, 1.0);
    EXPECT_LT(stall, 0.95 * stall_torque(epsilon, 1.0));
    // RK4 sees phi0 passed only if a grid point is beyond: dt^2/8 in the angle, 2e-5 in torque.
    EXPECT_FALSE(goes(epsilon, stall * (1 - 1e-4), 1.0));
    EXPECT_TRUE(goes(epsilon, stall * (1 + 1e-4), 1.0));
  }
}

TEST(StallTorqueTest, NoneWherePhi0TakesTooMuchSpeed) {
  EXPECT_FALSE(exact_stall_torque(0.3, 3.0));
  EXPECT_TRUE(exact_stall_torque(1e-4, 3.0));
}

// ---- nominal rate ------------------------------------------------------------------------------

TEST(NominalRateTest, BothLinesAtPointC) {
  const double first = *nominal_rate_torque(1.167245e-4, 0.03, Equations::first_order);
  EXPECT_NEAR(first, 1.5e-5, 2e-6 * 1.5e-5); // the paper's epsilon has seven digits
  // A few roundings of terms of 1.5e-4.
  EXPECT_NEAR(*stationary_rate_first_order(clock_of(1.167245e-4, first, 0.03)), 0.0, 1e-19);
  const double exact = *nominal_rate_torque(1.167245e-4, 0.03, Equations::exact);
  // C gains 1.844e-8 and more torque makes it lose: slow gain -3.229e-5. Curvature: 4 %.
  EXPECT_NEAR(exact / 1.5e-5 - 1.0, 1.844068e-8 / 3.22871e-5, 0.04 * 5.7e-4);
  EXPECT_NEAR(limit_cycle(clock_of(1.167245e-4, exact, 0.03))->rate_excess, 0.0, 5e-15); // its own
}

TEST(NominalRateTest, IsTheLargerOfTwoTorques) {
  for (const auto equations : {Equations::first_order, Equations::exact})
    for (const double epsilon : {1.2e-4, 2.5e-4, 1e-3}) {
      const double mu = *nominal_rate_torque(epsilon, 0.03, equations);
      const auto points = operating_points({epsilon, {}, {}, 0.0}, 0.03, equations);
      ASSERT_EQ(points.size(), 2u);
      EXPECT_LT(points[0].mu, 0.9 * mu);
      EXPECT_NEAR(points[1].mu, mu, 1e-9 * mu); // near epsilon = phi0^2/8 the rate hardly depends
    }
}

TEST(NominalRateTest, NoneWithTooLittleFrictionOrBeyondTheTop) {
  for (const auto equations : {Equations::first_order, Equations::exact}) {
    EXPECT_FALSE(nominal_rate_torque(0.99 * 0.03 * 0.03 / 8, 0.03, equations));
    EXPECT_FALSE(nominal_rate_torque(1e-2, 0.03, equations)); // only the smaller one is below 2 rad
  }
}

// ---- operating points --------------------------------------------------------------------------

struct KnownRate {
  const char* name;
  double epsilon, mu;
  double velocity, rate; // 128-bit values
};
constexpr KnownRate at_a{"A", 2.5e-4, 2e-5, 0.0390886300401325117257, 1.133264436573979e-04};
constexpr KnownRate at_b{"B", 2.5e-4, 4e-5, 0.0552840336990741440991, 1.960046634308295e-04};
constexpr KnownRate at_c{"C", 1.167245e-4, 1.5e-5, 0.0495414393471760923604, 1.844068077230375e-08};

// The relative distance of two points, largest of all quantities; rates as parts of epsilon.
double distance(const OperatingPoint& a, const OperatingPoint& b) {
  return std::max(std::max(std::abs(a.epsilon / b.epsilon - 1), std::abs(a.mu / b.mu - 1)),
                  std::max(std::abs(a.amplitude / b.amplitude - 1),
                           std::abs(a.rate_excess - b.rate_excess) / b.epsilon));
}

// How far the nearest solution is, over all six pairs of what is known.
void expect_round_trips(const OperatingPoint& p, double phi0, Equations equations,
                        double tolerance) {
  const KnownPair pairs[] = {
      {p.epsilon, p.mu, {}, {}},          {p.epsilon, {}, p.amplitude, {}},
      {p.epsilon, {}, {}, p.rate_excess}, {{}, p.mu, p.amplitude, {}},
      {{}, p.mu, {}, p.rate_excess},      {{}, {}, p.amplitude, p.rate_excess}};
  for (std::size_t i = 0; i < std::size(pairs); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    double last = 0.0;
    for (const auto& found : operating_points(pairs[i], phi0, equations)) {
      nearest = std::min(nearest, distance(found, p));
      EXPECT_GT(found.amplitude, last);
      last = found.amplitude;
    }
    EXPECT_LT(nearest, tolerance) << "pair " << i;
  }
}

class OperatingPointTest : public testing::TestWithParam<KnownRate> {};

TEST_P(OperatingPointTest, RoundTripOfAllPairs) {
  const KnownRate& p = GetParam();
  const auto exact = operating_points({p.epsilon, p.mu, {}, {}}, 0.03, Equations::exact);
  ASSERT_EQ(exact.size(), 1u);
  EXPECT_NEAR(exact[0].amplitude, p.velocity, 1e-15); // as limit_cycle promises
  EXPECT_NEAR(exact[0].rate_excess, p.rate, 2e-15);   // likewise
  // A rate good to 1e-15 is 1e-11 of epsilon; at A, close to the highest rate, it tells even less.
  expect_round_trips(exact[0], 0.03, Equations::exact, 2e-11);
  const auto first = operating_points({p.epsilon, p.mu, {}, {}}, 0.03, Equations::first_order);
  ASSERT_EQ(first.size(), 1u);
  expect_round_trips(first[0], 0.03, Equations::first_order, 1e-13); // roundings of a rate near 0
}

INSTANTIATE_TEST_SUITE_P(Points, OperatingPointTest, testing::Values(at_a, at_b, at_c),
                         [](const auto& scene) { return scene.param.name; });

TEST(OperatingPointsTest, RoundTripsInAWideRegion) {
  for (const double phi0 : {0.003, 0.03, 0.3})
    for (const double epsilon : {1e-5, 1e-3, 1e-2})
      for (const double spread : {1.01, 1.5, 4.0, 25.0}) { // lambda^2 / phi0^2
        const double mu = stall_torque(epsilon, phi0) * spread;
        const auto p = operating_points({epsilon, mu, {}, {}}, phi0, Equations::exact);
        ASSERT_EQ(p.size(), 1u) << phi0 << " " << epsilon << " " << spread;
        // A rate good to 1e-15, over epsilon of 1e-5 and close to a highest rate (a root of it).
        expect_round_trips(p[0], phi0, Equations::exact, 1e-8);
      }
}

TEST(OperatingPointsTest, RoundTripsCloseToStallAndWithMuchFriction) {
  struct Scene {
    double phi0, epsilon, y;
  };
  for (const Scene& s : {Scene{0.40, 0.068, 0.034}, Scene{0.98, 0.039, 0.020},
                         Scene{0.88, 0.0049, 0.010}, Scene{0.11, 0.043, 0.011}}) {
    const double mu = stall_torque(s.epsilon, s.phi0) * (1 + s.y * s.y);
    const auto p = operating_points({s.epsilon, mu, {}, {}}, s.phi0, Equations::exact);
    ASSERT_EQ(p.size(), 1u);
    expect_round_trips(p[0], s.phi0, Equations::exact, 1e-8); // as above
  }
  // The torque is so strong that the curve of constant torque begins where epsilon is 1.
  const auto p = operating_points({0.95, 0.01, {}, {}}, 0.003, Equations::first_order);
  ASSERT_EQ(p.size(), 1u);
  expect_round_trips(p[0], 0.003, Equations::first_order, 1e-13); // roundings
}

TEST(OperatingPointsTest, FirstOrderObeysItsClosedForms) {
  // Friction and rate known: y^2 - 2 p y + 1 + 16 r/phi0^2 = 0 with p = 8 eps/phi0^2.
  const double phi0 = 0.03, epsilon = 2.5e-4, rate = 1e-4;
  const double p = 8 * epsilon / (phi0 * phi0);
  const double root = std::sqrt(p * p - 1 - 16 * rate / (phi0 * phi0));
  const auto points = operating_points({epsilon, {}, {}, rate}, phi0, Equations::first_order);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NEAR(points[0].amplitude, phi0 * std::hypot(1.0, p - root), 1e-16); // roundings
  EXPECT_NEAR(points[1].amplitude, phi0 * std::hypot(1.0, p + root), 1e-16); // roundings
  // Amplitude and rate known: epsilon = (r + lambda^2/16)/y.
  const auto point = operating_points({{}, {}, 0.05, 1e-5}, phi0, Equations::first_order);
  ASSERT_EQ(point.size(), 1u);
  const double y = std::sqrt(0.05 * 0.05 / (phi0 * phi0) - 1);
  EXPECT_NEAR(point[0].epsilon, (1e-5 + 0.05 * 0.05 / 16) / y, 2e-19); // a few roundings of 1.2e-4
}

TEST(OperatingPointsTest, BothSidesOfTheHighestRateAreFound) {
  // With friction known the rate of first order is at most -phi0^2/16 + 4 eps^2/phi0^2.
  const double phi0 = 0.03, epsilon = 2.5e-4;
  const double highest = -phi0 * phi0 / 16 + 4 * epsilon * epsilon / (phi0 * phi0);
  const auto count = [&](double rate) {
    return operating_points({epsilon, {}, {}, rate}, phi0, Equations::first_order).size();
  };
  EXPECT_EQ(count(highest * (1 - 1e-11)), 2u); // the header promises 1e-12
  EXPECT_EQ(count(highest * (1 + 1e-11)), 0u);
  EXPECT_EQ(count(-phi0 * phi0 / 16), 1u); // the smaller one is at the stall line
}

TEST(OperatingPointsTest, NoneWhereThereIsNone) {
  for (const auto equations : {Equations::first_order, Equations::exact}) {
    EXPECT_TRUE(operating_points({2.5e-4, 1e-6, {}, {}}, 0.03, equations).empty()); // stalls
    EXPECT_TRUE(operating_points({2.5e-4, {}, 0.02, {}}, 0.03, equations).empty()); // below phi0
    EXPECT_TRUE(operating_points({{}, 2e-5, {}, 0.01}, 0.03, equations).empty()); // beyond maximum
    EXPECT_TRUE(operating_points({{}, {}, 0.1, -0.1}, 0.03, equations).empty());  // circular error
    EXPECT_TRUE(operating_points({{}, {}, 0.02, 0.0}, 0.03, equations).empty());
    EXPECT_TRUE(operating_points({2.5e-4, {}, {}, 0.0}, 3.0, equations).empty()); // phi0 too wide
  }
}

std::string refusal(const KnownPair& known, double phi0 = 0.03) {
  try {
    operating_points(known, phi0, Equations::first_order);
  } catch (const ArgumentError& e) {
    return std::string(e.what()).substr(0, std::string(e.what()).find(" ="));
  }
  return {};
}

TEST(OperatingPointsTest, RefusesWhatIsNoPairAndNamesIt) {
  EXPECT_EQ(refusal({}), "number of known quantities");
  EXPECT_EQ(refusal({1e-4, {}, {}, {}}), "number of known quantities");
  EXPECT_EQ(refusal({1e-4, 1e-5, 0.05, {}}), "number of known quantities");
  EXPECT_EQ(refusal({0.0, 1e-5, {}, {}}), "epsilon");
  EXPECT_EQ(refusal({1.0, 1e-5, {}, {}}), "epsilon");
  EXPECT_EQ(refusal({1e-4, std::nan(""), {}, {}}), "mu");
  EXPECT_EQ(refusal({1e-4, {}, 2.0, {}}), "amplitude");
  EXPECT_EQ(refusal({1e-4, {}, {}, -1.0}), "rate_excess");
  EXPECT_EQ(refusal({1e-4, {}, {}, std::numeric_limits<double>::infinity()}), "rate_excess");
  EXPECT_EQ(refusal({1e-4, 1e-5, {}, {}}, 0.0), "phi0");
  EXPECT_THROW(stall_torque(0.0, 0.03), ArgumentError);
  EXPECT_THROW(exact_stall_torque(1e-4, 4.0), ArgumentError);
  EXPECT_THROW(nominal_rate_torque(-1e-4, 0.03, Equations::exact), ArgumentError);
}

// ---- optimal drive -----------------------------------------------------------------------------

// -(1/lambda) oint m sin psi with the strength from oint m cos psi = eps lambda, by quadrature; the
// mirrored falling passage contributes the same as the rising one.
double error_by_quadrature(double epsilon, double lambda, double centre, double width) {
  using boost::math::quadrature::gauss_kronrod;
  const double psi1 = std::asin((centre - 0.5 * width) / lambda);
  const double psi2 = std::asin((centre + 0.5 * width) / lambda);
  const auto moment = [&](auto f) {
    return 2 * gauss_kronrod<double, 31>::integrate(f, psi1, psi2, 10, 1e-14) / (2 * pi);
  };
  const double strength = epsilon * lambda / moment([](double psi) { return std::cos(psi); });
  return -strength * moment([](double psi) { return std::sin(psi); }) / lambda;
}

TEST(EscapementErrorTest, MatchesTheIntegrals) {
  for (const double centre : {-0.03, -0.01, 0.001, 0.02, 0.045})
    for (const double width : {1e-4, 0.01, 0.03}) {
      if (std::abs(centre) + 0.5 * width > 0.05) continue;
      // The quadrature loses digits: its strip of sin psi cancels where it is narrow or centred.
      EXPECT_NEAR(escapement_error(2.5e-4, 0.05, centre, width),
                  error_by_quadrature(2.5e-4, 0.05, centre, width), 1e-16);
    }
}

TEST(EscapementErrorTest, TendsToTheSingleImpulse) {
  const double epsilon = 2.5e-4, lambda = 0.05, centre = 0.02;
  const double psi = std::asin(centre / lambda);
  const double impulse = -epsilon * std::tan(psi); // eq. blow6
  EXPECT_NEAR(escapement_error(epsilon, lambda, centre, 0.0), impulse, 1e-18);
  // Next order in the width: the part (w/lambda)^2 / (8 cos^4 psi) of it.
  EXPECT_NEAR(escapement_error(epsilon, lambda, centre, 1e-4), impulse, epsilon * 4e-7);
  EXPECT_NE(escapement_error(epsilon, lambda, centre, 1e-2), impulse);
}

TEST(EscapementErrorTest, PlaceMattersNotWidth) {
  const double epsilon = 2.5e-4, lambda = 0.05;
  for (const double width : {0.0, 0.001, 0.05, 0.1}) // centred: none, however wide
    EXPECT_EQ(escapement_error(epsilon, lambda, 0.0, width), 0.0);
  for (const double width : {0.001, 0.01, 0.05}) { // off centre by its half width
    const double dpsi = std::asin(width / lambda);
    EXPECT_NEAR(escapement_error(epsilon, lambda, 0.5 * width, width),
                -epsilon * std::tan(0.5 * dpsi), 1e-18); // roundings
  }
  for (const double width : {0.001, 0.005, 0.01}) // -eps centre/lambda: (c^2/2 + w^2/8)/lambda^2
    EXPECT_NEAR(escapement_error(epsilon, lambda, 0.005, width), -epsilon * 0.1,
                epsilon * 0.1 * 0.02);
  EXPECT_EQ(escapement_error(epsilon, lambda, -0.01, 0.01),
            -escapement_error(epsilon, lambda, 0.01, 0.01)); // early gains as late loses
}

TEST(EscapementErrorTest, ModelEscapementIsASumOfTwo) {
  // On a rising passage the model's torque is +mu from -lambda to phi0 and -mu from there to
  // lambda. Errors of torques that act together add with the weights of their work.
  const double epsilon = 2.5e-4, mu = 2e-5, phi0 = 0.03;
  const double lambda = *stationary_amplitude(clock_of(epsilon, mu, phi0));
  const double helps = lambda + phi0, opposes = lambda - phi0;
  const double sum = (helps * escapement_error(epsilon, lambda, 0.5 * (phi0 - lambda), helps) -
                      opposes * escapement_error(epsilon, lambda, 0.5 * (phi0 + lambda), opposes)) /
                     (helps - opposes);
  const double model =
      *stationary_rate_first_order(clock_of(epsilon, mu, phi0)) + lambda * lambda / 16;
  EXPECT_NEAR(sum, model, 1e-7 * model); // an end at lambda has a cosine good to 1e-8
}

TEST(EscapementErrorTest, RefusesATorqueBeyondTheSwing) {
  EXPECT_THROW(escapement_error(1.0, 0.05, 0.0, 0.01), ArgumentError);
  EXPECT_THROW(escapement_error(1e-4, 0.0, 0.0, 0.0), ArgumentError);
  EXPECT_THROW(escapement_error(1e-4, 0.05, 0.0, -0.01), ArgumentError);
  EXPECT_THROW(escapement_error(1e-4, 0.05, 0.046, 0.01), ArgumentError);
  EXPECT_THROW(escapement_error(1e-4, 0.05, 0.05, 0.0), ArgumentError); // tan of a right angle
  EXPECT_THROW(escapement_error(1e-4, 0.05, std::nan(""), 0.01), ArgumentError);
  EXPECT_NO_THROW(escapement_error(1e-4, 0.05, 0.045, 0.01));
}

} // namespace
} // namespace goingrate
