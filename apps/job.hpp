// A command as the job of a batch: the settings of its analysis, by the set-up that the command
// itself has, and its result for one log. Where results go is the batch's business.
#pragma once

#include "common.hpp"

#include "goingrate/analysis/batch.hpp"

#include <functional>

namespace goingrate::apps {

/// What adds the settings to a parser returns this; it keeps where they are parsed to.
struct Job {
  std::function<LogOptions()> log;               ///< how a log is to be read; without its path
  std::function<JobOutcome(NumberedLog)> result; ///< throws as the command does
};

Job add_fit_job(CLI::App& command);
Job add_rate_job(CLI::App& command);
Job add_report_job(CLI::App& command);
Job add_stability_job(CLI::App& command);

} // namespace goingrate::apps
