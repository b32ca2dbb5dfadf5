#include "friction_cone.hpp"

#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace goingrate::timing_model {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

double fall_at(const Eigen::VectorXd& f, const Eigen::VectorXd& centre,
               const Eigen::MatrixXd& information) {
  return (f - centre).dot(information * (f - centre));
}

// The lowest place with the sizes outside `inside` at 0 and, if `h` is given, h.f = v.
Eigen::VectorXd lowest(const Eigen::VectorXd& centre, const Eigen::MatrixXd& information,
                       const std::vector<Eigen::Index>& inside, const Eigen::VectorXd* h,
                       double v) {
  const auto n = static_cast<Eigen::Index>(inside.size());
  const Eigen::Index rows = n + (h != nullptr ? 1 : 0);
  Eigen::MatrixXd left = Eigen::MatrixXd::Zero(rows, rows);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(rows);
  const Eigen::VectorXd pull = information * centre;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < n; ++k)
      left(i, k) = information(inside[static_cast<std::size_t>(i)],
                               inside[static_cast<std::size_t>(k)]);
    right[i] = pull[inside[static_cast<std::size_t>(i)]];
    if (h == nullptr) continue;
    left(i, n) = left(n, i) = (*h)[inside[static_cast<std::size_t>(i)]];
  }
  if (h != nullptr) right[n] = v;
  const Eigen::VectorXd solved = left.fullPivLu().solve(right);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(centre.size());
  for (Eigen::Index i = 0; i < n; ++i)
    f[inside[static_cast<std::size_t>(i)]] = solved[i];
  return f;
}

// Over all choices of which sizes are above 0: at most eight.
std::pair<Eigen::VectorXd, double> lowest_on_cone(const Eigen::VectorXd& centre,
                                                  const Eigen::MatrixXd& information,
                                                  const Eigen::VectorXd* h, double v) {
  std::pair<Eigen::VectorXd, double> best{Eigen::VectorXd::Zero(centre.size()), infinite};
  const auto n = static_cast<unsigned>(centre.size());
  for (unsigned chosen = h != nullptr ? 1 : 0; chosen < 1U << n; ++chosen) {
    std::vector<Eigen::Index> inside;
    for (unsigned k = 0; k < n; ++k)
      if ((chosen >> k & 1U) != 0) inside.push_back(k);
    const Eigen::VectorXd f = lowest(centre, information, inside, h, v);
    if (!f.allFinite() || !(f.minCoeff() >= 0.0)) continue;
    const double fall = fall_at(f, centre, information);
    if (fall < best.second) best = {f, fall};
  }
  return best;
}

} // namespace

FrictionCone::FrictionCone(Eigen::VectorXd centre, Eigen::MatrixXd information)
    : centre_(std::move(centre)), information_(std::move(information)) {
  std::tie(likeliest_, least_) = lowest_on_cone(centre_, information_, nullptr, 0.0);
}

double FrictionCone::fall(const Eigen::VectorXd& h, double v) const {
  return lowest_on_cone(centre_, information_, &h, v).second;
}

std::array<double, 2> FrictionCone::interval(const Eigen::VectorXd& h, double z) const {
  const double best = h.dot(likeliest_), wanted = least_ + z * z;
  const double unit = std::sqrt(h.dot(information_.ldlt().solve(h))); // sigma without bounds
  if (!std::isfinite(unit) || !(unit > 0.0)) return {0.0, infinite};
  const auto excess = [&](double v) { return fall(h, v) - wanted; };
  // The fall is convex in v, so either end lies between the best and where it is above.
  const auto end_between = [&](double inside, double outside) {
    std::uintmax_t steps = 60;
    const auto [low, high] = boost::math::tools::bisect(
        excess, std::min(inside, outside), std::max(inside, outside),
        [&](double a, double b) { return b - a < 1e-4 * unit; }, steps);
    return 0.5 * (low + high);
  };
  std::array<double, 2> ends{0.0, infinite};
  if (excess(0.0) > 0.0 && best > 0.0) ends[0] = end_between(best, 0.0);
  for (double reach = z * unit; reach < 1e3 * z * unit; reach *= 2.0) {
    if (!(excess(best + reach) > 0.0)) continue;
    ends[1] = end_between(best, best + reach);
    break;
  }
  return ends;
}

} // namespace goingrate::timing_model
