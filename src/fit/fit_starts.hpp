// Where the search for a model's maximum likelihood begins. Private to the fit room.
#pragma once

#include "fit_setup.hpp"
#include "search.hpp"

namespace goingrate::timing_model {

FitProblem make_problem(const TimingData& data, const FitOptions& options,
                        const ModelChoice& model);

/// The problem with its noise held at the values of the starting point.
FitProblem with_noise_held(const FitProblem& problem, std::span<const double> start);

/// The points that lie in the model's domain with their L, lowest first; a free T0 is set to the
/// mean rate.
std::vector<Minimum> screened(const FitProblem& problem,
                              const std::vector<std::vector<double>>& points);

/// Drops each point that lies within a sigma of a better one; the points are in order of value. If
/// the problem has only a `share` of the beats that will finally tell points apart, the sigma is
/// the one for all beats.
void drop_duplicates(const FitProblem& problem, std::vector<Minimum>& places, double share = 1.0);

/// The points at which scoring on few beats, with the noise held, ends: from the best of the log's
/// own starts and from the clocks inferred from a change, or from the options' start. All differ;
/// lowest first.
std::vector<Minimum> finalists(FitProblem problem, const FitOptions& options,
                               const NoiseGuess& noise);

/// Every point with drive noise of several sizes and several memories.
std::vector<std::vector<double>> noise_variants(const std::vector<std::vector<double>>& points,
                                                const Parameters& parameters,
                                                const TimingData& data);

} // namespace goingrate::timing_model
