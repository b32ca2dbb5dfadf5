#include "series_path.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <span>

namespace goingrate {

namespace {

bool known(const Place& place) { return !std::isnan(place.x) && !std::isnan(place.y); }

long column_of(double x) { return std::lround(std::floor(x)); }

std::string command(char letter, const Place& place) {
  return fmt::format("{}{} {}", letter, coordinate(place.x), coordinate(place.y));
}

// Collects the places of one column and writes its lowest and highest when the next column begins.
class LineWriter {
public:
  void add(const Place& place) {
    if (count_ > 0 && column_of(place.x) != column_) flush();
    if (count_ == 0) {
      column_ = column_of(place.x);
      begins_run_ = gap_;
      first_ = second_ = place;
    } else if (count_ == 1) {
      second_ = place;
    } else {
      widen(place);
    }
    gap_ = false; // a gap narrower than its column cannot be seen
    ++count_;
  }

  void gap() { gap_ = true; }

  std::string finish() {
    flush();
    close_run();
    return std::move(path_);
  }

private:
  // first_ and second_ are the extremes so far, in their order.
  void widen(const Place& place) {
    const bool rising = first_.y <= second_.y;
    const double low = rising ? first_.y : second_.y;
    const double high = rising ? second_.y : first_.y;
    if (place.y >= low && place.y <= high) return;
    const bool replaces_second = (place.y > high) == rising;
    if (!replaces_second) first_ = second_;
    second_ = place;
  }

  void flush() {
    if (count_ == 0) return;
    emit(first_, begins_run_);
    if (count_ > 1) emit(second_, false);
    count_ = 0;
  }

  void emit(const Place& place, bool begins_run) {
    if (begins_run) close_run();
    path_ += command(begins_run ? 'M' : 'L', place);
    ++in_run_;
  }

  void close_run() {
    if (in_run_ == 1) path_ += "h0"; // drawn as a dot by its round cap
    in_run_ = 0;
  }

  std::string path_;
  Place first_{}, second_{};
  long column_ = 0;
  std::size_t count_ = 0;  // places in this column
  std::size_t in_run_ = 0; // places written since the last break
  bool gap_ = true;
  bool begins_run_ = true;
};

void add_dot(std::string& path, const Place& place) { path += command('M', place) + "h0"; }

void add_column(CloudPaths& cloud, std::span<const Place> sorted) {
  add_dot(cloud.dots, sorted.front());
  if (sorted.size() == 1) return;
  add_dot(cloud.dots, sorted.back());
  if (sorted.size() == 2) return;
  const std::size_t last = sorted.size() - 1;
  const double x = std::floor(sorted.front().x) + 0.5;
  cloud.body += command('M', {x, sorted[last / 10].y});
  cloud.body += fmt::format("V{}", coordinate(sorted[last - last / 10].y));
}

} // namespace

std::string coordinate(double value) {
  std::string text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

std::string line_path(const std::vector<Place>& places) {
  LineWriter writer;
  for (const Place& place : places) {
    if (known(place))
      writer.add(place);
    else
      writer.gap();
  }
  return writer.finish();
}

CloudPaths cloud_paths(const std::vector<Place>& places) {
  std::vector<Place> sorted;
  std::copy_if(places.begin(), places.end(), std::back_inserter(sorted), known);
  std::sort(sorted.begin(), sorted.end(), [](const Place& a, const Place& b) {
    const long left = column_of(a.x);
    const long right = column_of(b.x);
    return left != right ? left < right : a.y < b.y;
  });
  CloudPaths cloud;
  for (std::size_t begin = 0; begin < sorted.size();) {
    std::size_t end = begin + 1;
    while (end < sorted.size() && column_of(sorted[end].x) == column_of(sorted[begin].x))
      ++end;
    add_column(cloud, std::span(sorted).subspan(begin, end - begin));
    begin = end;
  }
  return cloud;
}

std::string band_path(const std::vector<Extent>& extents) {
  std::vector<Place> lows;
  std::vector<Place> highs;
  std::string path;
  const auto close = [&] {
    if (lows.empty()) return;
    std::reverse(highs.begin(), highs.end());
    lows.insert(lows.end(), highs.begin(), highs.end());
    for (std::size_t i = 0; i < lows.size(); ++i)
      path += command(i == 0 ? 'M' : 'L', lows[i]);
    path += "Z";
    lows.clear();
    highs.clear();
  };
  bool gap = false;
  for (const Extent& extent : extents) {
    if (std::isnan(extent.x) || std::isnan(extent.low) || std::isnan(extent.high)) {
      gap = true;
      continue;
    }
    if (!lows.empty() && column_of(lows.back().x) == column_of(extent.x)) {
      lows.back().y = std::max(lows.back().y, extent.low); // y grows downwards in a drawing
      highs.back().y = std::min(highs.back().y, extent.high);
    } else {
      if (gap) close(); // one narrower than its column cannot be seen
      lows.push_back({extent.x, extent.low});
      highs.push_back({extent.x, extent.high});
    }
    gap = false;
  }
  close();
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
