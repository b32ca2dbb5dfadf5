// How the numbers of one report are written: a quantity has one unit throughout, chosen by its
// size. Private to the report.
#pragma once

#include "goingrate/analysis/analyse.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace goingrate {

/// A unit of display: the value in this unit is the value in SI units times `factor`.
struct DisplayUnit {
  std::string_view name;
  double factor = 1.0;
};

/// s, h or days: the unit of the time since the first beat, in figures and in words.
DisplayUnit time_unit(double duration_s);

/// mrad, or rad where the free swing is wider than half a radian.
DisplayUnit angle_unit(const Decay& decay);

/// The unit of angles for any fit, by the amplitudes of its model.
DisplayUnit angle_unit(const FitSummary& fit);

/// The parameter in the unit in which it is shown: an angle in that unit instead of rad, a scatter
/// of times in ms, µs or ns, a variation of the drive in %; any other as it is.
FittedParameter in_shown_unit(const DisplayUnit& angle, FittedParameter parameter);

/// A quantity of this fit as it is shown: an angle, and the amplitude that a quantity belongs to,
/// in the unit `angle`; for the mean period, with a remark on what its sigma covers.
DerivedQuantity as_shown(const DisplayUnit& angle, const FitSummary& fit, DerivedQuantity quantity);

/// The words for the numbers of one log.
class Wording {
public:
  explicit Wording(const Analysis& data);

  /// Unit of rates: s/day, or ms/day where all rates of the log are below 1 s/day, or µs/day below
  /// 1 ms/day.
  [[nodiscard]] const DisplayUnit& rate_unit() const { return rate_; }
  /// Unit of Allan deviations: that of rates, or a larger one for deviations that exceed all rates,
  /// as those of neighbouring beats do.
  [[nodiscard]] const DisplayUnit& deviation_unit() const { return deviation_; }
  /// mrad, or rad where the pendulum swings by more than half a radian.
  [[nodiscard]] const DisplayUnit& angle_unit() const { return angle_; }

  /// Whether the log holds readings of a clock, not beats.
  [[nodiscard]] bool is_read() const { return is_read_; }

  /// "+18.42 ± 0.85 s/day".
  [[nodiscard]] std::string rate(double rate_excess, double sigma) const;
  /// "gains 18.42 ± 0.85 s/day" or "loses ...".
  [[nodiscard]] std::string going(double rate_excess, double sigma) const;
  /// The size of a change or of a swing of the rate, without a sign; the sigma is left out if it is
  /// larger than the size.
  [[nodiscard]] std::string size_of_rate(double size, double sigma) const;
  [[nodiscard]] std::string angle(double rad, double sigma) const;
  /// "924 s", "11.1 h".
  [[nodiscard]] std::string duration(double seconds) const;
  /// "300 s after the first beat", or "on 2013-03-31 at 00:03:30" where the log's times are dates; of
  /// readings a day apart the day alone.
  [[nodiscard]] std::string moment(double at_s) const;
  /// "300 s and 900 s after the first beat", or "on 2013-03-31 at 00:03:30 and on ...".
  [[nodiscard]] std::string moments(double first_s, double second_s) const;
  /// "1800 s to 2160 s after the first beat", "2013-03-31 00:03:30 to 00:06:40".
  [[nodiscard]] std::string span(double from_s, double to_s) const;
  /// A moment for a table: "300 s", "2013-03-31 00:03:30".
  [[nodiscard]] std::string short_moment(double at_s) const;
  /// Whether the times of the log are dates.
  [[nodiscard]] bool is_dated() const { return is_dated_; }

private:
  [[nodiscard]] std::string time_since(double at_s) const;
  // The date of the reading nearest to that moment.
  [[nodiscard]] std::string day(double at_s) const;
  // Date and time of day, no finer than the readings tell.
  [[nodiscard]] std::pair<std::string, std::string> dated(double at_s) const;

  DisplayUnit rate_, deviation_, angle_, duration_, moment_;
  Instant first_;
  bool is_dated_ = false, is_read_ = false;
  double spacing_s_ = 0.0;  // of readings a day or more apart, else 0
  double readings_s_ = 0.0; // between readings of a clock; 0 for beats
};

/// The text with its first letter as a capital.
std::string capitalised(std::string text);

/// "a, b or c", with `last_word` before the last.
std::string listed(const std::vector<std::string>& names, std::string_view last_word);

/// The number of sentences in a text; each ends with a full stop or a question mark.
std::size_t sentences_in(std::string_view text);

/// s, ms, µs or ns: the unit in which a scatter or a displacement of times is read most easily.
DisplayUnit short_time_unit(double seconds);

/// rad, mrad or µrad: the unit in which a scatter of angles is read most easily.
DisplayUnit small_angle_unit(double rad);

/// "15.3 µrad".
std::string small_angle(double rad);

/// "33.2 ± 1.1 ns".
std::string short_time(double seconds, double sigma_s);

/// Whether the fit found a pendulum that nothing drives.
bool swings_freely(const Analysis& data);

/// The unit in the denominator of a coefficient of the rate: "K", "mbar", "kg/m³".
std::string unit_of_covariate(const CovariateEffect& effect);

/// The name of a file without its folders, with unprintable characters replaced.
std::string file_name(const std::string& path);

} // namespace goingrate
