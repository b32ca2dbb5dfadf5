#include "daily_wave.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

namespace goingrate::apps {

namespace {

constexpr std::int64_t minutes_a_day = 1440;
constexpr double memory_minutes = 20.0 * minutes_a_day;
// How strongly the wave is held at zero, in minutes of data: within a few hours it cannot be told
// from a drift.
constexpr double held_minutes = 144.0;

} // namespace

DailyWave::Vector DailyWave::shape(std::int64_t minute) {
  const double day = 2.0 * std::numbers::pi * static_cast<double>(minute % minutes_a_day) /
                     static_cast<double>(minutes_a_day);
  return {1.0, std::cos(day), std::sin(day), std::cos(2.0 * day), std::sin(2.0 * day)};
}

std::optional<double> DailyWave::without(std::int64_t minute, std::optional<double> mean) {
  if (!mean) return {};
  const Vector x = shape(minute);
  Vector held = Vector::Constant(held_minutes);
  held[0] = 1e-9; // the level is free; this only keeps the first minute solvable
  const Vector learnt = (weights_ + held.asDiagonal().toDenseMatrix()).ldlt().solve(sums_);
  constexpr double fading = 1.0 - 1.0 / memory_minutes;
  weights_ = fading * weights_ + x * x.transpose();
  sums_ = fading * sums_ + x * *mean;
  return *mean - x.tail<terms - 1>().dot(learnt.tail<terms - 1>());
}

void DailyWave::pass(Learnt& learnt) {
  for (double& weight : weights_.reshaped())
    learnt(weight);
  for (double& sum : sums_)
    learnt(sum);
}

void DailyWave::stepped(double size) { sums_ += size * weights_.col(0); }

} // namespace goingrate::apps
