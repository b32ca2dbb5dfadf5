// What a fit does not accept: logs that no clock of the model can explain, and options and data
// that make no sense.
#include "goingrate/fit/clock_fit.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"
#include "support/simulated.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

// Beats that relax to an even rate, by a factor e in `cycles`, under little jitter.
TimingData relaxing(double offset_s, double cycles) {
  RandomStream jitter(7, StreamPurpose::jitter);
  TimingData data;
  data.reference_period_s = 1.0;
  for (int n = 0; n < 300; ++n) {
    data.cycle.push_back(n);
    data.lateness_s.push_back(offset_s * std::exp(-n / cycles) + 1e-5 * jitter.normal());
    data.elapsed_s.push_back(n + data.lateness_s.back());
  }
  return data;
}

void expect_contradiction(const FitSummary& fit, NoteKind kind) {
  EXPECT_EQ(fit.status, FitStatus::contradicts_log);
  EXPECT_TRUE(std::any_of(fit.notes.begin(), fit.notes.end(),
                          [&](const FitNote& note) { return note.kind == kind; }));
  for (const FittedParameter& p : fit.parameters)
    EXPECT_TRUE(p.status == ParameterStatus::fixed || p.status == ParameterStatus::undetermined)
        << p.name << " = " << p.value;
}

TEST(ClockFitTest, WhatRelaxesWithinABeatIsNoPendulum) {
  FitOptions options;
  options.fixed["T0"] = 1.0;
  options.noise = FitNoise::jitter;
  for (const double offset_s : {-3e-3, 3e-3})
    expect_contradiction(fit_clock(relaxing(offset_s, 0.25), 1.0, options), NoteKind::domain);
  EXPECT_EQ(fit_clock(relaxing(3e-3, 5.0), 1.0, options).status, FitStatus::converged);
}

TEST(ClockFitTest, NothingIsStatedOfALogThatNoPlaceExplains) {
  // A wander of a period of 60 beats, which a clock without noise does not follow.
  TimingData data = relaxing(0.0, 1.0);
  for (std::size_t n = 0; n < data.size(); ++n) {
    data.lateness_s[n] += 1e-3 * std::sin(2.0 * std::numbers::pi * static_cast<double>(n) / 60.0);
    data.elapsed_s[n] += data.lateness_s[n];
  }
  FitOptions options;
  options.noise = FitNoise::jitter;
  expect_contradiction(fit_clock(data, 1.0, options), NoteKind::misfit);
}

TEST(ClockFitTest, NonsenseIsRefusedByName) {
  const TimingData data = timing_data(test::simulated_beats(test::at_point_a(20), 1));
  const auto with = [&](auto&& change) {
    FitOptions options;
    change(options);
    return fit_clock(data, 2.0, options);
  };
  EXPECT_THROW((void)with([](FitOptions& o) { o.fixed["eps"] = 1; }), ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) { o.fixed["epsilon"] = -1; }), ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) { o.events = {{30, {"mu"}}}; }), ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) { o.events = {{5, {"lambda0"}}}; }), ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) { o.events = {{5, {"mu", "mu"}}}; }), ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) {
                 o.fixed["T0"] = 2.0;
                 o.priors = {{"T0", 2.0, 0.1}};
               }),
               ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) { o.priors = {{"mu", 1e-5, 0.0}}; }), ArgumentError);
  EXPECT_THROW((void)parse_fit_event("mu"), ArgumentError);
  EXPECT_THROW((void)parse_fit_event("15x:mu"), ArgumentError);
  EXPECT_THROW((void)parse_fit_event("~:mu"), ArgumentError);
  EXPECT_EQ(parse_fit_event("15:mu,epsilon").names.size(), 2u);
  EXPECT_TRUE(parse_fit_event("15:mu").has_known_moment());
  EXPECT_EQ(parse_fit_event("~15:mu").cycle, 15);
  EXPECT_FALSE(parse_fit_event("~15:mu").has_known_moment());
}

TEST(ClockFitTest, DataThatDoNotFitTogetherAreRefused) {
  EXPECT_THROW((void)fit_clock({}, 2.0, {}), ArgumentError);
  const TimingData good = timing_data(test::even_beats(50, 1, 2.0));
  for (const auto spoil : {+[](TimingData& data) { data.elapsed_s.pop_back(); },
                           +[](TimingData& data) { data.lateness_s.clear(); },
                           +[](TimingData& data) { data.amplitude_rad = {0.05}; },
                           +[](TimingData& data) { data.terms.front().advance_s.pop_back(); },
                           +[](TimingData& data) { data.lateness_s[3] = NAN; },
                           +[](TimingData& data) { data.cycle[7] = data.cycle[6]; },
                           +[](TimingData& data) { data.reference_period_s = 0.0; }}) {
    TimingData data = good;
    spoil(data);
    EXPECT_THROW((void)fit_clock(data, 2.0, {}), ArgumentError);
  }
}

} // namespace
} // namespace goingrate
