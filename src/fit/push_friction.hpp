// Estimates the friction from the decay of the swing between pushes. Private to the fit room.
#pragma once

#include "push_shapes.hpp"

#include <optional>
#include <span>
#include <vector>

namespace goingrate::push_shapes {

/// NaN if none is known.
double mean_of_known(std::span<const double> values);

/// Amplitudes in which a free swing dies away along a straight line, as its logarithm does. Near
/// their mean they are as they were.
Grid straightened(const Grid& amplitude);

/// From the saw-tooth of the straightened amplitude, `swing`: the loss between two pushes is proportional to the
/// amplitude, whatever a push gives. nullopt if the friction differs from one part of the log to
/// another.
std::optional<ImpulseCycle::Estimate> friction_of_teeth(const Grid& amplitude,
                                                        const std::vector<double>& pushes,
                                                        double periods, const Coefficients& swing);

/// From pushes that are seen one by one, between which the swing is free: the slope of the
/// logarithm of its amplitude.
std::optional<ImpulseCycle::Estimate> friction_between(const Grid& amplitude,
                                                       const std::vector<double>& pushes);

} // namespace goingrate::push_shapes
