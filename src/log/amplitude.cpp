#include "goingrate/log/reading.hpp"

#include "issue_list.hpp"

#include "goingrate/base/scaled_time.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

double median_amplitude(const ClockLog& log) {
  std::vector<double> known;
  for (const Beat& event : log.events)
    if (!std::isnan(event.amplitude_rad)) known.push_back(event.amplitude_rad);
  if (known.empty()) return 0.0;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  return *middle;
}

} // namespace

void correct_edge_to_centre(ClockLog& log, double edge_angle_rad, double period_s) {
  if (edge_angle_rad == 0.0) return;
  const double typical = median_amplitude(log);
  IssueList issues(log, false);
  for (Beat& event : log.events) {
    const bool reaches = event.amplitude_rad > std::abs(edge_angle_rad);
    if (!reaches)
      issues.add(event.line, 1, IssueKind::missing,
                 fmt::format("amplitude {} rad that does not reach the sensor's edge",
                             event.amplitude_rad),
                 "the log's median amplitude taken for the edge");
    const double amplitude = reaches ? event.amplitude_rad : typical;
    const double angle = event.edge == Edge::up ? edge_angle_rad : -edge_angle_rad;
    if (amplitude > std::abs(angle))
      event.time = event.time + -std::asin(angle / amplitude) * period_s / two_pi;
  }
  log.assumptions.push_back(fmt::format(
      "times moved from the sensor's edge at {:g} mrad to the vertical, with each beat's amplitude",
      edge_angle_rad * 1e3));
}

} // namespace goingrate
