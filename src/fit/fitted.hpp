// A model at the end of its search, and the steps of a search. Private to the fit room.
#pragma once

#include "inference.hpp"
#include "search.hpp"
#include "thinning.hpp"

namespace goingrate::timing_model {

/// A model, its problem and the point at which the search ended.
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

/// Whether the times are fitted as closely as their digits allow, so that there is no noise to
/// estimate.
bool is_rounding(const Fitted& fitted);

/// L without the weak priors, which depend on the start of a search, so that the ends of searches
/// from different starts can be compared.
double value_without_weak_priors(const FitProblem& problem, const Minimum& minimum);

/// -2 log likelihood + k log n, without the weak priors.
double bayes_criterion(const FitProblem& problem, const Minimum& minimum);

/// Runs a search to its end: first for the clock alone as long as the misfit says nothing about the
/// noise, then for everything; on every beat if a few beats do not give the same result.
void settle(FitProblem& problem, Minimum& minimum, const SearchLimits& limits);

/// Fills in the members that depend on the point at which the search ended; not usable if the model
/// does not hold there.
void finish(Fitted& fitted);

/// Rescales free noise to the size of the innovations.
void rescale_noise(const FitProblem& problem, std::vector<double>& x);

/// Lets a few beats stand for all if there is no noise but jitter.
void condense(FitProblem& problem, std::span<const double> x);

/// Whether every free parameter of the clock is known well.
bool all_but_known(const FitProblem& problem, const Certainty& known, std::span<const double> x);

/// Whether the innovations of the amplitudes look white, or are too few to tell.
bool white_in_amplitude(const Fitted& fitted);
/// Whether the innovations of both times and amplitudes look white, so that nothing calls for a
/// better model.
bool white(const Fitted& fitted);

/// Whether the fit determines the clock so well that no other starting point is needed.
bool knows_its_clock(const Fitted& fitted);

/// `place` shifted by the step from `from` to `to`: thinned beats or other dynamics shift
/// neighbouring points alike.
std::vector<double> moved_along(std::vector<double> place, std::span<const double> from,
                                std::span<const double> to);

/// A point with the noise of single beats, from one for blocks of `together` beats.
std::vector<double> with_noise_of_blocks(const Parameters& parameters, std::vector<double> x,
                                         double together);

/// A point with at least the jitter that neighbouring beats show: in beats at a stride the walk
/// hides the jitter, and a search recovers from too small a jitter only slowly.
std::vector<double> with_jitter_of(const TimingData& data, const Parameters& parameters,
                                   std::vector<double> x);

/// The spectrum according to the fit, for thinning; nullopt if there is no drive noise.
std::optional<NoiseShape> noise_shape(const Fitted& fitted);

/// The largest relative loss of information about a parameter of the clock, 1 - variance with these
/// beats / variance now, if the beats of the fit are used instead of these.
double information_lost(const Fitted& fitted, const TimingData& beats);

} // namespace goingrate::timing_model
