// Figures of the clock itself: its rate against its amplitude, and the course of its drive.
#include "palette.hpp"
#include "report_figures.hpp"

#include "wording.hpp"

#include "base/robust.hpp"
#include "base/scaled_time.hpp"
#include "fit/gravity_share.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

// Means over stretches of beats, because in single periods the jitter hides the dependence.
Series stretch_means(const Analysis& data, const Wording& words) {
  constexpr std::size_t wanted_points = 300;
  constexpr std::size_t fewest_beats = 10; // beats
  const std::size_t length = std::max(fewest_beats, data.beats.size() / wanted_points);
  const auto error = clock_error(data.beats, data.rate.nominal_period_s);
  Series means{
      Series::Style::points, fmt::format("means over {} beats", length), {}, {}, {}, {}, blue};
  for (std::size_t from = 0; from + length < data.beats.size(); from += length) {
    double sum = 0.0, seen = 0.0;
    for (std::size_t i = from; i < from + length; ++i) {
      if (!std::isfinite(data.beats[i].amplitude_rad)) continue;
      sum += data.beats[i].amplitude_rad;
      ++seen;
    }
    const double elapsed = data.beats[from + length].time - data.beats[from].time;
    if (seen == 0.0 || !(elapsed > 0.0)) continue;
    means.x.push_back(words.angle_unit().factor * sum / seen);
    means.y.push_back(words.rate_unit().factor * (error[from + length] - error[from]) / elapsed);
  }
  return means;
}

/// Curves of the rate against the amplitude, each laid through the middle of the points.
class RateCurves {
public:
  RateCurves(const Series& means, const Wording& words, double gravity_share)
      : words_(words), gravity_share_(gravity_share), middle_x_(median_of(means.x)),
        middle_y_(median_of(means.y)) {
    const auto [low, high] = std::minmax_element(means.x.begin(), means.x.end());
    constexpr int steps = 40;
    for (int i = 0; i <= steps; ++i)
      amplitude_rad_.push_back((*low + (*high - *low) * i / steps) / words.angle_unit().factor);
  }

  [[nodiscard]] Series circular_error() const {
    std::vector<double> rates;
    for (const double a : amplitude_rad_)
      rates.push_back(-gravity_share_ * a * a / 16.0);
    return curve("circular error", amplitude_rad_, rates, vermilion);
  }
  [[nodiscard]] Series measured_slope(const Isochronism& found) const {
    const std::vector<double> ends{amplitude_rad_.front(), amplitude_rad_.back()};
    return curve("slope of slow variations", ends,
                 {found.slope * ends.front(), found.slope * ends.back()}, green);
  }
  [[nodiscard]] Series curve(std::string label, const std::vector<double>& amplitude_rad,
                             const std::vector<double>& rates, int colour) const {
    Series series{Series::Style::line, std::move(label), {}, {}, {}, {}, colour};
    const double at = middle_x_ / words_.angle_unit().factor;
    const auto next = std::upper_bound(amplitude_rad.begin() + 1, amplitude_rad.end() - 1, at);
    const auto k = static_cast<std::size_t>(next - amplitude_rad.begin());
    const double share = (at - amplitude_rad[k - 1]) / (amplitude_rad[k] - amplitude_rad[k - 1]);
    const double level = std::lerp(rates[k - 1], rates[k], share);
    for (std::size_t i = 0; i < rates.size(); ++i) {
      series.x.push_back(words_.angle_unit().factor * amplitude_rad[i]);
      series.y.push_back(middle_y_ + words_.rate_unit().factor * (rates[i] - level));
    }
    return series;
  }

private:
  const Wording& words_;
  double gravity_share_, middle_x_, middle_y_;
  std::vector<double> amplitude_rad_;
};

} // namespace

std::optional<Figure> rate_amplitude_figure(const Analysis& data) {
  if (!data.log.has_amplitude) return std::nullopt;
  const Wording words(data);
  Series means = stretch_means(data, words);
  if (means.x.size() < 2) return std::nullopt;
  const double share = gravity_share_of(data.fit);
  const RateCurves curves(means, words, share);
  std::string caption =
      fmt::format("Points along the curve −{}A²/16 are a clock whose rate follows its amplitude by "
                  "the circular "
                  "error alone; off it something else moves the rate, such as the escapement. ",
                  share == 1.0 ? "" : fmt::format("{:.3g} ", share));
  std::vector<Series> series{std::move(means), curves.circular_error()};
  const auto& found = data.isochronism;
  if (found && found->curve) {
    const IsochronismCurve& fitted = *found->curve;
    series.push_back(
        curves.curve("escapement error", fitted.amplitude_rad, fitted.escapement, purple));
    series.push_back(
        curves.curve("their sum, the fitted clock", fitted.amplitude_rad, fitted.sum, blue));
    caption += "The escapement error and the sum of both are those of the fitted clock as its "
               "drive varies. ";
  }
  if (found) {
    series.push_back(curves.measured_slope(*found));
    caption += "The straight line is the slope that the log shows in slow variations, where the "
               "amplitude has followed the drive. ";
  }
  return Figure{"rate-amplitude",
                "Rate against amplitude",
                caption + "Curves are laid through the middle of the points: only slopes count.",
                {"amplitude", std::string(words.angle_unit().name)},
                {"rate", std::string(words.rate_unit().name)},
                std::move(series)};
}

std::optional<Figure> drive_figure(const Analysis& data, const Axis& time, double time_factor,
                                   std::vector<Marker> markers) {
  if (!data.history || data.history->points.empty()) return std::nullopt;
  Series band{Series::Style::band, "± σ", {}, {}, {}, {}, blue};
  Series line{Series::Style::line, "drive", {}, {}, {}, {}, blue};
  for (const DrivePoint& point : data.history->points) {
    line.x.push_back(point.at_s * time_factor);
    line.y.push_back(point.relative);
    band.low.push_back(point.relative - point.sigma);
    band.high.push_back(point.relative + point.sigma);
  }
  band.x = line.x;
  const DriveHistory& history = *data.history;
  const char* source = history.from_amplitude && history.from_rate ? "amplitude and rate"
                       : history.from_amplitude                    ? "amplitude"
                                                                   : "rate";
  return Figure{"drive-history",
                "History of the drive",
                fmt::format("The torque relative to that of the fit, found from {} by undoing the "
                            "pendulum's slow answer, with one σ either way; 1.01 is a drive "
                            "stronger by 1 %.",
                            source),
                time,
                {"drive μ(t)/μ₀", ""},
                {std::move(band), std::move(line)},
                std::move(markers)};
}

} // namespace goingrate
