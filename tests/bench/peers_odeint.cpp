// GCC at -O3 vectorises odeint's loops over phi and phi', which slows Fehlberg's method down by a
// third, and does not inline its stages, which costs a tenth (hence the "flatten" below). A fair
// comparison needs these settings.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-vectorize")
#endif

#include "peers.hpp"

#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include <functional>

namespace goingrate::bench {

namespace odeint = boost::numeric::odeint;

namespace {

constexpr double first_step = 0.1;
constexpr int most_trials = 100; // of one step; each at least halves it, about

using Fehlberg78 = odeint::runge_kutta_fehlberg78<Motion>;

// A controlled stepper copies the scratch space of the one it is given, so that had better be
// initialised; being static, this one is.
const Fehlberg78 zeroed;

class Fehlberg {
public:
  explicit Fehlberg(Tolerance tolerance)
      : controlled_(Controlled::error_checker_type(tolerance.absolute, tolerance.relative),
                    Controlled::step_adjuster_type(longest_step), zeroed) {}

  [[gnu::flatten]] double step(const SwingLaw& law, const Motion& from, const Motion& slope,
                               Motion& to) {
    double t = 0.0;
    for (int i = 0; i < most_trials && t == 0.0; ++i)
      controlled_.try_step(std::cref(law), from, slope, t, to, next_step_);
    return t;
  }

  [[gnu::flatten]] void step_by(double h, const SwingLaw& law, const Motion& from,
                                const Motion& slope, Motion& to) {
    exact_.do_step(std::cref(law), from, slope, 0.0, to, h);
  }

private:
  using Controlled = odeint::controlled_runge_kutta<Fehlberg78>;
  Controlled controlled_;
  Fehlberg78 exact_;
  double next_step_ = first_step;
};

class BulirschStoer {
public:
  explicit BulirschStoer(Tolerance tolerance)
      : adaptive_(tolerance.absolute, tolerance.relative, 1.0, 1.0, longest_step),
        exact_(tolerance.absolute, tolerance.relative) {}

  [[gnu::flatten]] double step(const SwingLaw& law, const Motion& from, const Motion& slope,
                               Motion& to) {
    double t = 0.0;
    for (int i = 0; i < most_trials && t == 0.0; ++i)
      adaptive_.try_step(std::cref(law), from, slope, t, to, next_step_);
    return t;
  }

  // It has controlled steps only, so one may be refused and two be needed. A second stepper, as a
  // foreign step length makes it forget the order it has found to be best.
  [[gnu::flatten]] void step_by(double h, const SwingLaw& law, const Motion& from,
                                const Motion& slope, Motion& to) {
    double t = 0.0;
    double length = h;
    if (exact_.try_step(std::cref(law), from, slope, t, to, length) == odeint::success) return;
    Motion at = from;
    for (int i = 0; i < most_trials && t < h; ++i) {
      length = std::min(length, h - t);
      exact_.try_step(std::cref(law), at, t, length);
    }
    to = at;
  }

private:
  odeint::bulirsch_stoer<Motion> adaptive_;
  odeint::bulirsch_stoer<Motion> exact_;
  double next_step_ = first_step;
};

template <class Stepper> ChartMethod method(const char* name, const char* setting, double tol) {
  return {name, setting, [tol](const ChartScene& scene) {
            return run_scene(scene, [tol](const ClockParameters& clock, double velocity) {
              return SteppedPendulum<Stepper>(clock, velocity, tol);
            });
          }};
}

} // namespace

std::vector<ChartMethod> odeint_peers() {
  return {method<Fehlberg>("odeint-f78", "tol=1e-12", 1e-12),
          method<Fehlberg>("odeint-f78", "tol=1e-15", 1e-15),
          method<BulirschStoer>("odeint-bs", "tol=1e-14", 1e-14)};
}

} // namespace goingrate::bench
