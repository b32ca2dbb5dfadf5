#include "goingrate/report/tables.hpp"

#include "goingrate/spectra/noise_type.hpp"
#include "goingrate/spectra/stability_reading.hpp"

#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace goingrate {

namespace {

std::string rms_line(const char* name, const RmsEstimate& rms, double factor, const char* unit) {
  if (std::isnan(rms.rms)) return fmt::format("  {:<22} not determined\n", name);
  if (rms.low68 == 0.0)
    return fmt::format("  {:<22} at most {:.3g} {}\n", name, rms.high68 * factor, unit);
  return fmt::format("  {:<22} {:.3g} {} ({:.3g} to {:.3g})\n", name, rms.rms * factor, unit,
                     rms.low68 * factor, rms.high68 * factor);
}

// A time as a person says it: 90 s, 15 min, 2.5 h, 3 d.
std::string time_in_words(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 7200.0) return fmt::format("{:.3g} min", seconds / 60.0);
  if (seconds < 172800.0) return fmt::format("{:.3g} h", seconds / 3600.0);
  return fmt::format("{:.3g} d", seconds / 86400.0);
}

const char* what_noise_means(int alpha) {
  if (alpha >= 2) return "the jitter of the readings rules; a longer average tells the rate better";
  if (alpha == 1) return "slowly varying errors of the readings rule";
  if (alpha == 0)
    return "the rate is random from one moment to the next: averaging helps as 1/sqrt(tau)";
  if (alpha == -1) return "averaging longer does not tell the rate any better";
  if (alpha == -2)
    return "the clock wanders like a random walk of rate: look for slow causes such as temperature";
  return "the rate drifts: look for a steady cause before reading anything else";
}

std::string region_line(const SlopeRegion& region) {
  if (std::isnan(region.slope)) return {}; // one row of its own is as often chance as not
  return fmt::format("From {} to {} (slope {:+.2g}, {}): {}.\n", time_in_words(region.from_s),
                     time_in_words(region.to_s), region.slope, noise_name(region.alpha),
                     what_noise_means(region.alpha));
}

// Jitter alone makes sqrt(3) j/tau of an Allan deviation.
std::string floor_line(const DeviationTable& table) {
  const auto jitter = jitter_of(table);
  if (!jitter) return {};
  std::string text = fmt::format("Jitter of the readings, from {}: {:.3g} s.",
                                 time_in_words(table.rows.front().tau_s), *jitter);
  if (table.kind == DeviationKind::adev || table.kind == DeviationKind::oadev)
    text += fmt::format(
        " Alone it would make {:.3g}/tau (tau in s): {:.2g} at {}.", std::sqrt(3.0) * *jitter,
        std::sqrt(3.0) * *jitter / table.rows.back().tau_s, time_in_words(table.rows.back().tau_s));
  return text + "\n";
}

std::string prediction_line(const DeviationTable& table, double after_s, const char* name) {
  const auto p = predict_time_error(table, after_s);
  if (!p) return {};
  std::string text = fmt::format(
      "Expected time error a {} after it was set: {:.2g} s (k tau sigma, k = {:.2g} for {})", name,
      p->error_s, p->k, noise_name(p->alpha));
  if (p->extrapolated)
    text += fmt::format(";\n  extrapolated from {}, as if the noise went on as it is there",
                        time_in_words(p->from_tau_s));
  return text + ".\n";
}

} // namespace

std::string deviation_text(const DeviationTable& table) {
  const bool seconds = is_in_seconds(table.kind);
  std::string text = fmt::format("{}, {}\n", name_of(table.kind),
                                 seconds ? "a time error in seconds"
                                         : "of the relative rate (1e-5 is 0.864 s a day)");
  text += fmt::format("{:>12} {:>9} {:>10} {:>14} {:>12} {:>12}  noise\n", "tau/s", "m", "n",
                      name_of(table.kind), "low 68 %", "high 68 %");
  for (const DeviationRow& row : table.rows) {
    text += fmt::format("{:>12.6g} {:>9} {:>10} {:>14.6e}", row.tau_s, row.m, row.n, row.value);
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
  constexpr std::size_t most = 8; // of a table of all tau the regions would be as many as the rows
  const auto regions = slope_regions(table);
  if (regions.size() <= most)
    for (const SlopeRegion& region : regions)
      text += region_line(region);
  else
    text += fmt::format("The noise type changes {} times along the table: too often for words.\n",
                        regions.size() - 1);
  text += floor_line(table);
  text += prediction_line(table, 86400.0, "day");
  text += prediction_line(table, 7.0 * 86400.0, "week");
  return text;
}

std::string split_text(const std::optional<DriveResponse>& response,
                       const std::optional<DriveSplit>& split) {
  if (!response)
    return "The log does not determine how the clock answers its drive, so fast and slow drive "
           "cannot\n"
           "be told apart. What would help: --fix epsilon=..., mu=..., phi0=... from elsewhere, "
           "an\n"
           "amplitude column, a ring-down, or a deliberate change of the driving weight.\n";
  std::string text = fmt::format(
      "response of the rate to a relative change of drive: {:.4g} at once, {:.4g} in the long run\n"
      "corner between the two: {:.4g} Hz (a period of {:.4g} s)\n",
      response->fast_gain, response->slow_gain, response->corner_hz, 1.0 / response->corner_hz);
  if (!split) return text;
  text += fmt::format("drive, parted at {:.4g} Hz (rms, 68 % interval):\n", split->split_hz);
  text += rms_line("fast (white)", split->fast, 100.0, "%");
  text += rms_line("slow", split->slow, 100.0, "%");
  text += rms_line("jitter of the sensor", split->jitter_s, 1e6, "us");
  if (!split->note.empty()) text += split->note + "\n";
  return text;
}

std::string spectrum_table(const Spectrum& spectrum) {
  std::string text = "frequency_hz,density_per_hz\n";
  for (std::size_t i = 0; i < spectrum.frequency_hz.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g}\n", spectrum.frequency_hz[i],
                   spectrum.density[i]);
  return text;
}

} // namespace goingrate
