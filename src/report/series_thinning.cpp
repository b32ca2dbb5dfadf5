#include "series_thinning.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

namespace goingrate {

namespace {

bool known(const Place& place) { return !std::isnan(place.x) && !std::isnan(place.y); }

bool known(const Extent& extent) {
  return !std::isnan(extent.x) && !std::isnan(extent.low) && !std::isnan(extent.high);
}

long column_of(double x) { return std::lround(std::floor(x)); }

// Collects the places of one column and keeps its lowest and highest when the next column begins.
class LineThinner {
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

  std::vector<std::vector<Place>> finish() {
    flush();
    return std::move(runs_);
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
    if (begins_run_) runs_.emplace_back();
    runs_.back().push_back(first_);
    if (count_ > 1) runs_.back().push_back(second_);
    count_ = 0;
  }

  std::vector<std::vector<Place>> runs_;
  Place first_{}, second_{};
  long column_ = 0;
  std::size_t count_ = 0; // places in this column
  bool gap_ = true;
  bool begins_run_ = true;
};

void add_column(Cloud& cloud, std::span<const Place> sorted) {
  cloud.dots.push_back(sorted.front());
  if (sorted.size() == 1) return;
  cloud.dots.push_back(sorted.back());
  if (sorted.size() == 2) return;
  const std::size_t last = sorted.size() - 1;
  const double x = std::floor(sorted.front().x) + 0.5;
  cloud.body.push_back({x, sorted[last / 10].y, sorted[last - last / 10].y});
}

} // namespace

std::vector<std::vector<Place>> thinned_line(const std::vector<Place>& places) {
  LineThinner thinner;
  for (const Place& place : places) {
    if (known(place))
      thinner.add(place);
    else
      thinner.gap();
  }
  return thinner.finish();
}

Cloud thinned_cloud(const std::vector<Place>& places) {
  std::vector<Place> sorted;
  std::copy_if(places.begin(), places.end(), std::back_inserter(sorted),
               [](const Place& place) { return known(place); });
  constexpr std::size_t most_dots = 1000; // no heavier than a line
  if (sorted.size() <= most_dots) return {std::move(sorted), {}};
  std::sort(sorted.begin(), sorted.end(), [](const Place& a, const Place& b) {
    const long left = column_of(a.x);
    const long right = column_of(b.x);
    return left != right ? left < right : a.y < b.y;
  });
  Cloud cloud;
  for (std::size_t begin = 0; begin < sorted.size();) {
    std::size_t end = begin + 1;
    while (end < sorted.size() && column_of(sorted[end].x) == column_of(sorted[begin].x))
      ++end;
    add_column(cloud, std::span(sorted).subspan(begin, end - begin));
    begin = end;
  }
  return cloud;
}

std::vector<std::vector<Extent>> thinned_band(const std::vector<Extent>& extents) {
  std::vector<std::vector<Extent>> runs;
  bool gap = true;
  for (const Extent& extent : extents) {
    if (!known(extent)) {
      gap = true;
      continue;
    }
    if (!runs.empty() && column_of(runs.back().back().x) == column_of(extent.x)) {
      Extent& last = runs.back().back(); // a gap narrower than its column cannot be seen
      last.low = std::max(last.low, extent.low);
      last.high = std::min(last.high, extent.high);
    } else {
      if (gap) runs.emplace_back();
      runs.back().push_back(extent);
    }
    gap = false;
  }
  return runs;
}

} // namespace goingrate
