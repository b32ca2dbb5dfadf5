// One model brought to its maximum likelihood. Private to the fit room.
#pragma once

#include "inference.hpp"
#include "thinning.hpp"

#include <string>

namespace goingrate::timing_model {

/// A model, its problem and where the search came to rest.
struct Fitted {
  ModelChoice model;
  FitDynamics dynamics = FitDynamics::averaged1;
  FitProblem problem;
  Minimum minimum;
  double bic = 0.0;
  Rivals rivals;
  std::vector<std::vector<double>> ends; ///< where else a search came to rest: other dynamics may
                                         ///< prefer one of them
  Residuals seen;                        ///< at the minimum
  Widening widening; ///< where a test at one in a thousand finds correlation in the innovations,
                     ///< and for few beats by the degrees of freedom that the parameters took
  Certainty known;   ///< with that widening
};

/// Whether the times are met as closely as their digits allow: then there is no noise to speak of.
bool is_rounding(const Fitted& fitted);

/// -2 log likelihood + k log n, without the weak priors.
double bayes_criterion(const FitProblem& problem, const Minimum& minimum);

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

/// The better of what two simpler fits lead to.
Fitted fit_from_either(const Fitted& one, const Fitted& other, const FitOptions& options,
                       const ModelChoice& model);

/// The same fit on beats that stand for its own, brought to their minimum; not usable if there is
/// none.
Fitted on_few_beats(const Fitted& fitted, const FewBeats& few);

/// A place with at least the jitter that neighbouring beats show: beats at a stride hide it under
/// the walk, and a search finds its way back from too little of it but slowly.
std::vector<double> with_jitter_of(const TimingData& data, const Parameters& parameters,
                                   std::vector<double> x);

/// Whether any size and memory of a slow drive, put into the fit as it is, raises its likelihood.
bool worth_trying(const Fitted& simpler, const FitOptions& options, const ModelChoice& model);

/// What the fit says of the spectrum, to thin by; nothing if there is no drive noise.
std::optional<NoiseShape> noise_shape(const Fitted& fitted);

/// Makes it the fit of other dynamics, by adding what they differ by until that stands still; false
/// (and nothing changed) if they cannot be run there.
bool refine(Fitted& fitted, FitDynamics dynamics);

/// The same from every place where the search came to rest: the best of them, the others as rivals
/// if they are nearly as good.
bool refine_every_end(Fitted& fitted, FitDynamics dynamics);

} // namespace goingrate::timing_model
