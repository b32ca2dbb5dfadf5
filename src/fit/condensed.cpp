#include "condensed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace goingrate::timing_model {

std::shared_ptr<const CondensedLog> CondensedLog::of(const TimingData& data,
                                                     const std::vector<double>& event_cycles,
                                                     double relaxation_cycles) {
  constexpr std::size_t least_block_beats =
      3 * nodes_a_block; // beats per block that make it worthwhile
  const double longest = 0.7 * relaxation_cycles;
  if (!(longest >= static_cast<double>(least_block_beats))) return nullptr;
  auto log = std::make_shared<CondensedLog>();
  log->nodes_.reference_period_s = data.reference_period_s;
  std::size_t begin = 0;
  for (std::size_t event = 0; event <= event_cycles.size(); ++event) {
    const auto from = data.cycle.begin();
    const std::size_t end =
        event < event_cycles.size()
            ? static_cast<std::size_t>(
                  std::upper_bound(from, data.cycle.end(), event_cycles[event]) - from)
            : data.size();
    if (end == begin) continue;
    const double cycles = data.cycle[end - 1] - data.cycle[begin];
    const auto blocks = static_cast<std::size_t>(cycles / longest) + 1;
    if (end - begin < blocks * least_block_beats) return nullptr;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::size_t count = end - begin;
      if (!log->add_block(data, begin + b * count / blocks, begin + (b + 1) * count / blocks))
        return nullptr;
    }
    begin = end;
  }
  log->constant_ = log->weighted_plainly(
      Eigen::MatrixXd::Ones(static_cast<Eigen::Index>(log->nodes_.size()), 1));
  return log;
}

namespace {

std::vector<std::size_t> chebyshev_places(std::size_t beats) {
  std::vector<std::size_t> places;
  for (int k = 0; k < nodes_a_block; ++k) {
    const double place =
        0.5 - 0.5 * std::cos(std::numbers::pi * (static_cast<double>(k) + 0.5) / nodes_a_block);
    places.push_back(static_cast<std::size_t>(std::lround(place * static_cast<double>(beats - 1))));
  }
  return places;
}

Eigen::MatrixXd lagrange(std::span<const double> cycle, std::span<const std::size_t> nodes) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(cycle.size()), nodes_a_block);
  std::array<double, nodes_a_block> weight, node;
  for (int k = 0; k < nodes_a_block; ++k)
    node[k] = cycle[nodes[k]];
  for (int k = 0; k < nodes_a_block; ++k) {
    double product = 1.0;
    for (int other = 0; other < nodes_a_block; ++other)
      if (other != k) product *= node[k] - node[other];
    weight[k] = 1.0 / product;
  }
  std::array<double, nodes_a_block + 1> below, above; // products of the distances on either side
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    const double here = cycle[static_cast<std::size_t>(i)];
    below.front() = above.back() = 1.0;
    for (int k = 0; k < nodes_a_block; ++k)
      below[k + 1] = below[k] * (here - node[k]);
    for (int k = nodes_a_block; k-- > 0;)
      above[k] = above[k + 1] * (here - node[k]);
    for (int k = 0; k < nodes_a_block; ++k)
      values(i, k) = weight[k] * below[k] * above[k + 1];
  }
  return values;
}

} // namespace

std::size_t CondensedLog::pattern_of(std::span<const double> cycle) {
  std::vector<double> relative(cycle.begin(), cycle.end());
  for (double& c : relative)
    c -= cycle.front();
  constexpr std::size_t kept_patterns = 4; // lengths differ by a beat; gaps hardly ever repeat
  for (std::size_t k = patterns_.size(); k > 0 && k + kept_patterns > patterns_.size(); --k)
    if (patterns_[k - 1].cycle == relative) return k - 1;
  if (patterns_.size() >= kept_patterns) patterns_[patterns_.size() - kept_patterns].qr = {};
  Pattern pattern;
  pattern.nodes = chebyshev_places(relative.size());
  const Eigen::MatrixXd polynomials = lagrange(relative, pattern.nodes);
  constexpr double largest_coefficient = 5.0; // 2.3 if the beats are evenly spaced
  pattern.swings = !(polynomials.cwiseAbs().maxCoeff() < largest_coefficient);
  pattern.qr.compute(polynomials);
  pattern.triangle.triangularView<Eigen::Upper>() = pattern.qr.matrixQR().topRows<nodes_a_block>();
  pattern.cycle = std::move(relative);
  patterns_.push_back(std::move(pattern));
  return patterns_.size() - 1;
}

bool CondensedLog::add_block(const TimingData& data, std::size_t first, std::size_t end) {
  const Block block{first, end - first,
                    pattern_of(std::span(data.cycle).subspan(first, end - first))};
  const Pattern& pattern = patterns_[block.pattern];
  if (pattern.swings) return false;
  const auto n = static_cast<Eigen::Index>(block.beats);
  constexpr Eigen::Index k = nodes_a_block;
  Eigen::VectorXd turned = Eigen::Map<const Eigen::VectorXd>(data.lateness_s.data() + first, n);
  turned.applyOnTheLeft(pattern.qr.householderQ().adjoint());
  rest_s2_ += turned.tail(n - k).squaredNorm();
  const Eigen::VectorXd at_nodes =
      pattern.triangle.triangularView<Eigen::Upper>().solve(turned.head(k));
  for (std::size_t i = 0; i < nodes_a_block; ++i) {
    const double late_here = at_nodes[static_cast<Eigen::Index>(i)];
    nodes_.cycle.push_back(data.cycle[first + pattern.nodes[i]]);
    nodes_.lateness_s.push_back(late_here);
    nodes_.elapsed_s.push_back(nodes_.cycle.back() * data.reference_period_s + late_here);
  }
  blocks_.push_back(block);
  beats_ += block.beats;
  return true;
}

Eigen::MatrixXd CondensedLog::weighted_plainly(const Eigen::MatrixXd& at_nodes) const {
  Eigen::MatrixXd result(at_nodes.rows(), at_nodes.cols());
  constexpr Eigen::Index k = nodes_a_block;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const auto row = static_cast<Eigen::Index>(b) * k;
    result.middleRows<nodes_a_block>(row).noalias() =
        patterns_[blocks_[b].pattern].triangle.lazyProduct(at_nodes.middleRows<nodes_a_block>(row));
  }
  return result;
}

Eigen::MatrixXd CondensedLog::weighted(const Eigen::MatrixXd& at_nodes) const {
  Eigen::MatrixXd result = weighted_plainly(at_nodes);
  const Eigen::RowVectorXd mean = constant_.transpose() * result / beats();
  result.noalias() -= constant_ * mean;
  return result;
}

std::vector<double> CondensedLog::spread(const std::vector<double>& at_nodes) const {
  std::vector<double> result;
  result.reserve(beats_);
  constexpr Eigen::Index k = nodes_a_block;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Eigen::Map<const Eigen::VectorXd> values(at_nodes.data() + b * nodes_a_block, k);
    const Pattern& pattern = patterns_[blocks_[b].pattern];
    const Eigen::VectorXd here = lagrange(pattern.cycle, pattern.nodes) * values;
    result.insert(result.end(), here.begin(), here.end());
  }
  return result;
}

} // namespace goingrate::timing_model
