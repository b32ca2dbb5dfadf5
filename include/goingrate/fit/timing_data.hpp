// A log reduced to what a fit needs.
#pragma once

#include "goingrate/log/beats.hpp"

#include <span>
#include <vector>

namespace goingrate {

/// Times and amplitudes of a run of good beats; all vectors have one entry a beat.
struct TimingData {
  double reference_period_s = 0.0;   ///< the mean period: makes the lateness small
  std::vector<double> cycle;         ///< n_i, 0 for the first beat
  std::vector<double> elapsed_s;     ///< t_i - t_0
  std::vector<double> lateness_s;    ///< t_i - t_0 - n_i * reference period, no digits lost
  std::vector<double> amplitude_rad; ///< NaN where unknown; empty if the log has none

  [[nodiscard]] std::size_t size() const { return cycle.size(); }
  [[nodiscard]] bool has_amplitude() const { return !amplitude_rad.empty(); }
};

/// Throws ArgumentError for fewer than three beats.
TimingData timing_data(std::span<const Beat> beats);

/// The entries with the given indices (increasing).
TimingData subset(const TimingData& data, std::span<const std::size_t> chosen);

} // namespace goingrate
