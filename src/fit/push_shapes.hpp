// The shapes that pushes leave in times and amplitudes: a saw-tooth, a hump, and the crossing in
// the midst of a push (impulse_cycle.hpp); how much of each there is, by the scatter from cycle to
// cycle. Private to the library.
#pragma once

#include "goingrate/fit/impulse_cycle.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace goingrate::push_shapes {

constexpr std::size_t least_cycles = 8; // enough to tell a scatter from
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// One value per cycle, NaN where there is none.
using Grid = std::vector<double>;

/// Values less the mean of the `n` around each (of n + 1, the outer ones by half, if n is even):
/// what wanders slowly goes, and what repeats every n stays whole, less its mean.
Grid less_moving_mean(const Grid& values, std::size_t n);

/// How high the hump stands above a push, half-way between two that are n swings apart.
constexpr double height_of_hump(double n) { return n / 8.0; }

/// The three shapes at one crossing, or how much there is of each.
using Shapes = Eigen::Vector3d;
enum Shape : std::size_t { tooth_shape, hump_shape, middle_shape };
/// At the m-th of n crossings after a push, 1 <= m <= n.
Shapes shapes_of(double m, double n);
/// At one crossing. Before the first push and after the last the interval counts as usual.
Shapes shapes_at(const std::vector<double>& pushes, double periods, double cycle);

/// Which of them are sought.
using Sought = std::span<const Shape>;
inline constexpr std::array<Shape, 3> every_shape{tooth_shape, hump_shape, middle_shape};
/// Two swings can have only one pattern; in a few more, the three shapes are hardly distinct.
Sought few_shapes(std::size_t n);
Sought most_shapes(std::size_t n);
/// An amplitude has no hump.
Sought in_amplitudes(Sought in_times);

/// The mean of each of the n values of a cycle.
std::vector<double> folded_means(const Grid& values, std::size_t n);
/// What the shapes, begun at place `first` of the cycle, explain of folded means: the sum of
/// squares.
double explained(const std::vector<double>& means, std::size_t first, Sought sought);
double explained_by_sine(const std::vector<double>& means);

/// Where regular pushes come, from one before the log to one after it.
std::vector<double> regular_pushes(std::size_t first, std::size_t n, double last);

/// A mean and its standard deviation. Neighbouring cycles share the values that their slow part was
/// taken from, and what wanders moves both.
ImpulseCycle::Estimate mean_of(const std::vector<double>& each);

/// Coefficients of the shapes with standard deviations from their scatter from cycle to cycle,
/// which contains whatever noise there is.
struct Coefficients {
  std::array<ImpulseCycle::Estimate, 3> of{{{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}}};
  std::vector<double> teeth{};       ///< of each interval that is whole
  std::vector<std::size_t> begins{}; ///< the crossing after the push with which that begins
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

/// For pushes once in n periods; `values` have no slow part (less_moving_mean). Nothing where there
/// are too few whole intervals.
std::optional<Coefficients> regular_coefficients(const Grid& values,
                                                 const std::vector<double>& pushes, std::size_t n,
                                                 Sought sought);
/// For pushes one by one, n periods apart in the mean; `values` as they are.
std::optional<Coefficients> irregular_coefficients(const Grid& values,
                                                   const std::vector<double>& pushes, std::size_t n,
                                                   Sought sought);

/// How much later the clock is after a push for the push itself, s: the step of the tooth less what
/// the push does through the circular error in the rest of the period in which it comes, for which
/// the tooth, begun with that period, has no place.
///
/// A push sets the clock back when it comes beyond the vertical, soon after that period has begun,
/// and ahead when it comes before, near its end; a tooth between the two is that of a push through
/// the vertical. Two swings have no hump that would tell it: their kick contains up to half of
/// that. ImpulseCycleTest.APushByItselfIsToldFromItsCircularError
ImpulseCycle::Estimate kick_alone(const ImpulseCycle& pushes);

} // namespace goingrate::push_shapes
