#include "goingrate/dynamics/ensemble.hpp"

#include "base/scaled_time.hpp"
#include "base/workers.hpp"
#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/stationary.hpp"
#include "base/lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace goingrate {

namespace {

constexpr std::size_t lanes = MapPatch::lanes;
using Lane = std::array<double, lanes>;

// TwoPart, lane by lane: the same operations in the same order.
struct LaneSums {
  Lane hi{}, lo{};
  [[nodiscard]] TwoPart<double> at(std::size_t k) const { return {hi[k], lo[k]}; }
  void set(std::size_t k, const TwoPart<double>& value) {
    hi[k] = value.hi;
    lo[k] = value.lo;
  }
};

[[gnu::always_inline]] inline void add(double& hi, double& lo, double x) {
  const double sum = hi + x, part = sum - hi;
  lo += (hi - (sum - part)) + (x - part);
  const double all = sum + lo;
  lo -= all - sum;
  hi = all;
}

GOINGRATE_WIDEST_LANES
void add_to_lanes(LaneSums& sums, const Lane& x) {
  for (std::size_t k = 0; k < lanes; ++k)
    add(sums.hi[k], sums.lo[k], x[k]);
}

// A period to each lane's time: nominal period and excess, as ClockRun adds them.
GOINGRATE_WIDEST_LANES
void add_period(LaneSums& time, const TwoPart<double>& nominal, const Lane& excess_s) {
  for (std::size_t k = 0; k < lanes; ++k) {
    double hi = time.hi[k], lo = time.lo[k];
    add(hi, lo, nominal.hi);
    add(hi, lo, nominal.lo);
    add(hi, lo, excess_s[k]);
    time.hi[k] = hi;
    time.lo[k] = lo;
  }
}

// Lanes can be used only for what all of them do at the same period.
bool fits_lanes(const Scenario& scenario, Method method) {
  const bool by_period =
      std::all_of(scenario.events.begin(), scenario.events.end(), [](const ClockEvent& event) {
        return event.at_period && !event.nominal_period_s && !event.every && !event.below;
      });
  return method == Method::map && !scenario.clock.is_intermittent() && by_period &&
         scenario.periods && scenario.length.none() &&
         scenario.sensor.edges == SensorEdges::up;
}

// The clocks of the scenario, each with its map; one set a thread, since maps grow as they are
// used.
struct Stage {
  std::int64_t from_cycle;
  ClockParameters clock;
  ReturnMap map;
};

std::vector<Stage> stages_of(const Scenario& scenario) {
  const FactorRange factors = factor_range(scenario.drive);
  std::vector<Stage> stages;
  stages.push_back({0, scenario.clock, ReturnMap(scenario.clock, factors)});
  auto events = scenario.events;
  std::stable_sort(events.begin(), events.end(),
                   [](const auto& a, const auto& b) { return *a.at_period < *b.at_period; });
  for (const ClockEvent& event : events) {
    const ClockParameters clock = event.applied_to(stages.back().clock);
    stages.push_back({*event.at_period, clock, ReturnMap(clock, factors)});
  }
  return stages;
}

class LaneGroup {
public:
  LaneGroup(const Scenario& scenario, std::vector<Stage>& stages, double velocity,
            std::span<const std::uint64_t> seeds)
      : scenario_(scenario), stages_(stages), count_(seeds.size()) {
    for (std::size_t k = 0; k < lanes; ++k) {
      // Lanes beyond the last realisation run a copy whose result is ignored.
      drives_.emplace_back(scenario.drive, scenario.clock.nominal_period_s,
                           seeds[std::min(k, count_ - 1)]);
      direct_.emplace_back(scenario.clock, velocity);
      speed2_.set(k, direct_.back().speed2());
    }
  }

  // Runs to the end; `each(k, period)` after every period if wanted.
  template <class Each> void run(Each each) {
    while (cycle_ < *scenario_.periods && going_ > 0) {
      while (stage_ + 1 < stages_.size() && cycle_ >= stages_[stage_ + 1].from_cycle)
        next_stage();
      Lane factor, excess;
      for (std::size_t k = 0; k < lanes; ++k)
        factor[k] = stopped(k) ? 1.0 : drives_[k].next(time_.hi[k]);
      if (!together(factor, excess)) one_by_one(factor, excess);
      finish(excess);
      last_factor_ = factor;
      last_excess_ = excess;
      for (std::size_t k = 0; k < count_; ++k)
        if (!stopped(k)) each(k);
    }
  }

  [[nodiscard]] SwingStatus status(std::size_t k) const { return status_[k]; }

  // The period completed last.
  [[nodiscard]] Period period(std::size_t k) const {
    const TimeScale scale(clock().nominal_period_s);
    Period period;
    period.cycle = status_[k] == SwingStatus::crossed ? cycle_ : stopped_at_[k];
    period.time_s = time_.at(k);
    period.nominal_period_s = clock().nominal_period_s;
    period.period_s = scale.nominal().hi + scale.seconds(last_excess_[k]);
    period.down_s = time_.at(k); // not computed; half a period before, to first order
    period.down_s += -0.5 * period.period_s;
    period.rate_excess = rate_excess_of(last_excess_[k]);
    period.velocity = std::sqrt(speed2_.at(k).value());
    period.amplitude_rad = turning_angle_of_velocity(clock().gravity_share, period.velocity);
    period.mu = drive_strength(clock()) * last_factor_[k];
    return period;
  }

private:
  [[nodiscard]] const ClockParameters& clock() const { return stages_[stage_].clock; }
  [[nodiscard]] bool stopped(std::size_t k) const { return status_[k] != SwingStatus::crossed; }

  void next_stage() {
    ++stage_;
    for (auto& direct : direct_)
      direct.set_clock(clock());
    patch_ = nullptr;
  }

  // One period of all lanes through one patch; false if a lane does not fit.
  bool together(const Lane& factor, Lane& excess) {
    ReturnMap& map = stages_[stage_].map;
    if (patch_ == nullptr || !patch_->contains(speed2_.hi[0])) patch_ = map.find(speed2_.hi[0]);
    if (patch_ == nullptr || irregular_ || going_ < lanes) return false;
    bool fits = true;
    for (std::size_t k = 0; k < lanes; ++k)
      fits = fits & patch_->contains(speed2_.hi[k]) & map.factors().contains(factor[k]);
    if (!fits) return false;
    Lane change;
    patch_->at(speed2_.hi, factor, change, excess);
    add_to_lanes(speed2_, change);
    return true;
  }

  // Steps each lane as MapPendulum does.
  void one_by_one(const Lane& factor, Lane& excess) {
    ReturnMap& map = stages_[stage_].map;
    irregular_ = false;
    for (std::size_t k = 0; k < lanes; ++k) {
      excess[k] = 0.0;
      if (stopped(k)) continue;
      const MapPatch* patch = map.find(speed2_.hi[k]);
      if (patch != nullptr && map.factors().contains(factor[k]) && direct_[k].is_regular()) {
        const auto values = patch->at(speed2_.hi[k], factor[k]);
        excess[k] = values.excess;
        TwoPart<double> speed2 = speed2_.at(k);
        speed2 += values.speed2_change;
        speed2_.set(k, speed2);
        continue;
      }
      direct_[k].set_speed2(speed2_.at(k));
      const PeriodStep step = direct_[k].advance(factor[k]);
      if (step.status != SwingStatus::crossed) {
        status_[k] = step.status;
        stopped_at_[k] = cycle_;
        --going_;
        continue;
      }
      excess[k] = step.excess;
      speed2_.set(k, direct_[k].speed2());
      irregular_ = irregular_ || !direct_[k].is_regular();
    }
  }

  void finish(const Lane& excess) {
    const TimeScale scale(clock().nominal_period_s);
    Lane seconds;
    for (std::size_t k = 0; k < lanes; ++k)
      seconds[k] = scale.seconds(excess[k]);
    ++cycle_;
    if (going_ == lanes) return add_period(time_, scale.nominal(), seconds);
    const LaneSums before = time_;
    add_period(time_, scale.nominal(), seconds);
    for (std::size_t k = 0; k < lanes; ++k)
      if (stopped(k)) time_.set(k, before.at(k));
  }

  const Scenario& scenario_;
  std::vector<Stage>& stages_;
  std::size_t count_, stage_ = 0, going_ = lanes;
  std::vector<DriveSequence> drives_;
  std::vector<DirectPendulum> direct_; // for periods off the map, with the memory they need
  LaneSums speed2_, time_;
  Lane last_factor_{}, last_excess_{};
  std::array<SwingStatus, lanes> status_{};
  std::array<std::int64_t, lanes> stopped_at_{};
  std::int64_t cycle_ = 0;
  const MapPatch* patch_ = nullptr;
  bool irregular_ = false;
};

// The realisations have successive seeds.
std::vector<std::uint64_t> seeds_from(std::uint64_t first, std::size_t count) {
  std::vector<std::uint64_t> seeds(count);
  std::iota(seeds.begin(), seeds.end(), first);
  return seeds;
}

class Runner {
public:
  explicit Runner(const Scenario& scenario) : decided_(scenario) {
    const ClockRun first(scenario, 0); // checks the scenario and chooses the method
    start_ = first.last();
    decided_.method.method = first.method().method;
    if (fits_lanes(decided_, decided_.method.method)) stages_ = stages_of(decided_);
  }
  // Maps are not copied: each grows by itself.
  Runner(const Runner& other) : decided_(other.decided_), start_(other.start_) {
    if (!other.stages_.empty()) stages_ = stages_of(decided_);
  }
  Runner& operator=(const Runner&) = delete;
  [[nodiscard]] const Period& start() const { return start_; }

  // `each(k, period maker)` after every period, `last(k, period, status)` at the end.
  template <class Each, class Last>
  void run(std::span<const std::uint64_t> seeds, Each each, Last last) {
    if (stages_.empty()) return one_by_one(seeds, each, last);
    for (std::size_t base = 0; base < seeds.size(); base += lanes) {
      const auto now = seeds.subspan(base, std::min(lanes, seeds.size() - base));
      LaneGroup group(decided_, stages_, start_.velocity, now);
      group.run([&](std::size_t k) { each(base + k, [&] { return group.period(k); }); });
      for (std::size_t k = 0; k < now.size(); ++k)
        last(base + k, group.period(k), group.status(k));
    }
  }

private:
  template <class Each, class Last>
  void one_by_one(std::span<const std::uint64_t> seeds, Each each, Last last) {
    for (std::size_t k = 0; k < seeds.size(); ++k) {
      ClockRun run(decided_, seeds[k]);
      while (run.next())
        each(k, [&] { return run.last(); });
      last(k, run.last(), run.status());
    }
  }

  Scenario decided_;
  Period start_;
  std::vector<Stage> stages_; // empty: not in lanes
};

// Runs everything; `each(realisation, period maker)` after every period, `last(...)` at the end.
template <class Each, class Last>
void run_all(const Scenario& scenario, const EnsembleOptions& options, Each each, Last last) {
  if (options.realisations == 0) return;
  const Runner first(scenario);
  const auto seeds = seeds_from(options.seed, options.realisations);
  const std::size_t groups = (seeds.size() + lanes - 1) / lanes;
  share_out(groups, threads_or_usual(options.threads), [&] {
    return [&, runner = first](std::size_t g) mutable {
      const std::size_t base = g * lanes;
      runner.run(
          std::span(seeds).subspan(base, std::min(lanes, seeds.size() - base)),
          [&](std::size_t k, auto period) { each(base + k, period); },
          [&](std::size_t k, const Period& period, SwingStatus end) {
            last(base + k, period, end);
          });
    };
  });
}

} // namespace

struct Realisations::Engine : Runner {
  using Runner::Runner;
};

Realisations::Realisations(const Scenario& scenario)
    : engine_(std::make_unique<Engine>(scenario)) {}
Realisations::Realisations(const Realisations& other)
    : engine_(std::make_unique<Engine>(*other.engine_)) {}
Realisations::~Realisations() = default;

const Period& Realisations::start() const { return engine_->start(); }

std::vector<SwingStatus> Realisations::run(std::span<const std::uint64_t> seeds,
                                           const PeriodSink& sink) {
  std::vector<SwingStatus> status(seeds.size());
  engine_->run(
      seeds, [&](std::size_t k, auto period) { sink(k, period()); },
      [&](std::size_t k, const Period&, SwingStatus end) { status[k] = end; });
  return status;
}

std::vector<SwingStatus> run_ensemble(const Scenario& scenario, const EnsembleOptions& options,
                                      const PeriodSink& sink) {
  std::vector<SwingStatus> status(options.realisations);
  run_all(
      scenario, options, [&](std::size_t i, auto period) { sink(i, period()); },
      [&](std::size_t i, const Period&, SwingStatus end) { status[i] = end; });
  return status;
}

std::vector<Period> final_periods(const Scenario& scenario, const EnsembleOptions& options) {
  std::vector<Period> periods(options.realisations);
  run_all(
      scenario, options, [](std::size_t, auto) {},
      [&](std::size_t i, const Period& period, SwingStatus) { periods[i] = period; });
  return periods;
}

} // namespace goingrate
