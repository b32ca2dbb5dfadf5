// The jobs of goingrate batch: their settings, and the work on one log or one realisation.
#pragma once

#include "job.hpp"

#include "goingrate/analysis/simulated_logs.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace goingrate::apps {

using Words = std::vector<std::string>;

/// A command that may be the job of a batch.
struct JobKind {
  const char* name;
  Job (*add)(CLI::App&);
};
inline constexpr std::array job_kinds{JobKind{"fit", add_fit_job}, JobKind{"rate", add_rate_job},
                                      JobKind{"report", add_report_job},
                                      JobKind{"stability", add_stability_job}};

/// The settings of a job. They are the same for all logs unless they contain "{.}", which stands
/// for the path of the log without its extension.
class JobSettings {
public:
  JobSettings(const JobKind& kind, Words words);

  [[nodiscard]] Job of(const std::string& log) const {
    return depend_on_log_ ? parsed(log) : *job_for_all_;
  }
  [[nodiscard]] const Words& words() const { return words_; }

private:
  [[nodiscard]] Job parsed(const std::string& log) const;

  const JobKind& kind_;
  Words words_;
  bool depend_on_log_ = false;
  std::optional<Job> job_for_all_; // unless they depend on the log
};

/// A worker that does the job on logs by their index; `logs` and `settings` must outlive it.
BatchWorker log_worker(const Words& logs, const JobSettings& settings);

/// Simulates realisations and does the job on each. All seeds of one call are simulated together.
/// Each thread has its own copy, and with it its own simulator.
class RealisationWorker {
public:
  RealisationWorker(const SimulatedLogs& logs, std::uint64_t seed, Job job)
      : logs_(logs), seed_(seed), job_(std::move(job)) {}

  std::vector<JobOutcome> operator()(std::span<const std::size_t> jobs);

private:
  std::vector<JobOutcome> each_alone(std::span<const std::size_t> jobs);
  [[nodiscard]] JobOutcome outcome_for(const SimulatedLog& log, std::uint64_t seed) const;

  SimulatedLogs logs_;
  std::uint64_t seed_;
  Job job_;
};

} // namespace goingrate::apps
