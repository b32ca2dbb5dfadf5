#include "fit/thinning.hpp"

#include "goingrate/base/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

namespace goingrate::timing_model {
namespace {

constexpr double period_s = 2.0;

// Beats with jitter and a walk of `walk_s` per beat; those of `missing` are left out.
TimingData beats(std::size_t count, double walk_s, std::size_t missing = 0) {
  RandomStream jitter(7, StreamPurpose::jitter), walk(7, StreamPurpose::fast_drive);
  TimingData data;
  data.reference_period_s = period_s;
  double late = 0.0;
  for (std::size_t n = 0; n < count; ++n) {
    late += walk_s * walk.normal();
    if (n == missing && n > 0) continue;
    data.cycle.push_back(static_cast<double>(n));
    data.lateness_s.push_back(late + 1e-4 * jitter.normal());
    data.elapsed_s.push_back(data.cycle.back() * period_s + data.lateness_s.back());
    data.amplitude_rad.push_back(n % 3 == 0 ? std::numeric_limits<double>::quiet_NaN()
                                            : 0.05 + 1e-6 * static_cast<double>(n));
  }
  data.terms.push_back({"drift", "1/day", data.elapsed_s});
  return data;
}

// Of the steps from one kept beat to the next, those between two beats of the log.
std::map<std::size_t, int> steps(const std::vector<std::size_t>& kept, std::size_t from,
                                 std::size_t to) {
  std::map<std::size_t, int> counts;
  for (std::size_t k = 1; k < kept.size(); ++k)
    if (kept[k - 1] >= from && kept[k] <= to) ++counts[kept[k] - kept[k - 1]];
  return counts;
}

TEST(KeptBeatsTest, EveryTimeScaleShowsAfterTheStartAndAfterAnEvent) {
  constexpr std::size_t dense = 100, stride = 64, event = 12800;
  const auto kept = kept_beats(beats(25601, 0.0), {static_cast<double>(event)}, stride, dense);
  EXPECT_EQ(kept.front(), 0u);
  EXPECT_EQ(kept.back(), 25600u);
  for (const std::size_t begin : {std::size_t{0}, event}) {
    const auto counts = steps(kept, begin, begin + event);
    EXPECT_GE(counts.at(1), static_cast<int>(dense) - 1);
    for (std::size_t step = 2; step < stride;
         step *= 2) // half as many beats as are dense an octave
      EXPECT_NEAR(counts.at(step), 0.5 * dense, 2.0) << step; // where an octave is cut off the grid
    EXPECT_EQ(counts.rbegin()->first, stride);
  }
}

TEST(FewBeatsTest, UnderJitterEachIsTheMeanOfABlock) {
  const TimingData all = beats(1100, 0.0);
  const FewBeats few = few_beats(all, {}, 100);
  ASSERT_EQ(few.together, 11.0);
  EXPECT_EQ(few.data.cycle.front(), 0.0); // all cycles count from it
  for (std::size_t k = 1; k < few.data.size(); ++k) {
    const std::size_t first = 1 + 11 * (k - 1);
    EXPECT_EQ(few.data.cycle[k], all.cycle[first + 5]);
    double late = 0.0, amplitude = 0.0, seen = 0.0;
    for (std::size_t i = first; i < first + 11; ++i) {
      late += all.lateness_s[i] / 11.0;
      if (i % 3 == 0) continue;
      amplitude += all.amplitude_rad[i];
      ++seen;
    }
    EXPECT_NEAR(few.data.lateness_s[k], late, 1e-18); // rounding of 1e-4
    EXPECT_NEAR(few.data.amplitude_rad[k], amplitude / seen, 1e-15);
    EXPECT_EQ(few.data.elapsed_s[k], few.data.cycle[k] * period_s + few.data.lateness_s[k]);
    EXPECT_NEAR(few.data.terms[0].advance_s[k], all.terms[0].advance_s[first + 5], 1e-3); // jitter
  }
}

TEST(FewBeatsTest, NoBlockHoldsAGapOrAnEvent) {
  const TimingData all = beats(1111, 0.0, 500);
  const FewBeats few = few_beats(all, {300.0}, 100);
  ASSERT_EQ(few.together, 11.0);
  EXPECT_GT(few.data.size(), 95u); // of a hundred
  for (std::size_t k = 1; k < few.data.size(); ++k) {
    const double from = few.data.cycle[k] - 5.0, to = few.data.cycle[k] + 5.0;
    EXPECT_FALSE(from <= 500.0 && 500.0 <= to) << from;
    EXPECT_FALSE(from <= 300.0 && 300.0 < to) << from; // the event follows beat 300
  }
}

TEST(FewBeatsTest, WhereTimesWalkTheyAreKeptAtAStride) {
  const TimingData all = beats(1100, 3e-4);
  const FewBeats few = few_beats(all, {}, 100);
  EXPECT_EQ(few.together, 1.0);
  ASSERT_EQ(few.data.size(), 100u);
  for (std::size_t k = 0; k < few.data.size(); ++k)
    EXPECT_EQ(few.data.lateness_s[k], all.lateness_s[11 * k]);
}

} // namespace
} // namespace goingrate::timing_model
