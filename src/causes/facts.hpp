// Causes that show in a log without a model of its rate: displaced times, missing beats, spectral
// lines, a rough drive. Private to the causes room.
#pragma once

#include "goingrate/causes/diagnosis.hpp"

#include <optional>
#include <vector>

namespace goingrate::timing_model {

/// The data with displacements of their times removed, at most eight, also less certain ones. Data
/// without displacements are not copied, and must outlive this object.
class Undisplaced {
public:
  explicit Undisplaced(const TimingData& data);
  Undisplaced(const Undisplaced&) = delete;
  Undisplaced& operator=(const Undisplaced&) = delete;
  [[nodiscard]] const TimingData& data() const { return *data_; }
  [[nodiscard]] const std::vector<Displacement>& displaced() const { return data_->displaced; }

private:
  const TimingData* data_;
  std::optional<TimingData> corrected_;
};

/// Adds the cause of displaced times: a sensor that was moved, a knock, hands that were set.
void look_at_displacements(const DiagnosisInput& input, const std::vector<Displacement>& found,
                           std::vector<Suspicion>& all);

/// The suspicions of these causes, each with a gain of convincing_gain or more.
std::vector<Suspicion> suspicions_of_facts(const DiagnosisInput& input,
                                           const std::vector<Displacement>& displaced);

} // namespace goingrate::timing_model
