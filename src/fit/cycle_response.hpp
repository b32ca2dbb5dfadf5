// The response of one cycle to a disturbance: by the averaged equations, and the correction from
// the full equation. Private to the fit room.
//
// With w the departure of lambda^2 from its course at an upward crossing, u the relative departure
// of the drive and t the lateness, to first order
//   w' = kept w + raised u,    t' = t + follow w + kick u.
// From dx' = f_x x + D u and late' = -(g_x x + push u) (course.hpp), with a = 2 pi f_x and
// M = (exp a - 1)/a,
//   kept = exp a,  raised = 2 pi D M,  follow = -T0 g_x M,
//   kick = -T0 [push + 2 pi g_x D (M - 1)/a].
// A log obeys the return map at the crossings, whose derivatives differ from these by parts of
// order epsilon and mu/lambda. Since such differences look like an error of phi0 or T0, they have
// to be known, at every amplitude to which the drive's noise takes the clock.
#pragma once

#include "course.hpp"

#include "base/scaled_time.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace goingrate::timing_model {

template <class T> struct CycleGains {
  T gone{};            ///< kept - 1
  T raised{};          ///< rad^2
  T follow{};          ///< s per rad^2
  T kick{};            ///< s
  T follow_by_drive{}; ///< change of follow with the drive, s per rad^2 and relative drive
};

/// The gains by the averaged equations; amplitude2 is lambda^2.
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
template <class T> struct CycleBend {
  T ww{}, wu{}, uu{};
  /// The mean of the second-order terms, for departures with these mean squares and products.
  [[nodiscard]] T of(const T& w2, const T& product, const T& u2) const {
    return w2 * ww + product * wu + u2 * uu;
  }
  /// The covariance of the second-order terms with `other`'s, for normal departures: ½ tr(H P H' P)
  /// with their matrices of second derivatives.
  [[nodiscard]] T covariance(const CycleBend& other, const T& w2, const T& product,
                             const T& u2) const {
    const auto rows = [&](const CycleBend& bend) {
      return std::array<T, 4>{
          bend.ww * w2 * 2.0 + bend.wu * product, bend.ww * product * 2.0 + bend.wu * u2,
          bend.wu * w2 + bend.uu * product * 2.0, bend.wu * product + bend.uu * u2 * 2.0};
    };
    const auto a = rows(*this), b = rows(other);
    return (a[0] * b[0] + a[1] * b[2] + a[2] * b[1] + a[3] * b[3]) * 0.5;
  }
};

/// The full equation compared with the averaged one, where a clock crosses at one speed.
template <class T> struct CycleResponse {
  /// Factors for the gains; for follow and follow_by_drive, which may be 0, terms to add.
  CycleGains<T> beside{T(1.0), T(1.0), T(0.0), T(1.0), T(0.0)};
  CycleBend<T> amplitude2; ///< rad^2
  CycleBend<T> late;       ///< s
};

/// The response of a clock that crosses with phi'^2 = `speed2` when its averaged amplitude squared
/// is `amplitude2`, by differences of its return map; nullopt if the map is not regular or the
/// averaged swing does not pass the escapement. Gains to 3e-5
/// (CycleResponseTest.GainsAreTheDerivativesOfTheReturnMap). Cost: nine periods.
std::optional<CycleResponse<double>> cycle_response(const ClockParameters& clock, double speed2,
                                                    const AveragedLaws<double>& laws,
                                                    double amplitude2);

/// The responses of one clock at all speeds it may cross with, and how they change with its laws.
class CycleResponses {
public:
  /// Covers phi'^2 between these two; beyond them the response of the nearer end is used. `offset`
  /// is the averaged amplitude squared minus phi'^2.
  CycleResponses(const ClockParameters& clock, const AveragedLaws<double>& laws,
                 double least_speed2, double greatest_speed2, double offset);

  [[nodiscard]] double offset() const { return offset_; }

  /// The response at a crossing with this speed, of a clock with laws near those of the responses.
  template <class T>
  [[nodiscard]] CycleResponse<T> at(const T& speed2, const AveragedLaws<T>& laws) const {
    const std::size_t below = before(plain(speed2));
    const Node &a = all_[below], &b = all_[below + 1];
    T share = (speed2 - a.speed2) * (1.0 / (b.speed2 - a.speed2));
    if (plain(share) < 0.0 || plain(share) > 1.0) share = T(plain(share) < 0.0 ? 0.0 : 1.0);
    const Changes<T> changes = changed(laws);
    std::array<T, numbers> values;
    for (std::size_t j = 0; j < numbers; ++j) {
      values[j] = share * (b.here[j] - a.here[j]) + a.here[j];
      for (std::size_t l = 0; l < by_.size(); ++l)
        values[j] += changes[l] * std::lerp(a.by[l][j], b.by[l][j], plain(share));
    }
    return from_numbers(values);
  }

  /// The integrals of the factor for `gone` and of the term added to `follow`, over departures of
  /// phi'^2 from `speed2` to `speed2` + w.
  template <class T>
  [[nodiscard]] std::pair<T, T> beside_on_the_way(const T& speed2, const T& w,
                                                  const AveragedLaws<T>& laws) const {
    return {integral(T(speed2 + w), gone, laws) - integral(speed2, gone, laws),
            integral(T(speed2 + w), follow, laws) - integral(speed2, follow, laws)};
  }

private:
  // A response as a row of numbers, and the places of two of them.
  static constexpr std::size_t numbers = 11, gone = 0, follow = 2;
  using Numbers = std::array<double, numbers>;
  static constexpr std::size_t most_laws = 5;
  template <class T> using Changes = std::array<T, most_laws>;
  using Law = double AveragedLaws<double>::*;

  struct Node {
    double speed2;
    Numbers here;
    std::vector<Numbers> by; // d here/d law
    Numbers sums{};          // integrals of `here` from the first node
    std::vector<Numbers> sums_by{};
  };

  template <class T> static CycleResponse<T> from_numbers(const std::array<T, numbers>& n) {
    return {{n[0], n[1], n[2], n[3], n[4]}, {n[5], n[6], n[7]}, {n[8], n[9], n[10]}};
  }
  static Numbers as_numbers(const CycleResponse<double>& response);
  static std::optional<Node> node_at(const ClockParameters& clock, const AveragedLaws<double>& laws,
                                     std::span<const Law> by, double speed2, double amplitude2);

  // By how much each of the laws `by_` differs from its value in the responses.
  template <class T> [[nodiscard]] Changes<T> changed(const AveragedLaws<T>& laws) const {
    Changes<T> changes;
    for (std::size_t l = 0; l < by_.size(); ++l)
      changes[l] = law_of(laws, by_[l]) - laws_.*by_[l];
    return changes;
  }
  template <class T> static const T& law_of(const AveragedLaws<T>& laws, Law law) {
    if (law == &AveragedLaws<double>::epsilon) return laws.epsilon;
    if (law == &AveragedLaws<double>::mu) return laws.mu;
    if (law == &AveragedLaws<double>::phi0) return laws.phi0;
    return law == &AveragedLaws<double>::quadratic ? laws.quadratic : laws.dry;
  }

  // Integral of the straight line between two nodes; beyond them, of the nearer one's value.
  template <class T>
  [[nodiscard]] T integral(const T& speed2, std::size_t what, const AveragedLaws<T>& laws) const {
    const std::size_t below = before(plain(speed2));
    const Node &a = all_[below], &b = all_[below + 1];
    const double width = b.speed2 - a.speed2;
    const auto along = [&](const auto& passed, double at_a, double at_b, double sum_a,
                           double sum_b) {
      using P = std::decay_t<decltype(passed)>;
      if (plain(passed) > width) return P((passed - width) * at_b + sum_b);
      if (plain(passed) < 0.0) return P(passed * at_a + sum_a);
      return P(passed * (passed * (0.5 * (at_b - at_a) / width) + at_a) + sum_a);
    };
    T sum = along(T(speed2 - a.speed2), a.here[what], b.here[what], a.sums[what], b.sums[what]);
    const Changes<T> changes = changed(laws);
    for (std::size_t l = 0; l < by_.size(); ++l)
      sum += changes[l] * along(plain(speed2) - a.speed2, a.by[l][what], b.by[l][what],
                                a.sums_by[l][what], b.sums_by[l][what]);
    return sum;
  }
  // The node below a speed, but not the last node; a search that goes astray may ask for NaN.
  [[nodiscard]] std::size_t before(double speed2) const {
    const auto above =
        std::upper_bound(all_.begin() + 1, all_.end() - 1, speed2,
                         [](double speed, const Node& node) { return speed < node.speed2; });
    return static_cast<std::size_t>(above - all_.begin()) - 1;
  }

  AveragedLaws<double> laws_;
  double offset_ = 0.0;
  std::vector<Law> by_;   // those of the laws that are not zero
  std::vector<Node> all_; // at least two, in order of speed
};

/// The response of the clock at one beat of its course: without `clock`, of the averaged one.
struct ResponseAt {
  const CycleResponses* clock = nullptr;
  double speed2 = 0.0; ///< of the undisturbed crossing
  double shift = 0.0;  ///< of the averaged amplitude squared to where the responses have it

  /// Gains and second derivatives where the squared amplitude is w above the course's.
  template <class T> struct There {
    CycleGains<T> gains;
    CycleBend<T> amplitude2, late;
  };
  template <class T>
  [[nodiscard]] There<T> there(const AveragedLaws<T>& laws, const T& amplitude2, const T& T0,
                               const T& w) const {
    There<T> there{averaged_cycle(laws, T(amplitude2 + w + shift), T0), {}, {}};
    if (clock == nullptr) return there;
    const CycleResponse<T> full = clock->at(T(speed2_of(amplitude2) + w), laws);
    there.gains.gone *= full.beside.gone;
    there.gains.raised *= full.beside.raised;
    there.gains.follow += full.beside.follow;
    there.gains.kick *= full.beside.kick;
    there.gains.follow_by_drive += full.beside.follow_by_drive;
    there.amplitude2 = full.amplitude2;
    there.late = full.late;
    return there;
  }
  /// By how much w has grown after a cycle, and by how much it makes the clock late: the averaged
  /// laws between the two amplitudes, in closed form, and the integral of what they lack.
  template <class T>
  [[nodiscard]] std::pair<T, T> passed(const AveragedLaws<T>& laws, const T& amplitude2,
                                       const T& T0, const T& w) const {
    using std::expm1;
    const T on_course = amplitude2 + shift, there = on_course + w;
    const T a = laws.mean_growth_slope(on_course, there) * two_pi;
    const T gone = expm1(a);
    const T averaged = gone / a * T0 * (laws.rate(on_course) - laws.rate(there));
    if (clock == nullptr) return {gone * w, averaged};
    const auto [factor, follow] = clock->beside_on_the_way(speed2_of(amplitude2), w, laws);
    return {gone * factor, averaged + follow};
  }
  /// phi'^2 of the undisturbed crossing, for the averaged amplitude squared.
  template <class T> [[nodiscard]] T speed2_of(const T& amplitude2) const {
    return amplitude2 + (clock == nullptr ? 0.0 : shift - clock->offset());
  }
};

} // namespace goingrate::timing_model
