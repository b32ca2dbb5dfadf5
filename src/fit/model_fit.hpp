// One model brought to its maximum likelihood. Private to the fit room.
#pragma once

#include "fitted.hpp"

#include <span>

namespace goingrate::timing_model {

/// Finds the maximum of a model in averaged1 from scratch: a grid of starts on few beats with the
/// noise held at a guess, the best of them by scoring, then all beats with the noise free. What
/// comes to rest elsewhere at nearly the same likelihood is kept as a rival. Not usable if no start
/// lies in the model's domain.
Fitted fit_from_scratch(const TimingData& data, const FitOptions& options, const ModelChoice& model,
                        const NoiseGuess& noise);

/// The same model with more or other noise or friction, from a fit without it; drive noise is
/// searched for over the clocks a stationary log could come from as well. On `data` if given, else
/// on those of the simpler fit.
Fitted fit_from(const Fitted& simpler, const FitOptions& options, const ModelChoice& model,
                const TimingData* data = nullptr);

/// The best of what simpler fits to the same data lead to. In a long log with amplitudes that is
/// sought on few beats first, where dates that may move are moved.
Fitted fit_from_any(std::span<const Fitted* const> simpler, FitOptions& options,
                    const ModelChoice& model);

/// Whether any size and memory of a slow drive, put into the fit as it is, raises its likelihood.
bool worth_trying(const Fitted& simpler, const FitOptions& options, const ModelChoice& model);

} // namespace goingrate::timing_model
