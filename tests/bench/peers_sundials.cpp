#include "peers.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <memory>
#include <new>
#include <stdexcept>

namespace goingrate::bench {

namespace {

// What CVODE's callbacks see; it must stay where it is.
struct Problem {
  SwingLaw law;
  double direction = 1.0; // of the torque
  double phi0 = 0.0;
  bool switches = false;
};

int slope_for_cvode(double, N_Vector x, N_Vector dxdt, void* data) {
  const double* from = N_VGetArrayPointer_Serial(x);
  double* to = N_VGetArrayPointer_Serial(dxdt);
  to[0] = from[1];
  to[1] = static_cast<const Problem*>(data)->law.acceleration(from[0], from[1]);
  return 0;
}

// Looked for where they rise: the vertical, the switching angle ahead, the top on either side.
constexpr int root_count = 3;
int roots_for_cvode(double, N_Vector x, double* root, void* data) {
  const auto& problem = *static_cast<const Problem*>(data);
  const double angle = N_VGetArrayPointer_Serial(x)[0];
  root[0] = angle;
  root[1] = problem.switches ? problem.direction * angle - problem.phi0 : -1.0;
  root[2] = std::abs(angle) - std::numbers::pi;
  return 0;
}

template <auto function> struct FreeWith {
  template <class T> void operator()(T* p) const { function(p); }
};
struct FreeContext {
  void operator()(SUNContext p) const { SUNContext_Free(&p); }
};
struct FreeMemory {
  void operator()(void* p) const { CVodeFree(&p); }
};

template <class T> T* not_null(T* p) {
  if (!p) throw std::bad_alloc();
  return p;
}

SUNContext new_context() {
  SUNContext context = nullptr;
  SUNContext_Create(nullptr, &context);
  return not_null(context);
}

class AdamsPendulum {
public:
  AdamsPendulum(const ClockParameters& clock, double velocity, double tolerance);

  void set_clock(const ClockParameters& clock) {
    check_peer_clock(clock);
    clock_ = clock;
    problem_->phi0 = clock.phi0;
    problem_->switches = clock.acting_torque() > 0.0;
    if (!problem_->switches) problem_->direction = 1.0;
  }

  PeriodStep advance(double factor);

private:
  void restart() {
    CVodeReInit(memory_.get(), 0.0, state_.get());
    time_ = 0.0;
  }

  // In the order they are made; freed the other way round.
  std::unique_ptr<_SUNContext, FreeContext> context_;
  std::unique_ptr<_generic_N_Vector, FreeWith<N_VDestroy>> state_;
  std::unique_ptr<_generic_SUNNonlinearSolver, FreeWith<SUNNonlinSolFree>> corrector_;
  std::unique_ptr<void, FreeMemory> memory_;
  std::unique_ptr<Problem> problem_;
  ClockParameters clock_;
  double absolute_tolerance_;
  double time_ = 0.0; // CVODE's own, since the last restart
};

AdamsPendulum::AdamsPendulum(const ClockParameters& clock, double velocity, double tolerance)
    : context_(new_context()), state_(not_null(N_VNew_Serial(2, context_.get()))),
      corrector_(not_null(SUNNonlinSol_FixedPoint(state_.get(), 0, context_.get()))),
      memory_(not_null(CVodeCreate(CV_ADAMS, context_.get()))),
      problem_(std::make_unique<Problem>()), absolute_tolerance_(tolerance * velocity) {
  double* x = N_VGetArrayPointer_Serial(state_.get());
  x[0] = start_of(velocity)[0];
  x[1] = start_of(velocity)[1];
  set_clock(clock);
  void* memory = memory_.get();
  std::array<int, root_count> rising{1, 1, 1};
  const bool ready = CVodeInit(memory, slope_for_cvode, 0.0, state_.get()) == CV_SUCCESS &&
                     CVodeSStolerances(memory, tolerance, absolute_tolerance_) == CV_SUCCESS &&
                     CVodeSetUserData(memory, problem_.get()) == CV_SUCCESS &&
                     CVodeSetNonlinearSolver(memory, corrector_.get()) == CV_SUCCESS &&
                     CVodeRootInit(memory, root_count, roots_for_cvode) == CV_SUCCESS &&
                     CVodeSetRootDirection(memory, rising.data()) == CV_SUCCESS &&
                     CVodeSetMaxNumSteps(memory, 1000000) == CV_SUCCESS &&
                     CVodeSetErrFile(memory, nullptr) == CV_SUCCESS; // the status says it
  if (!ready) throw std::runtime_error("CVODE could not be set up");
}

// Multistep methods start again with tiny steps of first order after each discontinuity. The upward
// crossing is one only if the torque is renewed to another value; else CVODE goes on through it,
// until its own clock has run for so long that the rounding of time would be felt.
PeriodStep AdamsPendulum::advance(double factor) {
  const double mu = factor * clock_.acting_torque();
  const SwingLaw law{clock_.epsilon, problem_->direction * mu};
  if (time_ > longest_period || law.torque != problem_->law.torque ||
      law.epsilon != problem_->law.epsilon) {
    problem_->law = law;
    restart();
  }
  double earlier = -time_; // what is over of the period by the last restart
  for (;;) {
    const double until = time_ + longest_period;
    const int flag = CVode(memory_.get(), until, state_.get(), &time_, CV_NORMAL);
    if (flag != CV_ROOT_RETURN) return {flag < 0 ? SwingStatus::not_finite : SwingStatus::stalled};
    std::array<int, root_count> found{};
    CVodeGetRootInfo(memory_.get(), found.data());
    if (found[0] != 0)
      return period_end(earlier + time_, N_VGetArrayPointer_Serial(state_.get())[1],
                        absolute_tolerance_);
    if (found[2] != 0) return {SwingStatus::overturned};
    earlier += time_;
    problem_->direction = -problem_->direction;
    problem_->law.torque = problem_->direction * mu;
    restart();
  }
}

ChartMethod method(const char* setting, double tolerance) {
  return {"cvode-adams", setting, [tolerance](const ChartScene& scene) {
            return run_scene(scene, [tolerance](const ClockParameters& clock, double velocity) {
              return AdamsPendulum(clock, velocity, tolerance);
            });
          }};
}

} // namespace

std::vector<ChartMethod> sundials_peers() {
  return {method("tol=1e-12", 1e-12), method("tol=1e-14", 1e-14)};
}

} // namespace goingrate::bench
