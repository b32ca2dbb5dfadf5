// Figures of the clock itself: its rate against its amplitude, and the drive as it went.
#include "report_figures.hpp"

#include "wording.hpp"

#include "base/scaled_time.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr int blue = 0;
constexpr int vermilion = 1;

// Means over stretches of beats: of a single period the jitter hides what is looked for.
Series stretch_means(const Analysis& data, const Wording& words) {
  constexpr std::size_t wanted = 300;
  constexpr std::size_t shortest = 10; // beats
  const std::size_t length = std::max(shortest, data.beats.size() / wanted);
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

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// -A^2/16 over the range of amplitudes, laid through the middle of the points.
Series circular_error(const Series& means, const Wording& words) {
  constexpr int steps = 40;
  Series curve{Series::Style::line, "circular error", {}, {}, {}, {}, vermilion};
  const auto of = [&](double amplitude) {
    return -words.rate_unit().factor * std::pow(amplitude / words.angle_unit().factor, 2) / 16.0;
  };
  const auto [low, high] = std::minmax_element(means.x.begin(), means.x.end());
  const double level = median(means.y) - of(median(means.x));
  for (int i = 0; i <= steps; ++i) {
    const double amplitude = *low + (*high - *low) * i / steps;
    curve.x.push_back(amplitude);
    curve.y.push_back(level + of(amplitude));
  }
  return curve;
}

} // namespace

std::optional<Figure> rate_amplitude_figure(const Analysis& data) {
  if (!data.log.has_amplitude) return std::nullopt;
  const Wording words(data);
  Series means = stretch_means(data, words);
  if (means.x.size() < 2) return std::nullopt;
  Series curve = circular_error(means, words);
  return Figure{"rate-amplitude",
                "Rate against amplitude",
                "Points along the curve −A²/16 are a clock whose rate follows its amplitude by the "
                "circular error alone; off it something else moves the rate, such as the "
                "escapement. The curve is laid through the middle of the points: only its slope "
                "counts.",
                {"amplitude", std::string(words.angle_unit().name)},
                {"rate", std::string(words.rate_unit().name)},
                {std::move(means), std::move(curve)}};
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
                "The drive as it went",
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
