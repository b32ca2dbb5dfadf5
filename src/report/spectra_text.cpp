#include "goingrate/report/tables.hpp"

#include "goingrate/spectra/noise_type.hpp"

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

} // namespace

std::string deviation_text(const DeviationTable& table) {
  std::string text = fmt::format("{:>12} {:>9} {:>10} {:>14} {:>12} {:>12}  noise\n", "tau/s", "m",
                                 "n", name_of(table.kind), "low 68 %", "high 68 %");
  for (const DeviationRow& row : table.rows) {
    text += fmt::format("{:>12.6g} {:>9} {:>10} {:>14.6e}", row.tau_s, row.m, row.n, row.value);
    text += row.interval ? fmt::format(" {:>12.4e} {:>12.4e}  {}\n", row.low, row.high,
                                       noise_name(row.alpha))
                         : fmt::format(" {:>12} {:>12}  -\n", "-", "-");
  }
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
