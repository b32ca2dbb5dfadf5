// How far a long log may be thinned. Private to the fit room.
#pragma once

#include "likelihood.hpp"

#include <span>

namespace goingrate::timing_model {

/// A stationary clock described by its spectrum, per cycle: increments of the times have the
/// density
///   S(f) = level |H|^2 + 4 j^2 sin^2(pi f),  H = 1 + (ratio - 1)/(1 + i f/corner),
/// f in 1/cycle, j^2 and level in one unit.
struct NoiseShape {
  double level = 1.0; ///< of the increments far above the corner
  double jitter2 = 0.0;
  double corner = 0.0; ///< 2 epsilon, 1/cycle
  double ratio = 0.0;  ///< slow gain over fast gain
};

/// The larger relative loss of information (1 - variance before / variance after) on corner and
/// ratio, which describe the clock, if only every `stride`-th time is used; from Whittle's
/// information of the aliased spectrum, with level and jitter unknown too. More is lost on level
/// and jitter, which neighbouring times show.
double information_lost(const NoiseShape& shape, std::size_t stride);

/// The largest stride (a power of two up to 64) that loses less than `allowed`.
std::size_t longest_stride(const NoiseShape& shape, double allowed);

/// Indices of the beats to keep: all within `dense` beats after the start and after each event;
/// from there on at a spacing that grows with the distance, so that noise of every time scale
/// shows, up to every stride-th, a power of two; and the last.
std::vector<std::size_t> kept_beats(const TimingData& data, const std::vector<double>& event_cycles,
                                    std::size_t stride, std::size_t dense);

/// The beats at those places. Each amplitude becomes the mean over the beats that are nearer to its
/// place than to any other: the swing follows the drive slowly, so that the amplitudes in between
/// are as informative, while the times in between add little.
TimingData thinned_to(const TimingData& data, std::span<const std::size_t> kept);

/// A few beats that stand for many.
struct FewBeats {
  TimingData data;
  double together = 1.0; ///< number of beats of which each is the mean
};

/// About `count` beats that hold nearly all information. With no noise but jitter these are means
/// over blocks of neighbours, put at the middle beat; only curvature within a block is lost. If
/// neighbours show that the times walk, they are beats at a constant stride. Blocks with a gap or
/// an event in them are left out.
FewBeats few_beats(const TimingData& data, const std::vector<double>& event_cycles,
                   std::size_t count);

} // namespace goingrate::timing_model
