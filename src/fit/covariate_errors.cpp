#include "covariate_errors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace goingrate::timing_model {

namespace {

using std::numbers::pi;

// The component size * cos(pi k t/T) of a covariate over the length T of the log.
struct Cosine {
  int k;
  double size;
};

// The cosines k = 1 to `most` of a covariate, without its mean and its linear trend.
std::vector<Cosine> cosines_of(const RateTerm& term, const std::vector<double>& t, int most) {
  // The mean value between two beats, the middle of that interval, and its width.
  std::vector<double> value, middle, width;
  double mean = 0.0, tilt = 0.0;
  const double length = t.back();
  for (std::size_t i = 1; i < t.size(); ++i) {
    width.push_back(t[i] - t[i - 1]);
    middle.push_back(0.5 * (t[i] + t[i - 1]));
    value.push_back((term.advance_s[i] - term.advance_s[i - 1]) / width.back());
    mean += value.back() * width.back() / length;
    tilt += value.back() * width.back() * (middle.back() - 0.5 * length);
  }
  const double slope = 12.0 * tilt / (length * length * length);
  std::vector<Cosine> all;
  for (int k = 1; k <= most; ++k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < value.size(); ++i)
      sum += (value[i] - mean - slope * (middle[i] - 0.5 * length)) * width[i] *
             std::cos(pi * k * middle[i] / length);
    all.push_back({k, 2.0 * sum / length});
  }
  return all;
}

} // namespace

void widen_by_readings(const Fitted& fitted, Certainty& known) {
  const FitProblem& problem = fitted.problem;
  const std::vector<double>& x = fitted.minimum.x;
  const TimingData& data = *problem.data;
  const double length = data.elapsed_s.back();
  std::vector<Eigen::VectorXd> shifts;
  for (const Slot& slot : problem.parameters.slots) {
    if (slot.quantity != Quantity::term || !slot.free) continue;
    const RateTerm& term = data.terms[slot.term];
    if (!(term.sigma > 0.0)) continue;
    const double step_s = term.step_s > 0.0 ? term.step_s : data.reference_period_s;
    const double sigma = term.sigma * std::sqrt(2.0 * step_s / length); // of a cosine
    constexpr int cosines_computed = 64;
    constexpr std::size_t cosines_used = 16;
    std::vector<Cosine> cosines = cosines_of(term, data.elapsed_s, cosines_computed);
    std::sort(cosines.begin(), cosines.end(),
              [](const Cosine& a, const Cosine& b) { return std::abs(a.size) > std::abs(b.size); });
    cosines.resize(cosines_used);
    for (const Cosine& cosine : cosines) {
      if (std::abs(cosine.size) < sigma) break;
      Correction shifted = problem.correction;
      const std::vector<double>& t = problem.asked().elapsed_s;
      shifted.late_s.resize(t.size());
      for (std::size_t i = 0; i < t.size(); ++i)
        shifted.late_s[i] -= slot.value(std::span<const double>(x)) * sigma * length /
                             (pi * cosine.k) * std::sin(pi * cosine.k * t[i] / length);
      shifts.push_back(shift_by(problem, x, shifted) - shift_by(problem, x, problem.correction));
    }
  }
  const auto own = known.factor.cols();
  known.factor.conservativeResize(Eigen::NoChange, own + static_cast<Eigen::Index>(shifts.size()));
  for (std::size_t i = 0; i < shifts.size(); ++i)
    known.factor.col(own + static_cast<Eigen::Index>(i)) = shifts[i];
}

} // namespace goingrate::timing_model
