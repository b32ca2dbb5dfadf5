#include "condensed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace goingrate::timing_model {

namespace {

constexpr std::size_t nodes_a_block = 12;

} // namespace

std::shared_ptr<const CondensedLog> CondensedLog::of(const TimingData& data,
                                                     const std::vector<double>& event_cycles,
                                                     double relaxation_cycles) {
  constexpr std::size_t least = 3 * nodes_a_block; // beats a block for which it is worth while
  const double longest = 0.5 * relaxation_cycles;
  if (!(longest >= static_cast<double>(least))) return nullptr;
  auto log = std::make_shared<CondensedLog>();
  log->beat_cycle_ = data.cycle;
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
    if (end - begin < blocks * least) return nullptr;
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

bool CondensedLog::add_block(const TimingData& data, std::size_t first, std::size_t end) {
  Block block{first, end - first, {}};
  const std::size_t first_node = nodes_.size();
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < nodes_a_block; ++k) {
    const double place =
        0.5 - 0.5 * std::cos(std::numbers::pi * (static_cast<double>(k) + 0.5) / nodes_a_block);
    chosen.push_back(first + static_cast<std::size_t>(
                                 std::lround(place * static_cast<double>(end - 1 - first))));
    nodes_.cycle.push_back(data.cycle[chosen.back()]);
  }
  const Eigen::MatrixXd polynomials = lagrange(block, first_node);
  constexpr double swinging = 5.0; // 2.3 if the beats are even
  if (!(polynomials.cwiseAbs().maxCoeff() < swinging)) return false;
  const auto n = static_cast<Eigen::Index>(block.beats);
  constexpr auto k = static_cast<Eigen::Index>(nodes_a_block);
  const Eigen::Map<const Eigen::VectorXd> late(data.lateness_s.data() + first, n);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(polynomials);
  Eigen::VectorXd turned = late;
  turned.applyOnTheLeft(qr.householderQ().adjoint());
  rest_s2_ += turned.tail(n - k).squaredNorm();
  block.triangle = qr.matrixQR().topRows(k).triangularView<Eigen::Upper>();
  const Eigen::VectorXd at_nodes =
      block.triangle.triangularView<Eigen::Upper>().solve(turned.head(k));
  for (std::size_t i = 0; i < nodes_a_block; ++i) {
    const double late_here = at_nodes[static_cast<Eigen::Index>(i)];
    nodes_.lateness_s.push_back(late_here);
    nodes_.elapsed_s.push_back(data.cycle[chosen[i]] * data.reference_period_s + late_here);
  }
  blocks_.push_back(std::move(block));
  return true;
}

Eigen::MatrixXd CondensedLog::lagrange(const Block& block, std::size_t first_node) const {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(block.beats),
                         static_cast<Eigen::Index>(nodes_a_block));
  const double* node = nodes_.cycle.data() + first_node;
  std::array<double, nodes_a_block> weight;
  for (std::size_t k = 0; k < nodes_a_block; ++k) {
    double product = 1.0;
    for (std::size_t other = 0; other < nodes_a_block; ++other)
      if (other != k) product *= node[k] - node[other];
    weight[k] = 1.0 / product;
  }
  std::array<double, nodes_a_block + 1> below, above; // products of the distances on either side
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    const double cycle = beat_cycle_[block.first + static_cast<std::size_t>(i)];
    below.front() = above.back() = 1.0;
    for (std::size_t k = 0; k < nodes_a_block; ++k)
      below[k + 1] = below[k] * (cycle - node[k]);
    for (std::size_t k = nodes_a_block; k-- > 0;)
      above[k] = above[k + 1] * (cycle - node[k]);
    for (std::size_t k = 0; k < nodes_a_block; ++k)
      values(i, static_cast<Eigen::Index>(k)) = weight[k] * below[k] * above[k + 1];
  }
  return values;
}

Eigen::MatrixXd CondensedLog::weighted_plainly(const Eigen::MatrixXd& at_nodes) const {
  Eigen::MatrixXd result(at_nodes.rows(), at_nodes.cols());
  constexpr auto k = static_cast<Eigen::Index>(nodes_a_block);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const auto row = static_cast<Eigen::Index>(b) * k;
    result.middleRows(row, k).noalias() =
        blocks_[b].triangle.triangularView<Eigen::Upper>() * at_nodes.middleRows(row, k);
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
  result.reserve(beat_cycle_.size());
  constexpr auto k = static_cast<Eigen::Index>(nodes_a_block);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Eigen::Map<const Eigen::VectorXd> values(at_nodes.data() + b * nodes_a_block, k);
    const Eigen::VectorXd here = lagrange(blocks_[b], b * nodes_a_block) * values;
    result.insert(result.end(), here.begin(), here.end());
  }
  return result;
}

} // namespace goingrate::timing_model
