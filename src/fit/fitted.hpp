// A model where its search came to rest, and how a search is brought there. Private to the fit
// room.
#pragma once

#include "inference.hpp"
#include "search.hpp"
#include "thinning.hpp"

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

/// L without the weak priors: these are about the start of a search, and ends of searches from
/// different starts are to be compared.
double value_without_weak_priors(const FitProblem& problem, const Minimum& minimum);

/// -2 log likelihood + k log n, without the weak priors.
double bayes_criterion(const FitProblem& problem, const Minimum& minimum);

/// Brings a search to rest: the clock first where the misfit says nothing of the noise yet, then
/// all; on every beat if few do not say the same.
void settle(FitProblem& problem, Minimum& minimum, const SearchLimits& limits);

/// Fills in what hangs on the place where the search came to rest; not usable if the model does not
/// hold there.
void finish(Fitted& fitted);

/// Rescales free noise to the size of the innovations.
void rescale_noise(const FitProblem& problem, std::vector<double>& x);

/// Lets a few beats stand for all where nothing but jitter disturbs them.
void condense(FitProblem& problem, std::span<const double> x);

/// Whether every free parameter of the clock is known well.
bool all_but_known(const FitProblem& problem, const Certainty& known, std::span<const double> x);

/// Whether the innovations of the amplitudes look white, or are too few to tell.
bool white_in_amplitude(const Fitted& fitted);
/// Whether both the times' and the amplitudes' do: then nothing calls for a better model.
bool white(const Fitted& fitted);

/// Whether the fit knows the clock well enough to be the only place to look from.
bool knows_its_clock(const Fitted& fitted);

/// `place` moved as `from` moved to `to`: thinned beats or other dynamics move neighbours alike.
std::vector<double> moved_along(std::vector<double> place, std::span<const double> from,
                                std::span<const double> to);

/// A place with the noise of single beats that blocks of `together` stand for.
std::vector<double> with_noise_of_blocks(const Parameters& parameters, std::vector<double> x,
                                         double together);

/// A place with at least the jitter that neighbouring beats show: beats at a stride hide it under
/// the walk, and a search finds its way back from too little of it only slowly.
std::vector<double> with_jitter_of(const TimingData& data, const Parameters& parameters,
                                   std::vector<double> x);

/// What the fit says of the spectrum, to thin by; nothing if there is no drive noise.
std::optional<NoiseShape> noise_shape(const Fitted& fitted);

/// The largest relative loss of information (1 - variance with these beats / variance now) on a
/// parameter of the clock, if the beats of the fit are used and not these.
double information_lost(const Fitted& fitted, const TimingData& beats);

} // namespace goingrate::timing_model
