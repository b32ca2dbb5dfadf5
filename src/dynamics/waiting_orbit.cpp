// The mean of a clock whose escapement waits for the amplitude to fall, impulse after impulse.
#include "goingrate/dynamics/intermittent.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/map.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {

namespace {

// Totals up to an upward crossing at which the escapement acts.
struct Impulse {
  double speed2 = 0.0;
  std::int64_t cycle = 0;
  TwoPart<double> excess, squares; // sums of T - 2 pi and of v^2
};

// The clock from impulse to impulse.
class Going {
public:
  explicit Going(const ClockParameters& clock)
      : clock_(clock), in_parts_(action_parts(clock).has_value()),
        pendulum_(clock, velocity_of_turning_angle(clock.gravity_share, clock.below), {1.0, 1.0}) {
    pendulum_.find_halves(false);
    now_.speed2 = pendulum_.speed2().value();
  }

  // Goes on to the next crossing at which the escapement acts after one at which it did not;
  // nullopt if the clock stops or `last_cycle` comes first.
  std::optional<Impulse> next(std::int64_t last_cycle) {
    while (now_.cycle < last_cycle) {
      const bool acts =
          escapement_acts(clock_, now_.cycle, pendulum_.velocity(), in_parts_ && acted_);
      if (acts && !acted_) {
        acted_ = true;
        const Impulse here = now_;
        return step(1.0) ? std::optional(here) : std::nullopt;
      }
      acted_ = acts;
      if (!step(acts ? 1.0 : 0.0)) return {};
    }
    return {};
  }

  // 2 pi + this is the shortest and the longest period so far.
  [[nodiscard]] double range_of_excess() const { return longest_ - shortest_; }

private:
  bool step(double factor) {
    const PeriodStep period = pendulum_.advance(factor);
    if (period.status != SwingStatus::crossed) return false;
    shortest_ = std::min(shortest_, period.excess);
    longest_ = std::max(longest_, period.excess);
    ++now_.cycle;
    now_.excess += period.excess;
    now_.speed2 = pendulum_.speed2().value();
    now_.squares += now_.speed2;
    return true;
  }

  const ClockParameters& clock_;
  bool in_parts_, acted_ = false;
  MapPendulum pendulum_;
  Impulse now_;
  double shortest_ = two_pi, longest_ = -two_pi;
};

WaitingOrbit between(const Impulse& first, const Impulse& last, std::int64_t impulses) {
  const auto periods = static_cast<double>(last.cycle - first.cycle);
  const auto mean = [&](TwoPart<double> to, const TwoPart<double>& from) {
    to += -from.hi;
    to += -from.lo;
    return to.value() / periods;
  };
  WaitingOrbit orbit;
  orbit.velocity = std::sqrt(first.speed2);
  orbit.periods = periods / static_cast<double>(impulses);
  orbit.mean_square = mean(last.squares, first.squares);
  orbit.period_excess = mean(last.excess, first.excess);
  orbit.impulses = impulses;
  return orbit;
}

} // namespace

std::optional<WaitingOrbit> waiting_orbit(const ClockParameters& clock) {
  if (!(clock.below > 0.0)) return {};
  check(clock);
  constexpr std::int64_t most_periods = 2'000'000; // some 0.1 s by the map
  constexpr double closed = 1e-12;                 // of v^2: of the rate, 1e-13 of lambda^2
  Going going(clock);
  std::optional<WaitingOrbit> best;
  bool closes = false;
  double nearest = 1.0; // smallest distance of the orbit from the mark since then, in v^2
  std::optional<Impulse> mark;
  // Brent's method to find a cycle: at every power of two the mark moves on to the present impulse,
  // so that the transient before the orbit is left behind.
  for (std::int64_t i = 0, marked = 0; !closes; ++i) {
    const auto here = going.next(most_periods);
    if (!here) break;
    if (mark) {
      const double miss = std::abs(here->speed2 / mark->speed2 - 1.0);
      closes = miss <= closed;
      // A near return that satisfies the inequality; the longest of these counts.
      if (miss <= nearest && (closes || !best || i - marked >= best->impulses))
        best = between(*mark, *here, i - marked);
      nearest = std::min(nearest, miss);
    }
    if ((i & (i - 1)) != 0) continue; // no power of two
    mark = here;
    marked = i;
    nearest = 1.0;
  }
  if (!best) return {};
  const double stretch = best->periods * static_cast<double>(best->impulses) * two_pi;
  best->rate_within = closes ? 1e-14 : 2.0 * going.range_of_excess() / stretch;
  return best;
}

} // namespace goingrate
