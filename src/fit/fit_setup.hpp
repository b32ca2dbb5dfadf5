// Turns the user's options into a parametrised problem with starting points. Private to the fit
// room.
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

/// Events may name the impulse and its angle just as they name the torque and its angle.
std::string_view as_torque(std::string_view name);

/// The parameters of the clock that are neither held nor have a starting value.
std::vector<std::string> names_without_start(const FitOptions& options);

/// Whether the options name a parameter: fix it, free it, or state a prior on it.
bool names(const FitOptions& options, const std::string& parameter);

/// If the noise is automatic and the options name drive_rms, slow_rms or slow_time, the noise
/// becomes a kind that has this parameter. Throws ArgumentError if the noise asked for does not
/// have it.
void include_named_noise(FitOptions& options);

/// Weak priors about a start, and the user's priors. A logarithm may move by a factor e^5, T0 by
/// 1 %, a changed torque by five times the first: wide compared with anything a log determines.
std::vector<CoordinatePrior> make_priors(const FitOptions& options, const Parameters& parameters,
                                         std::span<const double> start);

/// The allowed ranges of the coordinates: sizes not below 0, the jitter not below rounding, the
/// memory of a slow drive between two periods and ten times the log.
std::vector<std::array<double, 2>> make_bounds(const Parameters& parameters,
                                               const TimingData& data);

/// Starting points that cover the clocks people have: friction from 1e-5 to 3e-3, and amplitudes
/// from 0.025 to 0.2 rad (or the log's own, or the one that a known T0 and the rate demand) that
/// are one to four times the switching angle. The swing starts at its stationary amplitude, or at
/// half or one and a half times it. Events start from the jump seen in the rate, noise from the
/// guess.
std::vector<std::vector<double>> starting_points(const Parameters& parameters,
                                                 const TimingData& data, const NoiseGuess& noise);

/// A start at the clock estimated from amplitudes and times together; empty if there is none.
std::optional<std::vector<double>>
start_by_amplitudes(const Parameters& parameters, const TimingData& data, const NoiseGuess& noise);

/// A point of `to`: coordinates with the same name are taken from a point of `from`, new ones from
/// `otherwise`.
std::vector<double> carried_over(const Parameters& from, std::span<const double> x,
                                 const Parameters& to, std::span<const double> otherwise);

/// At most `count` beats, evenly spaced but denser just after events and at both ends.
TimingData thinned(const TimingData& data, const Parameters& parameters, std::size_t count);

/// About `count` beats, at a constant stride.
TimingData at_one_stride(const TimingData& data, std::size_t count);

} // namespace goingrate::timing_model
