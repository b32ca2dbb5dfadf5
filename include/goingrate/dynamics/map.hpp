// The return map: exact periods without integration.
//
// Between two upward crossings the motion depends only on x = v^2 and on the factor of the drive,
// which is renewed at crossings (Hoyng, eq. dmu). T - 2 pi, the change of v^2 and the time of the
// downward crossing are smooth functions of the two, away from the amplitude at which the
// escapement is just reached. On patches of x each is a product polynomial, from Chebyshev nodes
// that are integrated with 64 bits where the processor has them (Wide). Storing T - 2 pi and the
// change of v^2, not T and v', keeps the digits that matter.
//
// Patches are 8 % wide in x and made when the motion enters them; one holds the stationary swing in
// its middle. Their degrees come from the decay of the coefficients. Where the decay is too slow,
// where a node stalls or misses its switch, and for factors outside the range that was asked for,
// the direct integrator takes over, period by period, and is counted: nothing is extrapolated.
#pragma once

#include "goingrate/dynamics/direct.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace goingrate {

/// The range of drive factors a map is made for; a point is a steady drive.
struct FactorRange {
  double low = 1.0, high = 1.0;
  /// Whether the map knows a drive of this factor.
  [[nodiscard]] bool contains(double factor) const { return factor >= low && factor <= high; }
};

/// The arithmetic for the periods of a map: with the most digits, or in doubles, whose rounding
/// (some 1e-15 of T - 2 pi) is the same period after period and so adds up in the time.
enum class MapDigits { wide, of_a_double };

/// One patch: polynomials in x and factor, both mapped to [-1, 1].
class MapPatch {
public:
  /// The result of one period.
  struct Values {
    double speed2_change, excess;
  };
  /// Fits the patch low <= x < high; `usable()` tells whether it may be used.
  MapPatch(const ClockParameters& clock, double low, double high, const FactorRange& factors,
           MapDigits digits = MapDigits::wide);

  /// Whether the polynomials came out close enough.
  [[nodiscard]] bool usable() const { return usable_; }
  /// Whether x lies in the patch.
  [[nodiscard]] bool contains(double x) const { return x >= low_ && x < high_; }
  /// Degrees in x and in the factor.
  [[nodiscard]] std::array<std::size_t, 2> degrees() const {
    return {starts_.size() - 2, starts_[1] - 1};
  }

  /// One period at x with this drive.
  [[nodiscard]] Values at(double x, double factor) const;
  /// Time from the start to the downward crossing, minus pi.
  [[nodiscard]] double half_excess(double x, double factor) const;

  /// The same for many states at once, in SIMD lanes: bit for bit what `at` gives for each.
  static constexpr std::size_t lanes = 8;
  /// Lane by lane the change of v^2 and the excess.
  void at(const std::array<double, lanes>& x, const std::array<double, lanes>& factor,
          std::array<double, lanes>& speed2_change, std::array<double, lanes>& excess) const;

private:
  double low_, high_, factor_middle_, factor_scale_;
  bool usable_ = false;
  // Monomial coefficients, one row a power of x, where each row starts, and the last ends: change
  // of v^2 and excess side by side; the half apart.
  std::vector<std::size_t> starts_{0};
  std::vector<std::array<double, 2>> coefficients_;
  std::vector<double> half_;
};

/// The patches of one clock, made when they are first needed.
class ReturnMap {
public:
  /// Makes no patch yet. Throws ArgumentError for parameters out of range.
  ReturnMap(const ClockParameters& clock, const FactorRange& factors,
            MapDigits digits = MapDigits::wide);

  /// The patch that holds x, or nullptr if the map cannot serve there.
  [[nodiscard]] const MapPatch* find(double x);
  /// The drive it is made for.
  [[nodiscard]] const FactorRange& factors() const { return factors_; }
  /// How many were made so far.
  [[nodiscard]] std::size_t patches() const { return patches_.size(); }

private:
  ClockParameters clock_;
  FactorRange factors_;
  MapDigits digits_;
  double anchor_; // a patch is centred here
  std::map<int, std::unique_ptr<MapPatch>> patches_;
};

/// The pendulum advanced by the map, by the direct integrator where the map cannot serve.
///
/// At C within 2e-14 of the exact crossing times over 2000 periods, 2e-13 over 1e5
/// (MapTest.CrossingTimesOfPointC, MapTest.CrossingTimesOfANoisyDrive); with the digits of a double
/// its rate is within 2e-15 (MapTest.InDigitsOfADouble). 40 ns per period; a patch takes up to some
/// milliseconds to make.
class MapPendulum {
public:
  /// As DirectPendulum; `factors` bounds what advance() will be given most of the time.
  MapPendulum(const ClockParameters& clock, double velocity, const FactorRange& factors,
              MapDigits digits = MapDigits::wide);

  /// From the present crossing on the clock has these parameters; a new map is made.
  void set_clock(const ClockParameters& clock);
  /// One period, as DirectPendulum::advance.
  PeriodStep advance(double factor = 1.0);
  /// phi' at the last crossing.
  [[nodiscard]] double velocity() const { return direct_.velocity(); }
  /// The square of velocity().
  [[nodiscard]] const TwoPart<double>& speed2() const { return direct_.speed2(); }
  /// Restates the velocity for a nominal period changed by the factor `ratio`.
  void rescale(double ratio);

  /// Periods that the direct integrator had to do.
  [[nodiscard]] std::int64_t fallbacks() const { return fallbacks_; }
  /// Whether `advance` also finds the downward crossing (PeriodStep::half_excess).
  void find_halves(bool yes) { halves_ = yes; }

private:
  DirectPendulum direct_;
  // The patch for a factor of the drive at the present v^2, if there is one.
  const MapPatch* patch_for(double factor);

  struct Served {
    std::unique_ptr<ReturnMap> map;
    const MapPatch* patch = nullptr;
  };
  FactorRange factors_;
  MapDigits digits_;
  [[nodiscard]] Served* served_for(double factor);
  Served driven_, resting_; // the second for an escapement that rests
  Served before_, after_;   // the parts of an action that crossings cut in two (action_parts)
  bool halves_ = true;
  std::int64_t fallbacks_ = 0;
};

} // namespace goingrate
