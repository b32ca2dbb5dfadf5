// The daily wave in a quantity that is measured once a minute.
#pragma once

#include "learnt.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace goingrate::apps {

/// Learns the daily wave due to temperature: a level and harmonics of 24 and 12 hours, by least
/// squares with weights that fade within weeks (DailyWaveTest).
class DailyWave {
public:
  /// The mean of the minute that begins `minute` minutes after 1970, minus the wave learnt before
  /// it; nullopt if it is not known.
  std::optional<double> without(std::int64_t minute, std::optional<double> mean);
  /// The level has changed by `size`: the learnt level is changed by the same.
  void stepped(double size);
  void pass(Learnt& learnt);

private:
  static constexpr int terms = 5;
  using Vector = Eigen::Matrix<double, terms, 1>;
  static Vector shape(std::int64_t minute);

  Eigen::Matrix<double, terms, terms> weights_ = Eigen::Matrix<double, terms, terms>::Zero();
  Vector sums_ = Vector::Zero();
};

} // namespace goingrate::apps
