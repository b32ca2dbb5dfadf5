#include "step_search.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <type_traits>

namespace goingrate::timing_model {

namespace {

// The point of greatest gain within `reach` of `x` and between two bounds. The search varies the
// distance from x, so that it is finest there.
template <class Gain>
double best_near(double x, double reach, double low, double high, const Gain& gain) {
  constexpr int bits = 8;
  const auto loss = [&](double off) { return -gain(x + off); };
  const double least = std::max(-reach, low - x), most = std::min(reach, high - x);
  return x + boost::math::tools::brent_find_minima(loss, least, most, bits).first;
}

std::vector<double> difference(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] -= b[i];
  return a;
}

// Scalar products of the courses with each other and, last, with the series.
Eigen::MatrixXd products_of(const WhitenedSeries& series,
                            const std::vector<std::vector<double>>& courses) {
  const Eigen::MatrixXd x = series.without_taken(courses);
  Eigen::MatrixXd products(x.cols(), x.cols() + 1);
  products << x.transpose() * x, x.transpose() * series.rest();
  return products;
}

} // namespace

StepScan::StepScan(const Account& account, const RateBlocks& blocks) {
  const CourseMaker make(blocks);
  std::vector<std::vector<double>> steps;
  for (std::size_t block = rim; block + rim < blocks.rate.size(); ++block)
    steps.push_back(make.step(static_cast<double>(block)));
  const auto add_gains = [&](const Eigen::MatrixXd& products) {
    const Eigen::Index last = products.rows();
    for (Eigen::Index i = 0; i < last; ++i)
      of_step_[static_cast<std::size_t>(i)] += std::pow(products(i, last), 2) / products(i, i);
  };
  of_step_.assign(steps.size(), 0.0);
  const FixedNoiseAccount fixed = account.in_noise_beside();
  rate_products_ = products_of(fixed.rate, steps);
  add_gains(rate_products_);
  if (fixed.amplitude) add_gains(products_of(*fixed.amplitude, steps));
}

std::vector<std::size_t> StepScan::best_steps(std::size_t most, std::size_t apart) const {
  std::vector<double> left = of_step_;
  std::vector<std::size_t> blocks;
  while (blocks.size() < most) {
    const auto best = std::max_element(left.begin(), left.end());
    if (best == left.end() || !(*best > 0.0)) break;
    const auto at = static_cast<std::size_t>(best - left.begin());
    blocks.push_back(at + rim);
    const std::size_t from = at - std::min(at, apart), to = std::min(at + apart, left.size());
    std::fill(left.begin() + static_cast<std::ptrdiff_t>(from),
              left.begin() + static_cast<std::ptrdiff_t>(to), 0.0);
  }
  return blocks;
}

std::pair<std::size_t, std::size_t> StepScan::best_visit() const {
  constexpr Eigen::Index shortest = 4; // blocks
  const Eigen::Index last = rate_products_.rows();
  std::pair<std::size_t, std::size_t> best{rim, rim + shortest};
  double most = 0.0;
  for (Eigen::Index i = 0; i < last; ++i)
    for (Eigen::Index j = i + shortest; j < last; ++j) {
      const double gain =
          std::pow(rate_products_(i, last) - rate_products_(j, last), 2) /
          (rate_products_(i, i) - 2.0 * rate_products_(i, j) + rate_products_(j, j));
      if (gain <= most) continue;
      most = gain;
      best = {static_cast<std::size_t>(i) + rim, static_cast<std::size_t>(j) + rim};
    }
  return best;
}

FittedVisit fitted_visit(const Account& account, const RateBlocks& blocks, std::size_t from,
                         std::size_t to) {
  const CourseMaker make(blocks);
  const auto courses = [&](double begin, double end) {
    return Courses{
        .rate = {difference(make.step(begin), make.step(end))}, .amplitude = {}, .dates = 2};
  };
  FittedVisit visit{static_cast<double>(from), static_cast<double>(to), {}};
  const FixedNoiseAccount fixed = account.in_noise_beside(courses(visit.from, visit.to));
  const auto gain = [&](double begin, double end) { return fixed.gain_of(courses(begin, end)); };
  constexpr double reach = 1.5; // blocks
  const auto blocks_in_all = static_cast<double>(blocks.rate.size());
  visit.from =
      best_near(visit.from, reach, 0.0, visit.to, [&](double at) { return gain(at, visit.to); });
  visit.to = best_near(visit.to, reach, visit.from, blocks_in_all,
                       [&](double at) { return gain(visit.from, at); });
  visit.courses = courses(visit.from, visit.to);
  return visit;
}

StepSearch::StepSearch(const Account& account, const RateBlocks& blocks, double place, double doubt)
    : account_(account), make_(blocks), block_s_(blocks.length_s), place_(place),
      doubt_(std::min(std::max(1.0, doubt),
                      0.5 * std::min(place, static_cast<double>(blocks.rate.size()) - place))),
      first_log_time_(std::log(0.3 * block_s_)),
      last_log_time_(std::log(block_s_ * (static_cast<double>(blocks.rate.size()) - place))) {}

// Times and time constants are compared in fixed noise: first in that without the change, then in
// that with the best change so far. The likelihood may have a peak for each number of powers, at
// time constants that differ by a factor of two.
FittedStep StepSearch::best(ChangeKind kind) const {
  const FixedNoiseAccount fixed = account_.in_noise_beside();
  std::vector<FittedStep> starts; // one for each time constant
  const double first =
      kind == ChangeKind::regulation ? last_log_time_ : first_log_time_ + log_time_reach;
  for (double log_time = first; log_time <= last_log_time_; log_time += 2.0 * log_time_reach)
    starts.push_back(best_place(kind, log_time, fixed));
  std::stable_sort(starts.begin(), starts.end(),
                   [](const FittedStep& a, const FittedStep& b) { return a.gain > b.gain; });
  FittedStep best;
  constexpr std::size_t most_starts = 4;
  for (std::size_t i = 0; i < std::min(starts.size(), most_starts); ++i) {
    FittedStep step = polished(kind, std::move(starts[i]));
    if (step.gain > best.gain) best = std::move(step);
  }
  return best;
}

FittedStep StepSearch::best_place(ChangeKind kind, double log_time,
                                  const FixedNoiseAccount& fixed) const {
  FittedStep best;
  for (double place = place_ - doubt_; place <= place_ + doubt_; place += stride()) {
    FittedStep step = at(kind, place, log_time, fixed);
    if (step.gain > best.gain) best = std::move(step);
  }
  return best;
}

FittedStep StepSearch::polished(ChangeKind kind, FittedStep step) const {
  double place = step.place, log_time = std::log(step.time_s);
  for (int round = 0; round < 3; ++round) { // place and time are almost independent
    const FixedNoiseAccount fixed = account_.in_noise_beside(step.courses);
    if (round == 0) place = best_place(kind, log_time, fixed).place;
    const auto gain = [&](double at_place, double at_log_time) {
      return at(kind, at_place, at_log_time, fixed).gain;
    };
    place = best_near(place, stride(), place_ - doubt_, place_ + doubt_,
                      [&](double at_place) { return gain(at_place, log_time); });
    if (kind != ChangeKind::regulation)
      log_time = best_near(log_time, log_time_reach, first_log_time_, last_log_time_,
                           [&](double at_log_time) { return gain(place, at_log_time); });
    step = at(kind, place, log_time, fixed);
  }
  return by(account_, kind, place, log_time);
}

// The amplitude and the rate are nonlinear functions of the squared amplitude, so they also contain
// powers of its exponential approach, which are visible if the change is large.
void StepSearch::add_power(int power, ChangeKind kind, double place, double log_time,
                           Courses& courses) const {
  if (kind == ChangeKind::regulation) {
    courses.rate.push_back(make_.step(place));
    return;
  }
  std::vector<double> course = make_.approach(place, std::exp(log_time) / power);
  if (power > 1) course = difference(std::move(course), courses.amplitude.front());
  courses.amplitude.push_back(course);
  if (power == 1 && kind == ChangeKind::drive) {
    courses.rate.push_back(make_.step(place));
    course = difference(std::move(course), courses.rate.front());
  }
  courses.rate.push_back(std::move(course));
}

Courses StepSearch::courses_of(ChangeKind kind, double place, double log_time, int powers) const {
  Courses courses{.rate = {}, .amplitude = {}, .dates = 1};
  if (kind != ChangeKind::regulation) courses.times = 1;
  for (int power = 1; power <= powers; ++power)
    add_power(power, kind, place, log_time, courses);
  return courses;
}

template <class Gains>
FittedStep StepSearch::by(Gains& gains, ChangeKind kind, double place, double log_time) const {
  FittedStep step{.place = place, .time_s = std::exp(log_time), .courses = {}};
  const bool relaxes = kind != ChangeKind::regulation;
  const int most_powers = relaxes ? 3 : 1; // more could imitate a jump
  Courses courses = courses_of(kind, place, log_time, 0);
  for (int power = 1; power <= most_powers; ++power) {
    add_power(power, kind, place, log_time, courses);
    const double gain = gains.gain_of(courses);
    if (gain <= step.gain) break;
    // If the logged amplitude does not follow, this kind of change is ruled out, whatever the rate
    // does.
    if constexpr (std::is_same_v<Gains, const Account>)
      if (relaxes && gains.sees_amplitude() && gains.amplitude_gain_of(courses) < 0.0) break;
    step.gain = gain;
    step.courses = courses;
  }
  return step;
}

FittedStep StepSearch::at(ChangeKind kind, double place, double log_time,
                          const FixedNoiseAccount& fixed) const {
  GrowingGains gains(fixed);
  return by(gains, kind, place, log_time);
}

// The derivatives of the courses with respect to place and time constant are fitted as further
// courses, of sizes near 0, so that the sigmas include the uncertainty of both.
Sizes StepSearch::sizes_of(ChangeKind kind, const FittedStep& step) const {
  const double log_time = std::log(step.time_s);
  const int powers = std::max(1, static_cast<int>(step.courses.amplitude.size()));
  Courses with_slopes = courses_of(kind, step.place, log_time, powers);
  Sizes sizes = account_.sizes_of(with_slopes);
  const auto sum = [](const std::vector<std::vector<double>>& courses,
                      const std::vector<double>& size) {
    std::vector<double> total(courses.empty() ? 0 : courses.front().size(), 0.0);
    for (std::size_t c = 0; c < size.size(); ++c)
      for (std::size_t i = 0; i < total.size(); ++i)
        total[i] += size[c] * courses[c][i];
    return total;
  };
  const auto add_slope = [&](const Courses& up, const Courses& down) {
    const auto add = [&](auto series, const std::vector<double>& size) {
      if (size.empty()) return;
      (with_slopes.*series).push_back(difference(sum(up.*series, size), sum(down.*series, size)));
    };
    add(&Courses::rate, sizes.rate);
    add(&Courses::amplitude, sizes.amplitude);
  };
  constexpr double place_step_blocks = 0.25, log_time_step = 0.1;
  add_slope(courses_of(kind, step.place + place_step_blocks, log_time, powers),
            courses_of(kind, step.place - place_step_blocks, log_time, powers));
  if (kind != ChangeKind::regulation)
    add_slope(courses_of(kind, step.place, log_time + log_time_step, powers),
              courses_of(kind, step.place, log_time - log_time_step, powers));
  const Sizes wide = account_.sizes_of(with_slopes);
  const auto take_sigmas = [](std::vector<double>& sigma, const std::vector<double>& all) {
    std::copy_n(all.begin(), sigma.size(), sigma.begin());
  };
  take_sigmas(sizes.rate_sigma, wide.rate_sigma);
  take_sigmas(sizes.amplitude_sigma, wide.amplitude_sigma);
  return sizes;
}

} // namespace goingrate::timing_model
