#include "cycle_response.hpp"

#include "goingrate/dynamics/direct.hpp"

namespace goingrate::timing_model {

namespace {

struct Next {
  double amplitude2 = 0.0; // more than before
  double late = 0.0;       // of the crossing, in scaled time
};

// A drive or a follow that is absent has no factor.
double over(double exact, double averaged) { return averaged == 0.0 ? 1.0 : exact / averaged; }

} // namespace

CycleResponse cycle_response(const ClockParameters& clock, double speed2,
                             const AveragedLaws<double>& laws, double amplitude2) {
  // Small enough for a third derivative to show in the sixth digit; far above rounding.
  const double room = std::max(0.0, amplitude2 - laws.phi0 * laws.phi0);
  const double dw = std::min(3e-3 * speed2, 0.1 * room), du = 1e-2;
  std::array<std::array<Next, 3>, 3> next; // of w = -dw, 0, dw and u = -du, 0, du
  for (const int i : {0, 1, 2})
    for (const int k : {0, 1, 2}) {
      const long double start = speed2 + (i - 1) * static_cast<long double>(dw);
      const auto period = regular_period(clock, start, 1.0L + (k - 1) * du);
      if (!period.regular) return {};
      next[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] = {
          static_cast<double>(period.speed2_change + (i - 1) * static_cast<long double>(dw)),
          static_cast<double>(period.excess)};
    }
  const auto derivatives = [&](double Next::*what) {
    const auto at = [&](std::size_t i, std::size_t k) { return next[i][k].*what; };
    struct {
      double w, u;
      CycleResponse::Bend bend;
    } result;
    result.w = (at(2, 1) - at(0, 1)) / (2.0 * dw);
    result.u = (at(1, 2) - at(1, 0)) / (2.0 * du);
    result.bend = {(at(2, 1) - 2.0 * at(1, 1) + at(0, 1)) / (2.0 * dw * dw),
                   (at(2, 2) - at(2, 0) - at(0, 2) + at(0, 0)) / (4.0 * dw * du),
                   (at(1, 2) - 2.0 * at(1, 1) + at(1, 0)) / (2.0 * du * du)};
    return result;
  };
  const auto amplitude = derivatives(&Next::amplitude2), late = derivatives(&Next::late);
  const double second = clock.nominal_period_s / two_pi; // of scaled time
  const auto averaged = averaged_cycle(laws, amplitude2, clock.nominal_period_s);
  CycleResponse response;
  response.factor = {over(amplitude.w - 1.0, averaged.gone), over(amplitude.u, averaged.raised),
                     over(late.w * second, averaged.follow), over(late.u * second, averaged.kick),
                     over(late.bend.wu * second, averaged.follow_by_drive)};
  const auto above = averaged_cycle(laws, amplitude2 + dw, clock.nominal_period_s);
  const auto below = averaged_cycle(laws, amplitude2 - dw, clock.nominal_period_s);
  // So that factor times gain has the derivative of the full equation.
  const auto slope = [&](double exact, double CycleGains<double>::*gain) {
    const double of_gain = (above.*gain - below.*gain) / (2.0 * dw);
    return averaged.*gain == 0.0 ? 0.0
                                 : (exact - response.factor.*gain * of_gain) / (averaged.*gain);
  };
  using Gains = CycleGains<double>;
  response.slope = {slope(2.0 * amplitude.bend.ww, &Gains::gone),
                    slope(amplitude.bend.wu, &Gains::raised),
                    slope(2.0 * late.bend.ww * second, &Gains::follow),
                    slope(late.bend.wu * second, &Gains::kick), 0.0};
  // The turning angle is 2 asin(v/2).
  response.angle = std::sqrt(amplitude2 / (speed2 * (1.0 - 0.25 * speed2)));
  response.amplitude2 = amplitude.bend;
  response.late = {late.bend.ww * second, late.bend.wu * second, late.bend.uu * second};
  return response;
}

} // namespace goingrate::timing_model
