// Causes that show in a log without a model of its rate: displaced times, missing beats, spectral
// lines, a rough drive. Private to the causes room.
#pragma once

#include "goingrate/causes/diagnosis.hpp"

#include <optional>
#include <vector>

namespace goingrate::timing_model {

/// All times from one beat on are late by the same amount; the rate stays as it was.
struct Displacement {
  std::size_t beat = 0; ///< the first that is late
  double late_s = 0.0;
  double gain = 0.0;
};

/// The data without at most `most` displacements of their times, the greatest gain first; each is
/// taken off before the next is searched for. Data without any are not copied, and must outlive it.
class Undisplaced {
public:
  Undisplaced(const TimingData& data, std::size_t most);
  Undisplaced(const Undisplaced&) = delete;
  Undisplaced& operator=(const Undisplaced&) = delete;
  [[nodiscard]] const TimingData& data() const { return *data_; }
  [[nodiscard]] const std::vector<Displacement>& displaced() const { return displaced_; }

private:
  const TimingData* data_;
  std::optional<TimingData> corrected_;
  std::vector<Displacement> displaced_;
};

/// The suspicions that follow from these, each with a gain above `believed`.
std::vector<Suspicion> suspicions_of_facts(const DiagnosisInput& input,
                                           const std::vector<Displacement>& displaced);

} // namespace goingrate::timing_model
