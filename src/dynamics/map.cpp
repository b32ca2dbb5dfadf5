#include "goingrate/dynamics/map.hpp"

#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/intermittent.hpp"
#include "goingrate/dynamics/stationary.hpp"
#include "base/lanes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

// Vectors of eight are passed between functions of this file only, which are all inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace goingrate {

namespace {

constexpr double patch_ratio = 1.08;
constexpr std::size_t most_rows = 18, most_columns = 10; // Chebyshev nodes

// cos(pi j / (2 count)) for count up to most_rows, from tables: the sums over nodes need the same
// few again and again.
Wide cosine(std::size_t j, std::size_t count) {
  static const auto tables = [] {
    std::array<std::vector<Wide>, most_rows + 1> of_count;
    for (std::size_t n = 1; n <= most_rows; ++n)
      for (std::size_t i = 0; i < 4 * n; ++i)
        of_count[n].push_back(
            std::cos(std::numbers::pi_v<Wide> * static_cast<Wide>(i) / static_cast<Wide>(2 * n)));
    return of_count;
  }();
  return tables[count][j % (4 * count)];
}

Wide node(std::size_t i, std::size_t count) { return cosine(2 * i + 1, count); }

// Monomial coefficients of the polynomial of degree count - 1 through values at Chebyshev nodes,
// with the Chebyshev coefficients on the way.
template <std::size_t most> struct Expansion {
  std::array<Wide, most> chebyshev{}, monomial{};

  explicit Expansion(const std::vector<Wide>& values) {
    const std::size_t count = values.size();
    for (std::size_t k = 0; k < count; ++k) {
      Wide sum = 0;
      for (std::size_t i = 0; i < count; ++i)
        sum += values[i] * cosine(k * (2 * i + 1), count);
      chebyshev[k] = sum * (k == 0 ? 1 : 2) / static_cast<Wide>(count);
    }
  }

  // Keeps the first `terms` and turns them into powers.
  void keep(std::size_t terms) {
    std::array<Wide, most + 1> before{}, now{}, next{}; // T_{k-1}, T_k, T_{k+1}
    now[0] = 1;
    monomial.fill(0);
    for (std::size_t k = 0; k < terms; ++k) {
      for (std::size_t i = 0; i <= k; ++i)
        monomial[i] += chebyshev[k] * now[i];
      next.fill(0);
      for (std::size_t i = 0; i + 1 < next.size(); ++i)
        next[i + 1] = (k == 0 ? 1 : 2) * now[i];
      for (std::size_t i = 0; i < next.size(); ++i)
        next[i] -= k == 0 ? 0 : before[i];
      before = now;
      now = next;
    }
  }
};

using Table = std::vector<std::vector<Wide>>; // [row][column]

// Chebyshev coefficients in both directions.
Table chebyshev_of(Table values) {
  for (auto& row : values) {
    const Expansion<most_columns> in_factor(row);
    std::copy_n(in_factor.chebyshev.begin(), row.size(), row.begin());
  }
  for (std::size_t j = 0; j < values.front().size(); ++j) {
    std::vector<Wide> column;
    for (const auto& row : values)
      column.push_back(row[j]);
    const Expansion<most_rows> in_x(column);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i][j] = in_x.chebyshev[i];
  }
  return values;
}

Table monomial_of(Table chebyshev, std::size_t rows, std::size_t columns) {
  const auto convert = [](std::vector<Wide> coefficients, auto expansion, std::size_t keep) {
    std::copy(coefficients.begin(), coefficients.end(), expansion.chebyshev.begin());
    expansion.keep(keep);
    return std::vector<Wide>(expansion.monomial.begin(),
                             expansion.monomial.begin() + static_cast<std::ptrdiff_t>(keep));
  };
  Table result(rows, std::vector<Wide>(columns));
  for (std::size_t i = 0; i < rows; ++i)
    result[i] = convert(chebyshev[i], Expansion<most_columns>({}), columns);
  for (std::size_t j = 0; j < columns; ++j) {
    std::vector<Wide> column;
    for (std::size_t i = 0; i < rows; ++i)
      column.push_back(result[i][j]);
    column = convert(column, Expansion<most_rows>({}), rows);
    for (std::size_t i = 0; i < rows; ++i)
      result[i][j] = column[i];
  }
  return result;
}

Wide largest(const Table& values) {
  Wide most = 0;
  for (const auto& row : values)
    for (const Wide value : row)
      most = std::max(most, std::abs(value));
  return most;
}

// How many coefficients each row needs so that all others are below `allowed`. No row may have more
// than the one before it, because the powers of x collect those of higher Chebyshev rows.
std::vector<std::size_t> extent_of(const Table& chebyshev, Wide allowed) {
  std::vector<std::size_t> counts(chebyshev.size(), 0);
  std::size_t needed = 0;
  for (std::size_t i = chebyshev.size(); i-- > 0; counts[i] = needed)
    for (std::size_t j = needed; j < chebyshev[i].size(); ++j)
      if (std::abs(chebyshev[i][j]) > allowed) needed = j + 1;
  counts.front() = std::max<std::size_t>(counts.front(), 1);
  while (counts.back() == 0)
    counts.pop_back();
  return counts;
}

// sum_ij c_ij s^i t^j, the c_ij of row i from starts[i] to starts[i+1]: Horner in t, then even and
// odd powers of s apart. The sums in t do not wait for s, which the period before has just found.
template <class Number, class Coefficients>
[[gnu::always_inline]] inline Number polynomial(const Coefficients& c,
                                                const std::vector<std::size_t>& starts,
                                                const Number& s, const Number& t) {
  const auto row = [&](std::size_t i) __attribute__((always_inline)) {
    std::size_t j = starts[i + 1] - 1;
    Number sum = t * 0.0 + c[j];
    while (j-- > starts[i])
      sum = sum * t + c[j];
    return sum;
  };
  const std::size_t rows = starts.size() - 1;
  const Number s2 = s * s;
  const std::size_t last_even = (rows - 1) & ~std::size_t{1};
  Number even = row(last_even);
  for (std::size_t i = last_even; i >= 2; i -= 2)
    even = even * s2 + row(i - 2);
  if (rows == 1) return even;
  const std::size_t last_odd = (rows - 2) | std::size_t{1};
  Number odd = row(last_odd);
  for (std::size_t i = last_odd; i >= 3; i -= 2)
    odd = odd * s2 + row(i - 2);
  return even + odd * s;
}

typedef double Two __attribute__((vector_size(16)));
typedef double Lanes __attribute__((vector_size(8 * MapPatch::lanes)));

// Every second coefficient: one of the two quantities that are stored alternately.
struct Strided {
  const double* first;
  double operator[](std::size_t i) const { return first[2 * i]; }
};

// A regular period computed with T, and the rounding of T.
template <class T>
RegularPeriod<Wide> widened_period(const ClockParameters& clock, Wide speed2, Wide factor) {
  const auto period = regular_period<T>(clock, static_cast<T>(speed2), static_cast<T>(factor));
  return {period.regular, period.speed2_change, period.half_excess, period.excess};
}

} // namespace

MapPatch::MapPatch(const ClockParameters& clock, double low, double high,
                   const FactorRange& factors, MapDigits digits)
    : low_(low), high_(high), factor_middle_(0.5 * (factors.low + factors.high)),
      factor_scale_(factors.high > factors.low ? 2.0 / (factors.high - factors.low) : 0.0) {
  const std::size_t columns = factors.high > factors.low ? most_columns : 1;
  const bool wide = digits == MapDigits::wide;
  const auto period_at = wide ? widened_period<Wide> : widened_period<double>;
  Table change, excess, half;
  for (std::size_t i = 0; i < most_rows; ++i) {
    for (Table* table : {&change, &excess, &half})
      table->emplace_back();
    const Wide x = (Wide(high) + low) / 2 + (Wide(high) - low) / 2 * node(i, most_rows);
    for (std::size_t j = 0; j < columns; ++j) {
      const Wide factor =
          columns == 1 ? Wide(factor_middle_) : factor_middle_ + node(j, columns) / factor_scale_;
      const auto period = period_at(clock, x, factor);
      if (!period.regular) return; // not usable
      change.back().push_back(period.speed2_change);
      excess.back().push_back(period.excess);
      half.back().push_back(period.half_excess);
    }
  }
  const Wide most_change = largest(change);
  change = chebyshev_of(std::move(change));
  excess = chebyshev_of(std::move(excess));
  half = chebyshev_of(std::move(half));
  // A steady error of the excess shows in full in the rate; a steady error of v^2 adds up over a
  // relaxation time 1/(4 pi eps) and shows through dT/dx = pi/8.
  const Wide rounding = wide ? std::numeric_limits<Wide>::epsilon() // 1e-19 of 64 bits
                             : std::numeric_limits<double>::epsilon();
  const Wide allowed_excess = 4 * rounding;
  // No coefficient is known better than the rounding of the change itself, which matters if
  // friction or swing are large.
  const Wide allowed_change =
      std::max(32 * std::max<Wide>(clock.epsilon, 1e-8) * allowed_excess + 1e-4 * rounding * high,
               4 * rounding * most_change);
  auto counts = extent_of(change, allowed_change);
  const auto of_excess =
      extent_of(excess, std::max<Wide>(allowed_excess, 10 * rounding * static_cast<Wide>(high)));
  counts.resize(std::max(counts.size(), of_excess.size()), 0);
  for (std::size_t i = 0; i < of_excess.size(); ++i)
    counts[i] = std::max(counts[i], of_excess[i]);
  // Decay is only seen if some coefficients at the end were already negligible.
  if (counts.size() + 2 > most_rows || (columns > 1 && counts.front() + 2 > most_columns)) return;
  change = monomial_of(std::move(change), counts.size(), counts.front());
  excess = monomial_of(std::move(excess), counts.size(), counts.front());
  half = monomial_of(std::move(half), counts.size(), counts.front());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    for (std::size_t j = 0; j < counts[i]; ++j) {
      coefficients_.push_back(
          {static_cast<double>(change[i][j]), static_cast<double>(excess[i][j])});
      half_.push_back(static_cast<double>(half[i][j]));
    }
    starts_.push_back(half_.size());
  }
  usable_ = true;
}

MapPatch::Values MapPatch::at(double x, double factor) const {
  const double s = (x - 0.5 * (low_ + high_)) * (2.0 / (high_ - low_));
  const double t = (factor - factor_middle_) * factor_scale_;
  const Two values =
      polynomial(reinterpret_cast<const Two*>(coefficients_.data()), starts_, Two{s, s}, Two{t, t});
  return {values[0], values[1]};
}

double MapPatch::half_excess(double x, double factor) const {
  const double s = (x - 0.5 * (low_ + high_)) * (2.0 / (high_ - low_));
  return polynomial(half_.data(), starts_, s, (factor - factor_middle_) * factor_scale_);
}

GOINGRATE_WIDEST_LANES
void MapPatch::at(const std::array<double, lanes>& x, const std::array<double, lanes>& factor,
                  std::array<double, lanes>& speed2_change,
                  std::array<double, lanes>& excess) const {
  Lanes s, t;
  for (std::size_t k = 0; k < lanes; ++k) {
    s[k] = (x[k] - 0.5 * (low_ + high_)) * (2.0 / (high_ - low_));
    t[k] = (factor[k] - factor_middle_) * factor_scale_;
  }
  const double* c = coefficients_.front().data();
  const Lanes change = polynomial(Strided{c}, starts_, s, t);
  const Lanes late = polynomial(Strided{c + 1}, starts_, s, t);
  for (std::size_t k = 0; k < lanes; ++k) {
    speed2_change[k] = change[k];
    excess[k] = late[k];
  }
}

ReturnMap::ReturnMap(const ClockParameters& clock, const FactorRange& factors, MapDigits digits)
    : clock_(clock), factors_(factors), digits_(digits) {
  // Swings that do not repeat range upwards from a limit (and their mean is found with a map).
  const auto cycle = clock.below > 0.0 ? std::nullopt : limit_cycle(clock);
  anchor_ = cycle ? cycle->velocity * cycle->velocity : 1.0;
  if (clock.below > 0.0)
    anchor_ = std::pow(velocity_of_turning_angle(clock.gravity_share, clock.below), 2);
}

const MapPatch* ReturnMap::find(double x) {
  if (!(x > 0.0)) return nullptr;
  const int index = static_cast<int>(std::lround(std::log(x / anchor_) / std::log(patch_ratio)));
  // Rounding can put x just beside the patch of its index.
  for (const int i : {index, index - 1, index + 1}) {
    const double low = anchor_ * std::pow(patch_ratio, i - 0.5);
    const double high = anchor_ * std::pow(patch_ratio, i + 0.5);
    if (!(x >= low && x < high)) continue;
    auto& patch = patches_[i];
    if (!patch) patch = std::make_unique<MapPatch>(clock_, low, high, factors_, digits_);
    return patch->usable() ? patch.get() : nullptr;
  }
  return nullptr;
}

MapPendulum::MapPendulum(const ClockParameters& clock, double velocity, const FactorRange& factors,
                         MapDigits digits)
    : direct_(clock, velocity), factors_(factors), digits_(digits) {
  set_clock(clock);
}

void MapPendulum::set_clock(const ClockParameters& clock) {
  direct_.set_clock(clock);
  driven_ = {std::make_unique<ReturnMap>(clock, factors_, digits_)};
  resting_ = {};
  if (clock.is_intermittent())
    resting_.map = std::make_unique<ReturnMap>(clock, FactorRange{0.0, 0.0}, digits_);
  before_ = {};
  after_ = {};
  if (const auto parts = action_parts(clock)) {
    before_.map = std::make_unique<ReturnMap>(parts->before, factors_, digits_);
    after_.map = std::make_unique<ReturnMap>(parts->after, factors_, digits_);
  }
}

// The map of a period that contains the beginning, or the whole, of an action with this factor;
// null if one action ends in it and the next begins.
MapPendulum::Served* MapPendulum::served_for(double factor) {
  if (direct_.begun() != 0.0) return factor == 0.0 ? &after_ : nullptr;
  if (factor == 0.0 && resting_.map) return &resting_;
  return before_.map ? &before_ : &driven_;
}

const MapPatch* MapPendulum::patch_for(double factor) {
  Served* served = served_for(factor);
  if (served == nullptr || !direct_.is_regular()) return nullptr;
  const double acting = served == &after_ ? direct_.begun() : factor;
  if (!served->map->factors().contains(acting)) return nullptr;
  const double x = direct_.speed2().hi;
  if (served->patch == nullptr || !served->patch->contains(x)) served->patch = served->map->find(x);
  return served->patch;
}

void MapPendulum::rescale(double ratio) { direct_.rescale(ratio); }

PeriodStep MapPendulum::advance(double factor) {
  const MapPatch* patch = patch_for(factor);
  if (patch == nullptr) {
    ++fallbacks_;
    return direct_.advance(factor);
  }
  const double x = direct_.speed2().hi;
  const double acting = direct_.begun() != 0.0 ? direct_.begun() : factor;
  const auto values = patch->at(x, acting);
  PeriodStep step;
  step.excess = values.excess;
  if (halves_) step.half_excess = patch->half_excess(x, acting);
  direct_.add_period(values.speed2_change, factor);
  return step;
}

} // namespace goingrate
