#include "goingrate/analysis/phases.hpp"

#include "base/special_values.hpp"

#include <utility>

namespace goingrate {

void PhaseCollector::begin(const Beat& beat, std::size_t lines_expected) {
  if (run_.known > longest_.known) std::swap(run_, longest_);
  run_.phase_s.clear();
  run_.known = 0;
  if (longest_.known == 0) run_.phase_s.reserve(lines_expected);
  origin_ = beat;
}

void PhaseCollector::add(const LogPart& part) {
  const Beats& numbers = part.log.beats;
  for (std::size_t i = part.first; i < part.end; ++i) {
    const Beat& beat = numbers.beats[i];
    if (beat.flag != BeatFlag::good) continue;
    if (run_.known == 0 || beat.segment != origin_.segment) begin(beat, part.lines_expected);
    const std::int64_t cycles = beat.cycle - origin_.cycle;
    const std::int64_t place = numbers.step == 1 ? cycles : cycles / numbers.step;
    run_.phase_s.resize(static_cast<std::size_t>(place), not_known);
    run_.phase_s.push_back(
        -residual_from_grid(beat.time, origin_.time, cycles, part.log.nominal_period_s));
    ++run_.known;
  }
  step_ = numbers.step;
}

PhaseSeries PhaseCollector::series(NumberedLog log) {
  if (log.log.grid) return phase_series(std::move(log));
  if (run_.known > longest_.known) std::swap(run_, longest_);
  return {std::move(longest_.phase_s), static_cast<double>(step_) * log.nominal_period_s};
}

} // namespace goingrate
