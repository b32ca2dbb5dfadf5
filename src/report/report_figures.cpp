#include "report_figures.hpp"
#include "palette.hpp"

#include "figure_axes.hpp"
#include "wording.hpp"

#include "base/scaled_time.hpp"
#include "base/special_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <span>
#include <utility>

namespace goingrate {

namespace {

// A unit with a prefix: the value in this unit is the value in SI units times `factor`.
struct Unit {
  std::string name;
  double factor = 1.0;
};

double largest_size(std::span<const double> values) {
  double largest = 0.0;
  for (const double value : values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return largest;
}

// µ, m or nothing before the unit, so that the largest value is above one or so.
Unit prefixed(const std::string& unit, std::span<const double> values) {
  const double largest = largest_size(values);
  if (largest < 2e-3) return {"µ" + unit, 1e6};
  if (largest < 2.0) return {"m" + unit, 1e3};
  return {unit, 1.0};
}

std::vector<double> scaled(std::span<const double> values, double factor) {
  std::vector<double> result(values.begin(), values.end());
  for (double& value : result)
    value *= factor;
  return result;
}

class TimeFigures {
public:
  explicit TimeFigures(const Analysis& data)
      : data_(data), words_(data), unit_(time_unit(data.rate.duration_s)) {
    for (const Beat& beat : data.beats)
      time_.push_back((beat.time - data.beats.front().time) * unit_.factor);
    for (const Change& change : data.diary.changes)
      markers_.push_back({change.at_s * unit_.factor, std::to_string(markers_.size() + 1)});
  }

  [[nodiscard]] Figure rate() const;
  [[nodiscard]] Figure error() const;
  [[nodiscard]] Figure amplitude() const;
  [[nodiscard]] Figure time_residual() const;
  [[nodiscard]] Figure amplitude_residual() const;
  [[nodiscard]] std::optional<Figure> drive() const {
    return drive_figure(data_, time_axis(), unit_.factor, markers_);
  }

private:
  [[nodiscard]] Axis time_axis() const {
    return {"time since the first beat", std::string(unit_.name)};
  }
  [[nodiscard]] Series running_mean(std::span<const double> error) const;
  [[nodiscard]] std::size_t end_of_stretch(std::size_t begin) const;
  [[nodiscard]] Series against_time(Series::Style style, std::string label, std::vector<double> y,
                                    int colour) const {
    return {style, std::move(label), time_, std::move(y), {}, {}, colour};
  }

  const Analysis& data_;
  Wording words_;
  DisplayUnit unit_;
  std::vector<double> time_;
  std::vector<Marker> markers_;
};

// The mean rate over a window is the error gained in it divided by its length: no sum is needed.
// A window ends where a change of the rate is dated, so that the line shows it as sharp as it was.
Series TimeFigures::running_mean(std::span<const double> error) const {
  constexpr std::size_t windows = 100;     // in the length of the log
  constexpr std::size_t fewest_beats = 10; // beats
  const std::size_t reach = std::max(fewest_beats, data_.beats.size() / windows) / 2;
  Series mean{Series::Style::line, "", {}, {}, {}, {}, vermilion};
  if (data_.beats.size() < 4 * fewest_beats) return mean;
  std::size_t begin = 0, end = end_of_stretch(0);
  for (std::size_t i = reach; i + reach < data_.beats.size(); ++i) {
    while (i > end)
      end = end_of_stretch(begin = end);
    const std::size_t from = std::max(begin, i - reach);
    const std::size_t to = std::min(end, i + reach);
    const double elapsed = data_.beats[to].time - data_.beats[from].time;
    mean.x.push_back(time_[i]);
    mean.y.push_back(words_.rate_unit().factor * (error[to] - error[from]) / elapsed);
  }
  mean.label = fmt::format("mean over {} beats", 2 * reach);
  return mean;
}

// The last beat of the stretch of one rate that begins with beat `begin`.
std::size_t TimeFigures::end_of_stretch(std::size_t begin) const {
  const auto next =
      std::find_if(data_.stretches.begin(), data_.stretches.end(), [&](const PartRate& part) {
        return part.from_cycle > data_.beats[begin].cycle;
      });
  if (next == data_.stretches.end()) return data_.beats.size() - 1;
  const auto at =
      std::lower_bound(data_.beats.begin(), data_.beats.end(), next->from_cycle,
                       [](const Beat& beat, std::int64_t cycle) { return beat.cycle < cycle; });
  return static_cast<std::size_t>(at - data_.beats.begin());
}

Figure TimeFigures::rate() const {
  const double nominal = data_.rate.nominal_period_s;
  const auto rates = rate_per_period(data_.beats, nominal);
  Series points{Series::Style::points,
                "each period",
                {},
                scaled(rates, words_.rate_unit().factor),
                {},
                {},
                blue};
  for (std::size_t i = 1; i < time_.size(); ++i)
    points.x.push_back(0.5 * (time_[i - 1] + time_[i]));
  Figure figure{
      "rate",
      "Rate against time",
      "Above zero the clock gains; the cloud is the rate of every single period (where it is "
      "dense, a stroke holds most of it and dots the extremes), the line its running "
      "mean, and a numbered vertical line marks a change in the diary.",
      time_axis(),
      {"rate", std::string(words_.rate_unit().name)},
      {std::move(points)},
      markers_};
  Series mean = running_mean(clock_error(data_.beats, nominal));
  if (!mean.x.empty()) figure.series.push_back(std::move(mean));
  return figure;
}

Figure TimeFigures::error() const {
  const auto error = clock_error(data_.beats, data_.rate.nominal_period_s);
  const Unit unit = prefixed("s", error);
  return {"error",
          "Clock error against time",
          "What the hands would show against true time since the first beat: a steady rate is a "
          "straight line, a change of rate a bend, and a lost or gained second a step.",
          time_axis(),
          {"clock error, positive if fast", unit.name},
          {against_time(Series::Style::line, "clock error", scaled(error, unit.factor), blue)},
          markers_};
}

Figure TimeFigures::amplitude() const {
  std::vector<double> amplitude;
  for (const Beat& beat : data_.beats)
    amplitude.push_back(words_.angle_unit().factor * beat.amplitude_rad);
  Figure figure{
      "amplitude",
      "Amplitude against time",
      "How far the pendulum swings from the vertical at each beat, with the fitted model: "
      "where the two part, something acted on the pendulum that the model does not know.",
      time_axis(),
      {"amplitude", std::string(words_.angle_unit().name), data_.fit.decay.has_value()},
      {},
      markers_};
  if (data_.log.has_amplitude)
    figure.series.push_back(
        against_time(Series::Style::points, "measured", std::move(amplitude), blue));
  else
    figure.caption = "How far the pendulum swings from the vertical by the fitted model: the log "
                     "has no amplitudes, and the times tell them by the circular error.";
  if (data_.fit.decay)
    figure.caption += " On this scale linear friction gives a straight line; drag bends it up, dry "
                      "friction down.";
  const auto& model = data_.fit.model_amplitude_rad;
  if (tells_amplitude(data_.fit) && model.size() == time_.size())
    figure.series.push_back(against_time(Series::Style::line, "model",
                                         scaled(model, words_.angle_unit().factor), vermilion));
  else
    figure.caption = "How far the pendulum swings from the vertical at each beat.";
  return figure;
}

Figure TimeFigures::time_residual() const {
  const Unit unit = prefixed("s", data_.fit.residual_s);
  const ModelChoice& model = data_.fit.model;
  const bool wanders = model.walk || model.drive || model.slow;
  return {
      "time-residual",
      "Residuals of the times",
      fmt::format("What the fitted clock, going evenly, leaves of each beat's time (positive: the "
                  "beat came late): {}",
                  wanders ? "here the model's drive or rate wanders as well, so that a wave or a "
                            "bend may be that wander."
                          : "a cloud without shape means that the model explains the log, a wave "
                            "or a bend that it does not."),
      time_axis(),
      {"residual of time", unit.name},
      {against_time(Series::Style::points, "residual", scaled(data_.fit.residual_s, unit.factor),
                    blue)},
      markers_};
}

Figure TimeFigures::amplitude_residual() const {
  const Unit unit = prefixed("rad", data_.fit.amplitude_residual_rad);
  return {"amplitude-residual",
          "Residuals of the amplitudes",
          "Measured amplitude minus that of the fitted model; read it like the figure before.",
          time_axis(),
          {"residual of amplitude", unit.name},
          {against_time(Series::Style::points, "residual",
                        scaled(data_.fit.amplitude_residual_rad, unit.factor), blue)},
          markers_};
}

Series spectrum_line(std::string label, const std::vector<double>& frequency,
                     const std::vector<double>& density, int colour) {
  BinnedSpectrum binned = log_binned(frequency, density);
  return {Series::Style::line,
          std::move(label),
          std::move(binned.frequency_hz),
          std::move(binned.density),
          {},
          {},
          colour};
}

// Cuts off the part of a model's line that is far below everything measured: it would only stretch
// the axis.
Series without_depths(Series part, const Series& measured) {
  constexpr double depth = 0.03;
  if (measured.y.empty()) return part;
  const double least = depth * *std::min_element(measured.y.begin(), measured.y.end());
  for (double& density : part.y)
    if (density < least) density = std::numeric_limits<double>::quiet_NaN();
  return part;
}

Figure spectrum_figure(const Analysis& data) {
  const auto& frequency = data.drive.rate_spectrum->frequency_hz;
  Figure figure{"spectrum",
                "Spectrum of the rate",
                "How strongly the rate fluctuates at each frequency, slow wander on the left and "
                "changes from beat to beat on the right; a narrow peak is something periodic.",
                {"frequency", "Hz", true},
                {"density of the rate", "1/Hz", true},
                {spectrum_line("measured", frequency, data.drive.rate_spectrum->density, blue)}};
  if (data.drive.split && data.drive.split->fast_density.size() == frequency.size() &&
      data.drive.split->jitter_density.size() == frequency.size()) {
    const Series measured = figure.series.front();
    figure.series.push_back(without_depths(
        spectrum_line("fast drive", frequency, data.drive.split->fast_density, vermilion),
        measured));
    if (data.drive.split->slow_time_s > 0.0)
      figure.series.push_back(without_depths(
          spectrum_line("slow drive", frequency, data.drive.split->slow_density, purple),
          measured));
    figure.series.push_back(without_depths(
        spectrum_line("jitter of the sensor", frequency, data.drive.split->jitter_density, green),
        measured));
    figure.caption += " The broken lines are the parts that fast and slow noise of the drive and "
                      "the sensor's jitter explain.";
  }
  if (data.drive.response) {
    figure.markers.push_back({data.drive.response->corner_hz, "corner"});
    figure.caption += " Left of the corner the amplitude follows the drive, right of it the "
                      "amplitude does not change.";
  }
  return figure;
}

// sqrt(3) j / tau: the deviation that white jitter j of the sensor alone would give.
Series jitter_floor(const Series& measured, double jitter_s) {
  Series floor{Series::Style::line, "jitter of the sensor alone", {}, {}, {}, {}, green};
  for (const double tau : measured.x) {
    floor.x.push_back(tau);
    floor.y.push_back(std::sqrt(3.0) * jitter_s / tau);
  }
  return floor;
}

std::string_view kind_in_words(DeviationKind kind) {
  constexpr std::array<std::string_view, deviation_kinds.size()> names = {
      "Allan deviation",
      "overlapping Allan deviation",
      "modified Allan deviation",
      "time deviation",
      "Hadamard deviation",
      "overlapping Hadamard deviation",
      "total deviation",
      "modified total deviation",
      "time total deviation",
      "Hadamard total deviation",
      "Theo1 deviation",
      "TheoH deviation",
      "maximum time interval error",
      "rms time interval error",
      "parabolic deviation",
  }; // in the order of deviation_kinds
  return names[static_cast<std::size_t>(kind)];
}

Figure deviation_figure(const Analysis& data) {
  Series bars{Series::Style::bars, "deviation", {}, {}, {}, {}, blue};
  for (const DeviationRow& row : data.deviation.rows) {
    if (!std::isfinite(row.value)) continue;
    bars.x.push_back(row.tau_s);
    bars.y.push_back(row.value);
    bars.low.push_back(row.interval ? row.low : not_known);
    bars.high.push_back(row.interval ? row.high : not_known);
  }
  const DeviationKind kind = data.deviation.kind;
  const bool usual = kind == DeviationKind::oadev;
  Figure figure{
      "deviation",
      fmt::format("Stability ({})", kind_in_words(kind)),
      usual
          ? "By how much the rate, averaged over τ, typically differs from one such stretch to the "
            "next (bars: 68 %; 10⁻⁵ is 0.86 s a day): where the points fall, a longer average "
            "tells "
            "the rate better (like 1/τ: the sensor's jitter limits; like 1/√τ: random rate); where "
            "they are flat it does not; and where they rise the clock itself wanders, so look for "
            "slow causes such as temperature."
          : "The deviation against the averaging time (bars: 68 %).",
      {"averaging time τ", "s", true},
      {std::string(kind_in_words(kind)), is_in_seconds(kind) ? "s" : "", true},
      {std::move(bars)}};
  if (usual && data.fit.has_result() && data.fit.jitter_s > 0.0) {
    figure.series.push_back(without_depths(jitter_floor(figure.series.front(), data.fit.jitter_s),
                                           figure.series.front()));
    figure.caption +=
        " The line is the deviation √3 j/τ of a perfect clock with the fitted jitter.";
  }
  return figure;
}

void add(std::vector<Figure>& figures, std::optional<Figure> figure) {
  if (figure) figures.push_back(std::move(*figure));
}

// The rates of single periods may be thousands of times the log's mean rate, and then need a larger
// unit.
std::optional<Figure> in_unit_of_its_rates(std::optional<Figure> figure) {
  constexpr double longest_number = 1e4; // five digits
  constexpr std::array<std::string_view, 3> units{"µs/day", "ms/day", "s/day"};
  if (!figure) return figure;
  const auto* unit = std::find(units.begin(), units.end(), figure->y.unit);
  const auto is_long = [&] {
    const AxisScale axis = figure_axes(*figure).y;
    return std::max(std::abs(axis.from), std::abs(axis.to)) >= longest_number;
  };
  for (; unit != units.end() && unit + 1 != units.end() && is_long(); ++unit) {
    figure->y.unit = *(unit + 1);
    for (Series& series : figure->series)
      for (double& rate : series.y)
        rate *= 1e-3;
  }
  return figure;
}

// The figures that share a time axis, then those with an axis of their own.
void add_time_figures(const Analysis& data, bool fitted, std::vector<Figure>& figures) {
  const TimeFigures of_time(data);
  add(figures, in_unit_of_its_rates(of_time.rate()));
  if (data.log.has_amplitude || data.fit.decay) figures.push_back(of_time.amplitude());
  if (fitted && data.fit.residual_s.size() == data.beats.size())
    figures.push_back(of_time.time_residual());
  if (tells_amplitude(data.fit) && data.fit.amplitude_residual_rad.size() == data.beats.size())
    figures.push_back(of_time.amplitude_residual());
  for (Figure& figure : figures)
    figure.group = "course";
  if (!swings_freely(data)) { // a free swing keeps no time
    figures.push_back(of_time.error());
    add(figures, in_unit_of_its_rates(rate_amplitude_figure(data)));
  }
  add(figures, period_amplitude_figure(data));
  add(figures, q_figure(data.fit));
  if (fitted) add(figures, of_time.drive());
}

} // namespace

BinnedSpectrum log_binned(const std::vector<double>& frequency_hz,
                          const std::vector<double>& density, int per_decade) {
  BinnedSpectrum binned;
  const double ratio = std::pow(10.0, 1.0 / per_decade);
  double first = 0.0, log_sum = 0.0, sum = 0.0, count = 0.0;
  const auto close = [&] {
    if (count == 0.0) return;
    binned.frequency_hz.push_back(std::exp(log_sum / count));
    binned.density.push_back(sum / count);
    log_sum = sum = count = 0.0;
  };
  for (std::size_t i = 0; i < frequency_hz.size() && i < density.size(); ++i) {
    if (!(frequency_hz[i] > 0.0) || !std::isfinite(density[i])) continue;
    if (count > 0.0 && frequency_hz[i] >= first * ratio) close();
    if (count == 0.0) first = frequency_hz[i];
    log_sum += std::log(frequency_hz[i]);
    sum += density[i];
    ++count;
  }
  close();
  return binned;
}

std::vector<Figure> report_figures(const Analysis& data) {
  std::vector<Figure> figures;
  const bool fitted = data.fit.has_result();
  if (data.beats.size() > 1) add_time_figures(data, fitted, figures);
  if (data.drive.rate_spectrum && data.drive.rate_spectrum->frequency_hz.size() > 1)
    figures.push_back(spectrum_figure(data));
  if (!data.deviation.rows.empty() && !swings_freely(data))
    figures.push_back(deviation_figure(data));
  add(figures, beat_figure(data.log));
  if (fitted) add(figures, correlation_figure(data.fit));
  if (fitted) add(figures, interval_figure(data.fit));
  if (fitted) add(figures, profile_figure(data.fit));
  return figures;
}

bool tells_amplitude(const FitSummary& fit) {
  const FittedParameter* first = fit.find("lambda0");
  return fit.has_result() && (first == nullptr || first->status != ParameterStatus::undetermined);
}

} // namespace goingrate
