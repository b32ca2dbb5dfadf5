#include "peers.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <memory>
#include <new>

namespace goingrate::bench {

namespace {

constexpr double first_step = 0.1;
constexpr int most_trials = 100; // of one step

int slope_for_gsl(double, const double x[], double dxdt[], void* law) {
  dxdt[0] = x[1];
  dxdt[1] = static_cast<const SwingLaw*>(law)->acceleration(x[0], x[1]);
  return GSL_SUCCESS;
}

class PrinceDormand {
public:
  explicit PrinceDormand(Tolerance tolerance)
      : step_(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, 2)),
        control_(gsl_odeiv2_control_y_new(tolerance.absolute, tolerance.relative)) {
    if (!step_ || !control_) throw std::bad_alloc();
  }

  // What gsl_odeiv2_evolve_apply does, without the copies it makes and with the slope at hand.
  double step(const SwingLaw& law, const Motion& from, const Motion& slope, Motion& to) {
    Motion error;
    Motion end_slope{}; // read by the controller, which weighs it by 0
    for (int i = 0; i < most_trials; ++i) {
      const double h = std::min(next_step_, longest_step);
      if (!try_step(h, law, from, slope, to, error)) return 0.0;
      next_step_ = h;
      const int verdict = gsl_odeiv2_control_hadjust(control_.get(), step_.get(), to.data(),
                                                     error.data(), end_slope.data(), &next_step_);
      if (verdict != GSL_ODEIV_HADJ_DEC) return h;
    }
    return 0.0;
  }

  void step_by(double h, const SwingLaw& law, const Motion& from, const Motion& slope, Motion& to) {
    Motion error;
    try_step(h, law, from, slope, to, error);
  }

private:
  struct Free {
    void operator()(gsl_odeiv2_step* p) const { gsl_odeiv2_step_free(p); }
    void operator()(gsl_odeiv2_control* p) const { gsl_odeiv2_control_free(p); }
  };

  bool try_step(double h, const SwingLaw& law, const Motion& from, const Motion& slope, Motion& to,
                Motion& error) {
    SwingLaw copy = law; // GSL takes no constant parameters
    const gsl_odeiv2_system system{slope_for_gsl, nullptr, 2, &copy};
    to = from;
    return gsl_odeiv2_step_apply(step_.get(), 0.0, h, to.data(), error.data(), slope.data(),
                                 nullptr, &system) == GSL_SUCCESS;
  }

  std::unique_ptr<gsl_odeiv2_step, Free> step_;
  std::unique_ptr<gsl_odeiv2_control, Free> control_;
  double next_step_ = first_step;
};

ChartMethod method(const char* setting, double tolerance) {
  return {"gsl-rk8pd", setting, [tolerance](const ChartScene& scene) {
            return run_scene(scene, [tolerance](const ClockParameters& clock, double velocity) {
              return SteppedPendulum<PrinceDormand>(clock, velocity, tolerance);
            });
          }};
}

} // namespace

std::vector<ChartMethod> gsl_peers() {
  return {method("tol=1e-12", 1e-12), method("tol=1e-14", 1e-14)};
}

} // namespace goingrate::bench
