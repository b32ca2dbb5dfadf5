// Reading logs.
#pragma once

#include "goingrate/base/errors.hpp"
#include "goingrate/log/clock_log.hpp"

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// The default limit of bytes that a packed file may unpack to: six years of beats per second. A
/// few megabytes of gzip can hold a thousand times as much.
inline constexpr std::uint64_t usual_unpacked_limit = std::uint64_t{4} << 30;

/// The assumed error of the sampling rate of a telephone or a sound card, parts in 10^6, unless it
/// was measured.
inline constexpr double usual_clock_ppm = 50.0;

/// Properties of a log that are given instead of being found from it.
struct ReadingOptions {
  std::optional<LogFormat> format{};
  std::optional<double> nominal_period_s{};
  std::vector<std::string> columns{}; ///< "time=2", "amplitude=5:mrad", "angle=Angle (deg)"
  std::optional<TimeUnit> unit{};     ///< of the times (in_days: MJD)
  std::optional<double> wrap_s{};     ///< s after which times start again; 0: never
  std::optional<double> tau0_s{};     ///< between values of phase, frequency or intervals
  std::optional<double> counter_hz{}; ///< of a counter whose cycles a log gives
  bool decimal_comma = false;
  std::string channel{};                  ///< of a TICC
  std::size_t beat_channel = 1;           ///< of a recording: in which the clock is heard
  std::optional<std::size_t> pps_channel{}; ///< in which a reference clicks once a second
  double clock_ppm = usual_clock_ppm; ///< standard deviation of a recorder's sampling rate, 1e-6
  std::optional<double> rest_angle_rad{}; ///< of angle samples: the angle at rest
  std::optional<bool> month_first{}; ///< in dates such as 03/04/2013; else the day comes first
  double zone_s = 0.0; ///< of dates that name no zone: east of Greenwich, s
  bool phases_alone = false; ///< data on a grid: their phases are wanted, and no events but three
  bool weather = false; ///< a table of the weather: two readings are enough, of any distance
  bool strict = false;                    ///< the first issue is an error
  std::uint64_t unpacked_limit = usual_unpacked_limit; ///< of a packed file, bytes
  std::function<void(double)> progress{}; ///< called from time to time with the share read
};

/// Another reading of a log that cannot be what it was taken for.
struct OtherReading {
  std::string words; ///< the contents of the log under this reading
  std::optional<LogFormat> format{};
  std::optional<double> nominal_period_s{}, tau0_s{}, wrap_s{};
  std::string unit{};                 ///< of the times, as unit_named takes it
  std::vector<std::string> columns{}; ///< as ReadingOptions::columns takes them
  bool both_edges = false;
};

/// A log was read, but the result is impossible for a clock. The message says what was found;
/// `others` are the most likely other readings, best first.
class ImpossibleReading : public InputError {
public:
  /// `place`, `found` and `expected` as for InputError.
  ImpossibleReading(TextPlace place, std::string_view found, std::string_view expected,
                    std::vector<OtherReading> others)
      : InputError(std::move(place), found, expected), others_(std::move(others)) {}
  /// Most likely first.
  [[nodiscard]] const std::vector<OtherReading>& others() const noexcept { return others_; }
  /// The same message with other readings.
  [[nodiscard]] ImpossibleReading with_others(std::vector<OtherReading> others) const {
    ImpossibleReading same = *this;
    same.others_ = std::move(others);
    return same;
  }

private:
  std::vector<OtherReading> others_;
};

/// Other readings of a log whose events are `step_s` apart, not a whole number of nominal
/// periods: another unit of the times if one makes it so, another nominal period, both directions.
std::vector<OtherReading> readings_for_period(double step_s, double nominal_s);

/// Other readings of a log whose phases change by more than the error of a clock.
std::vector<OtherReading> readings_for_phases(const GridData& grid);

/// Reads the whole text of a log; `source` names it in messages.
///
/// The layout is found from the beginning of the text and reported in `assumptions`; each part of
/// it can be overridden. Times keep all their digits. A line that can be mended is mended, and
/// other faulty lines are left out; both are listed in `issues` (line, column, kind, what was
/// done). Order is restored by sorting, and a log with the newest line first is reversed. If the
/// time goes back and continues from there, a new block begins. Amplitudes outside 0 to pi rad and
/// widths outside 0 to 1e6 s are taken as unknown, times beyond 4e18 s and clock errors beyond 1e9
/// s left out; all of this is reported. Angle samples become crossings, see crossings_of_samples. A
/// recording of sound (WAV, RF64, AIFF, FLAC, OGG) becomes the beats that find_ticks finds in it,
/// ticks as upward crossings and tocks as downward ones, with their standard deviations. Throws
/// InputError (file, line, column, found, expected) if the text is empty, in UTF-16, binary in its
/// first line or in half of them (holes of zeros are left out), of no known format, has more than
/// 256 columns or a line of more than 16 MiB, unpacks to more than the limit, if fewer than half of
/// its lines can be used, or fewer than three events are found; ArgumentError for options out of
/// range. Memory: 48 bytes per line and at most ten times the text (tests/fuzz). Formats:
/// ReadingTest, Formats/ReadsInTheWild. Speed and memory: tests/studies/reading.txt.
ClockLog read_log(std::string_view text, const std::string& source,
                  const ReadingOptions& options = {});

/// The same for a file (gzip or not), or standard input for "-", read piece by piece.
ClockLog read_log_file(const std::string& path, const ReadingOptions& options = {});

/// Several files of one clock as one log: each of `paths` is a file, or a folder or a ZIP whose
/// files are meant, without hidden ones and those that hold no log, which are listed in
/// `assumptions`. Files whose times are dates are joined in order of time, others in the order
/// given, those of a folder by name. If they have the same layout, the result is that of one file
/// with all their lines (SeveralFilesTest.AreReadAsOneFileIs); `files` says which lines are whose.
/// A file without a header may have the layout of those that have one. A gap between two files is a
/// gap like any other. Throws InputError as read_log does, and for dated files whose hours overlap,
/// that hold the same times, or whose beats are of another clock (2 % in the period, and not twice
/// or half of it); ArgumentError if one of several is not a regular file, or given twice.
ClockLog read_log_files(const std::vector<std::string>& paths, const ReadingOptions& options = {});

/// Further values of one event; NaN where the log has none.
struct EventValues {
  double width_s = std::numeric_limits<double>::quiet_NaN();
  double temperature_c = std::numeric_limits<double>::quiet_NaN();
  double pressure_mbar = std::numeric_limits<double>::quiet_NaN();
  double humidity_percent = std::numeric_limits<double>::quiet_NaN();
};

/// Reads a log that is still being written, event by event. A file that is truncated or replaced by
/// another of the same name is read from its beginning. Lines before the first usable one are left
/// out. Times in seconds that start again are returned unchanged.
class LogFollower {
public:
  /// Called every tenth of a second while no line arrives; returns false to give up. `held` is the
  /// text read so far whose layout is not known yet, and which has given no event; later empty.
  using Wait = std::function<bool(std::string_view held)>;

  /// Waits for the first lines to find the layout. `before` is text that was read from the pipe
  /// earlier: lines that were held when it was last followed, or its head(). Throws InputError as
  /// read_log does.
  LogFollower(const std::string& path, const ReadingOptions& options, Wait wait,
              std::string before = {});
  ~LogFollower();

  /// The next event; nothing at the end.
  std::optional<Beat> next();
  /// Further values of the event that next() returned.
  [[nodiscard]] EventValues values() const;
  /// The lines before the data, which define the layout; empty if there are none.
  [[nodiscard]] const std::string& head() const;
  /// Assumptions and issues so far.
  [[nodiscard]] const ClockLog& log() const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Reads a file, or standard input for "-". Throws InputError if it cannot be opened, or unpacks to
/// more than `unpacked_limit` bytes.
std::string read_text(const std::string& path, std::uint64_t unpacked_limit = usual_unpacked_limit);

} // namespace goingrate
