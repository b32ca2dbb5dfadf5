#include "batch_jobs.hpp"

#include "exit_code.hpp"
#include "usage.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <string_view>

namespace goingrate::apps {

namespace {

constexpr std::string_view log_mark = "{.}"; // stands for the log's path without its extension

// Runs `work`; an exception becomes the outcome of the job, with its message and exit code.
template <class Work> JobOutcome outcome_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  JobOutcome outcome;
  try {
    outcome = work();
  } catch (const std::exception&) {
    const Failure failure = current_failure();
    outcome = {failure.code, failure.message};
  }
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

JobOutcome result_of(const Job& job, NumberedLog loaded) {
  name_options(loaded.log.assumptions);
  std::vector<std::string> assumed;
  for (const Assumption& assumption : loaded.log.assumptions)
    assumed.push_back(assumption.text);
  JobOutcome outcome = job.result(std::move(loaded));
  outcome.assumed = std::move(assumed);
  return outcome;
}

} // namespace

JobSettings::JobSettings(const JobKind& kind, Words words) : kind_(kind), words_(std::move(words)) {
  depend_on_log_ = std::any_of(words_.begin(), words_.end(), [](const std::string& word) {
    return word.find(log_mark) != std::string::npos;
  });
  if (!depend_on_log_) job_for_all_ = parsed("");
}

Job JobSettings::parsed(const std::string& log) const {
  CLI::App command{"", fmt::format("goingrate batch {}", kind_.name)};
  Job job = kind_.add(command);
  Words words = words_;
  const std::string stem = std::filesystem::path(log).replace_extension().string();
  for (std::string& word : words)
    for (auto at = word.find(log_mark); at != std::string::npos;
         at = word.find(log_mark, at + stem.size()))
      word.replace(at, log_mark.size(), stem);
  std::reverse(words.begin(), words.end());
  try {
    command.parse(words);
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  return job;
}

BatchWorker log_worker(const Words& logs, const JobSettings& settings) {
  return [&](std::span<const std::size_t> jobs) {
    std::vector<JobOutcome> outcomes;
    for (const std::size_t i : jobs)
      outcomes.push_back(outcome_of([&] {
        const Job job = settings.of(logs[i]);
        LogOptions options = job.log();
        options.paths = {logs[i]};
        return result_of(job, load(load_request(options)));
      }));
    return outcomes;
  };
}

std::vector<JobOutcome> RealisationWorker::operator()(std::span<const std::size_t> jobs) {
  std::vector<std::uint64_t> seeds;
  for (const std::size_t i : jobs)
    seeds.push_back(seed_ + i);
  std::vector<SimulatedLog> made;
  try {
    made = logs_.make(seeds);
  } catch (const std::exception&) {
    if (jobs.size() > 1) return each_alone(jobs);
    return {outcome_of([]() -> JobOutcome { throw; })};
  }
  std::vector<JobOutcome> outcomes;
  for (std::size_t k = 0; k < jobs.size(); ++k)
    outcomes.push_back(outcome_of([&] { return outcome_for(made[k], seeds[k]); }));
  return outcomes;
}

std::vector<JobOutcome> RealisationWorker::each_alone(std::span<const std::size_t> jobs) {
  std::vector<JobOutcome> outcomes;
  for (std::size_t k = 0; k < jobs.size(); ++k)
    outcomes.push_back((*this)(jobs.subspan(k, 1)).front());
  return outcomes;
}

JobOutcome RealisationWorker::outcome_for(const SimulatedLog& log, std::uint64_t seed) const {
  if (log.status != SwingStatus::crossed)
    throw NumericsError(fmt::format("{} after {} periods", words_for(log.status), log.periods));
  LogOptions options = job_.log();
  options.paths = {fmt::format("seed {}", seed)};
  return result_of(job_, load_text(log.text, load_request(options)));
}

} // namespace goingrate::apps
