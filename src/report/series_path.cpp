#include "series_path.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

std::string command(char letter, const Place& place) {
  return fmt::format("{}{} {}", letter, coordinate(place.x), coordinate(place.y));
}

} // namespace

std::string coordinate(double value) {
  std::string text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

std::string line_path(const std::vector<Place>& places) {
  std::string path;
  for (const auto& run : thinned_line(places)) {
    for (std::size_t i = 0; i < run.size(); ++i)
      path += command(i == 0 ? 'M' : 'L', run[i]);
    if (run.size() == 1) path += "h0"; // drawn as a dot by its round cap
  }
  return path;
}

CloudPaths cloud_paths(const std::vector<Place>& places) {
  const Cloud cloud = thinned_cloud(places);
  CloudPaths paths;
  for (const Place& dot : cloud.dots)
    paths.dots += command('M', dot) + "h0";
  for (const Extent& stroke : cloud.body)
    paths.body += command('M', {stroke.x, stroke.low}) + "V" + coordinate(stroke.high);
  return paths;
}

std::string band_path(const std::vector<Extent>& extents) {
  std::string path;
  for (const auto& run : thinned_band(extents)) {
    for (std::size_t i = 0; i < run.size(); ++i)
      path += command(i == 0 ? 'M' : 'L', {run[i].x, run[i].low});
    for (std::size_t i = run.size(); i-- > 0;)
      path += command('L', {run[i].x, run[i].high});
    path += "Z";
  }
  return path;
}

std::string bars_path(const std::vector<Extent>& extents, double cap) {
  std::string path;
  for (const Extent& extent : extents) {
    if (std::isnan(extent.x) || std::isnan(extent.low) || std::isnan(extent.high)) continue;
    const std::string width = coordinate(2.0 * cap);
    path += command('M', {extent.x, extent.low}) + "V" + coordinate(extent.high);
    path += command('M', {extent.x - cap, extent.low}) + "h" + width;
    path += command('M', {extent.x - cap, extent.high}) + "h" + width;
  }
  return path;
}

} // namespace goingrate
