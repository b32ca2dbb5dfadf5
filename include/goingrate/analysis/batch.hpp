// Many logs: one job each, distributed over threads, processes and machines.
//
// A batch is a list of jobs, numbered from 0: logs, or realisations of a scenario. Share k of n
// holds the jobs i with i mod n = k - 1. Each job becomes one line of JSON; a share is a file of
// its lines in order, after a line that says which batch and which share it is. Neither the number
// of threads nor that of shares changes a byte of what merge_batch() makes of them; the lines hold
// no times and no names of machines.
//
// While a share is being made, its finished lines are in a file beside it, with `.part` after the
// name; each is appended whole. That file outlives the process that wrote it, however the process
// ended, and the next one continues it. The share itself appears only when it is complete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// Which jobs of a batch: every n-th, from the k-th on; 1 <= k <= n.
struct BatchShare {
  std::size_t k = 1, n = 1;

  /// The number of the share's i-th job.
  [[nodiscard]] std::size_t job(std::size_t i) const { return k - 1 + i * n; }
  /// How many of `jobs` are its own.
  [[nodiscard]] std::size_t size(std::size_t jobs) const { return (jobs + n - k) / n; }
};

/// Reads "3/20"; throws ArgumentError.
BatchShare parse_share(const std::string& text);

/// The scenario whose realisations are the jobs; job i has the seed `seed` + i.
struct BatchScenario {
  std::string hash; ///< scenario_hash() of it
  std::uint64_t seed = 1;
  std::map<std::string, double> truth; ///< true_parameters() of it
};

/// Identifies a scenario: the name-based UUID (RFC 4122, version 5, of objects) of its text,
/// its overrides and the factors of its drive's series.
std::string scenario_hash(std::string_view text, std::span<const std::string> overrides,
                          std::span<const double> series);

/// The description that all shares of a batch have in common. Two descriptions mean the same batch
/// if everything but the truth is equal and they were made by the same versions of goingrate and of
/// the libraries that it uses for fitting.
struct BatchDescription {
  std::string command;               ///< fit, rate ...: what each job does
  std::vector<std::string> settings; ///< the options of the command, as given
  std::size_t jobs = 0;
  std::vector<std::string> logs; ///< one per job; none for realisations
  std::optional<BatchScenario> scenario{};
};

/// How one job ended.
struct JobOutcome {
  int exit_code = 0;                  ///< of the command that would have done this job alone
  std::string message{};              ///< the error, if exit_code is not 0
  std::vector<std::string> assumed{}; ///< the assumptions made in reading the log
  std::string result{};               ///< JSON; empty if there is none
  double seconds = 0.0;               ///< duration of the job; not written to the file
};

/// Does some jobs of the batch; outcomes in the order of the jobs. An exception ends the batch.
using BatchWorker = std::function<std::vector<JobOutcome>(std::span<const std::size_t> jobs)>;

/// What run_batch() is to do.
struct BatchRequest {
  BatchDescription description;
  BatchShare share{};
  std::string output = "-"; ///< the share's file; "-" is standard output, which cannot be resumed
  bool resume = false;      ///< do only the jobs that an earlier run left undone
  std::size_t threads = 0;  ///< 0: one per core
  std::size_t at_once = 1;  ///< jobs that a worker does best together
  std::function<BatchWorker()> make_worker; ///< called by each thread
  /// Called with the part that is done, 0 to 1, by one thread at a time.
  std::function<void(double)> progress{};
};

/// The outcome of a share.
struct BatchOutcome {
  std::size_t jobs = 0;         ///< of the share
  std::size_t taken_up = 0;     ///< of these, done by an earlier run
  std::size_t failed = 0;       ///< of those done now
  std::size_t threads = 0;      ///< as requested
  double seconds = 0.0;         ///< from begin to end
  double seconds_in_jobs = 0.0; ///< summed over all threads
  double longest_s = 0.0;       ///< duration of the longest job
  std::size_t longest_job = 0;  ///< its number
};

/// Does a share of a batch and writes its file. A job that fails is a line like any other.
///
/// Throws InputError if the file to be resumed belongs to another batch or share, OutputError if a
/// file cannot be written or another process is writing to it, UnfinishedBatch if a share was begun
/// and `resume` is false. (BatchTest.SharesAndThreadsChangeNoByte,
/// BatchTest.AKilledBatchIsTakenUp)
BatchOutcome run_batch(const BatchRequest& request);

/// The file of a share was begun by an earlier run, and the request does not ask to resume it.
class UnfinishedBatch : public std::runtime_error {
public:
  /// `file` holds `done` of `jobs` lines.
  UnfinishedBatch(std::string file, std::size_t done, std::size_t jobs);
  /// The file with the finished lines.
  [[nodiscard]] const std::string& file() const noexcept { return file_; }

private:
  std::string file_;
};

/// Joins all shares of a batch, given in any order, into the file that a single share 1/1 would be,
/// byte for byte. Only one line of each share is in memory at a time. Throws InputError if a share
/// belongs to another batch, is given twice, missing, or damaged.
void merge_batch(std::span<const std::string> shares, const std::string& output);

} // namespace goingrate
