// Where the slope of a series jumps. Private to the causes room.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace goingrate::timing_model {

/// A series against time.
struct Track {
  std::vector<double> time;
  std::vector<double> value;
};

/// Prefix sums give the least-squares slope of any stretch in constant time.
class Slopes {
public:
  explicit Slopes(const Track& track) {
    const double offset = track.value[track.value.size() / 2]; // any typical value keeps sums small
    for (std::size_t i = 0; i < track.time.size(); ++i) {
      const double t = track.time[i];
      const double v = track.value[i] - offset;
      t_.push_back(t_.back() + t);
      v_.push_back(v_.back() + v);
      tt_.push_back(tt_.back() + t * t);
      tv_.push_back(tv_.back() + t * v);
    }
  }

  /// Slope of the points [from, to).
  [[nodiscard]] double slope(std::size_t from, std::size_t to) const {
    const auto n = static_cast<double>(to - from);
    const long double t = t_[to] - t_[from];
    const long double stt = tt_[to] - tt_[from] - t * t / n;
    const long double stv = tv_[to] - tv_[from] - t * (v_[to] - v_[from]) / n;
    return static_cast<double>(stv / stt);
  }

private:
  std::vector<long double> t_{0}, v_{0}, tt_{0}, tv_{0}; // precise in sums of 1e7 squares
};

/// Slope jump at every point (0 within a window of the ends) and its robust scatter over the log.
struct Jumps {
  std::vector<double> jump;
  double scatter = 0.0;
  [[nodiscard]] double score(std::size_t i) const { return std::abs(jump[i]) / scatter; }
};

/// The jumps of a track between the `window` points before and after each one, with what a smooth
/// bend makes taken off. Their scatter is at least `least_scatter`.
Jumps slope_jumps(const Track& track, std::size_t window, double least_scatter);

} // namespace goingrate::timing_model
