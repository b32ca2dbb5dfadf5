// Finds the maximum likelihood of one model. Private to the fit room.
#pragma once

#include "fitted.hpp"

#include <span>

namespace goingrate::timing_model {

/// Finds the maximum of a model in averaged1 from scratch: a grid of starts on few beats with the
/// noise held at a guess, scoring from the best of them, then all beats with the noise free.
/// Searches that end elsewhere at nearly the same likelihood are kept as rivals. Not usable if no
/// start lies in the model's domain.
Fitted fit_from_scratch(const TimingData& data, const FitOptions& options, const ModelChoice& model,
                        const NoiseGuess& noise);

/// The same model with more or other noise or friction, starting from a fit without it; with drive
/// noise the search also covers the other clocks from which a stationary log could come. Uses
/// `data` if given, else the data of the simpler fit.
Fitted fit_from(const Fitted& simpler, const FitOptions& options, const ModelChoice& model,
                const TimingData* data = nullptr);

/// The best of the fits reached from simpler fits to the same data. In a long log with amplitudes
/// it is looked for on few beats first, and dates that may move are moved there.
Fitted fit_from_any(std::span<const Fitted* const> simpler, FitOptions& options,
                    const ModelChoice& model);

/// Whether a slow drive of any size and memory, added to `simpler` as it is, raises the likelihood
/// above that of `best`, a fit of the same data.
bool worth_trying(const Fitted& simpler, const Fitted& best, const FitOptions& options,
                  const ModelChoice& model);

} // namespace goingrate::timing_model
