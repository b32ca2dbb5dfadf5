// Random streams that are the same on every compiler and machine.
//
// The standard does not specify the algorithm of std::normal_distribution; that of Boost is fixed.
// A stream is identified by the user's seed and a purpose, so that adding one kind of noise never
// changes the draws of another.
#pragma once

#include <cstdint>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>

namespace goingrate {

/// What a stream of random numbers is used for.
enum class StreamPurpose : std::uint64_t {
  fast_drive = 1,
  slow_drive = 2,
  jitter = 3,
  amplitude_noise = 4,
  missed = 5,
  spurious = 6,
  temperature_noise = 7,
};

/// One reproducible stream of deviates, fixed by (seed, purpose).
class RandomStream {
public:
  /// Streams of other seeds or purposes are independent of it.
  RandomStream(std::uint64_t seed, StreamPurpose purpose)
      : engine_(mix(mix(seed) ^ static_cast<std::uint64_t>(purpose))) {}

  /// A standard normal deviate (mean 0, variance 1).
  double normal() { return normal_(engine_); }
  /// A uniform deviate in [0, 1).
  double uniform() { return uniform_(engine_); }

private:
  // The finaliser of SplitMix64 (Steele, Lea and Flood 2014): neighbouring seeds become unrelated.
  static std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
  }

  boost::random::mt19937_64 engine_;
  boost::random::normal_distribution<double> normal_;
  boost::random::uniform_01<double> uniform_;
};

} // namespace goingrate
