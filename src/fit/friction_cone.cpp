#include "friction_cone.hpp"

#include "base/special_values.hpp"
#include "goingrate/base/random.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace goingrate::timing_model {

namespace {

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

// The bounded coordinates alone, with the others at their likeliest values.
FrictionCone FrictionCone::of_bounded() const {
  std::vector<Eigen::Index> own, other;
  for (Eigen::Index k = 0; k < centre_.size(); ++k)
    (bounded_[static_cast<std::size_t>(k)] ? own : other).push_back(k);
  Eigen::MatrixXd information = information_(own, own);
  if (!other.empty())
    information -= information_(own, other) *
                   information_(other, other).ldlt().solve(information_(other, own));
  return {centre_(own), information, std::vector<bool>(own.size(), true)};
}

double FrictionCone::reach_about(const Eigen::VectorXd& f, const Eigen::VectorXd& h,
                                 double z) const {
  constexpr int draws = 300; // the 95 % quantile of the root is then good to 5 %
  const Eigen::LLT<Eigen::MatrixXd> root(information_);
  RandomStream chance(1, StreamPurpose::jitter);
  std::vector<double> falls;
  for (int k = 0; k < draws; ++k) {
    Eigen::VectorXd noise(f.size());
    for (double& n : noise)
      n = chance.normal();
    const FrictionCone drawn(f + root.matrixU().solve(noise), information_, bounded_);
    falls.push_back(drawn.lowest(&h, h.dot(f)).fall - drawn.least_);
  }
  const double share = std::erf(z * std::sqrt(0.5));
  const auto at = falls.begin() + static_cast<std::ptrdiff_t>(share * draws);
  std::nth_element(falls.begin(), at, falls.end());
  return std::sqrt(*at);
}

double FrictionCone::reach(const Eigen::VectorXd& h, double z) const {
  const FrictionCone bounded = of_bounded();
  Eigen::VectorXd own(bounded.centre_.size());
  for (Eigen::Index k = 0, next = 0; k < centre_.size(); ++k)
    if (bounded_[static_cast<std::size_t>(k)]) own[next++] = h[k];
  if (!(own.norm() > 0.0)) return z; // a sum of others alone
  double reach = std::max(z, bounded.reach_about(bounded.likeliest_, own, z));
  constexpr double farthest_sigma = 3.0; // from the log's estimate
  for (Eigen::Index k = 0; k < own.size(); ++k) {
    if (!(own[k] > 0.0)) continue;
    const Eigen::VectorXd alone =
        Eigen::VectorXd::Unit(own.size(), k) * (own.dot(bounded.likeliest_) / own[k]);
    const Eigen::VectorXd off = alone - bounded.centre_;
    if (off.dot(bounded.information_ * off) - bounded.least_ < farthest_sigma * farthest_sigma)
      reach = std::max(reach, bounded.reach_about(alone, own, z));
  }
  return reach;
}

std::array<double, 2> FrictionCone::interval(const Eigen::VectorXd& h, double z) const {
  const double best = h.dot(likeliest_), wanted = least_ + std::pow(reach(h, z), 2);
  const double unit = std::sqrt(h.dot(information_.ldlt().solve(h))); // sigma without bounds
  if (!std::isfinite(unit) || !(unit > 0.0)) return {-infinite, infinite};
  const auto excess = [&](double v) { return lowest(&h, v).fall - wanted; };
  // The fall is convex in v, so an end lies between the best v and one at which the fall is too
  // large.
  const auto end_towards = [&](double side) {
    constexpr double farthest = 1e3;
    double outside = z;
    while (outside < farthest * z && !(excess(best + side * outside * unit) > 0.0))
      outside *= 2.0;
    if (!(outside < farthest * z)) return side * infinite;
    double inside = 0.0;
    constexpr double resolution = 1e-3; // of a sigma
    while (outside - inside > resolution) {
      const double middle = 0.5 * (inside + outside);
      (excess(best + side * middle * unit) > 0.0 ? outside : inside) = middle;
    }
    return best + side * 0.5 * (inside + outside) * unit;
  };
  return {end_towards(-1.0), end_towards(1.0)};
}

} // namespace goingrate::timing_model
