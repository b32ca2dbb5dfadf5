// A report with something in every part, made by hand.
#pragma once

#include "support/nan.hpp"
#include "goingrate/report/report.hpp"

#include <cmath>
#include <vector>

namespace goingrate::test {

inline std::vector<Beat> swinging_beats(std::size_t count, bool with_amplitude) {
  std::vector<Beat> beats;
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<double>(i);
    const double late = 1e-5 * std::sin(1e4 * n) - 3e-5 * n; // scatter, and gaining
    beats.push_back({Instant{1364774403, 0.25} + (3.0 * n + late), static_cast<std::int64_t>(i),
                     with_amplitude ? 0.046 + 1e-4 * std::sin(n / 500.0) : nan,
                     static_cast<std::uint32_t>(i + 1), 0, BeatFlag::good});
  }
  return beats;
}

inline FitSummary some_fit(const std::vector<Beat>& beats, bool with_amplitude) {
  FitSummary fit;
  fit.chosen_by = "asked for";
  fit.parameters = {
      {"T0", "s", ParameterStatus::free, 2.9999, 0.0001, 2.9998, 3.0, 2.9997, 3.0001},
      {"epsilon", "", ParameterStatus::prior, 8e-5, 1e-6, 7.9e-5, 8.1e-5, 7.8e-5, 8.2e-5},
      {"mu", "", ParameterStatus::undetermined, 7.77e-6, 7.77e-6, 7.77},
      {"phi0", "rad", ParameterStatus::fixed, 0.03, nan, nan}};
  for (FittedParameter& p : fit.parameters)
    if (std::isfinite(p.low95))
      p.profile = {
          {p.low95, 4.0}, {p.low68, 1.0}, {p.value, 0.0}, {p.high68, 1.0}, {p.high95, 4.0}};
  fit.correlated = {"T0", "epsilon", "mu"};
  fit.correlation = {{1.0, -0.4, 0.777}, {-0.4, 1.0, 0.05}, {0.777, 0.05, 1.0}};
  fit.combinations = {{"decay time", "T0/(2 pi epsilon)", "s", 6000.0, 30.0},
                      {"fast gain", "2 mu/(pi lambda)", "", nan, nan}};
  fit.q_factor = {"Q", "1/(2 epsilon)", "", 6250.0, 80.0};
  fit.rate_s_per_day = {"rate", "T0/mean period - 1", "s/day", 0.86, 0.02};
  fit.quality = {100.0, 98.0, 0.4, false, 0.5, 1e-5, with_amplitude ? 1e-5 : nan, 10.0, 12.0};
  fit.alternatives = {{"averaged1, constant-torque", 12.0, "chosen"}};
  fit.residual_s.assign(beats.size(), 1e-6);
  fit.model_amplitude_rad.assign(beats.size(), 0.046);
  if (with_amplitude) fit.amplitude_residual_rad.assign(beats.size(), 1e-5);
  return fit;
}

inline Analysis some_report(std::size_t count = 500, bool with_amplitude = true) {
  Analysis data;
  data.log.source = "clock.csv";
  data.log.has_amplitude = with_amplitude;
  data.log.assumptions = {{"times are seconds"}};
  data.beats = swinging_beats(count, with_amplitude);
  data.numbered.beats = data.beats;
  data.rate = summarise_rates(data.beats, 3.0);
  const auto cut = [&](double at_s) { return data.beats.front().time + at_s; };
  data.stretches = rates_between(data.beats, std::vector{cut(300.0), cut(600.0)}, 3.0);
  data.now = data.stretches.back();
  data.fit = some_fit(data.beats, with_amplitude);
  data.diary.changes = {{100, 300.0, -2e-5, with_amplitude ? -1e-6 : nan, 20.0},
                        {200, 600.0, 2e-5, with_amplitude ? 1e-6 : nan, 18.0}};
  Interruption stop{data.diary.changes[0], data.diary.changes[1], 0.046, 0.044, -2e-5, {}, {}};
  stop.decay = Relaxation{6000.0, 40.0, 300.0, 0.0, 1e-5, true, nan, nan};
  stop.recovery = Relaxation{3100.0, 50.0, 900.0, 0.046, 1e-5, false, 3050.0, 3200.0};
  data.diary.interruptions = {stop};
  data.drive.rate_spectrum =
      Spectrum{{0.0, 0.001, 0.002, 0.01, 0.1}, {1, 2e-9, 1e-9, 3e-10, 1e-9}, 0.001, 2.0, 1, 0, 8};
  data.drive.response = DriveResponse{3e-4, -1e-4, 0.003};
  DriveSplit split;
  split.split_hz = 0.003;
  split.fast = {0.01, 0.009, 0.011};
  split.slow = {0.002, 0.0, 0.004};
  split.jitter_s = {nan, nan, nan};
  split.slow_time_s = nan;
  split.costs = {{86400.0, {0.1, 0.09, 0.11}, {0.0, 0.0, 0.2}},
                 {7.0 * 86400.0, {0.3, 0.27, 0.33}, {0.0, 0.0, 1.2}}};
  split.jitter_density = {1e-20, 1e-15, 1e-14, 1e-12, 1e-9};
  split.fast_density = {1e-10, 1e-10, 1e-10, 1e-10, 1e-10};
  split.slow_density = std::vector<double>(5, 0.0);
  data.drive.split = split;
  DriveHistory history;
  for (int i = 0; i < 20; ++i)
    history.points.push_back({75.0 * i, 1.0 + 0.001 * i, 0.002});
  history.from_rate = true;
  data.history = history;
  data.drive.lines = {{0.0167, 1e-5, 1e-6, 0.0, 50.0, 1e-9}};
  data.deviation = {DeviationKind::oadev,
                    3.0,
                    {{3.0, 1, 498, 5e-6, 4.8e-6, 5.2e-6, 2, true},
                     {6.0, 2, 496, 2e-6, nan, nan, 0, false},
                     {300.0, 100, 0, nan, nan, nan, 0, false}}};
  return data;
}

} // namespace goingrate::test
