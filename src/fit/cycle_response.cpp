#include "cycle_response.hpp"

#include "goingrate/dynamics/direct.hpp"

namespace goingrate::timing_model {

namespace {

struct Next {
  double amplitude2 = 0.0; // increase
  double late = 0.0;       // of the crossing, in scaled time
};

// A drive that is absent has no factor.
double over(double exact, double averaged) { return averaged == 0.0 ? 1.0 : exact / averaged; }

} // namespace

std::optional<CycleResponse<double>> cycle_response(const ClockParameters& clock, double speed2,
                                                    const AveragedLaws<double>& laws,
                                                    double amplitude2) {
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
      CycleBend<double> bend;
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
  CycleResponse<double> response;
  response.beside = {over(amplitude.w - 1.0, averaged.gone), over(amplitude.u, averaged.raised),
                     late.w * second - averaged.follow, over(late.u * second, averaged.kick),
                     late.bend.wu * second - averaged.follow_by_drive};
  response.amplitude2 = amplitude.bend;
  response.late = {late.bend.ww * second, late.bend.wu * second, late.bend.uu * second};
  return response;
}

namespace {

// The clock with another value of one of its laws.
ClockParameters with_law(ClockParameters clock, double AveragedLaws<double>::*law, double value) {
  const bool impulse = clock.escapement == Escapement::single_impulse;
  using Laws = AveragedLaws<double>;
  if (law == &Laws::epsilon) clock.epsilon = value;
  if (law == &Laws::mu) (impulse ? clock.impulse : clock.mu) = value;
  if (law == &Laws::phi0) (impulse ? clock.impulse_angle : clock.phi0) = value;
  if (law == &Laws::quadratic) clock.quadratic_drag = value;
  if (law == &Laws::dry) clock.dry_friction = value;
  return clock;
}

} // namespace

CycleResponses::Numbers CycleResponses::as_numbers(const CycleResponse<double>& r) {
  return {
      r.beside.gone,   r.beside.raised, r.beside.follow, r.beside.kick, r.beside.follow_by_drive,
      r.amplitude2.ww, r.amplitude2.wu, r.amplitude2.uu, r.late.ww,     r.late.wu,
      r.late.uu};
}

// nullopt if the clock, or one close to it, has no response.
std::optional<CycleResponses::Node> CycleResponses::node_at(const ClockParameters& clock,
                                                            const AveragedLaws<double>& laws,
                                                            std::span<const Law> by, double speed2,
                                                            double amplitude2) {
  const auto here = cycle_response(clock, speed2, laws, amplitude2);
  if (!here) return {};
  Node node{speed2, as_numbers(*here), {}};
  constexpr double step = 1e-3; // of the law: 1e-6 of a second derivative, and far above rounding
  for (const Law law : by) {
    std::array<Numbers, 2> beside;
    for (const std::size_t k : {0U, 1U}) {
      AveragedLaws<double> other = laws;
      other.*law *= k == 0 ? 1.0 - step : 1.0 + step;
      const auto response =
          cycle_response(with_law(clock, law, other.*law), speed2, other, amplitude2);
      if (!response) return {};
      beside[k] = as_numbers(*response);
    }
    Numbers slope;
    for (std::size_t j = 0; j < numbers; ++j)
      slope[j] = (beside[1][j] - beside[0][j]) / (2.0 * step * (laws.*law));
    node.by.push_back(slope);
  }
  return node;
}

CycleResponses::CycleResponses(const ClockParameters& clock, const AveragedLaws<double>& laws,
                               double least_speed2, double greatest_speed2, double offset)
    : laws_(laws), offset_(offset) {
  using Laws = AveragedLaws<double>;
  for (const Law law : {&Laws::epsilon, &Laws::mu, &Laws::phi0, &Laws::quadratic, &Laws::dry})
    if (laws.*law != 0.0) by_.push_back(law);
  // Between neighbouring nodes the factors of the gains are linear to 3e-5, except close to the
  // escapement (CycleResponseTest.GainsAreTheDerivativesOfTheReturnMap).
  constexpr double ratio = 1.05;
  double at = least_speed2;
  for (bool covered = false; !covered; at *= ratio) {
    covered = at > greatest_speed2;
    auto node = node_at(clock, laws, by_, at, at + offset);
    if (node) all_.push_back(std::move(*node)); // near the escapement there are none
  }
  const Node averaged{0.0, as_numbers({}), std::vector<Numbers>(by_.size(), Numbers{})};
  for (; all_.size() < 2; at *= ratio) {
    all_.push_back(all_.empty() ? averaged : all_.back());
    all_.back().speed2 = at;
  }
  const auto added = [](Numbers sums, const Numbers& a, const Numbers& b, double width) {
    for (std::size_t j = 0; j < numbers; ++j)
      sums[j] += 0.5 * width * (a[j] + b[j]);
    return sums;
  };
  all_.front().sums_by.resize(by_.size());
  for (std::size_t i = 1; i < all_.size(); ++i) {
    const Node& last = all_[i - 1];
    Node& node = all_[i];
    const double width = node.speed2 - last.speed2;
    node.sums = added(last.sums, last.here, node.here, width);
    node.sums_by.clear();
    for (std::size_t l = 0; l < by_.size(); ++l)
      node.sums_by.push_back(added(last.sums_by[l], last.by[l], node.by[l], width));
  }
}

} // namespace goingrate::timing_model
