// Figures of a ring-down: the period against the squared amplitude, and Q against the amplitude.
#include "palette.hpp"
#include "report_figures.hpp"

#include "wording.hpp"

#include "base/robust.hpp"
#include "fit/gravity_share.hpp"
#include "goingrate/clock/restoring.hpp"
#include "goingrate/report/tables.hpp"

#include <math.h> // declares the isnan that pchip.hpp of Boost 1.74 calls unqualified

#include <algorithm>
#include <boost/math/interpolators/pchip.hpp>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace goingrate {

namespace {

// Periods and squared amplitudes, as means over stretches of beats.
struct Stretches {
  std::vector<double> squared_rad2, period_s;
  std::size_t beats = 1; ///< in each
};

Stretches stretches_of(const Analysis& data, const std::vector<double>& amplitude_rad) {
  constexpr std::size_t wanted_points = 200;
  Stretches stretches;
  stretches.beats = std::max<std::size_t>(1, data.beats.size() / wanted_points);
  const std::size_t length = stretches.beats;
  for (std::size_t from = 0; from + length < data.beats.size(); from += length) {
    double sum = 0.0, seen = 0.0;
    for (std::size_t i = from; i <= from + length; ++i) {
      if (!std::isfinite(amplitude_rad[i])) continue;
      sum += amplitude_rad[i] * amplitude_rad[i];
      ++seen;
    }
    const Beat &first = data.beats[from], &last = data.beats[from + length];
    if (seen == 0.0 || last.cycle <= first.cycle) continue;
    stretches.squared_rad2.push_back(sum / seen);
    stretches.period_s.push_back((last.time - first.time) /
                                 static_cast<double>(last.cycle - first.cycle));
  }
  return stretches;
}

// The period of a free swing divided by that of a small swing. An amplitude above three radians
// comes from a wrong scale and is replaced by three radians.
double period_ratio(double gravity_share, double squared_rad2) {
  constexpr double least_rad = 1e-6, most_rad = 3.0;
  return free_period_ratio(gravity_share, std::clamp(std::sqrt(squared_rad2), least_rad, most_rad));
}

// T0 from the fit, or from the points if the fit has none.
double T0_of(const FitSummary& fit, const Stretches& points) {
  const FittedParameter* T0 = fit.find("T0");
  if (T0 != nullptr && std::isfinite(T0->value)) return T0->value;
  std::vector<double> each;
  for (std::size_t i = 0; i < points.period_s.size(); ++i)
    each.push_back(points.period_s[i] /
                   period_ratio(gravity_share_of(fit), points.squared_rad2[i]));
  return median_of(std::move(each));
}

Series theory(double T0, double gravity_share, double largest_rad2) {
  constexpr int steps = 40;
  Series curve{
      Series::Style::line, fmt::format("theory, T0 = {:.6g} s", T0), {}, {}, {}, {}, vermilion};
  for (int i = 0; i <= steps; ++i) {
    const double squared = largest_rad2 * i / steps;
    curve.x.push_back(squared);
    curve.y.push_back(T0 * period_ratio(gravity_share, squared));
  }
  return curve;
}

// Q as a curve over the amplitude. Between the amplitudes at which it is known, 1/Q, a sum of
// smooth losses, is interpolated by monotone cubics (Fritsch and Carlson 1980).
class QCurve {
public:
  explicit QCurve(const Decay& decay) : unit_(angle_unit(decay)) {
    for (const QAtAmplitude& at : decay.q_at_amplitude)
      if (std::isfinite(at.q.value)) known_.push_back(at);
    std::sort(known_.begin(), known_.end(), [](const QAtAmplitude& a, const QAtAmplitude& b) {
      return a.amplitude_rad < b.amplitude_rad;
    });
  }

  [[nodiscard]] std::size_t size() const { return known_.size(); }
  [[nodiscard]] const DisplayUnit& unit() const { return unit_; }
  /// The amplitudes that are drawn, in the unit of the figure.
  [[nodiscard]] std::vector<double> amplitudes() const {
    std::vector<double> all;
    for (const double rad : drawn_rad())
      all.push_back(unit_.factor * rad);
    return all;
  }
  /// One number of each Q at these amplitudes.
  [[nodiscard]] std::vector<double> of(double DecayEstimate::*number) const {
    std::vector<double> rad, inverse, drawn;
    for (const QAtAmplitude& at : known_) {
      rad.push_back(at.amplitude_rad);
      inverse.push_back(1.0 / (at.q.*number)); // 0 where an interval is open
    }
    if (!is_smooth()) {
      drawn = std::move(inverse);
    } else {
      const boost::math::interpolators::pchip curve(std::move(rad), std::move(inverse));
      for (const double at : drawn_rad())
        drawn.push_back(curve(at));
    }
    for (double& q : drawn)
      q = 1.0 / q;
    return drawn;
  }

private:
  [[nodiscard]] bool is_smooth() const { return known_.size() >= 4; } // cubics need four points
  [[nodiscard]] std::vector<double> drawn_rad() const {
    constexpr int steps = 64;
    std::vector<double> all;
    if (!is_smooth()) {
      for (const QAtAmplitude& at : known_)
        all.push_back(at.amplitude_rad);
      return all;
    }
    const double first = known_.front().amplitude_rad, last = known_.back().amplitude_rad;
    for (int i = 0; i <= steps; ++i)
      all.push_back(std::lerp(first, last, static_cast<double>(i) / steps));
    return all;
  }

  DisplayUnit unit_;
  std::vector<QAtAmplitude> known_;
};

Series band(const QCurve& curve, const char* label, double DecayEstimate::*low,
            double DecayEstimate::*high, int colour) {
  return {Series::Style::band, label, curve.amplitudes(), {}, curve.of(low),
          curve.of(high),      colour};
}

} // namespace

std::optional<Figure> period_amplitude_figure(const Analysis& data) {
  const bool measured = data.log.has_amplitude;
  const FittedParameter* found = data.fit.find("amplitude_scale");
  const bool is_scaled = found != nullptr && std::isfinite(found->value) && found->value > 0.0;
  const double scale = is_scaled ? found->value : 1.0; // from the log's amplitudes to the true ones
  const std::vector<double>& course = data.fit.model_amplitude_rad;
  if (!data.fit.decay || course.size() != data.beats.size()) return std::nullopt;
  if (!measured && !tells_amplitude(data.fit)) return std::nullopt;
  std::vector<double> amplitude = course;
  for (std::size_t i = 0; measured && i < amplitude.size(); ++i)
    amplitude[i] = data.beats[i].amplitude_rad / scale;
  Stretches points = stretches_of(data, amplitude);
  if (points.period_s.size() < 2) return std::nullopt;
  const double largest = *std::max_element(points.squared_rad2.begin(), points.squared_rad2.end());
  Series curve = theory(T0_of(data.fit, points), gravity_share_of(data.fit), largest);
  Series seen{Series::Style::points,
              points.beats == 1 ? "each period"
                                : fmt::format("means over {} periods", points.beats),
              std::move(points.squared_rad2),
              std::move(points.period_s),
              {},
              {},
              blue};
  return Figure{
      "period-amplitude",
      "Period against squared amplitude",
      std::string(
          "The circular error: a wide swing takes longer, T = T0 (1 + A²/16 + …). The line "
          "is the period of a free pendulum to all orders, with the T0 of the fit; it meets "
          "the axis at T0, the period of small swings. ") +
          (measured && is_scaled
               ? fmt::format("The amplitudes are those of the log over {}, the factor of its "
                             "amplitude column, which the fit has from this very slope: it is no "
                             "test of the theory here.",
                             with_sigma(scale, found->sigma, 4))
           : measured
               ? "Points that leave the line point to amplitudes with a wrong scale, to times "
                 "taken off the vertical, or to a pendulum that is more than a rigid body on a "
                 "fixed axis."
               : "The log has no amplitudes: those of the fit, which come from the times, stand "
                 "in for them, so that the slope is no test here, only the scatter."),
      {"squared amplitude", "rad²"},
      {"period", "s"},
      {std::move(seen), std::move(curve)}};
}

std::optional<Figure> q_figure(const FitSummary& fit) {
  if (!fit.decay) return std::nullopt;
  const QCurve curve(*fit.decay);
  if (curve.size() < 2) return std::nullopt;
  return Figure{
      "q-amplitude",
      "Quality factor against amplitude",
      "2π times the energy of the swing over the energy lost in a period, with its 68 % and "
      "95 % intervals, whichever law the friction has. Level: linear friction. Falling to "
      "the right: drag that grows with the square of the speed. Falling to the left: dry "
      "friction.",
      {"amplitude", std::string(curve.unit().name)},
      {"Q", ""},
      {band(curve, "95 %", &DecayEstimate::low95, &DecayEstimate::high95, green),
       band(curve, "68 %", &DecayEstimate::low68, &DecayEstimate::high68, blue),
       {Series::Style::line,
        "Q",
        curve.amplitudes(),
        curve.of(&DecayEstimate::value),
        {},
        {},
        vermilion}}};
}

} // namespace goingrate
