// What the subcommands share: options that several have, and the way results leave the program.
#pragma once

#include "goingrate/analysis/analyse.hpp"
#include "goingrate/analysis/fit_request.hpp"
#include "goingrate/base/errors.hpp"
#include "words.hpp"

#include <CLI/CLI.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace goingrate::apps {

/// Options of the whole command.
struct GlobalOptions {
  bool quiet = false;
};

inline constexpr double gib = 1073741824.0; ///< bytes

/// Options of every command that reads a log.
struct LogOptions {
  std::vector<std::string> paths; ///< several, or folders: files of one clock
  std::string format;
  double nominal_period_s = 0.0; ///< 0: not given
  double flag_width_rad = 0.0;
  std::optional<double> gravity_share;
  double gap_probability = NumberingOptions{}.least_probability;
  bool both_edges = false;
  std::string sensor_offset;        ///< rad, or auto
  std::vector<std::string> columns; ///< ROLE=PLACE[:UNIT]
  std::string unit;
  std::optional<double> wrap_s, rest_angle_rad;
  double tau0_s = 0.0; ///< 0: not given
  double counter_hz = 0.0; ///< 0: not given
  bool decimal_comma = false;
  std::string date_order; // day or month; empty: not given
  std::vector<std::string> channels; ///< of a TICC, or ROLE=NUMBER of a recording
  double clock_ppm = usual_clock_ppm;
  bool strict = false;
  WeatherRequest weather;
  std::string site; ///< LATITUDE,LONGITUDE; empty: not given
  std::optional<double> dead_time_s;
  bool phases_will_do = false; ///< the command takes data on a grid that are not a clock's
  double unpacked_limit_gib = static_cast<double>(usual_unpacked_limit) / gib;
};

/// Checks of numbers on the command line. CLI11's own let "nan" pass, which is neither above nor
/// below anything, and name their limits with 300 digits.
CLI::Validator positive();
CLI::Validator not_negative();
CLI::Validator seed_range();

void add_log_options(CLI::App& command, LogOptions& options);
/// The same without the log itself.
void add_log_settings(CLI::App& command, LogOptions& options);
/// The subset of these that says how the text is read.
void add_reading_options(CLI::App& command, LogOptions& options);

/// What the options ask of the reader.
ReadingOptions reading_options(const LogOptions& options);

/// One issue as a line: file:line:column: what was found: what was done.
std::string words_for(const LineIssue& issue, const ClockLog& log);

/// What the options ask of load().
LoadRequest load_request(const LogOptions& options);

/// A year of a seconds pendulum, which takes 0.7 GB, and 5 GB to analyse. A longer log is read in
/// parts.
inline constexpr std::size_t most_events_at_once = 1 << 24;

/// Reads and numbers the log; says on standard error what was assumed and what was wrong.
NumberedLog load(const LogOptions& options, const GlobalOptions& global);
/// The same for a request that is made of options and changed.
NumberedLog load(LoadRequest request, const GlobalOptions& global, const LogVisitor& visit = {});

/// Appends to each assumption the option that says otherwise.
void name_options(std::vector<Assumption>& assumptions);
/// Appends to the notes of a fit the options that would help.
void name_options(FitSummary& fit);

/// Wrong usage that only the library notices.
class UsageError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The options that ask for this reading: "--format periods --unit us".
std::string options_for(const OtherReading& other);

/// Where the readable result goes: to `output`; if that is not given, to standard output, or
/// nowhere if the JSON goes there.
std::string table_output(const std::string& output, const std::string& json);

/// Adds --json.
void add_json_option(CLI::App& command, std::string& path);

/// A line on standard error unless --quiet; one that cannot be written is lost without complaint.
void say(const GlobalOptions& global, std::string_view line);

/// The numbers of "3,30,300"; throws ArgumentError naming `option`.
std::vector<double> numbers_in(const std::string& option, const std::string& text);

/// Options of every command that fits; empty: not given.
struct ModelOptions {
  std::vector<std::string> fixed;  ///< NAME=VALUE
  std::vector<std::string> freed;  ///< names
  std::vector<std::string> priors; ///< NAME=VALUE+-SIGMA
  std::vector<std::string> events; ///< CYCLE:NAME[,NAME], TIMEs:NAME, auto or none
  std::string model, noise, escapement;
  std::string from; ///< a file of parameters; what else is given wins
};

void add_model_options(CLI::App& command, ModelOptions& options);

/// Says which events were found, and what may change at them.
void tell_events(std::span<const FitEvent> events, std::span<const Beat> good,
                 const GlobalOptions& global);

/// The model options as the library takes them.
FitRequest fit_request(const ModelOptions& options);
/// The log read with the share of gravity that its fit is to hold, if it is.
LogOptions with_held_share(LogOptions log, const ModelOptions& options);

/// Sets the help of the program and of the subcommands that are added later in 80 columns.
void narrow_help(CLI::App& program);

// The subcommands: each adds itself to the program.
void add_simulate(CLI::App& program, const GlobalOptions& global);
void add_rate(CLI::App& program, const GlobalOptions& global);
void add_fit(CLI::App& program, const GlobalOptions& global);
void add_spectrum(CLI::App& program, const GlobalOptions& global);
void add_stability(CLI::App& program, const GlobalOptions& global);
void add_report(CLI::App& program, const GlobalOptions& global);
void add_compare(CLI::App& program, const GlobalOptions& global);
void add_map(CLI::App& program, const GlobalOptions& global);
void add_chart(CLI::App& program, const GlobalOptions& global);
void add_paper(CLI::App& program, const GlobalOptions& global);
void add_batch(CLI::App& program, const GlobalOptions& global);
/// Adds what batch takes behind the name of a job, as commands of batch: for completion only, since
/// a program that has them cannot parse a batch.
void add_batch_jobs(CLI::App& program);
void add_help(CLI::App& program);

} // namespace goingrate::apps
