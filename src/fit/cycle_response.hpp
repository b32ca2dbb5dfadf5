// What one cycle makes of a disturbance: by the averaged equations, and what the full equation adds
// to that. Private to the fit room.
//
// With w the departure of lambda^2 from its course at an upward crossing, u the relative departure
// of the drive and t the lateness, to first order
//   w' = kept w + raised u,    t' = t + follow w + kick u.
// From dx' = f_x x + D u and late' = -(g_x x + push u) (course.hpp), with a = 2 pi f_x and
// M = (exp a - 1)/a,
//   kept = exp a,  raised = 2 pi D M,  follow = -T0 g_x M,
//   kick = -T0 [push + 2 pi g_x D (M - 1)/a].
// A log obeys the return map at the crossings, whose derivatives differ from these by parts of
// epsilon and of mu/lambda. Where they pass for an error of phi0 or T0, they have to be known, and
// at every amplitude that the drive's noise leads the clock to.
#pragma once

#include "course.hpp"

#include "base/scaled_time.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace goingrate::timing_model {

template <class T> struct CycleGains {
  T gone{};            ///< kept - 1
  T raised{};          ///< rad^2
  T follow{};          ///< s per rad^2
  T kick{};            ///< s
  T follow_by_drive{}; ///< of follow, s per rad^2 and relative drive
};

/// By the averaged equations; amplitude2 is lambda^2.
template <class T>
CycleGains<T> averaged_cycle(const AveragedLaws<T>& laws, const T& amplitude2, const T& T0) {
  using std::expm1;
  const T a = laws.growth_slope(amplitude2) * two_pi;
  const T gone = expm1(a), mean = gone / a;
  const T drive = laws.drive() * two_pi;
  const T driven = laws.push_slope(amplitude2) * T0 * -1.0;
  const T slope = driven + T0 * laws.circular;
  return {gone, drive * mean, slope * mean,
          slope * drive * (mean - 1.0) / a - laws.push(amplitude2) * T0, driven * mean};
}

/// Half the second derivatives by w and by u, and the one by both.
struct CycleBend {
  double ww = 0.0, wu = 0.0, uu = 0.0;
  /// What is of second order, for departures of these mean squares and products.
  template <class T> [[nodiscard]] T of(const T& w2, const T& product, const T& u2) const {
    return w2 * ww + product * wu + u2 * uu;
  }
};

inline CycleBend between(const CycleBend& a, const CycleBend& b, double share) {
  return {std::lerp(a.ww, b.ww, share), std::lerp(a.wu, b.wu, share), std::lerp(a.uu, b.uu, share)};
}

struct CycleBends {
  CycleBend amplitude2; ///< rad^2
  CycleBend late;       ///< s
};

/// The full equation beside the averaged one, where a clock crosses at one speed.
struct CycleResponse {
  /// Factors of the gains; of follow and follow_by_drive, which may be 0, what is to be added.
  CycleGains<double> beside{1.0, 1.0, 0.0, 1.0, 0.0};
  CycleBends bends;
};

/// By differences of the return map of a clock that crosses with phi'^2 = `speed2` when its
/// averaged amplitude squared is `amplitude2`; nothing where the map is not regular or the averaged
/// swing does not pass the escapement. Gains to 3e-5
/// (CycleResponseTest.GainsAreTheDerivativesOfTheReturnMap). Cost: nine periods.
std::optional<CycleResponse> cycle_response(const ClockParameters& clock, double speed2,
                                            const AveragedLaws<double>& laws, double amplitude2);

/// Those of one clock at all the speeds it may cross with.
class CycleResponses {
public:
  /// For phi'^2 between these; beyond, those at the nearer end. `offset` is by how much the
  /// averaged amplitude squared is greater than phi'^2.
  CycleResponses(const ClockParameters& clock, const AveragedLaws<double>& laws,
                 double least_speed2, double greatest_speed2, double offset);

  [[nodiscard]] double offset() const { return offset_; }
  /// What is of second order at a crossing with this speed.
  [[nodiscard]] CycleBends bends(double speed2) const {
    const std::size_t below = before(speed2);
    const Node &a = all_[below], &b = all_[below + 1];
    const double share = std::clamp((speed2 - a.speed2) / (b.speed2 - a.speed2), 0.0, 1.0);
    return {between(a.response.bends.amplitude2, b.response.bends.amplitude2, share),
            between(a.response.bends.late, b.response.bends.late, share)};
  }
  /// Makes averaged gains those at a crossing with this speed.
  template <class T> void correct(const T& speed2, CycleGains<T>& gains) const {
    const std::size_t below = before(plain(speed2));
    const double from = all_[below].speed2, to = all_[below + 1].speed2;
    T share = (speed2 - from) * (1.0 / (to - from));
    if (plain(share) < 0.0 || plain(share) > 1.0) share = T(plain(share) < 0.0 ? 0.0 : 1.0);
    const CycleGains<double>&a = all_[below].response.beside, &b = all_[below + 1].response.beside;
    const auto between = [&](double at_from, double at_to) {
      return share * (at_to - at_from) + at_from;
    };
    gains.gone *= between(a.gone, b.gone);
    gains.raised *= between(a.raised, b.raised);
    gains.follow += between(a.follow, b.follow);
    gains.kick *= between(a.kick, b.kick);
    gains.follow_by_drive += between(a.follow_by_drive, b.follow_by_drive);
  }

  /// The integrals of the factor of gone and of what is added to follow, over departures of phi'^2
  /// from `speed2` to `speed2` + w.
  template <class T>
  [[nodiscard]] std::pair<T, T> beside_on_the_way(double speed2, const T& w) const {
    const T end = w + speed2;
    return {integral(end, &Node::gone, &CycleGains<double>::gone) -
                integral(speed2, &Node::gone, &CycleGains<double>::gone),
            integral(end, &Node::follow, &CycleGains<double>::follow) -
                integral(speed2, &Node::follow, &CycleGains<double>::follow)};
  }

private:
  struct Node {
    double speed2;
    CycleResponse response;
    double gone = 0.0, follow = 0.0; // integrals of `beside` from the first node
  };
  // Of a line between neighbours, and of the nearer end's value beyond.
  template <class T>
  [[nodiscard]] T integral(const T& speed2, double Node::*sum,
                           double CycleGains<double>::*what) const {
    const std::size_t below = before(plain(speed2));
    const Node &a = all_[below], &b = all_[below + 1];
    const double at_a = a.response.beside.*what, at_b = b.response.beside.*what;
    if (plain(speed2) > b.speed2) return (speed2 - b.speed2) * at_b + b.*sum;
    const T passed = speed2 - a.speed2;
    if (plain(passed) < 0.0) return passed * at_a + a.*sum;
    return passed * (passed * (0.5 * (at_b - at_a) / (b.speed2 - a.speed2)) + at_a) + a.*sum;
  }
  // The node below a speed, which is no number where a search has gone astray; not the last one.
  [[nodiscard]] std::size_t before(double speed2) const {
    const auto above =
        std::upper_bound(all_.begin() + 1, all_.end() - 1, speed2,
                         [](double speed, const Node& node) { return speed < node.speed2; });
    return static_cast<std::size_t>(above - all_.begin()) - 1;
  }

  double offset_ = 0.0;
  std::vector<Node> all_; ///< at least two, in order of speed
};

/// The response of the clock at one beat of its course: without `clock`, of the averaged one.
struct ResponseAt {
  const CycleResponses* clock = nullptr;
  double speed2 = 0.0; ///< of the undisturbed crossing
  double shift = 0.0;  ///< of the averaged amplitude squared to where the responses have it

  /// Where the squared amplitude is w above the course's.
  template <class T>
  [[nodiscard]] CycleGains<T> gains(const AveragedLaws<T>& laws, const T& amplitude2, const T& T0,
                                    const T& w) const {
    CycleGains<T> gains = averaged_cycle(laws, T(amplitude2 + w + shift), T0);
    if (clock != nullptr) clock->correct(T(w + speed2), gains);
    return gains;
  }
  /// By how much w has grown after a cycle, and by how much it makes the clock late: the averaged
  /// laws between the two amplitudes, in closed form, and the integral of what stands beside them.
  template <class T>
  [[nodiscard]] std::pair<T, T> passed(const AveragedLaws<T>& laws, const T& amplitude2,
                                       const T& T0, const T& w) const {
    using std::expm1;
    const T on_course = amplitude2 + shift, there = on_course + w;
    const T a = laws.mean_growth_slope(on_course, there) * two_pi;
    const T gone = expm1(a);
    const T averaged = gone / a * T0 * (laws.rate(on_course) - laws.rate(there));
    if (clock == nullptr) return {gone * w, averaged};
    const auto [factor, follow] = clock->beside_on_the_way(speed2, w);
    return {gone * factor, averaged + follow};
  }
  /// phi'^2 of the undisturbed crossing, for the averaged amplitude squared.
  template <class T> [[nodiscard]] T speed2_of(const T& amplitude2) const {
    return amplitude2 + (clock == nullptr ? 0.0 : shift - clock->offset());
  }
  [[nodiscard]] CycleBends bends(double w) const {
    return clock == nullptr ? CycleBends{} : clock->bends(speed2 + w);
  }
};

} // namespace goingrate::timing_model
