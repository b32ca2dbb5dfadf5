// A friction law of one's own: a bob in air at a Reynolds number between the two textbook laws has
// a drag that grows as the 3/2 power of its speed. What does that do to amplitude and rate,
// compared with linear friction of the same loss?
#include <goingrate/goingrate.hpp>

#include <cmath>
#include <cstdio>

using namespace goingrate;

struct Swing {
  double amplitude_rad, rate_excess;
};

// Where the pendulum settles, from its upward crossings.
Swing settled(const CustomLaws& laws) {
  CustomPendulum pendulum(laws, 0.05);
  PeriodStep period;
  for (int i = 0; i < 3000; ++i)
    period = pendulum.advance();
  const double two_pi = 2.0 * std::acos(-1.0);
  // phi' = 2 sin(lambda/2) at the vertical; `excess` is the period less 2 pi.
  return {2.0 * std::asin(0.5 * pendulum.velocity()), -period.excess / (two_pi + period.excess)};
}

int main() {
  constexpr double mu = 4e-4, phi0 = 0.03, epsilon = 2.5e-3, usual_speed = 0.05;
  CustomLaws laws;
  laws.torque = [](double phi, double speed) { // pushes along, within phi0 of the vertical
    return std::abs(phi) > phi0 ? 0.0 : speed > 0.0 ? mu : -mu;
  };
  laws.jumps = {-phi0, phi0};
  laws.jumps_with_direction = true;

  laws.friction = [](double, double speed) { return 2.0 * epsilon * speed; };
  const Swing linear = settled(laws);
  laws.friction = [](double, double speed) {
    return 2.0 * epsilon * speed * std::sqrt(std::abs(speed) / usual_speed);
  };
  const Swing between = settled(laws);

  std::printf("linear friction:   amplitude %.5f rad, rate %+.4e\n", linear.amplitude_rad,
              linear.rate_excess);
  std::printf("3/2 power of speed: amplitude %.5f rad, rate %+.4e\n", between.amplitude_rad,
              between.rate_excess);
}
