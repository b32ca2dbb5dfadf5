#include "change_kinds.hpp"

#include "base/special_values.hpp"
#include "step_search.hpp"

#include "goingrate/log/rates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace goingrate::timing_model {

namespace {

constexpr double most_blocks_a_side = 96.0, fewest_blocks_a_side = 8.0;

// Blocks of equal time around a change; nothing if a side has too few.
std::optional<RateBlocks> blocks_about(const TimingData& data, const Stretch& stretch, double at_s,
                                       double length_s) {
  const auto count = [&](double span_s) {
    return std::clamp(std::floor(span_s / length_s * (1.0 + 1e-12)), 0.0, most_blocks_a_side);
  };
  const double before = count(at_s - stretch.begin_s), after = count(stretch.end_s - at_s);
  if (std::min(before, after) < fewest_blocks_a_side) return {};
  return rate_blocks(data, at_s - before * length_s, length_s,
                     static_cast<std::size_t>(before + after));
}

constexpr std::array kinds{ChangeKind::regulation, ChangeKind::drive, ChangeKind::friction};

// The best fit of each kind of change in blocks of one length.
struct Look {
  RateBlocks blocks;
  std::array<FittedStep, kinds.size()> steps;
  [[nodiscard]] double best_gain() const {
    return std::max_element(
               steps.begin(), steps.end(),
               [](const FittedStep& a, const FittedStep& b) { return a.gain < b.gain; })
        ->gain;
  }
};

// Takes the settling after the previous change into account, which is not a further change. The
// squared amplitude settles exponentially; rate and amplitude are nonlinear functions of it and
// contain powers of that exponential.
void take_settling(const RateBlocks& blocks, Account& account) {
  const CourseMaker make(blocks);
  Courses best;
  double most = 0.0;
  const double longest_s = blocks.length_s * static_cast<double>(blocks.rate.size());
  constexpr double time_ratio = 1.5; // of successive time constants
  for (double time_s = blocks.length_s; time_s < longest_s; time_s *= time_ratio) {
    Courses settling{.rate = {}, .amplitude = {}, .times = 1};
    for (const double power : {1.0, 2.0, 3.0}) {
      settling.rate.push_back(make.dying(0.0, time_s / power));
      settling.amplitude.push_back(settling.rate.back());
      const double gain = account.gain_of(settling);
      if (gain <= most) continue;
      most = gain;
      best = settling;
    }
  }
  if (most > 0.0) account.take(best);
}

Look look_at(RateBlocks blocks, const Stretch& stretch, double at_s, double doubt_s) {
  Account account(blocks, {.wanders = true});
  if (stretch.begin_s > 0.0) take_settling(blocks, account);
  const StepSearch search(account, blocks, (at_s - blocks.begin_s) / blocks.length_s,
                          doubt_s / blocks.length_s);
  Look look{.blocks = std::move(blocks), .steps = {}};
  for (std::size_t k = 0; k < kinds.size(); ++k)
    look.steps[k] = search.best(kinds[k]);
  return look;
}

// Sets the change of the rate: at the change; for friction, in the end.
void put_jump(ChangeKind kind, const FittedStep& step, const RateBlocks& blocks,
              Judgement& judgement) {
  const Account account(blocks, {.wanders = true});
  const Sizes sizes = StepSearch(account, blocks, step.place, 1.0).sizes_of(kind, step);
  judgement.jump = sizes.rate[0];
  if (kind == ChangeKind::regulation) judgement.jump_sigma = sizes.rate_sigma[0];
  if (kind == ChangeKind::drive) judgement.jump -= sizes.rate[1]; // less the part that dies away
}

void put_rate(std::span<const Beat> beats, double nominal_period_s, double& rate, double& sigma) {
  rate = sigma = not_known;
  constexpr std::size_t fewest_beats = 3, fewest_for_scatter = 5;
  if (beats.size() < fewest_beats) return;
  const RateSummary summary = summarise_rates(beats, nominal_period_s);
  rate = summary.rate_excess;
  if (beats.size() >= fewest_for_scatter) sigma = summary.rate_excess_sigma;
}

void put_judgement(const Judgement& found, Change& change) {
  change.kind = found.kind;
  change.next_kind = found.next;
  change.gain = found.gain;
  change.kind_gain = found.ahead;
  change.rate_change_sigma = not_known;
  if (!(found.jump_sigma > 0.0)) return;
  change.rate_change = found.jump;
  change.rate_change_sigma = found.jump_sigma;
}

void put_date(std::span<const Beat> beats, double at_s, Change& change) {
  change.at_s = at_s;
  change.cycle = beats.front().cycle + cycle_at(beats, at_s);
}

// The uncertainty of a date: the largest distance to the date found for any kind, plus 1.5 blocks.
double doubt_of_place(const Look& look, double at_s) {
  constexpr double block_edges = 1.5; // blocks: a date is accurate to about one
  double doubt_s = 0.0;
  for (const FittedStep& step : look.steps)
    doubt_s =
        std::max(doubt_s, std::abs(look.blocks.begin_s + step.place * look.blocks.length_s - at_s));
  return doubt_s + block_edges * look.blocks.length_s;
}

Judgement judged_about(const TimingData& data, const Stretch& stretch, double at_s,
                       double doubt_s) {
  std::vector<Look> looks;
  constexpr double finest_block_beats = 4.0, block_ratio = 4.0; // beats per block
  for (double length_s = finest_block_beats * data.reference_period_s;; length_s *= block_ratio) {
    if (doubt_s > 0.25 * most_blocks_a_side * length_s) continue; // the change may lie outside
    auto blocks = blocks_about(data, stretch, at_s, length_s);
    if (!blocks) break;
    Look look = look_at(std::move(*blocks), stretch, at_s, doubt_s);
    if (look.best_gain() > convincing_gain) looks.push_back(std::move(look));
  }
  Judgement told{.at_s = at_s};
  if (looks.empty()) return told;
  std::array<std::pair<double, std::size_t>, kinds.size()> gains{}; // means over block lengths
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    gains[k].second = k;
    for (const Look& look : looks)
      gains[k].first += look.steps[k].gain / static_cast<double>(looks.size());
  }
  std::sort(gains.rbegin(), gains.rend());
  const std::size_t kind = gains[0].second;
  told.kind = kinds[kind];
  told.next = kinds[gains[1].second];
  told.ahead = gains[0].first - gains[1].first;
  const Look& strongest =
      *std::max_element(looks.begin(), looks.end(), [&](const Look& a, const Look& b) {
        return a.steps[kind].gain < b.steps[kind].gain;
      });
  told.gain = strongest.steps[kind].gain;
  // Finer blocks give a better date, as long as the change shows in them as well.
  constexpr double least_share = 0.5; // of the gain: z is then within 30 %
  const Look& sharpest = *std::find_if(looks.begin(), looks.end(), [&](const Look& look) {
    return look.steps[kind].gain >= least_share * told.gain;
  });
  told.at_s = sharpest.blocks.begin_s + sharpest.steps[kind].place * sharpest.blocks.length_s;
  told.doubt_s = doubt_of_place(sharpest, told.at_s);
  put_jump(told.kind, strongest.steps[kind], strongest.blocks, told);
  return told;
}

} // namespace

Judgement judge_kind(const TimingData& data, const Stretch& stretch, double at_s, double doubt_s) {
  Judgement told = judged_about(data, stretch, at_s, doubt_s);
  constexpr int most_rounds = 6; // each centres the blocks on the date found before
  constexpr double finest_block_beats = 4.0; // beats: the finest block
  constexpr double least_narrowing = 0.5;    // of the doubt: less allows no finer blocks
  for (int round = 0; round < most_rounds && told.kind != ChangeKind::unclear; ++round) {
    const double moved = std::abs(told.at_s - at_s);
    const bool is_narrower = told.doubt_s < least_narrowing * doubt_s;
    if (moved < finest_block_beats * data.reference_period_s && !is_narrower) break;
    at_s = told.at_s;
    doubt_s = std::min(doubt_s, told.doubt_s);
    const Judgement again = judged_about(data, stretch, at_s, doubt_s);
    if (again.kind == ChangeKind::unclear) break;
    told = again;
  }
  return told;
}

namespace {

// The stretch from the change before `at_s` to the one after it.
Stretch stretch_about(double at_s, const TimingData& data, const std::vector<Change>& changes) {
  Stretch stretch{0.0, data.elapsed_s.back()};
  for (const Change& other : changes) {
    if (other.at_s < at_s) stretch.begin_s = std::max(stretch.begin_s, other.at_s);
    if (other.at_s > at_s) stretch.end_s = std::min(stretch.end_s, other.at_s);
  }
  return stretch;
}

constexpr double doubt_of_bend_beats = 60.0;

} // namespace

bool has_kind(const TimingData& data, double at_s, const std::vector<Change>& others) {
  return judge_kind(data, stretch_about(at_s, data, others), at_s,
                    doubt_of_bend_beats * data.reference_period_s)
             .kind != ChangeKind::unclear;
}

void judge_changes(std::span<const Beat> beats, const TimingData& data,
                   std::vector<Change>& changes) {
  const std::vector<Change> dated = changes;
  for (Change& change : changes) {
    const Judgement found = judge_kind(data, stretch_about(change.at_s, data, dated), change.at_s,
                                       doubt_of_bend_beats * data.reference_period_s);
    put_judgement(found, change);
    // A gradual bend is dated better by the beats that follow it.
    constexpr double sharp_beats = 15.0; // beats: for a jump, the beats next to it tell more
    const bool is_sharp =
        std::abs(found.at_s - change.at_s) < sharp_beats * data.reference_period_s;
    if (found.kind == ChangeKind::friction || !is_sharp) put_date(beats, found.at_s, change);
  }
}

void add_change(const TimingData& data, double at_s, double doubt_s, std::span<const Beat> beats,
                std::vector<Change>& changes) {
  const Judgement found = judge_kind(data, stretch_about(at_s, data, changes), at_s, doubt_s);
  if (found.kind == ChangeKind::unclear) return;
  Change change;
  put_judgement(found, change);
  put_date(beats, found.at_s, change);
  change.rate_change = found.jump;
  change.amplitude_slope_change = not_known;
  change.significance = std::sqrt(found.gain);
  change.stands_out = false;
  changes.insert(std::find_if(changes.begin(), changes.end(),
                              [&](const Change& other) { return other.at_s > change.at_s; }),
                 change);
}

// The interval in which a change lies belongs to neither stretch; where the beats are readings, which
// date it to half an interval, nor does the next.
void put_rates(std::span<const Beat> beats, double nominal_period_s, std::vector<Change>& changes) {
  const double margin_s = nominal_period_s > longest_swing_s ? 0.5 * nominal_period_s : 0.0;
  std::vector<std::size_t> firsts{0}, ends; // of the stretches between changes
  for (const Change& change : changes) {
    const Instant cut = beats.front().time + change.at_s;
    const auto place = [&](const auto& is_before) {
      const auto at = std::partition_point(beats.begin(), beats.end(), is_before);
      return static_cast<std::size_t>(at - beats.begin());
    };
    ends.push_back(place([&](const Beat& beat) { return beat.time <= cut + -margin_s; }));
    firsts.push_back(place([&](const Beat& beat) { return beat.time < cut + margin_s; }));
  }
  ends.push_back(beats.size());
  const auto stretch = [&](std::size_t k) {
    return beats.subspan(firsts[k], std::max(ends[k], firsts[k]) - firsts[k]);
  };
  for (std::size_t j = 0; j < changes.size(); ++j) {
    put_rate(stretch(j), nominal_period_s, changes[j].rate_before, changes[j].rate_before_sigma);
    put_rate(stretch(j + 1), nominal_period_s, changes[j].rate_after,
             changes[j].rate_after_sigma);
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
