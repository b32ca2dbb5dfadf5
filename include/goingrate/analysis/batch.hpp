// Many logs: one job each, shared out over threads, processes and machines.
//
// A batch is a list of jobs, numbered from 0: logs, or realisations of a scenario. Share k of n
// holds the jobs i with i mod n = k - 1. Each job becomes one line of JSON; a share is a file of
// its lines in order, after a line that says which batch and which share it is. Neither the number
// of threads nor that of shares changes a byte of what merge_batch() makes of them; the lines hold
// no times and no names of machines.
//
// While a share is being made its finished lines are in a file beside it, with `.part` after the
// name, each appended whole. It outlives the process that wrote it, however that ended, and the
// next one takes it up; the share itself appears only when it is complete.
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

/// What identifies a scenario: the name-based UUID (RFC 4122, version 5, of objects) of its text,
/// its overrides and the factors of its drive's series.
std::string scenario_hash(std::string_view text, std::span<const std::string> overrides,
                          std::span<const double> series);

/// What all shares of a batch have in common. Two of these are the same batch if all but the truth
/// is equal, and was made by the same versions of goingrate and of the libraries it fits with.
struct BatchDescription {
  std::string command;               ///< fit, rate ...: what each job does
  std::vector<std::string> settings; ///< of it, as they were given
  std::size_t jobs = 0;
  std::vector<std::string> logs; ///< one per job; none for realisations
  std::optional<BatchScenario> scenario{};
};

/// How one job ended.
struct JobOutcome {
  int exit_code = 0;                  ///< of the command that would have done this job alone
  std::string message{};              ///< why, where that is not 0
  std::vector<std::string> assumed{}; ///< in reading the log
  std::string result{};               ///< JSON; empty if there is none
  double seconds = 0.0;               ///< it took so long; not written
};

/// Does some jobs of the batch; outcomes in the order of the jobs. What it throws ends the batch.
using BatchWorker = std::function<std::vector<JobOutcome>(std::span<const std::size_t> jobs)>;

/// What run_batch() is to do.
struct BatchRequest {
  BatchDescription description;
  BatchShare share{};
  std::string output = "-"; ///< the share's file; "-" is standard output, which cannot be resumed
  bool resume = false;      ///< take up what is there, and do nothing if all of it is
  std::size_t threads = 0;  ///< 0: one per core
  std::size_t at_once = 1;  ///< jobs that a worker does best together
  std::function<BatchWorker()> make_worker; ///< called by each thread
  std::function<void(double)> progress{};   ///< told the part that is done, by one thread at a time
};

/// What became of a share.
struct BatchOutcome {
  std::size_t jobs = 0;         ///< of the share
  std::size_t taken_up = 0;     ///< of these, done before
  std::size_t failed = 0;       ///< of those done now
  std::size_t threads = 0;      ///< asked for
  double seconds = 0.0;         ///< from begin to end
  double seconds_in_jobs = 0.0; ///< of all threads, as the outcomes say
  double longest_s = 0.0;       ///< of a job
  std::size_t longest_job = 0;  ///< which
};

/// Does a share of a batch and writes its file. A job that fails is a line like any other.
///
/// Throws InputError if what is to be resumed belongs to another batch or share, OutputError if a
/// file cannot be written or another process is at it, UnfinishedBatch if there is a begun share
/// and `resume` does not ask for it. (BatchTest.SharesAndThreadsChangeNoByte,
/// BatchTest.AKilledBatchIsTakenUp)
BatchOutcome run_batch(const BatchRequest& request);

/// The file of a share was begun, and the request does not say what to do with it.
class UnfinishedBatch : public std::runtime_error {
public:
  /// `file` holds `done` of `jobs` lines.
  UnfinishedBatch(std::string file, std::size_t done, std::size_t jobs);
  /// The file with the finished lines.
  [[nodiscard]] const std::string& file() const noexcept { return file_; }

private:
  std::string file_;
};

/// Makes the whole batch of all its shares, given in any order: byte for byte what one share 1/1
/// would be. One line of each share is held at a time. Throws InputError if a share is of another
/// batch, given twice, missing, or damaged.
void merge_batch(std::span<const std::string> shares, const std::string& output);

} // namespace goingrate
