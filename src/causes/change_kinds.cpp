#include "change_kinds.hpp"

#include "step_search.hpp"

#include "goingrate/log/rates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace goingrate::timing_model {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

constexpr double most_blocks = 96.0, fewest_blocks = 8.0; // a side

// Blocks of equal time about a place; nothing if a side has too few.
std::optional<RateBlocks> blocks_about(const TimingData& data, const Stretch& stretch, double at_s,
                                       double length_s) {
  const auto count = [&](double span_s) {
    return std::clamp(std::floor(span_s / length_s * (1.0 + 1e-12)), 0.0, most_blocks);
  };
  const double before = count(at_s - stretch.begin_s), after = count(stretch.end_s - at_s);
  if (std::min(before, after) < fewest_blocks) return {};
  return rate_blocks(data, at_s - before * length_s, length_s,
                     static_cast<std::size_t>(before + after));
}

Judgement judged(const RateBlocks& blocks, double at_s, double doubt_s) {
  const Account account(blocks, {.wanders = true});
  const StepSearch search(account, blocks, (at_s - blocks.begin_s) / blocks.length_s,
                          doubt_s / blocks.length_s);
  Judgement found;
  FittedStep best;
  double first = 0.0, second = -std::numeric_limits<double>::infinity(); // no change gains nothing
  found.at_s = at_s;
  for (const ChangeKind kind : {ChangeKind::regulation, ChangeKind::drive, ChangeKind::friction}) {
    const FittedStep fitted = search.best(kind);
    if (fitted.gain > first) {
      best = fitted;
      second = std::exchange(first, fitted.gain);
      found.next = std::exchange(found.kind, kind);
      found.at_s = blocks.begin_s + fitted.place * blocks.length_s;
    } else if (fitted.gain > second) {
      second = fitted.gain;
      found.next = kind;
    }
  }
  found.gain = first;
  found.ahead = first - second;
  if (found.kind == ChangeKind::regulation) {
    const Sizes sizes = search.sizes_of(found.kind, best);
    found.jump = sizes.rate.front();
    found.jump_sigma = sizes.rate_sigma.front();
  }
  return found;
}

void put_rate(std::span<const Beat> beats, double nominal_period_s, double& rate, double& sigma) {
  rate = sigma = unknown;
  constexpr std::size_t fewest = 3, fewest_for_scatter = 5;
  if (beats.size() < fewest) return;
  const RateSummary summary = summarise_rates(beats, nominal_period_s);
  rate = summary.rate_excess;
  if (beats.size() >= fewest_for_scatter) sigma = summary.rate_excess_sigma;
}

} // namespace

Judgement judge_kind(const TimingData& data, const Stretch& stretch, double at_s, double doubt_s) {
  Judgement best;
  best.at_s = at_s;
  constexpr double finest = 4.0, coarser = 4.0; // beats a block
  for (double length_s = finest * data.reference_period_s;; length_s *= coarser) {
    if (doubt_s > 0.25 * most_blocks * length_s) continue; // the change may lie outside
    const auto blocks = blocks_about(data, stretch, at_s, length_s);
    if (!blocks) break;
    const Judgement found = judged(*blocks, at_s, doubt_s);
    if (found.gain > best.gain) best = found;
  }
  return best;
}

void judge_changes(std::span<const Beat> beats, const TimingData& data, double nominal_period_s,
                   std::vector<Change>& changes) {
  std::vector<std::size_t> knots{0};
  for (const Change& change : changes)
    knots.push_back(static_cast<std::size_t>(
        std::lower_bound(data.elapsed_s.begin(), data.elapsed_s.end(), change.at_s) -
        data.elapsed_s.begin()));
  knots.push_back(beats.size() - 1);
  constexpr double doubt = 30.0; // beats: of a bend
  for (std::size_t j = 0; j < changes.size(); ++j) {
    Change& change = changes[j];
    const std::size_t from = knots[j], at = knots[j + 1], to = knots[j + 2];
    put_rate(beats.subspan(from, at - from + 1), nominal_period_s, change.rate_before,
             change.rate_before_sigma);
    put_rate(beats.subspan(at, to - at + 1), nominal_period_s, change.rate_after,
             change.rate_after_sigma);
    const Judgement found = judge_kind(data, {data.elapsed_s[from], data.elapsed_s[to]},
                                       data.elapsed_s[at], doubt * data.reference_period_s);
    change.kind = found.kind;
    change.next_kind = found.next;
    change.gain = found.gain;
    change.kind_gain = found.ahead;
    change.rate_change_sigma = unknown;
    if (found.jump_sigma > 0.0) {
      change.rate_change = found.jump;
      change.rate_change_sigma = found.jump_sigma;
    }
    if (found.kind == ChangeKind::friction) { // a bend is dated better by what comes of it
      change.at_s = found.at_s;
      change.cycle = cycle_at(beats, found.at_s);
    }
  }
}

} // namespace goingrate::timing_model

namespace goingrate {

std::string_view name_of(ChangeKind kind) {
  switch (kind) {
  case ChangeKind::regulation:
    return "regulation";
  case ChangeKind::drive:
    return "drive";
  case ChangeKind::friction:
    return "friction";
  case ChangeKind::unclear:
    break;
  }
  return "unclear";
}

} // namespace goingrate
