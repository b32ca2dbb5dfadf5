#include "goingrate/dynamics/averaged2.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace goingrate {
namespace {

using Wide = boost::multiprecision::cpp_bin_float_quad;
using WidePeriod = SecondOrderPeriod<Wide>;

const Wide wide_pi = second_order::exact_pi<Wide>();

// The slow obvious oracle: Taylor series of fixed order and step, stopped at angles by Newton.
class Pendulum {
public:
  Pendulum(const Wide& eps, const Wide& speed) : eps_(eps), w_(speed) {}

  Wide time = 0, torque = 0;
  [[nodiscard]] const Wide& speed() const { return w_; }
  void kick(const Wide& e) { w_ = sqrt(w_ * w_ + 2 * e); }

  // Goes on until phi passes `target` in the given direction.
  void run_to(const Wide& target, int direction) {
    const Wide step = Wide(1) / 8; // 8^-30 = 1e-27: what is left of the series at its end
    expand();
    while (
        !(direction * sum(speeds_, step) > 0 && direction * (sum(angles_, step) - target) >= 0)) {
      advance(step);
      expand();
    }
    Wide t = step / 2;
    for (int i = 0; i < 12; ++i) // far more than a quadratic iteration needs for 34 digits
      t -= (sum(angles_, t) - target) / sum(speeds_, t);
    advance(t);
    phi_ = target;
  }

private:
  static constexpr std::size_t order = 30;
  using Series = std::array<Wide, order + 1>;

  void expand() {
    angles_[0] = phi_;
    speeds_[0] = w_;
    Series s, c;
    s[0] = sin(phi_);
    c[0] = cos(phi_);
    for (std::size_t k = 0; k < order; ++k) {
      s[k + 1] = c[k + 1] = 0;
      for (std::size_t j = 0; j <= k; ++j) {
        s[k + 1] += c[j] * speeds_[k - j] / (k + 1);
        c[k + 1] -= s[j] * speeds_[k - j] / (k + 1);
      }
      angles_[k + 1] = speeds_[k] / (k + 1);
      speeds_[k + 1] = (-2 * eps_ * speeds_[k] - s[k] + (k == 0 ? torque : Wide(0))) / (k + 1);
    }
  }
  static Wide sum(const Series& series, const Wide& t) {
    Wide value = 0;
    for (std::size_t k = order + 1; k-- > 0;)
      value = value * t + series[k];
    return value;
  }
  void advance(const Wide& t) {
    phi_ = sum(angles_, t);
    w_ = sum(speeds_, t);
    time += t;
  }

  Wide eps_, phi_ = 0, w_;
  Series angles_, speeds_;
};

WidePeriod exact_period(const Wide& eps, const Wide& mu, const Wide& phi0, const Wide& Lambda2) {
  Pendulum pendulum(eps, sqrt(Lambda2));
  pendulum.torque = mu;
  pendulum.run_to(phi0, 1);
  pendulum.torque = -mu;
  pendulum.run_to(0, -1);
  pendulum.run_to(-phi0, -1);
  pendulum.torque = mu;
  pendulum.run_to(0, 1);
  return {pendulum.speed() * pendulum.speed() - Lambda2, pendulum.time - 2 * wide_pi};
}

WidePeriod exact_impulse_period(const Wide& eps, const Wide& e, const Wide& phi1,
                                const Wide& Lambda2) {
  Pendulum pendulum(eps, sqrt(Lambda2));
  if (phi1 > 0) pendulum.run_to(phi1, 1);
  if (phi1 >= 0) pendulum.kick(e);
  pendulum.run_to(0, -1);
  if (phi1 < 0) {
    pendulum.run_to(phi1, 1);
    pendulum.kick(e);
  }
  pendulum.run_to(0, 1);
  return {pendulum.speed() * pendulum.speed() - Lambda2, pendulum.time - 2 * wide_pi};
}

// The rate excess at the fixed point of a map Lambda^2 -> period, of friction eps.
template <class Map> double settled_rate(Map map, double eps, Wide Lambda2) {
  // Newton with the slope of first order: every round gains three digits.
  for (int i = 0; i < 12; ++i)
    Lambda2 += map(Lambda2).amplitude2_change / (4 * wide_pi * eps);
  const Wide excess = map(Lambda2).period_excess;
  return static_cast<double>(-excess / (2 * wide_pi + excess));
}

// The errors of a period's time and relative change of Lambda^2, as powers of the scale s of all
// small terms: from s = 2^-6 to 2^-12, where what is beyond the leading power has died out.
// `errors` takes sqrt(s), a power of two, so that the scaled parameters are exact.
template <class Errors> void expect_slope(Errors errors, double slope) {
  WidePeriod last = errors(Wide(0.125));
  for (const double root : {0.0625, 0.03125, 0.015625}) {
    const WidePeriod next = errors(Wide(root));
    const auto slope_of = [](const Wide& coarse, const Wide& fine) {
      return std::log(std::abs(static_cast<double>(coarse / fine))) / std::log(4.0);
    };
    // A wrong term of the order before would show as a slope lower by one.
    EXPECT_NEAR(slope_of(last.period_excess, next.period_excess), slope, 0.1);
    EXPECT_NEAR(slope_of(last.amplitude2_change, next.amplitude2_change), slope, 0.1);
    last = next;
  }
}

WidePeriod difference(const WidePeriod& a, const WidePeriod& b, const Wide& Lambda2) {
  return {(a.amplitude2_change - b.amplitude2_change) / Lambda2, a.period_excess - b.period_excess};
}

// Driven near balance, driven hard, held back, left alone: for eps = 2e-3 and lambda = 0.08.
constexpr std::array torques{4e-4, 1.2e-3, -4e-4, 0.0};

template <class Map> void expect_slope_of_constant_torque(Map map, double slope) {
  for (const double mu : torques) {
    SCOPED_TRACE(mu);
    expect_slope(
        [&](const Wide& root) {
          const Wide s = root * root, eps = 2e-3 * s, torque = mu * s * root, phi0 = 0.03 * root,
                     Lambda2 = 0.0064 * s;
          return difference(map(eps, torque, phi0, Lambda2),
                            exact_period(eps, torque, phi0, Lambda2), Lambda2);
        },
        slope);
  }
}

TEST(Averaged2Test, ErrorFallsAsTheCube) {
  expect_slope_of_constant_torque([](const auto&... x) { return second_order_period<Wide>(x...); },
                                  3.0);
}

TEST(Averaged2Test, ThirdOrderErrorFallsAsTheFourthPower) {
  expect_slope_of_constant_torque([](const auto&... x) { return third_order_period<Wide>(x...); },
                                  4.0);
}

TEST(Averaged2Test, ImpulseErrorFallsAsTheCube) {
  for (const double phi1 : {-0.05, -0.01, 0.0, 0.01, 0.05}) {
    for (const double e : {8e-5, -8e-5}) {
      SCOPED_TRACE(testing::Message() << phi1 << ' ' << e);
      expect_slope(
          [&](const Wide& root) {
            const Wide s = root * root, eps = 2e-3 * s, kick = e * s * s, at = phi1 * root,
                       Lambda2 = 0.0064 * s;
            return difference(second_order_impulse_period<Wide>(eps, kick, at, Lambda2),
                              exact_impulse_period(eps, kick, at, Lambda2), Lambda2);
          },
          3.0);
    }
  }
}

TEST(Averaged2Test, RatesAtThePapersPoints) {
  struct Point {
    const char* name;
    double eps, mu, exact, second, third;
  };
  // Exact rates from 128-bit integration. Limits: what the fit of a log asks of second order; third
  // order is held to twice what it leaves.
  for (const auto& [name, eps, mu, exact, second, third] :
       {Point{"A", 2.5e-4, 2e-5, 1.133264436573979e-04, 5e-12, 2e-14},
        Point{"B", 2.5e-4, 4e-5, 1.960046634308295e-04, 1e-10, 2e-13},
        Point{"C", 1.167245e-4, 1.5e-5, 1.844068077230375e-08, 5e-12, 2e-14}}) {
    SCOPED_TRACE(name);
    const Wide start = 2 * mu * 0.03 / (wide_pi * eps);
    const auto rate = [&, eps = eps, mu = mu](auto map) {
      return settled_rate([&](const Wide& Lambda2) { return map(eps, mu, 0.03, Lambda2); }, eps,
                          start);
    };
    EXPECT_NEAR(rate(second_order_period<Wide>), exact, second);
    EXPECT_NEAR(rate(third_order_period<Wide>), exact, third);
    // The oracle itself, to the last digit of the table.
    EXPECT_NEAR(rate(exact_period), exact, 1e-19);
  }
}

TEST(Averaged2Test, ImpulseRateMatchesTheFullEquation) {
  // Friction and amplitude of A; first order (eq. blow6) is off by 3e-8 to 5e-8 here.
  const double eps = 2.5e-4, lambda = 0.0390882;
  const Wide start = lambda * lambda, e = 2 * wide_pi * eps * start;
  for (const double place : {-0.6, -0.2, 0.0, 0.2, 0.6}) {
    SCOPED_TRACE(place);
    const Wide phi1 = place * lambda;
    const double exact = settled_rate(
        [&](const Wide& Lambda2) { return exact_impulse_period(eps, e, phi1, Lambda2); }, eps,
        start);
    const double ours = settled_rate(
        [&](const Wide& Lambda2) {
          return second_order_impulse_period<Wide>(eps, e, phi1, Lambda2);
        },
        eps, start);
    // Third order: some (2 pi eps)^2 of the escapement error eps tan psi1, and of lambda^2/16.
    EXPECT_NEAR(ours, exact, 7e-11 + 1e-9 * std::abs(place));
  }
}

TEST(Averaged2Test, TwoHalvesMakeAPeriod) {
  for (const double mu : {4e-4, 1.2e-3, -4e-4}) { // at mu = 0 both are exact in what differs
    SCOPED_TRACE(mu);
    const auto errors = [&](const Wide& root) {
      const Wide s = root * root, eps = 2e-3 * s, torque = mu * s * root, phi0 = 0.03 * root,
                 Lambda2 = 0.0064 * s;
      const auto up = second_order_half_period<Wide>(eps, torque, phi0, Lambda2);
      const auto down =
          second_order_half_period<Wide>(eps, torque, phi0, Lambda2 + up.amplitude2_change);
      const auto whole = exact_period(eps, torque, phi0, Lambda2);
      return difference(
          {up.amplitude2_change + down.amplitude2_change, up.period_excess + down.period_excess},
          whole, Lambda2);
    };
    expect_slope(errors, 3.0);
  }
}

TEST(Averaged2Test, ErrorGrowsTowardsTheSwitchAngle) {
  struct Row {
    double mu, place, limit;
  };
  // The figures of the header, rounded up: T of one period, Lambda = place * phi0.
  for (const auto& [mu, place, limit] :
       {Row{2e-5, 2.0, 7e-10}, Row{2e-5, 1.3, 7e-10}, Row{2e-5, 1.1, 7e-10}, Row{2e-5, 1.03, 8e-10},
        Row{1e-4, 1.5, 2e-9}, Row{1e-4, 1.1, 8e-9}, Row{1e-4, 1.03, 3e-8}}) {
    SCOPED_TRACE(testing::Message() << mu << ' ' << place);
    const Wide Lambda2 = Wide(0.03 * place) * (0.03 * place);
    const auto error = second_order_period<Wide>(2.5e-4, mu, 0.03, Lambda2).period_excess -
                       exact_period(2.5e-4, mu, 0.03, Lambda2).period_excess;
    EXPECT_LT(abs(error), limit);
  }
  EXPECT_TRUE(std::isnan(second_order_period(2.5e-4, 2e-5, 0.03, 0.0008).period_excess));
}

TEST(Averaged2Test, FreePendulumIsThatOfTheEllipticIntegral) {
  for (const double Lambda2 : {1e-4, 1e-2, 4e-2}) {
    const double exact =
        4.0 * std::comp_ellint_1(std::sqrt(Lambda2) / 2.0) - 2.0 * std::numbers::pi;
    const auto torque = second_order_period(0.0, 0.0, 0.005, Lambda2);
    const auto impulse = second_order_impulse_period(0.0, 0.0, -0.005, Lambda2);
    // The first term left out, 2 pi q^5/17000, and the rounding of K.
    const double limit = 4e-4 * std::pow(Lambda2, 5) + 4e-15;
    EXPECT_NEAR(torque.period_excess, exact, limit);
    EXPECT_NEAR(impulse.period_excess, exact, limit);
    EXPECT_EQ(torque.amplitude2_change, 0.0); // energy is kept
    EXPECT_EQ(impulse.amplitude2_change, 0.0);
  }
}

TEST(Averaged2Test, DoubleKeepsAllDigitsOfTheExcess) {
  const double eps = 2.5e-4, mu = 2e-5, phi0 = 0.03, Lambda2 = 0.0016;
  const auto near = second_order_period(eps, mu, phi0, Lambda2);
  const auto wide = second_order_period<Wide>(eps, mu, phi0, Lambda2);
  // Some roundings of the terms of first order, 1e-3 here; 2 pi itself would cost 4e-16.
  EXPECT_NEAR(static_cast<double>(near.period_excess - wide.period_excess), 0.0, 2e-18);
  EXPECT_NEAR(static_cast<double>(near.amplitude2_change - wide.amplitude2_change), 0.0, 4e-21);
}

TEST(Averaged2Test, AutomaticDerivativesAreThoseOfTheMap) {
  using Jet = ceres::Jet<double, 4>;
  const auto check = [](const std::array<double, 4>& x, auto map) {
    const SecondOrderPeriod<Jet> jet = map(Jet(x[0], 0), Jet(x[1], 1), Jet(x[2], 2), Jet(x[3], 3));
    for (std::size_t i = 0; i < 4; ++i) {
      std::array<Wide, 4> up{x[0], x[1], x[2], x[3]}, down = up;
      const Wide h = 1e-10 * up[i];
      up[i] += h;
      down[i] -= h;
      const WidePeriod a = map(up[0], up[1], up[2], up[3]),
                       b = map(down[0], down[1], down[2], down[3]);
      const auto slope = [&](const Wide& high, const Wide& low) {
        return static_cast<double>((high - low) / (2 * h));
      };
      const auto k = static_cast<Eigen::Index>(i);
      const double time = slope(a.period_excess, b.period_excess);
      const double change = slope(a.amplitude2_change, b.amplitude2_change);
      // The rounding of the derivative in double; h^2 is far below.
      EXPECT_NEAR(jet.period_excess.v[k], time, 1e-12 * std::abs(time) + 1e-14);
      EXPECT_NEAR(jet.amplitude2_change.v[k], change, 1e-12 * std::abs(change) + 1e-14);
    }
  };
  const std::array<double, 4> torque{2.5e-4, 2e-5, 0.03, 0.0016};
  check(torque, [](const auto&... x) { return second_order_period(x...); });
  check(torque, [](const auto&... x) { return third_order_period(x...); });
  for (const double phi1 : {-0.02, 0.02})
    check({2.5e-4, 2.5e-6, phi1, 0.0016},
          [](const auto&... x) { return second_order_impulse_period(x...); });
}

} // namespace
} // namespace goingrate
