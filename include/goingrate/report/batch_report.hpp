// The summary of a batch, for the eye and for scripts.
#pragma once

#include "goingrate/analysis/batch_summary.hpp"

#include <string>

namespace goingrate {

/// How many jobs ended how; for fits, how often the intervals hold the truth, the pulls and sigma
/// against scatter; for logs, a row each with rate, status or failure.
std::string batch_text(const BatchSummary& summary);

/// The same as JSON, schema goingrate.batch-summary: `jobs`, `exits`, `statuses`, `models`,
/// `parameters` (list of {`name`, `truth`, `determined`, `undetermined`, `within68`, `within95`,
/// `mean_pull`, `sd_pull`, `median`, `median_sigma`, `scatter`, `rms_error`}), `deviations`, and
/// `rows` (list of {`job`, `subject`, `exit`, `words`, `rate_s_per_day`, `sigma`}).
std::string batch_json(const BatchSummary& summary);

} // namespace goingrate
