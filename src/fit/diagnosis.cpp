#include "goingrate/fit/diagnosis.hpp"

#include "rate_blocks.hpp"

#include "goingrate/base/scaled_time.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace goingrate {

namespace {

using namespace timing_model;

constexpr double strong = 6.0; // of BIC

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Courses of the rate against noise alone.
class Courses {
public:
  explicit Courses(const TimingData& data)
      : data_(data), blocks_(rate_blocks(data, std::min<std::size_t>(1024, data.size() / 16))),
        rate_(cosines(blocks_.rate, false)), white_(regress(rate_, {}, first, false)),
        wander_(regress(rate_, {}, first, true)),
        price_(std::log(static_cast<double>(blocks_.rate.size()))) {}

  [[nodiscard]] const RateBlocks& blocks() const { return blocks_; }

  struct Found {
    double gain = 0.0;        ///< BIC of white noise alone less that of white noise and the course
    double over_wander = 0.0; ///< BIC of a wander less that of the wander and the course
    RateRegression fit;       ///< beside the wander
  };
  /// `numbers`: what the course has beside its coefficients, such as a date.
  [[nodiscard]] Found gain_of(const std::vector<std::vector<double>>& causes, int numbers) const {
    std::vector<std::vector<double>> transformed;
    for (const auto& cause : causes)
      transformed.push_back(cosines(cause, false));
    const double price = price_ * static_cast<double>(static_cast<int>(causes.size()) + numbers);
    Found found{0.0, 0.0, regress(rate_, transformed, first, true)};
    found.gain = white_.deviance - regress(rate_, transformed, first, false).deviance - price;
    found.over_wander = wander_.deviance - found.fit.deviance - price;
    return found;
  }
  /// What flicker and random walk add to white noise, on the same scale.
  [[nodiscard]] double gain_of_wander() const {
    return white_.deviance - wander_.deviance - 2.0 * price_;
  }
  [[nodiscard]] std::vector<double> ramp() const {
    std::vector<double> t;
    for (std::size_t i = 0; i < blocks_.rate.size(); ++i)
      t.push_back(static_cast<double>(i) * blocks_.length_s / seconds_per_day);
    return t;
  }
  [[nodiscard]] std::vector<double> step_at(std::size_t block) const {
    std::vector<double> s(blocks_.rate.size(), 0.0);
    std::fill(s.begin() + static_cast<std::ptrdiff_t>(block), s.end(), 1.0);
    return s;
  }
  // The block a step falls into: part of it is as before.
  [[nodiscard]] std::vector<double> block_alone(std::size_t block) const {
    std::vector<double> s(blocks_.rate.size(), 0.0);
    s[block] = 1.0;
    return s;
  }
  // What dies away after a step, with a time constant.
  [[nodiscard]] std::vector<double> return_at(std::size_t block, double time_s) const {
    std::vector<double> s(blocks_.rate.size(), 0.0);
    const double ratio = std::exp(-blocks_.length_s / time_s);
    double value = time_s / blocks_.length_s * (1.0 - ratio); // the mean over the first block
    for (std::size_t i = block; i < s.size(); ++i, value *= ratio)
      s[i] = value;
    return s;
  }

private:
  static constexpr std::size_t first = 1;
  const TimingData& data_;
  RateBlocks blocks_;
  std::vector<double> rate_;
  RateRegression white_, wander_;
  double price_;
};

// Where the rate jumps: the greatest difference of medians over some blocks before and after.
std::vector<std::size_t> likely_steps(const std::vector<double>& rate) {
  std::vector<std::size_t> places;
  for (const std::size_t reach : {4U, 12U, 40U}) {
    if (rate.size() < 4 * reach) continue;
    std::size_t best = 0;
    double most = 0.0;
    for (std::size_t i = reach; i + reach < rate.size(); ++i) {
      const auto at = rate.begin() + static_cast<std::ptrdiff_t>(i);
      const auto far = static_cast<std::ptrdiff_t>(reach);
      const double difference = std::abs(median({at, at + far}) - median({at - far, at}));
      if (difference > most) {
        most = difference;
        best = i;
      }
    }
    places.push_back(best);
  }
  return places;
}

void add(std::vector<Suspicion>& all, Cause cause, double strength, std::string evidence,
         std::string against = {}) {
  if (strength > strong) all.push_back({cause, strength, std::move(evidence), std::move(against)});
}

std::string daily(double rate) { return fmt::format("{:+.3g} s/day", rate * seconds_per_day); }

void look_for_answers(const Courses& courses, const TimingData& data, std::vector<Suspicion>& all) {
  for (std::size_t k = 0; k < data.terms.size(); ++k) {
    const std::string& name = data.terms[k].name;
    if (name != "temperature" && name != "pressure") continue;
    const auto& values = courses.blocks().values[k];
    if (std::all_of(values.begin(), values.end(), [](double v) { return std::abs(v) < 1e-9; }))
      continue;
    const auto found = courses.gain_of({values}, 0);
    if (found.over_wander < strong) continue; // a wander may go with the weather by chance
    add(all, name == "temperature" ? Cause::temperature : Cause::pressure, found.gain,
        fmt::format("the rate answers by {} per {} (+- {:.2g})", daily(found.fit.coefficients[0]),
                    name == "temperature" ? "K" : "mbar", found.fit.sigmas[0] * seconds_per_day),
        name == "temperature" ? "heating also changes the oil and the air: compare two seasons"
                              : "");
  }
}

void look_for_steps(const Courses& courses, std::vector<Suspicion>& all) {
  struct Best {
    double gain = 0.0;
    std::size_t block = 0;
    Courses::Found found;
    double time_s = 0.0;
  } step, returning;
  const double block_s = courses.blocks().length_s;
  for (const std::size_t place : likely_steps(courses.blocks().rate))
    for (std::size_t block = place > 3 ? place - 3 : 1; block <= place + 3; ++block) {
      if (block + 1 >= courses.blocks().rate.size()) continue;
      const auto step_here = courses.step_at(block), within = courses.block_alone(block);
      const auto plain = courses.gain_of({step_here, within}, 1);
      if (plain.gain > step.gain) step = {plain.gain, block, plain, 0.0};
      for (const double time_s : {block_s, 2.0 * block_s, 5.0 * block_s}) {
        const auto both = courses.gain_of({step_here, within, courses.return_at(block, time_s)}, 2);
        const auto& b = both.fit.coefficients;
        const bool overshoots = std::abs(b[2]) > std::abs(b[0]);
        if (overshoots && both.gain > returning.gain) returning = {both.gain, block, both, time_s};
      }
    }
  const auto when = [&](std::size_t block) {
    return fmt::format("{:.3g} h after the start", static_cast<double>(block) * block_s / 3600.0);
  };
  if (returning.gain > step.gain + strong)
    add(all, Cause::drive_step, returning.gain,
        fmt::format("{} the rate jumps by {} more than it keeps, {}", when(returning.block),
                    daily(returning.found.fit.coefficients[2]),
                    daily(returning.found.fit.coefficients[0])),
        "amplitudes, if the log has them, show the swing follow the drive");
  else
    add(all, Cause::length_step, step.gain,
        fmt::format("{} the rate changes by {} and stays", when(step.block),
                    daily(step.gain > 0.0 ? step.found.fit.coefficients[0] : 0.0)),
        "a small step of the drive looks alike if its return is hidden: look at the amplitude");
}

void look_for_ramp(const Courses& courses, std::vector<Suspicion>& all) {
  std::vector<double> t = courses.ramp(), t2;
  for (const double days : t)
    t2.push_back(days * days);
  const auto straight = courses.gain_of({t}, 0), bent = courses.gain_of({t, t2}, 0);
  const auto& found = bent.gain > straight.gain ? bent : straight;
  add(all, Cause::growing_friction, found.gain,
      fmt::format("the rate drifts by {} each day (+- {:.2g})", daily(found.fit.coefficients[0]),
                  found.fit.sigmas[0] * seconds_per_day),
      "a drifting length or drive drifts as well: friction lowers the amplitude, a length does "
      "not");
}

// A time that is displaced once: one period is longer or shorter and its neighbours are not.
void look_for_shift(const TimingData& data, std::vector<Suspicion>& all) {
  std::vector<double> period, size;
  for (std::size_t i = 1; i < data.size(); ++i)
    period.push_back((data.lateness_s[i] - data.lateness_s[i - 1]) /
                     (data.cycle[i] - data.cycle[i - 1]));
  const double middle = median(period);
  for (const double p : period)
    size.push_back(std::abs(p - middle));
  const double scatter = 1.4826 * median(size); // standard deviation over median of the size
  // The mean lateness of some beats on either side, less the way the rate goes.
  constexpr std::size_t reach = 16;
  double most = 0.0;
  std::size_t place = 0;
  std::vector<double> jumps;
  for (std::size_t i = reach; i + reach < period.size(); ++i) {
    const double jump = period[i] - 0.5 * (period[i - 1] + period[i + 1]);
    const double second = std::abs(period[i] - middle);
    if (second < 6.0 * scatter) continue;
    double before = 0.0, after = 0.0;
    for (std::size_t k = 1; k < reach; ++k) {
      before += period[i - k] / (reach - 1.0);
      after += period[i + k] / (reach - 1.0);
    }
    const double shift = period[i] - 0.5 * (before + after); // does not come back
    if (std::abs(shift) > std::abs(most) && std::abs(jump) > 0.5 * std::abs(shift)) {
      most = shift;
      place = i;
    }
  }
  if (scatter == 0.0 || most == 0.0) return;
  const double z2 = std::pow(most / scatter, 2);
  const double price = 2.0 * std::log(static_cast<double>(period.size()));
  add(all, Cause::sensor_shift, z2 - price,
      fmt::format("{:.3g} h after the start one period is {:+.3g} ms off, and the clock goes on as "
                  "before",
                  data.elapsed_s[place] / 3600.0, 1e3 * most),
      "a knock does the same once; a sensor that was moved shows it in the other direction's beats "
      "too");
}

std::string by_chance(double probability) {
  constexpr double never = 1e-9; // such tails are the model's, not the world's
  return probability < never ? std::string("which chance does not do")
                             : fmt::format("by chance once in {:.1g} logs", 1.0 / probability);
}

void look_for_wheel(const DiagnosisInput& input, std::vector<Suspicion>& all) {
  for (const SpectralLine& line : input.lines) {
    const double period_s = 1.0 / line.frequency_hz;
    constexpr double slowest = 4.0 * 3600.0; // of a wheel in the train
    if (period_s > slowest || line.false_alarm > 1e-4) continue;
    add(all, Cause::wheel, -2.0 * std::log(std::max(line.false_alarm, 1e-300)),
        fmt::format("the rate swings by {} every {:.5g} s, {}", daily(line.amplitude), period_s,
                    by_chance(line.false_alarm)),
        "give the teeth (spectrum --train) to know the wheel");
    return;
  }
}

// White noise of the rate from period to period, from the walk of the times over 16 periods.
double walk_per_period(const TimingData& data) {
  constexpr std::size_t stride = 16;
  std::vector<double> near, far;
  for (std::size_t i = 0; i + 2 * stride < data.size(); i += 3) {
    const auto& x = data.lateness_s;
    near.push_back(std::pow(x[i + 2] - 2.0 * x[i + 1] + x[i], 2));
    far.push_back(std::pow(x[i + 2 * stride] - 2.0 * x[i + stride] + x[i], 2));
  }
  constexpr double to_mean = 2.198; // of one chi-squared over its median
  // 6 j^2 + 2 w^2 and 6 j^2 + 2 stride w^2.
  const double excess = to_mean * (median(far) - median(near)) / (2.0 * (stride - 1.0));
  return std::sqrt(std::max(0.0, excess));
}

void look_at_noise(const DiagnosisInput& input, const Courses& courses,
                   std::vector<Suspicion>& all) {
  // What a step, a ramp or the weather explains is a wander too: the better account comes first.
  add(all, Cause::slow_drive, courses.gain_of_wander(),
      "the rate wanders more than white noise would",
      "amplitudes tell a wandering drive from a wandering length");
  const double rough = walk_per_period(*input.data) / input.nominal_period_s;
  constexpr double usual = 3e-5; // relative: a drive of some 8 % at the usual gains
  if (rough > usual)
    add(all, Cause::rough_drive, 20.0 * rough / usual,
        fmt::format("the rate is rough from beat to beat, {:.2g} of itself (rms)", rough),
        "a loose suspension or a worn escapement; the amplitude tells, and so does a hand on the "
        "case");
}

} // namespace

std::string_view name_of(Cause cause) {
  switch (cause) {
  case Cause::slow_drive:
    return "slow drive";
  case Cause::drive_step:
    return "step of the drive";
  case Cause::growing_friction:
    return "growing friction";
  case Cause::temperature:
    return "temperature";
  case Cause::pressure:
    return "pressure";
  case Cause::length_step:
    return "step of the length";
  case Cause::wheel:
    return "a wheel";
  case Cause::sensor_shift:
    return "shift of the sensor";
  case Cause::missed_beats:
    return "missed beats";
  case Cause::rough_drive:
    break;
  }
  return "rough drive";
}

std::vector<Suspicion> diagnose(const DiagnosisInput& input) {
  std::vector<Suspicion> all;
  constexpr std::size_t least = 2000;
  if (input.data == nullptr || input.data->size() < least) return all;
  constexpr double too_many = 1e-3;
  if (input.missed_share > too_many)
    add(all, Cause::missed_beats, 1e5 * input.missed_share,
        fmt::format("{:.2g} % of the beats are missing", 100.0 * input.missed_share),
        "the clock itself may be well: clean and aim the sensor");
  look_for_shift(*input.data, all);
  look_for_wheel(input, all);
  const Courses courses(*input.data);
  look_for_answers(courses, *input.data, all);
  look_for_steps(courses, all);
  look_for_ramp(courses, all);
  look_at_noise(input, courses, all);
  std::sort(all.begin(), all.end(),
            [](const Suspicion& a, const Suspicion& b) { return a.strength > b.strength; });
  return all;
}

} // namespace goingrate
