// Logs that hold every n-th beat only.
#pragma once

#include "goingrate/log/beats.hpp"

#include <cstdint>
#include <span>

namespace goingrate {

/// Cycles from one beat to the next if nine in ten beats are equally far apart, otherwise 1: 2 if
/// every second beat is missing, or half the period was given as the period; 30 if a contact closes
/// once a minute. Beats missed at random leave more single steps than that.
inline std::int64_t usual_step(std::span<const Beat> beats) {
  if (beats.size() < 3) return 1;
  // If nine in ten beats are two cycles or more apart, all are 1.8 apart in the mean.
  constexpr double least_mean = 1.8;
  const auto cycles = static_cast<double>(beats.back().cycle - beats.front().cycle);
  if (cycles < least_mean * static_cast<double>(beats.size() - 1)) return 1;
  const auto step = [&](std::size_t i) { return beats[i].cycle - beats[i - 1].cycle; };
  std::int64_t usual = step(1); // the majority, if there is one (Boyer and Moore)
  std::size_t votes = 0, alike = 0;
  for (std::size_t i = 1; i < beats.size(); ++i) {
    if (votes == 0) usual = step(i);
    votes = step(i) == usual ? votes + 1 : votes - 1;
  }
  for (std::size_t i = 1; i < beats.size(); ++i)
    alike += step(i) == usual ? 1 : 0;
  return 10 * alike >= 9 * (beats.size() - 1) ? usual : 1;
}

} // namespace goingrate
