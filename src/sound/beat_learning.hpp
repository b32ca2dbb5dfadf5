// The mean beat, learnt from many.
#pragma once

#include "beat_fit.hpp"

#include <vector>

namespace goingrate {

/// Learns one kind of beat, tick or tock.
BeatKind learn_kind(const BeatGrid& grid, std::vector<BeatSnippet> snippets);

} // namespace goingrate
