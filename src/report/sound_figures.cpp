#include "report_figures.hpp"

#include <cmath>

namespace goingrate {

namespace {

Series loudness(const MeanBeat& beat, std::string label, int colour) {
  Series line{Series::Style::line, std::move(label), {}, {}, {}, {}, colour};
  for (std::size_t i = 0; i < beat.power.size(); ++i) {
    line.x.push_back(1e3 * (beat.begin_s + static_cast<double>(i) * beat.step_s));
    line.y.push_back(10.0 * std::log10(beat.power[i]));
  }
  return line;
}

} // namespace

std::optional<Figure> beat_figure(const ClockLog& log) {
  if (!log.sound || log.sound->tick.power.empty()) return {};
  Figure figure{
      "mean-beat",
      "One beat",
      "How loud the mean tick and the mean tock are over the noise around them. A beat is "
      "timed from where it first stands out, at 0; the sound before the loudest click, "
      "and the intervals between the clicks, show the escapement at work.",
      {"time since the beat begins", "ms"},
      {"power over the background", "dB"},
      {loudness(log.sound->tick, "tick", 0)}};
  if (!log.sound->tock.power.empty()) figure.series.push_back(loudness(log.sound->tock, "tock", 1));
  return figure;
}

} // namespace goingrate
