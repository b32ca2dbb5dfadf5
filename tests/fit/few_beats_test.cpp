#include "fit/fit_starts.hpp"
#include "fit/fitted.hpp"
#include "fit/thinning.hpp"

#include "goingrate/base/random.hpp"
#include "support/fit_scenes.hpp"

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

TEST(ThinnedBeatsTest, AnAmplitudeIsTheMeanOfThoseNearestToItsBeat) {
  TimingData all = beats(4000, 0.0);
  const double event = 2001.0;
  const auto kept = kept_beats(all, {event}, 16, 100);
  const TimingData thin = thinned_to(all, kept);
  for (std::size_t k = 1; k + 1 < kept.size(); ++k) {
    double sum = 0.0, seen = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto away = [&](std::size_t place) { return i > place ? i - place : place - i; };
      const std::size_t neighbour =
          std::min(kept[k] - kept[k - 1], kept[k + 1] - kept[k]); // as far on either side
      if (2 * away(kept[k]) >= neighbour || i % 3 == 0) continue;
      EXPECT_EQ(all.cycle[i] < event, all.cycle[kept[k]] < event) << kept[k];
      sum += all.amplitude_rad[i];
      ++seen;
    }
    EXPECT_EQ(thin.lateness_s[k], all.lateness_s[kept[k]]);
    if (seen == 0.0) {
      EXPECT_TRUE(std::isnan(thin.amplitude_rad[k]));
      continue;
    }
    EXPECT_NEAR(thin.amplitude_rad[k], sum / seen, 1e-15); // rounding
    EXPECT_NEAR(thin.amplitude_noise[k], 1.0 / std::sqrt(seen), 1e-15);
  }
}

// A clock whose swing wanders, and a sensor that sees single amplitudes less well than that.
Fitted told_the_truth(const TimingData& data, const Scenario& s) {
  Fitted fitted;
  fitted.model.drive = true;
  fitted.problem = make_problem(data, {}, fitted.model);
  const std::map<std::string, double> truth{
      {"T0", s.clock.nominal_period_s},
      {"epsilon", s.clock.epsilon},
      {"mu", s.clock.mu},
      {"phi0", s.clock.phi0},
      {"lambda0", data.amplitude_rad.front()},
      {"drive_rms", s.drive.fast_rms},
      {"jitter_rms", s.sensor.jitter_rms_s},
      {"amplitude_rms", *s.sensor.amplitude_rms},
  };
  fitted.minimum.x.resize(fitted.problem.parameters.free_count);
  for (const Slot& slot : fitted.problem.parameters.slots)
    if (slot.free)
      fitted.minimum.x[slot.index] =
          slot.coordinate_of(truth.at(fitted.problem.parameters.name_of(slot)));
  return fitted;
}

TEST(ThinnedBeatsTest, AmplitudesInBetweenStillTellOfTheClock) {
  Scenario s;
  s.clock = {1.0, 3e-4, 2e-5, 0.025};
  s.periods = 20000;
  s.drive.fast_rms = 0.05;
  s.sensor.jitter_rms_s = 2e-5;
  s.sensor.amplitude_rms = 5e-5;
  const TimingData all = timing_data(test::simulated_beats(s, 1618));
  const auto kept = kept_beats(all, {}, 16, 100);
  const TimingData thinned = thinned_to(all, kept), picked = subset(all, kept);
  Fitted fitted = told_the_truth(all, s);
  const auto lost_by = [&](const TimingData& beats) {
    fitted.problem = fitted.problem.on(beats);
    return information_lost(fitted, all);
  };
  EXPECT_GT(lost_by(picked), 0.7);
  EXPECT_LT(lost_by(thinned), 0.3);
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
