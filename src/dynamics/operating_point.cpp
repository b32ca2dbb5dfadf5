#include "goingrate/dynamics/operating_point.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/half_swing.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>

namespace goingrate {

using std::numbers::pi;

namespace {

void check_between(const char* name, double value, double low, double high, const char* legal) {
  if (!(value > low && value < high)) throw ArgumentError(name, value, legal);
}
void check_epsilon(double epsilon) {
  check_between("epsilon", epsilon, 0.0, 1.0, "greater than 0 and less than 1");
}
void check_phi0(double phi0) {
  check_between("phi0", phi0, 0.0, pi, "greater than 0 and less than pi");
}

// A root of f between x1 and x2, where f changes sign.
template <class F> double zero_between(F f, double x1, double x2, double f1, double f2) {
  if (f1 == 0.0) return x1;
  if (f2 == 0.0) return x2;
  std::uintmax_t rounds = 200; // some 10 are used
  const auto bracket = boost::math::tools::toms748_solve(
      f, x1, x2, f1, f2, boost::math::tools::eps_tolerance<double>(53), rounds);
  return std::abs(f(bracket.first)) < std::abs(f(bracket.second)) ? bracket.first : bracket.second;
}

// Stationary operation for given friction and torque.
std::optional<OperatingPoint> operate(double epsilon, double mu, double phi0, Equations equations) {
  if (!(epsilon > 0.0 && epsilon < 1.0 && mu > 0.0 && mu < 1.0)) return {};
  ClockParameters clock;
  clock.epsilon = epsilon;
  clock.mu = mu;
  clock.phi0 = phi0;
  if (equations == Equations::exact) {
    const auto cycle = limit_cycle(clock);
    if (!cycle) return {};
    return OperatingPoint{epsilon, mu, cycle->velocity, cycle->rate_excess};
  }
  const auto lambda = stationary_amplitude(clock);
  if (!lambda || !(*lambda < 2.0)) return {};
  return OperatingPoint{epsilon, mu, *lambda, *stationary_rate_first_order(clock)};
}

// Properties of the free pendulum whose phi' at the vertical is v = 2k.
double free_rate_excess(double k) { return 0.5 * pi / std::comp_ellint_1(k) - 1.0; }
// The lambda^2 to put into eq. statam to get the torque that balances the friction of this swing.
double free_amplitude2(double k) {
  return 16.0 / pi * (std::comp_ellint_2(k) - (1.0 - k) * (1.0 + k) * std::comp_ellint_1(k));
}

// Ratio of the stall line for small epsilon to that of first order; y^2 is counted from it.
double stall_ratio(double phi0, Equations equations) {
  if (equations == Equations::first_order) return 1.0;
  return free_amplitude2(std::sin(0.5 * phi0)) / (phi0 * phi0);
}

// ---- one of friction and torque known, and one of amplitude and rate ------------------------

// The operating points along the curve on which friction or torque is constant, by x = log y.
class Curve {
public:
  Curve(const KnownPair& known, double phi0, Equations equations)
      : known_(known), phi0_(phi0), equations_(equations), base_(stall_ratio(phi0, equations)) {}

  [[nodiscard]] std::optional<OperatingPoint> at(double x) const {
    const double spread = base_ + std::exp(2.0 * x); // torque over stall_torque
    if (known_.epsilon)
      return operate(*known_.epsilon, stall_torque(*known_.epsilon, phi0_) * spread, phi0_,
                     equations_);
    return operate(2.0 * *known_.mu / (pi * phi0_ * spread), *known_.mu, phi0_, equations_);
  }

  // The other known quantity at this point minus its given value; NaN where the clock stalls.
  [[nodiscard]] double miss(double x) const {
    const auto point = at(x);
    if (!point) return std::numeric_limits<double>::quiet_NaN();
    return known_.amplitude ? point->amplitude - *known_.amplitude
                            : point->rate_excess - *known_.rate_excess;
  }

  // Whether the quantity is monotonic along the curve, as the amplitude is.
  [[nodiscard]] bool rises() const { return known_.amplitude.has_value(); }

private:
  const KnownPair& known_;
  double phi0_;
  Equations equations_;
  double base_;
};

struct Node {
  double x, miss;
  [[nodiscard]] bool swings() const { return !std::isnan(miss); }
};

Node node_at(const Curve& curve, double x) { return {x, curve.miss(x)}; }

// The edge of the region where the clock swings, between a node inside it and one outside.
Node edge_between(const Curve& curve, Node swings, Node stands) {
  for (int i = 0; i < 50; ++i) { // halves the interval below rounding
    const Node middle = node_at(curve, 0.5 * (swings.x + stands.x));
    (middle.swings() ? swings : stands) = middle;
  }
  return swings;
}

// Nodes along the part of the curve where the clock swings. The amplitude rises along it, the rate
// rises and then falls, so a few nodes bracket all solutions.
std::vector<Node> nodes_of(const Curve& curve, double phi0) {
  constexpr int count = 24;
  const double first = std::log(1e-5);
  const double last = std::log(2.0 / phi0); // amplitude 2 of first order
  std::vector<Node> nodes;
  std::optional<Node> below, above; // the nearest nodes at which the clock stalls
  for (int i = 0; i <= count; ++i) {
    const Node node = node_at(curve, first + (last - first) * i / count);
    if (node.swings())
      nodes.push_back(node);
    else if (nodes.empty())
      below = node;
    else if (!above)
      above = node;
  }
  if (nodes.empty()) return nodes;
  // An edge is expensive to find, and needed only if a solution may lie between it and the last
  // node.
  const auto highest = std::max_element(
      nodes.begin(), nodes.end(), [](const Node& a, const Node& b) { return a.miss < b.miss; });
  const bool all_low = highest->miss < 0.0;
  const bool want_above =
      curve.rises() ? all_low : nodes.back().miss > 0.0 || highest->x == nodes.back().x;
  const bool want_below = curve.rises() ? nodes.front().miss > 0.0
                                        : nodes.front().miss > 0.0 || highest->x == nodes.front().x;
  if (below && want_below) nodes.insert(nodes.begin(), edge_between(curve, nodes.front(), *below));
  if (above && want_above) nodes.push_back(edge_between(curve, nodes.back(), *above));
  return nodes;
}

// If the rate is too low at all nodes, two solutions may lie between nodes, on either side of its
// maximum.
void add_maximum(const Curve& curve, std::vector<Node>& nodes) {
  const auto highest = std::max_element(
      nodes.begin(), nodes.end(), [](const Node& a, const Node& b) { return a.miss < b.miss; });
  if (highest == nodes.end() || highest->miss >= 0.0) return;
  const auto low = highest == nodes.begin() ? highest : highest - 1;
  const auto high = highest + 1 == nodes.end() ? highest : highest + 1;
  const auto depth = [&](double x) { return -curve.miss(x); };
  std::uintmax_t rounds = 60; // half the digits take 30
  const double x = boost::math::tools::brent_find_minima(depth, low->x, high->x, 26, rounds).first;
  const Node top = node_at(curve, x);
  if (top.miss > highest->miss) nodes.insert(x < highest->x ? highest : highest + 1, top);
}

std::vector<OperatingPoint> points_on(const Curve& curve, double phi0) {
  std::vector<OperatingPoint> points;
  std::vector<Node> nodes = nodes_of(curve, phi0);
  if (!curve.rises()) add_maximum(curve, nodes);
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    const Node& a = nodes[i];
    const Node& b = nodes[i + 1];
    if ((a.miss < 0.0) == (b.miss < 0.0)) continue;
    const double x =
        zero_between([&](double z) { return curve.miss(z); }, a.x, b.x, a.miss, b.miss);
    // If a limit cycle was not found on the way, the search cannot be trusted, and no answer is
    // better than a wrong one.
    const double allowed = 1e-6 * (std::abs(a.miss) + std::abs(b.miss)) + 1e-13;
    if (!(std::abs(curve.miss(x)) <= allowed)) continue;
    if (const auto point = curve.at(x)) points.push_back(*point);
  }
  return points;
}

// ---- amplitude and rate known ----------------------------------------------------------------

// Newton's method for one amplitude and one rate, in p = log epsilon and x = log y.
class TwoTargets {
public:
  TwoTargets(double amplitude, double rate, double phi0, Equations equations)
      : amplitude_(amplitude), rate_(rate), phi0_(phi0), equations_(equations),
        base_(stall_ratio(phi0, equations)) {}

  // Starts from first order with the circular error and the friction of the free swing, which is
  // right to the second order in epsilon, or above that if it is too close to stall. Steps are
  // shortened if the clock would stall, and end when they are only rounding.
  [[nodiscard]] std::optional<OperatingPoint> solve() const {
    const bool exact = equations_ == Equations::exact;
    const double k = 0.5 * amplitude_;
    const double push = rate_ - (exact ? free_rate_excess(k) : -0.25 * k * k);
    const double reach2 = (exact ? free_amplitude2(k) : 4.0 * k * k) / (phi0_ * phi0_);
    if (!(push > 0.0 && reach2 > 0.9 * base_))
      return {}; // far below phi0 no friction gives a limit cycle
    const double y2 = std::max(reach2 - base_, 1e-4);
    double p = std::log(std::min(push / std::sqrt(y2), 0.9)), x = 0.5 * std::log(y2);
    auto now = at(p, x);
    for (int n = 0; !now && n < 20; ++n)
      now = at(p, x += 0.25);
    double last = std::numeric_limits<double>::infinity();
    for (int i = 0; now && i < 100; ++i) { // 5 suffice away from the borders
      const auto [dp, dx] = step(*now, p, x);
      const double longest = std::max(std::abs(dp), std::abs(dx));
      if (!std::isfinite(longest)) return {};
      if (longest < 1e-15 || (last < 1e-3 && longest > 0.3 * last)) return now;
      last = longest;
      double share = std::min(1.0, 0.5 / longest);
      std::optional<OperatingPoint> next;
      for (int n = 0; !next && n < 30; ++n, share *= 0.5)
        next = at(p + share * dp, x + share * dx);
      now = next;
      p += 2.0 * share * dp;
      x += 2.0 * share * dx;
    }
    return {};
  }

private:
  [[nodiscard]] std::optional<OperatingPoint> at(double p, double x) const {
    const double epsilon = std::exp(p);
    if (!(epsilon < 1.0)) return {};
    return operate(epsilon, stall_torque(epsilon, phi0_) * (base_ + std::exp(2.0 * x)), phi0_,
                   equations_);
  }

  // Derivatives by finite differences; their error makes convergence linear, by a factor 1e-4 a
  // step.
  [[nodiscard]] std::pair<double, double> step(const OperatingPoint& now, double p,
                                               double x) const {
    constexpr double h = 1e-4;
    const auto e = at(p - h, x);
    const auto y = at(p, x + h);
    if (!e || !y) return {NAN, NAN};
    const double ae = (now.amplitude - e->amplitude) / h, ay = (y->amplitude - now.amplitude) / h;
    const double re = (now.rate_excess - e->rate_excess) / h;
    const double ry = (y->rate_excess - now.rate_excess) / h;
    const double da = amplitude_ - now.amplitude, dr = rate_ - now.rate_excess;
    const double determinant = ae * ry - ay * re;
    return {(da * ry - ay * dr) / determinant, (ae * dr - da * re) / determinant};
  }

  double amplitude_, rate_, phi0_;
  Equations equations_;
  double base_;
};

void check(const KnownPair& known, double phi0) {
  check_phi0(phi0);
  const int count = known.epsilon.has_value() + known.mu.has_value() + known.amplitude.has_value() +
                    known.rate_excess.has_value();
  if (count != 2) throw ArgumentError("number of known quantities", count, "2");
  if (known.epsilon) check_epsilon(*known.epsilon);
  if (known.mu) check_between("mu", *known.mu, 0.0, 1.0, "greater than 0 and less than 1");
  if (known.amplitude)
    check_between("amplitude", *known.amplitude, 0.0, 2.0, "greater than 0 and less than 2");
  if (known.rate_excess)
    check_between("rate_excess", *known.rate_excess, -1.0, std::numeric_limits<double>::infinity(),
                  "greater than -1");
}

} // namespace

std::vector<OperatingPoint> operating_points(const KnownPair& known, double phi0,
                                             Equations equations) {
  check(known, phi0);
  std::optional<OperatingPoint> point;
  if (known.epsilon && known.mu)
    point = operate(*known.epsilon, *known.mu, phi0, equations);
  else if (known.amplitude && known.rate_excess)
    point = TwoTargets(*known.amplitude, *known.rate_excess, phi0, equations).solve();
  else
    return points_on(Curve(known, phi0, equations), phi0);
  if (!point) return {};
  return {*point};
}

double stall_torque(double epsilon, double phi0) {
  check_epsilon(epsilon);
  check_phi0(phi0);
  return 0.5 * pi * epsilon * phi0;
}

std::optional<double> exact_stall_torque(double epsilon, double phi0) {
  const double first_order = stall_torque(epsilon, phi0);
  // The gain of v^2 over a half swing that just reaches phi0; nothing if none does below v = 2.
  const auto gain = [&](double mu) {
    double misses = 0.0, reaches = 2.0;
    HalfSwing<double> swing;
    bool any = false;
    for (int i = 0; i < 60; ++i) { // to the last bit of v
      const double v = 0.5 * (misses + reaches);
      const auto trial = half_swing(v, epsilon, mu, phi0, true);
      const bool reached = trial.switched || trial.status == SwingStatus::overturned;
      (reached ? reaches : misses) = v;
      if (reached) swing = trial, any = true;
    }
    const bool back = any && swing.switched && swing.status == SwingStatus::crossed;
    return back ? swing.speed2_change : std::numeric_limits<double>::quiet_NaN();
  };
  const double low = 0.3 * first_order, high = 1.5 * first_order; // 8/(3 pi) at phi0 = pi
  const double loses = gain(low), gains = gain(high);
  if (!(loses < 0.0 && gains > 0.0)) return {};
  return zero_between(gain, low, high, loses, gains);
}

std::optional<double> nominal_rate_torque(double epsilon, double phi0, Equations equations) {
  const double stall = stall_torque(epsilon, phi0);
  if (equations == Equations::first_order) {
    const double p = 8.0 * epsilon / (phi0 * phi0);
    if (!(p >= 1.0)) return {};
    const double y = p + std::sqrt(p * p - 1.0);
    const double spread = 1.0 + y * y;
    if (!(stall * spread < 1.0 && phi0 * std::sqrt(spread) < 2.0)) return {};
    return stall * spread;
  }
  const auto points = operating_points({epsilon, {}, {}, 0.0}, phi0, equations);
  if (points.empty()) return {};
  // With a single solution it is not yet known whether it is the larger of the two.
  const auto beyond = operate(epsilon, points.back().mu * (1.0 + 1e-5), phi0, equations);
  if (points.size() == 1 && !(beyond && beyond->rate_excess < 0.0)) return {};
  return points.back().mu;
}

double escapement_error(double epsilon, double lambda, double centre, double width) {
  if (!(epsilon >= 0.0 && epsilon < 1.0))
    throw ArgumentError("epsilon", epsilon, "at least 0 and less than 1");
  if (!(lambda > 0.0 && std::isfinite(lambda)))
    throw ArgumentError("lambda", lambda, "greater than 0");
  if (!(width >= 0.0)) throw ArgumentError("width", width, "at least 0");
  if (!(std::abs(centre) + 0.5 * width <= lambda))
    throw ArgumentError("centre", centre, "such that the torque acts within the amplitude");
  const auto cosine = [&](double phi) { // without cancellation near the turning points
    return std::sqrt(std::max((1.0 - phi / lambda) * (1.0 + phi / lambda), 0.0));
  };
  if (centre == 0.0) return 0.0;
  const double sum = cosine(centre - 0.5 * width) + cosine(centre + 0.5 * width);
  if (!(sum > 0.0)) throw ArgumentError("width", width, "greater than 0 at the turning point");
  return -2.0 * epsilon * (centre / lambda) / sum;
}

} // namespace goingrate
