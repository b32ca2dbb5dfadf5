#include "amplitude_clock.hpp"

#include "base/scaled_time.hpp"

#include <Eigen/Dense>

#include <boost/math/tools/minima.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace goingrate::timing_model {

namespace {

// A block of neighbouring beats: their mean amplitude, and the times at both ends.
struct Block {
  double cycles = 0.0;
  double amplitude2 = 0.0;        // mean of lambda^2
  double cycle = 0.0, late = 0.0; // at the end
  double end2 = 0.0;              // lambda^2 there
};

double square_of(double turning_angle) { return std::pow(2.0 * std::sin(turning_angle / 2.0), 2); }

// The amplitudes squared; a missing one is replaced by that of the beat before.
std::vector<double> squares(const TimingData& data) {
  std::vector<double> all;
  std::size_t missed = 0;
  for (const double a : data.amplitude_rad) {
    const bool seen = a > 0.0;
    missed += seen ? 0 : 1;
    all.push_back(seen ? square_of(a) : all.empty() ? 0.0 : all.back());
  }
  constexpr double largest_missed_share = 0.2;
  const bool enough =
      static_cast<double>(missed) < largest_missed_share * static_cast<double>(all.size());
  return enough && all.size() > 100 && all.front() > 0.0 ? all : std::vector<double>{};
}

double mean_about(const std::vector<double>& x, std::size_t middle, std::size_t reach) {
  reach = std::min({reach, middle, x.size() - 1 - middle});
  const auto first = x.begin() + static_cast<std::ptrdiff_t>(middle - reach);
  const auto count = static_cast<std::ptrdiff_t>(2 * reach + 1);
  return std::accumulate(first, first + count, 0.0) / static_cast<double>(count);
}

// The amplitudes at the ends are means over a block, because noise would look like a push, which is
// largest near the escapement.
std::vector<Block> blocks_of(const TimingData& data, const std::vector<double>& x) {
  constexpr std::size_t most_blocks = 400; // blocks
  const std::size_t length = 1 + x.size() / most_blocks;
  std::vector<Block> blocks;
  for (std::size_t from = 0; from + length < x.size(); from += length) {
    const std::size_t end = from + length;
    Block block;
    for (std::size_t i = from; i < end; ++i) { // each cycle has the mean of its ends
      const double cycles = data.cycle[i + 1] - data.cycle[i];
      block.cycles += cycles;
      block.amplitude2 += cycles * 0.5 * (x[i] + x[i + 1]);
    }
    block.amplitude2 /= block.cycles;
    block.cycle = data.cycle[end] - data.cycle.front();
    block.late = data.lateness_s[end] - data.lateness_s.front();
    block.end2 = mean_about(x, end, length / 2);
    blocks.push_back(block);
  }
  return blocks;
}

struct Line {
  double stretch = 0.0, epsilon = 0.0; // T0 over the reference period - 1
  double misfit = std::numeric_limits<double>::infinity();
};

// The best T0 and epsilon for one phi0; given values are held.
Line line_for(const std::vector<Block>& blocks, double reference_s, double phi0,
              std::optional<double> stretch, std::optional<double> epsilon) {
  const auto steep = [&](double x) { return std::sqrt(std::max(0.0, x / (phi0 * phi0) - 1.0)); };
  const auto kicked = [&](double x) { return (steep(x) - std::atan(steep(x))) / two_pi; };
  const auto rows = static_cast<Eigen::Index>(blocks.size());
  Eigen::MatrixXd design(rows, 3); // of a constant, of the stretch, of epsilon T0
  Eigen::VectorXd seen(rows);
  double circular = 0.0, pushed = 0.0;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Block& block = blocks[static_cast<std::size_t>(i)];
    circular += block.cycles * block.amplitude2 * (1.0 + block.amplitude2 * 9.0 / 64.0) / 16.0;
    pushed += block.cycles * steep(block.amplitude2);
    const double late = circular - kicked(block.end2) - epsilon.value_or(0.0) * pushed; // in T0
    seen[i] = block.late / reference_s - late;
    design.row(i) << 1.0, block.cycle + late, -pushed;
  }
  if (stretch) {
    seen -= *stretch * design.col(1);
    design.col(1) = design.col(2);
  }
  const Eigen::Index free = 3 - (stretch ? 1 : 0) - (epsilon ? 1 : 0);
  const Eigen::VectorXd found = design.leftCols(free).colPivHouseholderQr().solve(seen);
  Line line;
  line.stretch = stretch ? *stretch : found[1];
  line.epsilon = epsilon ? *epsilon : found[free - 1] / (1.0 + line.stretch);
  line.misfit = (seen - design.leftCols(free) * found).squaredNorm();
  return line;
}

std::optional<double> held(const Parameters& parameters, Quantity quantity) {
  const Slot* slot = parameters.find(quantity);
  return slot == nullptr || slot->free ? std::nullopt : std::optional(slot->fixed_value);
}

} // namespace

std::optional<AmplitudeClock> amplitude_clock(const TimingData& data,
                                              const Parameters& parameters) {
  if (parameters.escapement != Escapement::constant_torque) return {};
  const std::vector<double> x = squares(data);
  if (x.empty()) return {};
  const std::vector<Block> blocks = blocks_of(data, x);
  const auto T0 = held(parameters, Quantity::T0), epsilon = held(parameters, Quantity::epsilon);
  const auto stretch = T0 ? std::optional(*T0 / data.reference_period_s - 1.0) : std::nullopt;
  const auto line = [&](double phi0) {
    return line_for(blocks, data.reference_period_s, phi0, stretch, epsilon);
  };
  const auto narrower = [](const Block& a, const Block& b) { return a.end2 < b.end2; };
  const double least = std::sqrt(std::min_element(blocks.begin(), blocks.end(), narrower)->end2);
  double phi0 = 0.95 * least;
  Line best;
  if (const auto known = held(parameters, Quantity::phi0)) {
    best = line(phi0 = *known);
  } else {
    constexpr double angle_ratio = 0.9, smallest_angle_share = 0.04; // of the amplitude
    for (double angle = phi0; angle > smallest_angle_share * least; angle *= angle_ratio) {
      const Line there = line(angle);
      if (!(there.epsilon > 0.0) || !(there.misfit < best.misfit)) continue;
      best = there;
      phi0 = angle;
    }
    constexpr int bits = 12; // of the angle
    phi0 = boost::math::tools::brent_find_minima([&](double angle) { return line(angle).misfit; },
                                                 phi0 * angle_ratio,
                                                 std::min(phi0 / angle_ratio, 0.99 * least), bits)
               .first;
    best = line(phi0);
  }
  if (!std::isfinite(best.misfit) || !(best.epsilon > 0.0)) return {};
  double mean2 = 0.0;
  for (const Block& block : blocks)
    mean2 += block.cycles * block.amplitude2 / blocks.back().cycle;
  return AmplitudeClock{(1.0 + best.stretch) * data.reference_period_s, best.epsilon, phi0, mean2};
}

} // namespace goingrate::timing_model
