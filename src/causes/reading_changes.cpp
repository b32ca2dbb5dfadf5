#include "reading_changes.hpp"

#include "account.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace goingrate::timing_model {

namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

// u and v of the header, as decades; `none` for 0.
struct Noise {
  static constexpr int none = -2, most = 9;
  int walk = none, wander = none;
};

// What may have happened, `after` a reading in units of the log's length.
struct Event {
  enum class Kind { rate, setting, misreading } kind{};
  Index reading = 0;
  double after = 0.0;
};

class Readings {
public:
  Readings(std::span<const double> time_s, std::span<const double> error_s)
      : error_(VectorXd::Map(error_s.data(), static_cast<Index>(error_s.size()))) {
    const Index n = error_.size();
    time_.resize(n);
    for (Index i = 0; i < n; ++i)
      time_[i] =
          (time_s[static_cast<std::size_t>(i)] - time_s.front()) / (time_s.back() - time_s.front());
    walk_.resize(n, n);
    wander_.resize(n, n);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        const double early = std::min(time_[i], time_[j]), late = std::max(time_[i], time_[j]);
        walk_(i, j) = early;
        wander_(i, j) = early * early * (3.0 * late - early) / 6.0;
      }
  }

  [[nodiscard]] Index size() const { return error_.size(); }
  [[nodiscard]] const VectorXd& time() const { return time_; }
  [[nodiscard]] const VectorXd& error() const { return error_; }
  [[nodiscard]] double usual_interval() const {
    std::vector<double> intervals;
    for (Index i = 1; i < size(); ++i)
      intervals.push_back(time_[i] - time_[i - 1]);
    const auto middle = intervals.begin() + std::ssize(intervals) / 2;
    std::nth_element(intervals.begin(), middle, intervals.end());
    return *middle > 0.0 ? *middle : 1.0 / static_cast<double>(size());
  }

  [[nodiscard]] Eigen::LLT<MatrixXd> covariance(const Noise& noise) const {
    MatrixXd sum = MatrixXd::Identity(size(), size());
    if (noise.walk > Noise::none) sum += std::pow(10.0, noise.walk) * walk_;
    if (noise.wander > Noise::none) sum += std::pow(10.0, noise.wander) * wander_;
    return sum.llt();
  }

  [[nodiscard]] VectorXd course(const Event& event) const {
    const auto since = time_.array() - time_[event.reading] - event.after;
    switch (event.kind) {
    case Event::Kind::rate:
      return since.max(0.0);
    case Event::Kind::setting:
      return (since >= 0.0).cast<double>();
    case Event::Kind::misreading:
      return VectorXd::Unit(size(), event.reading);
    }
    return {};
  }

  // The columns 1, t, and one for each event.
  [[nodiscard]] MatrixXd design(const std::vector<Event>& events) const {
    MatrixXd columns(size(), 2 + static_cast<Index>(events.size()));
    columns.col(0).setOnes();
    columns.col(1) = time_;
    for (std::size_t j = 0; j < events.size(); ++j)
      columns.col(2 + static_cast<Index>(j)) = course(events[j]);
    return columns;
  }

private:
  VectorXd time_, error_;
  MatrixXd walk_, wander_;
};

// Events with the noise that goes with them.
struct Explained {
  std::vector<Event> events;
  Noise noise;
  double deviance = std::numeric_limits<double>::infinity(); // -2 log L
};

// -2 log L at its greatest over a, b, c_j and s.
double deviance_of(const Readings& readings, const MatrixXd& design, const Noise& noise) {
  const auto factor = readings.covariance(noise);
  const MatrixXd x = factor.matrixL().solve(design);
  const VectorXd y = factor.matrixL().solve(readings.error());
  const auto n = static_cast<double>(readings.size());
  constexpr double rounding = 1e-13; // of the largest error: exact readings gain nothing from it
  const double least2 = n * std::pow(rounding * (1.0 + readings.error().cwiseAbs().maxCoeff()), 2);
  const double misfit2 = std::max(least2, (y - x * x.householderQr().solve(y)).squaredNorm());
  const double log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  return n * std::log(misfit2 / n) + log_determinant;
}

// Tries noise from `low` to `high`, in steps of `stride` decades.
void try_noise(const Readings& readings, const Noise& low, const Noise& high, int stride,
               Explained& best) {
  const MatrixXd design = readings.design(best.events);
  Noise noise;
  for (noise.walk = low.walk; noise.walk <= high.walk; noise.walk += stride)
    for (noise.wander = low.wander; noise.wander <= high.wander; noise.wander += stride) {
      const double deviance = deviance_of(readings, design, noise);
      if (deviance >= best.deviance) continue;
      best.deviance = deviance;
      best.noise = noise;
    }
}

// The events, with the noise near `about` that goes best with them.
Explained explained_near(const Readings& readings, std::vector<Event> events, const Noise& about) {
  Explained best{std::move(events), about};
  const auto less = [](int decade) { return std::max(Noise::none, decade - 1); };
  const auto more = [](int decade) { return std::min(Noise::most, decade + 1); };
  try_noise(readings, {less(about.walk), less(about.wander)},
            {more(about.walk), more(about.wander)}, 1, best);
  return best;
}

Explained explained(const Readings& readings, std::vector<Event> events) {
  constexpr int stride = 2; // decades
  Explained best{std::move(events), {}};
  try_noise(readings, {}, {Noise::most, Noise::most}, stride, best);
  return explained_near(readings, std::move(best.events), best.noise);
}

// The events in noise without a wander of the rate.
Explained steady(const Readings& readings, std::vector<Event> events) {
  Explained best{std::move(events), {}};
  try_noise(readings, {}, {Noise::most, Noise::none}, 1, best);
  return best;
}

// Where the rate may step: at every half of a usual interval from one reading to the next, with
// six readings or more on either side that belong to no other step.
void add_steps_of_rate(const Readings& readings, const std::vector<Event>& known,
                       std::vector<Event>& all) {
  constexpr Index fewest = 6; // so that the rates before and after have an uncertainty
  std::vector<double> edges{readings.time()[0], readings.time()[readings.size() - 1]};
  for (const Event& event : known)
    if (event.kind == Event::Kind::rate)
      edges.push_back(readings.time()[event.reading] + event.after);
  std::sort(edges.begin(), edges.end());
  const auto count = [&](double low, double high) {
    return ((readings.time().array() >= low) && (readings.time().array() <= high)).count();
  };
  const double usual = readings.usual_interval();
  for (Index i = 0; i + 1 < readings.size(); ++i) {
    constexpr double most_intervals = 20.0; // in a gap
    const double interval = readings.time()[i + 1] - readings.time()[i];
    const double halves = 2.0 * std::clamp(std::round(interval / usual), 1.0, most_intervals);
    for (double half = 0.0; half < halves; ++half) {
      const Event event{Event::Kind::rate, i, half / halves * interval};
      const double place = readings.time()[i] + event.after;
      const auto after = std::upper_bound(edges.begin(), edges.end(), place);
      if (after == edges.begin() || after == edges.end()) continue;
      if (count(*(after - 1), place) >= fewest && count(place, *after) >= fewest)
        all.push_back(event);
    }
  }
}

std::vector<Event> possible_events(const Readings& readings, const std::vector<Event>& known) {
  std::vector<Event> all;
  add_steps_of_rate(readings, known, all);
  constexpr Index fewest = 2; // readings on either side: a last one may as well be wrong
  for (Index i = fewest; i + fewest <= readings.size(); ++i)
    all.push_back({Event::Kind::setting, i});
  for (Index i = 0; i < readings.size(); ++i)
    all.push_back({Event::Kind::misreading, i});
  return all;
}

std::vector<Event> with(std::vector<Event> events, const Event& more) {
  events.push_back(more);
  return events;
}

// The event that explains most in the noise given.
Event best_event(const Readings& readings, const std::vector<Event>& known, const Noise& noise,
                 const std::vector<Event>& possible) {
  const auto factor = readings.covariance(noise);
  const MatrixXd x = factor.matrixL().solve(readings.design(known));
  const Eigen::HouseholderQR<MatrixXd> design(x);
  const auto unexplained = [&](const VectorXd& v) -> VectorXd { return v - x * design.solve(v); };
  const VectorXd rest = unexplained(factor.matrixL().solve(readings.error()));
  Event best = possible.front();
  double most = -1.0;
  for (const Event& event : possible) {
    const VectorXd white = factor.matrixL().solve(readings.course(event));
    const VectorXd course = unexplained(white);
    constexpr double least_new = 1e-6; // of a course: less is what the known ones explain
    if (!(course.squaredNorm() > least_new * white.squaredNorm())) continue;
    const double gain = std::pow(course.dot(rest), 2) / course.squaredNorm();
    if (gain <= most) continue;
    most = gain;
    best = event;
  }
  return best;
}

// One more event: placed in the noise that was found without it, then in that found with it; and
// placed in errors of reading alone, since a wander hides the place of what it is taken for.
Explained with_one_more(const Readings& readings, const Explained& before) {
  const std::vector<Event> possible = possible_events(readings, before.events);
  Explained best;
  for (const Noise& noise : {before.noise, Noise{}}) {
    const auto placed_in = [&](const Noise& known) {
      return with(before.events, best_event(readings, before.events, known, possible));
    };
    const Explained first = explained(readings, placed_in(noise));
    const Explained second = explained_near(readings, placed_in(first.noise), first.noise);
    for (const Explained& found : {first, second})
      if (found.deviance < best.deviance) best = found;
  }
  return best;
}

// Two events more that explain most together: a nut that was turned and turned back shows neither
// turn alone. They are placed in errors of reading and in the noise that was found without them.
Explained with_two_more(const Readings& readings, const Explained& before) {
  std::vector<Event> possible;
  for (const Event& event : possible_events(readings, before.events))
    if (event.kind == Event::Kind::setting ||
        (event.kind == Event::Kind::rate && event.after == 0.0))
      possible.push_back(event);
  Explained best;
  for (const Noise& noise : {before.noise, Noise{}}) {
    const auto factor = readings.covariance(noise);
    const MatrixXd x = factor.matrixL().solve(readings.design(before.events));
    const Eigen::HouseholderQR<MatrixXd> design(x);
    MatrixXd courses(readings.size(), static_cast<Index>(possible.size()));
    for (Index i = 0; i < courses.cols(); ++i)
      courses.col(i) = readings.course(possible[static_cast<std::size_t>(i)]);
    courses = factor.matrixL().solve(courses).eval();
    const VectorXd whole = courses.colwise().squaredNorm();
    courses -= (x * design.solve(courses)).eval();
    // Less of a course is what the known events, or the other one, explain.
    constexpr double least_new = 1e-6;
    for (Index i = 0; i < courses.cols(); ++i)
      if (!(courses.col(i).squaredNorm() > least_new * whole[i])) courses.col(i).setZero();
    const MatrixXd products = courses.transpose() * courses;
    const VectorXd seen = courses.transpose() * factor.matrixL().solve(readings.error());
    double most = 0.0;
    std::pair<Index, Index> pair{-1, -1};
    for (Index i = 0; i < courses.cols(); ++i)
      for (Index j = i + 1; j < courses.cols(); ++j) {
        const double both = products(i, j), all = products(i, i) * products(j, j) - both * both;
        if (!(all > least_new * products(i, i) * products(j, j))) continue;
        const double gain = (seen[i] * seen[i] * products(j, j) +
                             seen[j] * seen[j] * products(i, i) - 2.0 * seen[i] * seen[j] * both) /
                            all;
        if (gain <= most) continue;
        most = gain;
        pair = {i, j};
      }
    if (pair.first < 0) continue;
    Explained found = explained(
        readings, with(with(before.events, possible[static_cast<std::size_t>(pair.first)]),
                       possible[static_cast<std::size_t>(pair.second)]));
    if (found.deviance < best.deviance) best = std::move(found);
  }
  return best;
}

// 2 log L that the further events gain, less their price. The factor keeps the ratio of likelihoods
// of few readings distributed as that of many (Bartlett).
double gain_of(const Explained& with, const Explained& without, Index readings) {
  const auto n = static_cast<double>(readings);
  const double numbers = 3.0 + static_cast<double>(with.events.size());
  const auto more = static_cast<double>(with.events.size() - without.events.size());
  return (without.deviance - with.deviance) * (1.0 - numbers / n) - 3.0 * more * std::log(n);
}

// Each further fault is less likely by the same factor. The first needs twice a convincing gain: of
// rates that only wander, one in 25 looks like a step by one of them. A wander that remains beside
// the events imitates steps, whose gain is small compared with its own.
bool convinces(const Readings& readings, const Explained& more, const Explained& all) {
  if (!std::isfinite(more.deviance)) return false;
  double least = 0.0;
  for (std::size_t count = all.events.size() + 1; count <= more.events.size(); ++count)
    least += convincing_gain * static_cast<double>(1 + count);
  constexpr double least_share = 0.5;
  const double wander = steady(readings, more.events).deviance - more.deviance;
  return gain_of(more, all, readings.size()) > std::max(least, least_share * wander);
}

// Event by event, as long as each gains enough.
Explained everything(const Readings& readings) {
  constexpr std::size_t most_events = 8;
  Explained all = explained(readings, {});
  while (all.events.size() < most_events) {
    Explained more = with_one_more(readings, all);
    if (!convinces(readings, more, all)) more = with_two_more(readings, all);
    if (!convinces(readings, more, all)) break;
    all = std::move(more);
  }
  return all;
}

// The sizes of the events: least squares in their noise.
VectorXd sizes_of(const Readings& readings, const Explained& all) {
  const auto factor = readings.covariance(all.noise);
  const MatrixXd x = factor.matrixL().solve(readings.design(all.events));
  const VectorXd y = factor.matrixL().solve(readings.error());
  return x.householderQr().solve(y).tail(static_cast<Index>(all.events.size()));
}

} // namespace

std::vector<ReadingChange> changes_among_readings(std::span<const double> time_s,
                                                  std::span<const double> late_s) {
  constexpr std::size_t fewest_readings = 12;
  if (time_s.size() < fewest_readings || !(time_s.back() > time_s.front())) return {};
  const Readings readings(time_s, late_s);
  const Explained all = everything(readings);
  const VectorXd sizes = sizes_of(readings, all);
  const double length_s = time_s.back() - time_s.front();
  std::vector<ReadingChange> found;
  for (std::size_t j = 0; j < all.events.size(); ++j) {
    const Event& event = all.events[j];
    if (event.kind == Event::Kind::misreading) continue;
    std::vector<Event> others = all.events;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(j));
    const double gain = gain_of(all, explained(readings, others), readings.size());
    const bool is_of_rate = event.kind == Event::Kind::rate;
    const double size = sizes[static_cast<Index>(j)];
    if (gain > convincing_gain)
      found.push_back({(readings.time()[event.reading] + event.after) * length_s,
                       is_of_rate ? -size / length_s : size, gain, is_of_rate});
  }
  std::sort(found.begin(), found.end(),
            [](const ReadingChange& a, const ReadingChange& b) { return a.at_s < b.at_s; });
  return found;
}

std::vector<ReadingChange> changes_among_readings(const TimingData& data) {
  const UnevenReadings& read = data.as_read;
  if (read.elapsed_s.empty()) return changes_among_readings(data.elapsed_s, data.lateness_s);
  auto changes = changes_among_readings(read.elapsed_s, read.late_s);
  for (ReadingChange& change : changes)
    change.at_s += read.elapsed_s.front(); // counted from the first beat
  return changes;
}

// The share of a setting that a beat has: beats that stand in for uneven readings lie on the
// straight lines between these.
static double share_of_setting(const UnevenReadings& read, double set_s, double elapsed_s) {
  constexpr double rounding_s = 1e-3;
  const auto first =
      std::lower_bound(read.elapsed_s.begin(), read.elapsed_s.end(), set_s - rounding_s);
  if (first == read.elapsed_s.begin() || first == read.elapsed_s.end())
    return elapsed_s < set_s - rounding_s ? 0.0 : 1.0;
  const double before = *(first - 1);
  return std::clamp((elapsed_s - before) / (*first - before), 0.0, 1.0);
}

void level_settings(TimingData& data) {
  for (const ReadingChange& change : changes_among_readings(data)) {
    if (change.is_of_rate) continue;
    std::size_t beat = data.size() - 1; // the first that has most of it
    for (std::size_t i = data.size(); i-- > 0;) {
      const double share = share_of_setting(data.as_read, change.at_s, data.elapsed_s[i]);
      if (share >= 0.5) beat = i;
      data.lateness_s[i] -= share * change.size;
    }
    data.displaced.push_back({beat, change.size, change.gain});
    UnevenReadings& read = data.as_read;
    for (std::size_t i = 0; i < read.late_s.size(); ++i)
      read.late_s[i] -= share_of_setting(read, change.at_s, read.elapsed_s[i]) * change.size;
  }
}

} // namespace goingrate::timing_model
