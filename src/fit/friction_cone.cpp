#include "friction_cone.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace goingrate::timing_model {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// The lowest place with the coordinates outside `inside` at 0 and, if `h` is given, h.f = v: the
// lowest without that condition, moved along information^-1 h.
Eigen::VectorXd lowest_inside(const Eigen::VectorXd& centre, const Eigen::MatrixXd& information,
                              const std::vector<Eigen::Index>& inside, const Eigen::VectorXd* h,
                              double v) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(centre.size());
  if (inside.empty()) return f;
  const Eigen::LDLT<Eigen::MatrixXd> own(information(inside, inside));
  const Eigen::VectorXd pull = information * centre;
  Eigen::VectorXd there = own.solve(pull(inside));
  if (h != nullptr) {
    const Eigen::VectorXd along = own.solve((*h)(inside));
    there += along * ((v - (*h)(inside).dot(there)) / (*h)(inside).dot(along));
  }
  f(inside) = there;
  return f;
}

} // namespace

FrictionCone::FrictionCone(Eigen::VectorXd centre, Eigen::MatrixXd information,
                           std::vector<bool> bounded)
    : centre_(std::move(centre)), information_(std::move(information)),
      bounded_(std::move(bounded)) {
  Place best = lowest(nullptr, 0.0);
  likeliest_ = std::move(best.f);
  least_ = best.fall;
}

// Over all choices of which bounded coordinates are above 0: at most eight.
FrictionCone::Place FrictionCone::lowest(const Eigen::VectorXd* h, double v) const {
  std::vector<Eigen::Index> bounded;
  for (Eigen::Index k = 0; k < centre_.size(); ++k)
    if (bounded_[static_cast<std::size_t>(k)]) bounded.push_back(k);
  Place best{Eigen::VectorXd::Zero(centre_.size()), infinite};
  for (unsigned chosen = 0; chosen < 1U << bounded.size(); ++chosen) {
    std::vector<Eigen::Index> inside;
    for (Eigen::Index k = 0; k < centre_.size(); ++k)
      if (!bounded_[static_cast<std::size_t>(k)]) inside.push_back(k);
    for (std::size_t k = 0; k < bounded.size(); ++k)
      if ((chosen >> k & 1U) != 0) inside.push_back(bounded[k]);
    if (h != nullptr && ((*h)(inside).array() == 0.0).all()) continue;
    const Eigen::VectorXd f = lowest_inside(centre_, information_, inside, h, v);
    const bool allowed = f.allFinite() && (bounded.empty() || f(bounded).minCoeff() >= 0.0);
    const double fall = (f - centre_).dot(information_ * (f - centre_));
    if (allowed && fall < best.fall) best = {f, fall};
  }
  return best;
}

Eigen::VectorXd FrictionCone::likeliest_at(const Eigen::VectorXd& h, double v) const {
  return lowest(&h, v).f;
}

std::array<double, 2> FrictionCone::interval(const Eigen::VectorXd& h, double z) const {
  const double best = h.dot(likeliest_), wanted = least_ + z * z;
  const double unit = std::sqrt(h.dot(information_.ldlt().solve(h))); // sigma without bounds
  if (!std::isfinite(unit) || !(unit > 0.0)) return {-infinite, infinite};
  const auto excess = [&](double v) { return lowest(&h, v).fall - wanted; };
  // The fall is convex in v, so an end lies between the best and where it is above.
  const auto end_towards = [&](double side) {
    constexpr double farthest = 1e3;
    double outside = z;
    while (outside < farthest * z && !(excess(best + side * outside * unit) > 0.0))
      outside *= 2.0;
    if (!(outside < farthest * z)) return side * infinite;
    double inside = 0.0;
    constexpr double fine = 1e-3; // of a sigma
    while (outside - inside > fine) {
      const double middle = 0.5 * (inside + outside);
      (excess(best + side * middle * unit) > 0.0 ? outside : inside) = middle;
    }
    return best + side * 0.5 * (inside + outside) * unit;
  };
  const double centre = h.dot(centre_);
  return {std::min(end_towards(-1.0), centre - z * unit),
          std::max(end_towards(1.0), centre + z * unit)};
}

} // namespace goingrate::timing_model
