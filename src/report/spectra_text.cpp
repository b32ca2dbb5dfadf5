#include "goingrate/report/tables.hpp"

#include "rms_words.hpp"

#include "spectra/noise_type.hpp"
#include "spectra/stability_reading.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <utility>

namespace goingrate {

namespace {

std::string rms_line(const char* name, const RmsEstimate& rms, double factor, const char* unit) {
  const auto number = [](double value) { return fmt::format("{:.3g}", value); };
  return fmt::format("  {:<22} {}\n", name, rms_words(rms, factor, unit, number));
}

// A time in the unit that a person would use: 90 s, 15 min, 2.5 h, 3 d.
std::string time_in_words(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 7200.0) return fmt::format("{:.3g} min", seconds / 60.0);
  if (seconds < 172800.0) return fmt::format("{:.3g} h", seconds / 3600.0);
  return fmt::format("{:.3g} d", seconds / 86400.0);
}

const char* what_noise_means(int alpha) {
  if (alpha >= 2) return "jitter of the readings dominates; a longer average gives a better rate";
  if (alpha == 1) return "the readings err slowly, or the clock returns to its course";
  if (alpha == 0) return "the rate is random from one moment to the next: averaging helps as 1/√τ";
  if (alpha == -1) return "a longer average does not give a better rate";
  if (alpha == -2)
    return "the clock wanders like a random walk of rate: look for slow causes such as temperature";
  return "the rate drifts: look for a steady cause before reading anything else";
}

std::string region_line(const SlopeRegion& region, DeviationKind kind) {
  if (std::isnan(region.slope)) return {}; // a single row may well be chance
  const std::string times =
      fmt::format("From {} to {} ", time_in_words(region.from_s), time_in_words(region.to_s));
  if (!may_be_noise(region, kind))
    return times + fmt::format("(slope {:+.2g}): neighbouring values look like {}, whose slope "
                               "is {:+.2g}. A step or a trend of the rate can do that, or "
                               "something periodic.\n",
                               region.slope, noise_name(region.alpha),
                               slope_of_noise(kind, region.alpha));
  return times + fmt::format("(slope {:+.2g}, {}): {}.\n", region.slope, noise_name(region.alpha),
                             what_noise_means(region.alpha));
}

// Jitter alone gives an Allan deviation of sqrt(3) j/tau.
std::string floor_line(const DeviationTable& table) {
  const auto jitter = jitter_of(table);
  if (!jitter) return {};
  std::string text = fmt::format("Jitter of the readings, from {}: {:.3g} s.",
                                 time_in_words(table.rows.front().tau_s), *jitter);
  if (table.kind == DeviationKind::adev || table.kind == DeviationKind::oadev)
    text += fmt::format(
        " Alone it would make {:.3g}/τ (τ in s): {:.2g} at {}.", std::sqrt(3.0) * *jitter,
        std::sqrt(3.0) * *jitter / table.rows.back().tau_s, time_in_words(table.rows.back().tau_s));
  return text + "\n";
}

std::string prediction_line(const TimePrediction& p, const char* name) {
  std::string text =
      fmt::format("Expected time error a {} after it was set: {:.2g} s (k τ σ, k = {:.2g} for {})",
                  name, p.error_s, p.k, noise_name(p.alpha));
  if (p.extrapolated)
    text +=
        fmt::format("; extrapolated from {}, as if the noise went on as it is there and nothing "
                    "else moved the clock",
                    time_in_words(p.from_tau_s));
  return text + ".\n";
}

// Nothing is predicted from a slope that is not noise, because it need not continue.
std::string prediction_lines(const DeviationTable& table, bool all_noise) {
  std::string text;
  bool left_out = false;
  for (const auto& [name, after_s] : {std::pair{"day", 86400.0}, {"week", 7.0 * 86400.0}}) {
    const auto p = predict_time_error(table, after_s);
    if (!p) continue;
    if (p->extrapolated && !all_noise)
      left_out = true;
    else
      text += prediction_line(*p, name);
  }
  if (left_out)
    text += fmt::format("No time error is predicted beyond {}: noise alone does not explain this "
                        "log.\n",
                        time_in_words(table.rows.back().tau_s));
  return text;
}

} // namespace

std::string deviation_text(const DeviationTable& table) {
  const bool seconds = is_in_seconds(table.kind);
  std::string text = fmt::format("{}, {}\n", name_of(table.kind),
                                 seconds ? "a time error in seconds"
                                         : "of the relative rate (1e-5 is 0.864 s a day)");
  text += fmt::format("{:>12} {:>9} {:>10} {:>14} {:>12} {:>12}  noise\n", "τ/s", "m", "n",
                      name_of(table.kind), "low 68 %", "high 68 %");
  for (const DeviationRow& row : table.rows) {
    text += fmt::format("{:>12.6g} {:>9} {:>10} {:>14}", row.tau_s, row.m, row.n,
                        std::isfinite(row.value) ? fmt::format("{:.6e}", row.value) : "-");
    text += row.interval ? fmt::format(" {:>12.4e} {:>12.4e}  {}\n", row.low, row.high,
                                       noise_name(row.alpha))
                         : fmt::format(" {:>12} {:>12}  -\n", "-", "-");
  }
  if (table.bridged > 0)
    text += fmt::format("{} unknown phases were bridged by straight lines.\n", table.bridged);
  return text;
}

std::string deviation_findings(const DeviationTable& table) {
  std::string text;
  constexpr std::size_t most_regions = 8; // a table of all tau could have as many regions as rows
  const auto regions = slope_regions(table);
  const bool all_noise =
      std::all_of(regions.begin(), regions.end(),
                  [&](const SlopeRegion& region) { return may_be_noise(region, table.kind); });
  if (regions.size() <= most_regions)
    for (const SlopeRegion& region : regions)
      text += region_line(region, table.kind);
  else
    text += fmt::format("The noise type changes {} times along the table: too often for words.\n",
                        regions.size() - 1);
  text += floor_line(table);
  text += prediction_lines(table, all_noise);
  return wrapped(text, line_columns, 2);
}

namespace {

std::string cost_lines(const DriveSplit& split) {
  std::string text = "time error to expect of them (rms, 68 % interval):\n";
  for (const DriveCost& cost : split.costs) {
    const std::string after = fmt::format("after {:.6g} d", cost.after_s / 86400.0);
    text += rms_line((after + ", fast").c_str(), cost.fast_s, 1.0, "s");
    text += rms_line((after + ", slow").c_str(), cost.slow_s, 1.0, "s");
  }
  return text;
}

std::string split_lines(const DriveSplit& split) {
  std::string text =
      split.at_frequency
          ? fmt::format("drive, above and below {:.4g} Hz (rms, 68 % interval):\n", split.split_hz)
          : std::string("drive (rms, 68 % interval):\n");
  text += rms_line(split.at_frequency ? "above" : "fast, white", split.fast, 100.0, "%");
  text += rms_line(split.at_frequency ? "below" : "slow, with a memory", split.slow, 100.0, "%");
  if (std::isfinite(split.slow_time_s))
    text += fmt::format("  {:<22} {:.3g} s (log L greater by {:.3g} than without)\n",
                        "memory of the slow part", split.slow_time_s, split.slow_gain);
  text += rms_line("jitter of the sensor", split.jitter_s, 1e6, "µs");
  if (!split.costs.empty()) text += cost_lines(split);
  if (!split.note.empty()) text += split.note + "\n";
  return text;
}

// The expected periods that a line may have, itself or as a harmonic, within its resolution.
std::string label_of(const SpectralLine& line, double resolution_hz,
                     std::span<const ExpectedPeriod> expected) {
  std::string label;
  constexpr int harmonics = 5;
  for (const ExpectedPeriod& e : expected)
    for (int n = 1; n <= harmonics; ++n) {
      if (std::abs(line.frequency_hz - n / e.period_s) > resolution_hz) continue;
      label += fmt::format("{}{}{}{}", label.empty() ? "  " : ", or ", e.kind,
                           e.place > 0 ? fmt::format(" {}", e.place) : "",
                           n > 1 ? fmt::format(" ({} times as fast)", n) : "");
      break;
    }
  return label;
}

std::string line_lines(const DriveAnalysis& drive, std::span<const ExpectedPeriod> expected) {
  std::string text;
  if (!expected.empty()) {
    text += "periods to expect:\n";
    for (const ExpectedPeriod& e : expected)
      text += fmt::format("  {:>12.6g} s  {}{}\n", e.period_s, e.kind,
                          e.place > 0 ? fmt::format(" {}", e.place) : "");
  }
  if (drive.lines.empty()) return text + "no strictly periodic part stands out of the rate\n";
  text += fmt::format("periodic parts of the rate:\n  {:>12} {:>12} {:>10} {:>12}\n", "period/s",
                      "rate", drive.response ? "drive/%" : "", "false alarm");
  for (std::size_t i = 0; i < drive.lines.size(); ++i) {
    const SpectralLine& line = drive.lines[i];
    const auto label = [&](const SpectralLine& l) {
      return label_of(l, drive.rate_spectrum->resolution_hz, expected);
    };
    const std::string name = label(line);
    // A line with a name of its own, such as a tide close to half a day, may not be a sideband.
    if (line.sideband_of && (name.empty() || name == label(drive.lines[*line.sideband_of])))
      continue;
    text += fmt::format(
        "  {:>12.7g} {:>12.3g} {:>10} {:>12.2g}{}\n", 1.0 / line.frequency_hz, line.amplitude,
        drive.response ? fmt::format("{:.3g}", 100.0 * drive_of(line, *drive.response)) : "",
        line.false_alarm, name);
    if (const std::string sidebands = sideband_text(drive.lines, i); !sidebands.empty())
      text += fmt::format("  {:>12} {}\n", "", sidebands);
  }
  return text;
}

} // namespace

std::string sideband_text(const std::vector<SpectralLine>& lines, std::size_t main_line) {
  std::size_t count = 0;
  double largest = 0.0;
  for (const SpectralLine& line : lines) {
    if (line.sideband_of != main_line) continue;
    ++count;
    largest = std::max(largest, line.amplitude);
  }
  if (count == 0) return {};
  return fmt::format("and {} beside it, of up to {:.2g} % of it: it changes with time", count,
                     100.0 * largest / lines[main_line].amplitude);
}

std::string drive_text(const DriveAnalysis& drive, std::span<const ExpectedPeriod> expected) {
  std::string text;
  if (drive.response)
    text =
        fmt::format("response of the rate to a relative change of drive:\n  {:.4g} at once, {:.4g} "
                    "in the long run\ncorner between the two: {:.4g} Hz (a period of {:.4g} s)\n",
                    drive.response->fast_gain, drive.response->slow_gain, drive.response->corner_hz,
                    1.0 / drive.response->corner_hz);
  else if (drive.swings_freely)
    text = "The pendulum swings freely: there is no drive to split.\n";
  else
    text = fmt::format("The log does not determine how the clock answers its drive, so fast and "
                       "slow drive cannot be told apart. What would help: ε, μ and φ0 known from "
                       "elsewhere, {}a ring-down, or a deliberate change of the driving weight.\n",
                       drive.sees_amplitude ? "" : "an amplitude column, ");
  if (drive.split) text += split_lines(*drive.split);
  return wrapped(text + line_lines(drive, expected), line_columns, 2);
}

std::string spectrum_table(const DriveAnalysis& drive) {
  const Spectrum& spectrum = *drive.rate_spectrum;
  const bool parts = drive.split && drive.split->fast_density.size() == spectrum.density.size();
  std::string text =
      parts ? "frequency_hz,density_per_hz,fast,slow,jitter\n" : "frequency_hz,density_per_hz\n";
  for (std::size_t i = 0; i < spectrum.frequency_hz.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g}", spectrum.frequency_hz[i],
                   spectrum.density[i]);
    if (parts)
      fmt::format_to(std::back_inserter(text), ",{:.9g},{:.9g},{:.9g}",
                     drive.split->fast_density[i], drive.split->slow_density[i],
                     drive.split->jitter_density[i]);
    text += '\n';
  }
  return text;
}

std::string tapered_table(const Spectrum& spectrum) {
  const DensityInterval interval = density_interval(spectrum.degrees_of_freedom);
  std::string text = "frequency_hz,density_per_hz,low,high\n";
  for (std::size_t i = 0; i < spectrum.frequency_hz.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g},{:.9g},{:.9g}\n",
                   spectrum.frequency_hz[i], spectrum.density[i],
                   spectrum.density[i] * interval.low, spectrum.density[i] * interval.high);
  return text;
}

std::string coherence_table(const CrossSpectrum& cross) {
  std::string text = "frequency_hz,coherence,gain,phase_rad,significant\n";
  for (std::size_t i = 0; i < cross.frequency_hz.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.9g},{:.6g},{:.6g},{:.6g},{:.4g}\n",
                   cross.frequency_hz[i], cross.coherence[i], cross.gain[i], cross.phase_rad[i],
                   cross.significant);
  return text;
}

std::string gapped_table(const GappedPeriodogram& periodogram) {
  std::string text = "frequency_hz,power,window\n";
  for (std::size_t i = 0; i < periodogram.frequency_hz.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g},{:.9g}\n", periodogram.frequency_hz[i],
                   periodogram.power[i], periodogram.window[i]);
  return text;
}

std::string profile_table(const FoldedProfile& profile) {
  std::string text = "phase,rate,sigma\n";
  for (std::size_t i = 0; i < profile.phase.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.6g},{},{}\n", profile.phase[i],
                   std::isnan(profile.mean[i]) ? "" : fmt::format("{:.9g}", profile.mean[i]),
                   std::isnan(profile.sigma[i]) ? "" : fmt::format("{:.3g}", profile.sigma[i]));
  return text;
}

} // namespace goingrate
