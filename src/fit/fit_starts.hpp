// Where the search for a model's maximum likelihood begins. Private to the fit room.
#pragma once

#include "fit_setup.hpp"
#include "search.hpp"

namespace goingrate::timing_model {

FitProblem make_problem(const TimingData& data, const FitOptions& options,
                        const ModelChoice& model);

/// The problem with its noise held at what the starting point says.
FitProblem with_noise_held(const FitProblem& problem, std::span<const double> start);

/// The points that lie in the model's domain with their L, lowest first; a free T0 is set to the
/// mean rate.
std::vector<Minimum> screened(const FitProblem& problem,
                              const std::vector<std::vector<double>>& points);

/// Drops each place that lies within a sigma of a better one. They are in order of value. Where the
/// problem's beats are a `share` of those that are to tell places apart, sigma is that of all.
void drop_duplicates(const FitProblem& problem, std::vector<Minimum>& places, double share = 1.0);

/// Where scoring comes to rest on few beats with the noise held, from the best of the log's own
/// starts and the clocks that a change tells of (or the options' start), all different, lowest
/// first.
std::vector<Minimum> finalists(FitProblem problem, const FitOptions& options,
                               const NoiseGuess& noise);

/// Every point with its drive noise at several sizes, and its memory at several lengths.
std::vector<std::vector<double>> noise_variants(const std::vector<std::vector<double>>& points,
                                                const Parameters& parameters,
                                                const TimingData& data);

} // namespace goingrate::timing_model
