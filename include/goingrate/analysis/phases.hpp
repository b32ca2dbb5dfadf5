// The clock's error at equal intervals, of logs of any length.
#pragma once

#include "goingrate/analysis/load.hpp"

#include <cstdint>
#include <vector>

namespace goingrate {

/// Takes the phases from the parts of a log as they are loaded, so that of a long log only they are
/// in memory, 8 bytes each:
///
///     PhaseCollector phases;
///     NumberedLog log = load(request, [&](const LogPart& part) { phases.add(part); });
///     const PhaseSeries series = phases.series(std::move(log));
///
/// The result is that of phase_series() for the log loaded as a whole
/// (LoadPartsTest.PhasesAreThoseOfTheWholeLog).
class PhaseCollector {
public:
  void add(const LogPart& part);
  /// The series, once `log` has been loaded; leaves nothing.
  PhaseSeries series(NumberedLog log);

private:
  void begin(const Beat& beat, std::size_t lines_expected);

  struct Run { // of a segment
    std::vector<double> phase_s;
    std::size_t known = 0;
  };
  Run run_, longest_;
  Beat origin_;
  std::int64_t step_ = 1;
};

} // namespace goingrate
