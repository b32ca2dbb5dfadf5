// The shapes that pushes leave in times and amplitudes: a saw-tooth, a hump, and the crossing in
// the middle of a push (impulse_cycle.hpp). How much of each there is, with an uncertainty from the
// scatter from cycle to cycle. Private to the library.
#pragma once

#include "goingrate/fit/impulse_cycle.hpp"

#include "base/special_values.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace goingrate::push_shapes {

constexpr std::size_t least_cycles = 8; // enough to estimate a scatter

/// One value per cycle, NaN where there is none.
using Grid = std::vector<double>;

/// The values minus the mean of the `n` around each (of n + 1, with half weight for the outer two,
/// if n is even). This removes a slow wander and keeps a pattern that repeats every n, except for
/// its mean.
Grid less_moving_mean(const Grid& values, std::size_t n);

/// The height of the hump above a push, half-way between two pushes that are n swings apart.
constexpr double height_of_hump(double n) { return n / 8.0; }

/// The three shapes at one crossing, or how much there is of each.
using Shapes = Eigen::Vector3d;
enum Shape : std::size_t { tooth_shape, hump_shape, middle_shape };
/// At the m-th of n crossings after a push, 1 <= m <= n.
Shapes shapes_of(double m, double n);
/// The shapes at one crossing. The intervals before the first push and after the last count as
/// being of the usual length.
Shapes shapes_at(const std::vector<double>& pushes, double periods, double cycle);
/// The same at every crossing for pushes at irregular intervals, all of one strength: the tooth
/// falls by as much in each swing, whatever the interval, and its slow part is taken off.
std::vector<Shapes> irregular_shapes(const std::vector<double>& pushes, double periods,
                                     std::size_t length);

/// Which of the shapes are looked for.
using Sought = std::span<const Shape>;
inline constexpr std::array<Shape, 3> every_shape{tooth_shape, hump_shape, middle_shape};
/// Two swings can have only one pattern; in a few more, the three shapes are hardly distinct.
Sought few_shapes(std::size_t n);
Sought most_shapes(std::size_t n);
/// An amplitude has no hump.
Sought in_amplitudes(Sought in_times);

/// The mean of each of the n values of a cycle.
std::vector<double> folded_means(const Grid& values, std::size_t n);
/// The sum of squares of folded means that the shapes explain if they begin at place `first` of the
/// cycle.
double explained(const std::vector<double>& means, std::size_t first, Sought sought);
double explained_by_sine(const std::vector<double>& means);

/// The places of regular pushes, from one before the log to one after it.
std::vector<double> regular_pushes(std::size_t first, std::size_t n, double last);

/// A mean and its standard deviation, which allows for neighbouring cycles that err alike: they
/// share values in their slow parts, and a slow wander moves both. If they seem to err in opposite
/// ways, that is taken for chance.
ImpulseCycle::Estimate mean_of(const std::vector<double>& each);

/// Coefficients of the shapes with standard deviations from their scatter from cycle to cycle,
/// which contains whatever noise there is.
struct Coefficients {
  std::array<ImpulseCycle::Estimate, 3> of{{{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}}};
  std::vector<double> teeth{};       ///< of each complete interval
  std::vector<std::size_t> begins{}; ///< the crossing after the push with which the interval begins
  double cycles = 0.0;
  bool steady = true; ///< whether each keeps its sign from one part of the log to the next
  [[nodiscard]] const ImpulseCycle::Estimate& operator[](Shape shape) const { return of[shape]; }
  /// In 2 log L, with the scatter from the same cycles: if they are few, they may agree by chance.
  [[nodiscard]] double gain(Shape shape) const {
    const auto& [value, sigma] = of[shape];
    if (!(sigma > 0.0)) return 0.0;
    return cycles * std::log1p(std::pow(value / sigma, 2) / (cycles - 1.0));
  }
  [[nodiscard]] double gain() const {
    return gain(tooth_shape) + gain(hump_shape) + gain(middle_shape);
  }
};

/// For pushes once in n periods; the slow part of `values` has been subtracted (less_moving_mean).
/// nullopt if there are too few complete intervals.
std::optional<Coefficients> regular_coefficients(const Grid& values,
                                                 const std::vector<double>& pushes, std::size_t n,
                                                 Sought sought);
/// For single pushes, `periods` apart on average; `values` with their slow part.
std::optional<Coefficients> irregular_coefficients(const Grid& values,
                                                   const std::vector<double>& pushes,
                                                   double periods, Sought sought);

/// The delay of the clock by a push itself, s: the step of the tooth minus the effect, through the
/// circular error, of the push on the rest of the period in which it comes. The tooth does not
/// contain that effect, because it begins with that period.
///
/// A push past the vertical, soon after its period has begun, delays the clock; a push before the
/// vertical, near the end of its period, advances it. A tooth between the two belongs to a push
/// through the vertical. With two swings between pushes there is no hump that would separate the
/// two: the kick contains up to half of that effect.
/// ImpulseCycleTest.APushByItselfIsToldFromItsCircularError
ImpulseCycle::Estimate kick_alone(const ImpulseCycle& pushes);

} // namespace goingrate::push_shapes
