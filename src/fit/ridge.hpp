// The ridge of a likelihood along one coordinate. Private to the fit room.
#pragma once

#include "inference.hpp"
#include "valley.hpp"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace goingrate::timing_model {

/// A minimum of L and how well it is known.
struct ProfiledPlace {
  const FitProblem& problem;
  const Minimum& minimum;
  const Certainty& known;
};

/// A point of the ridge, along which L is least for each value of one coordinate.
struct Foot {
  double z = 0.0;          ///< of that coordinate, in sigmas of the curvature from the minimum
  double rise = 0.0;       ///< of L above the minimum
  std::vector<double> x;   ///< the point
  std::vector<double> u;   ///< the same in the coordinates that straighten the valley
  Eigen::VectorXd tangent; ///< du/dz
};

/// Follows the ridge from foot to foot: extrapolated by the cubic through the last two feet and
/// their directions, and brought back by steps of scoring in the other coordinates, each a pass
/// over the log with derivatives. The rise at a foot agrees with that of a search with the
/// coordinate held to a few hundredths of L (RidgeTest).
class Ridge {
public:
  /// Most steps of scoring on one side. A ridge that needs more can take minutes on a long noisy
  /// log, and is given up.
  static constexpr int most_steps_of_a_side = 100;

  /// `widening`: the stated sigma over the curvature's; strides are in stated sigmas. `place` must
  /// outlive the ridge.
  Ridge(const ProfiledPlace& place, std::size_t k, double widening,
        int most_steps = most_steps_of_a_side);

  /// Goes back to the minimum, with all steps available again.
  void restart();
  /// Goes one stride further to that side, or less far if the ridge bends; false if the ridge is
  /// lost.
  bool advance(double side);
  /// Goes to z, which is further from the minimum on the side of the last foot; false if the ridge
  /// is lost.
  bool walk_to(double z);

  [[nodiscard]] const Foot& last() const { return last_; }
  [[nodiscard]] const Foot& before() const { return before_; }
  /// A foot between two others; nullopt if none is found.
  [[nodiscard]] std::optional<Foot> between(double z, const Foot& a, const Foot& b);

  /// L beyond the minimum along the tangent, and what the last of one or two steps of scoring in the
  /// other coordinates gains there; nullopt if the model does not hold.
  struct Look {
    double value = 0.0; ///< after that step
    double gain = 0.0;
  };
  [[nodiscard]] std::optional<Look> look(double z) const;

  [[nodiscard]] int steps_taken() const { return most_steps_ - steps_left_; }

private:
  struct Step {
    Evaluation here;        // before the step
    double gain = 0.0;      // of L by the step
    Eigen::VectorXd change; // of the coordinates by the step
  };
  [[nodiscard]] Eigen::VectorXd in_valley(const std::vector<double>& u,
                                          const Eigen::VectorXd& change) const;
  [[nodiscard]] std::optional<Step> step_of_others(std::span<const double> x) const;
  bool go_to(double z);
  [[nodiscard]] std::vector<double> foreseen(double z) const;
  [[nodiscard]] std::vector<double> with_own(std::vector<double> x, double z) const;
  bool search_on(double strides);
  [[nodiscard]] bool is_allowed(std::span<const double> x) const;
  [[nodiscard]] std::optional<Foot> foot_near(std::vector<double> x, double z, double& first_gain);
  [[nodiscard]] std::optional<std::vector<double>> lower(const std::vector<double>& x,
                                                         const Step& step) const;
  [[nodiscard]] std::optional<Foot> by_search(std::vector<double> x, double z);
  [[nodiscard]] std::optional<Foot> foot(const std::vector<double>& x, double z, double value,
                                         const Eigen::MatrixXd& triangle) const;

  const FitProblem& problem_;
  const Minimum& minimum_;
  const Certainty& known_;
  std::size_t k_;
  Valley valley_;
  double widening_;
  int most_steps_;
  Foot first_;          // the minimum
  Foot last_, before_;  // the last two
  double stride_ = 0.0; // in z
  int steps_left_ = 0;
};

/// The feet of the ridge along the coordinate of the clock that the log leaves most open, on either
/// side of the minimum, up to where L has risen by `largest_rise`, the ridge is lost, or some
/// coordinate is a factor e^3 away; `is_lost` in the latter two cases.
struct RidgeSide {
  std::vector<Foot> feet; ///< the first is the minimum
  bool is_lost = false;
};
std::array<RidgeSide, 2> sides_of_most_open(const ProfiledPlace& place, double largest_rise);

/// Points from which a search may end elsewhere than at that minimum: the hollows of both sides, and
/// the last foot of a side that is lost.
std::vector<std::vector<double>> hollows_along_most_open(const ProfiledPlace& place,
                                                         double largest_rise);

} // namespace goingrate::timing_model
