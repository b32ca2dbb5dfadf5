// The results of a whole batch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace goingrate {

/// The results for one parameter of a fit, over the jobs that determine it. Shares of intervals,
/// pulls and errors refer to the true value, and are NaN without one.
struct ParameterScore {
  std::string name;
  double truth = 0.0;                    ///< NaN if not known
  std::size_t determined = 0;            ///< jobs that state it, neither fixed nor undetermined
  std::size_t undetermined = 0;          ///< jobs in which it is undetermined
  double within68 = 0.0, within95 = 0.0; ///< shares of the intervals that hold the true value
  double mean_pull = 0.0, sd_pull = 0.0; ///< of (value - truth)/sigma: 0 and 1 for honest sigmas
  double median = 0.0;                   ///< of the values
  double median_sigma = 0.0;             ///< of their sigmas
  double scatter = 0.0;                  ///< standard deviation of the values; NaN for one
  double rms_error = 0.0;                ///< of the values, from the truth
};

/// The deviations of all jobs at one averaging time.
struct DeviationScore {
  double tau_s = 0.0;
  std::size_t jobs = 0;
  double median = 0.0, low = 0.0, high = 0.0; ///< the quantiles at 50 %, 16 % and 84 %
};

/// One job, in a line of a table.
struct JobRow {
  std::size_t job = 0;
  std::string subject; ///< the log, or the seed
  int exit_code = 0;
  std::string words;                        ///< status of the fit, or the error
  double rate_s_per_day = 0.0, sigma = 0.0; ///< NaN where there is none
};

/// What batch_summary() finds.
struct BatchSummary {
  std::string batch, command; ///< the id of the batch; the command and its settings
  std::string scenario;       ///< its hash; empty for logs
  std::uint64_t first_seed = 0;
  std::size_t jobs = 0;
  std::map<int, std::size_t> exits;            ///< number of jobs with each exit code
  std::map<std::string, std::size_t> statuses; ///< of fits
  std::map<std::string, std::size_t> models;   ///< of fits: dynamics, escapement, noise
  std::vector<JobRow> rows;                    ///< one per job
  std::vector<ParameterScore> parameters;      ///< in order of name
  std::vector<DeviationScore> deviations;      ///< in order of averaging time
};

/// Reads a whole batch, share 1/1; only one line, and some numbers of each job, are in memory. A
/// change at the k-th event (mu\@k) is compared with the true value only if the fit has as many
/// events as the scenario. Throws InputError if the file cannot be read or is a share of several.
/// (BatchSummaryTest.CountsAgainstTheTruth)
BatchSummary batch_summary(const std::string& path);

} // namespace goingrate
