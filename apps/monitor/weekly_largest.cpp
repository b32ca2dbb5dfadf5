#include "weekly_largest.hpp"

#include <algorithm>
#include <functional>

namespace goingrate::apps {

void WeeklyLargest::add(double size) { largest_.front() = std::max(largest_.front(), size); }

void WeeklyLargest::end_week() {
  std::shift_right(largest_.begin(), largest_.end(), 1);
  largest_.front() = 0.0;
}

double WeeklyLargest::habit() const {
  auto sorted = largest_;
  std::nth_element(sorted.begin(), sorted.begin() + 1, sorted.end(), std::greater<>());
  return sorted[1];
}

double WeeklyLargest::limit() const {
  auto sorted = largest_;
  std::nth_element(sorted.begin(), sorted.begin() + weeks / 2, sorted.end());
  const double its_own = habit();
  return its_own + std::max(0.5 * its_own, 2.0 * (its_own - sorted[weeks / 2]));
}

} // namespace goingrate::apps
