// Results as text: tables for programs (CSV) and summaries for people.
#pragma once

#include "goingrate/drive/drive_history.hpp"
#include "goingrate/drive/drive_split.hpp"
#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/log/amplitude.hpp"
#include "goingrate/log/beats.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/spectra/multitaper.hpp"
#include "goingrate/spectra/stability.hpp"

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

class DecimalText;

/// A value with its uncertainty, rounded to two digits of the uncertainty: "2.00031 ± 0.00012",
/// "(2.49995 ± 0.00021)×10⁻⁴".
/// A sigma of 0 or NaN gives the value alone, with `digits` digits.
std::string with_sigma(double value, double sigma, int digits = 6);

/// Width of a terminal by tradition, to which text for people is wrapped.
inline constexpr std::size_t line_columns = 80;

/// The text with its lines broken at blanks so that none has more than `width` characters (UTF-8);
/// a continuation line is indented like the line it continues and by `hanging` more. A word that is
/// too long is broken after a comma, or not at all.
std::string wrapped(std::string_view text, std::size_t width, std::size_t hanging = 0);

/// The per-period table as CSV, row by row:
/// cycle,time_s,period_s,rate_excess,rate_s_per_day,amplitude_rad,flags, and after these, where the
/// log has them, rate_excess_at_zero_amplitude (without the circular error), running_rate_excess
/// (over the number of cycles asked for), sigma_s, width_s, temperature_c, pressure_mbar. Every
/// event has a row; so has a missing beat, without times and flagged `missed`, but a run of more
/// than `rows_per_gap` missing beats has one row flagged `gap`. A period after missing beats is the
/// mean over the cycles since the last beat. The first beat after a split is flagged `split`, or
/// `step` where the reference clock was set.
class RateTable {
public:
  /// Which columns there are, and what their values depend on.
  struct Options {
    double nominal_period_s = 0.0;
    bool amplitudes = false;         ///< adds rate_excess_at_zero_amplitude
    std::int64_t running_cycles = 0; ///< length of running_rate_excess; 0: none
    std::int64_t step = 1;           ///< cycles from one event to the next where none is missing
    double gravity_share = 1.0;      ///< of the restoring torque, for the circular error
  };
  /// `columns` and `gaps` are those of the log and must outlive the table.
  RateTable(const Options& options, const EventColumns& columns, const std::vector<Gap>& gaps);

  /// The first line.
  [[nodiscard]] std::string header() const;
  /// Appends the row of the i-th event, after those of the cycles missed before it. Events come in
  /// order.
  void append(std::string& text, const Beat& beat, std::size_t i);
  /// The events that follow are of the next part of the log, with these columns and gaps.
  void go_on(const EventColumns& columns, const std::vector<Gap>& gaps);

private:
  void append_bad(DecimalText& line, const Beat& beat, std::size_t i);
  void append_good(DecimalText& line, const Beat& beat, std::size_t i);
  double append_period(DecimalText& line, const Beat& beat) const;
  void append_missing(std::string& text, std::int64_t from, std::int64_t to) const;
  void append_extras(DecimalText& line, const Beat* beat, double rate, std::size_t i);
  [[nodiscard]] double running_rate(const Beat& beat);
  bool is_step_after(std::int64_t cycle);

  Options options_;
  const EventColumns* columns_;
  const std::vector<Gap>* gaps_;
  std::size_t gap_ = 0;
  std::size_t extras_ = 0;
  std::optional<Beat> last_;
  std::deque<Beat> recent_; // beats within the running rate
};

/// The whole table of a log without other columns.
std::string rate_table(const Beats& beats, double nominal_period_s);

/// Rates of blocks as CSV: segment,from_cycle,to_cycle,time_s,duration_s,rate_excess,sigma,
/// rate_s_per_day,amplitude_rad.
std::string block_table(const std::vector<PartRate>& blocks);

/// A few lines: the number of beats, the duration, the rate and its uncertainty, the beat error (s)
/// if known, the other segments. Values at equal intervals have no period unless the log or its
/// owner states one: `has_period` is then false.
std::string rate_text(const Beats& beats, const RateSummary& summary,
                      const SensorFindings& sensor = {}, bool has_period = true);

/// The fit in the layout of other fitting programs: statistics, variables, correlations above 0.1,
/// undetermined parameters, the models that were tried.
std::string fit_text(const FitSummary& fit);

/// How the swing of a free pendulum dies away, in a few plain sentences.
std::string decay_sentences(const Decay& decay);

/// The sentences of decay_sentences(), and a table of Q at each amplitude.
std::string decay_text(const Decay& decay);

/// The parameters as a LaTeX table (tabular with booktabs): value and sigma rounded to two digits
/// of sigma, the ends of the 95 % interval where sigma alone would mislead, and "undetermined"
/// where there is no value.
std::string fit_latex(const FitSummary& fit);

/// The parameters as CSV with all digits: name,value,sigma,low68,high68,low95,high95,unit,status;
/// a field is empty if there is no number, or if an interval is open on that side.
std::string fit_csv(const FitSummary& fit);

/// Whether the 95 % interval is so asymmetric, or open, that sigma alone would mislead.
bool is_lopsided(const FittedParameter& parameter);

/// The word for the status in tables and JSON.
std::string_view name_of(ParameterStatus status);

/// The course of the drive as CSV: time_s,relative_drive,sigma.
std::string drive_table(const DriveHistory& history);

/// The deviation as a table: tau, averaging factor, count, value, 68 % interval, noise type.
std::string deviation_text(const DeviationTable& table);

/// What the table shows, in lines of at most 80 columns: the regions of one noise type each, or of
/// a slope that is no noise's; the jitter; and the time error to expect after a day and a week,
/// marked if it is extrapolated. For a log that holds more than noise, nothing is predicted beyond
/// the table.
std::string deviation_findings(const DeviationTable& table);

/// "and 2 beside it, of up to 25 % of it: it changes with time" for a line with sidebands among
/// `lines`; empty for a line without.
std::string sideband_text(const std::vector<SpectralLine>& lines, std::size_t main_line);

/// What the spectrum shows about drive, jitter and lines, in a few lines; a line whose period is
/// among `expected` is labelled with its name.
std::string drive_text(const DriveAnalysis& drive, std::span<const ExpectedPeriod> expected = {});

/// The spectrum as CSV: frequency_hz,density_per_hz, and the fitted parts fast,slow,jitter if
/// known.
std::string spectrum_table(const DriveAnalysis& drive);

/// A spectrum with its 68 % intervals as CSV: frequency_hz,density_per_hz,low,high.
std::string tapered_table(const Spectrum& spectrum);

/// The coherence of two series as CSV: frequency_hz,coherence,gain,phase_rad,significant.
std::string coherence_table(const CrossSpectrum& cross);

/// A periodogram of a series with gaps as CSV: frequency_hz,power,window.
std::string gapped_table(const GappedPeriodogram& periodogram);

/// A folded profile as CSV: phase,rate,sigma.
std::string profile_table(const FoldedProfile& profile);

} // namespace goingrate
