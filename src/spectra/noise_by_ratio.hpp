// Identifies the noise of one series at many averaging times by ratios of variances; the method is
// described in noise_type.hpp. Private to the spectra room.
#pragma once

#include "spectra/noise_type.hpp"
#include "window_means.hpp"

#include <mutex>
#include <optional>

namespace goingrate {

// May be called from several threads at once.
class NoiseByRatio {
public:
  explicit NoiseByRatio(std::span<const double> phase) : phase_(phase) {} // must outlive it
  [[nodiscard]] NoiseType at(std::size_t m) const;

private:
  // 2 or 1: which phase noise MVAR/AVAR speaks for.
  [[nodiscard]] int alpha_of_phase_noise(std::size_t m) const;
  const WindowMeans& means() const;

  std::span<const double> phase_;
  mutable std::once_flag formed_;
  mutable std::optional<WindowMeans> means_; // formed when first asked for
};

} // namespace goingrate
