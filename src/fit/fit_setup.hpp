// From the user's options to a parametrised problem, and where to start. Private to the fit room.
#pragma once

#include "likelihood.hpp"
#include "noise_guess.hpp"

#include "goingrate/fit/clock_fit.hpp"

namespace goingrate::timing_model {

/// The parameters of a model. Throws ArgumentError for names that do not exist, values out of range
/// and events that make no sense.
Parameters make_parameters(const FitOptions& options, const TimingData& data,
                           const ModelChoice& model);

/// Checks the names of options against everything any model could have.
void check_names(const FitOptions& options, const TimingData& data);

/// Events may name the impulse and its angle as they name torque and angle.
std::string_view as_torque(std::string_view name);

/// The parameters of the clock that are neither held nor have a place to start from.
std::vector<std::string> names_without_start(const FitOptions& options);

/// Whether the options speak of a parameter: fix it, free it, or state a prior on it.
bool names(const FitOptions& options, const std::string& parameter);

/// Automatic noise that names drive_rms, slow_rms or slow_time becomes the noise that has it.
/// Throws ArgumentError where the noise asked for does not have it.
void include_named_noise(FitOptions& options);

/// Weak priors about a start, and those the user states. A logarithm may move by e^5, T0 by 1 %, a
/// changed torque by five times the first: wide compared with anything a log determines.
std::vector<CoordinatePrior> make_priors(const FitOptions& options, const Parameters& parameters,
                                         std::span<const double> start);

/// What the coordinates may be: sizes not below 0, the jitter not below rounding, the memory of a
/// slow drive between two periods and ten logs.
std::vector<std::array<double, 2>> make_bounds(const Parameters& parameters,
                                               const TimingData& data);

/// Starting points that cover the clocks people have: friction from 1e-5 to 3e-3, amplitudes from
/// 0.025 to 0.2 rad (or the log's own, or what a known T0 and the rate demand), one to four times
/// the switching angle, at rest in its stationary swing or half or one and a half times it. Events
/// start from the jump seen in the rate, noise from the guess.
std::vector<std::vector<double>> starting_points(const Parameters& parameters,
                                                 const TimingData& data, const NoiseGuess& noise);

/// A start at the clock that amplitudes and times tell together; nothing if they tell none.
std::optional<std::vector<double>>
start_by_amplitudes(const Parameters& parameters, const TimingData& data, const NoiseGuess& noise);

/// The coordinates of `to` taken over from a point of `from` where the names are the same; those
/// that are new come from `otherwise`.
std::vector<double> carried_over(const Parameters& from, std::span<const double> x,
                                 const Parameters& to, std::span<const double> otherwise);

/// At most `count` beats, evenly spread but denser just after events and at both ends.
TimingData thinned(const TimingData& data, const Parameters& parameters, std::size_t count);

/// About `count` beats at one stride.
TimingData at_one_stride(const TimingData& data, std::size_t count);

} // namespace goingrate::timing_model
