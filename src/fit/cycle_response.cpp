#include "cycle_response.hpp"

#include "goingrate/dynamics/direct.hpp"

namespace goingrate::timing_model {

namespace {

struct Next {
  double amplitude2 = 0.0; // more than before
  double late = 0.0;       // of the crossing, in scaled time
};

// A drive that is absent has no factor.
double over(double exact, double averaged) { return averaged == 0.0 ? 1.0 : exact / averaged; }

} // namespace

std::optional<CycleResponse> cycle_response(const ClockParameters& clock, double speed2,
                                            const AveragedLaws<double>& laws, double amplitude2) {
  // Small enough for a third derivative to show in the sixth digit; far above rounding.
  const double room = amplitude2 - laws.phi0 * laws.phi0;
  if (!(room > 0.0)) return {};
  const double dw = std::min(3e-3 * speed2, 0.1 * room), du = 1e-2;
  std::array<std::array<Next, 3>, 3> next; // of w = -dw, 0, dw and u = -du, 0, du
  for (const int i : {0, 1, 2})
    for (const int k : {0, 1, 2}) {
      const auto period = regular_period<double>(clock, speed2 + (i - 1) * dw, 1.0 + (k - 1) * du);
      if (!period.regular) return {};
      next[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] = {
          period.speed2_change + (i - 1) * dw, period.excess};
    }
  const auto derivatives = [&](double Next::*what) {
    const auto at = [&](std::size_t i, std::size_t k) { return next[i][k].*what; };
    struct {
      double w, u;
      CycleBend bend;
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
  response.beside = {over(amplitude.w - 1.0, averaged.gone), over(amplitude.u, averaged.raised),
                     late.w * second - averaged.follow, over(late.u * second, averaged.kick),
                     late.bend.wu * second - averaged.follow_by_drive};
  response.bends = {amplitude.bend,
                    {late.bend.ww * second, late.bend.wu * second, late.bend.uu * second}};
  return response;
}

CycleResponses::CycleResponses(const ClockParameters& clock, const AveragedLaws<double>& laws,
                               double least_speed2, double greatest_speed2, double offset)
    : offset_(offset) {
  // Between neighbours what stands beside the gains is straight to 3e-5, except close to the
  // escapement (CycleResponseTest.GainsAreTheDerivativesOfTheReturnMap).
  constexpr double ratio = 1.05;
  double at = least_speed2;
  for (bool covered = false; !covered; at *= ratio) {
    covered = at > greatest_speed2;
    const auto response = cycle_response(clock, at, laws, at + offset);
    if (response) all_.push_back({at, *response}); // near the escapement there are none
  }
  for (; all_.size() < 2; at *= ratio)
    all_.push_back({at, all_.empty() ? CycleResponse{} : all_.back().response});
  for (std::size_t i = 1; i < all_.size(); ++i) {
    const Node& last = all_[i - 1];
    const CycleGains<double>&a = last.response.beside, &b = all_[i].response.beside;
    const double half = 0.5 * (all_[i].speed2 - last.speed2);
    all_[i].gone = last.gone + half * (a.gone + b.gone);
    all_[i].follow = last.follow + half * (a.follow + b.follow);
  }
}

} // namespace goingrate::timing_model
