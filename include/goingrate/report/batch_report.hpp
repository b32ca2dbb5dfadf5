// The summary of a batch, as text for people and as JSON for scripts.
#pragma once

#include "goingrate/analysis/batch_summary.hpp"

#include <string>

namespace goingrate {

/// The number of jobs that ended in each way; for fits, how often the intervals hold the truth, the
/// pulls, and sigma compared with the scatter; for logs, a row each with rate, status or failure.
std::string batch_text(const BatchSummary& summary);

/// The same as JSON, schema goingrate.batch-summary: `jobs`, `exits`, `statuses`, `models`,
/// `parameters` (list of {`name`, `truth`, `determined`, `undetermined`, `within68`, `within95`,
/// `mean_pull`, `sd_pull`, `median`, `median_sigma`, `scatter`, `rms_error`}), `deviations`, and
/// `rows` (list of {`job`, `subject`, `exit`, `words`, `rate_s_per_day`, `sigma`}).
std::string batch_json(const BatchSummary& summary);

} // namespace goingrate
