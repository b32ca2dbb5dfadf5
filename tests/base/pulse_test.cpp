#include "goingrate/base/pulse.hpp"

#include "base/workers.hpp"

#include <atomic>
#include <gtest/gtest.h>
#include <stdexcept>
#include <thread>

namespace goingrate {
namespace {

struct Enough : std::runtime_error {
  Enough() : std::runtime_error("enough") {}
};

TEST(PulseTest, IsNothingWithoutAScope) { EXPECT_NO_THROW(pulse()); }

TEST(PulseTest, TheInnermostScopeCounts) {
  int outer = 0, inner = 0;
  const PulseScope one([&] { ++outer; });
  pulse();
  {
    const PulseScope two([&] { ++inner; });
    pulse();
    pulse();
  }
  pulse();
  EXPECT_EQ(outer, 2);
  EXPECT_EQ(inner, 2);
}

TEST(PulseTest, IsOfItsOwnThread) {
  int beats = 0;
  const PulseScope scope([&] { ++beats; });
  std::thread([] { pulse(); }).join();
  EXPECT_EQ(beats, 0);
}

TEST(PulseTest, EndsSharedWork) {
  for (const std::size_t threads : {1, 4}) {
    int beats = 0;
    const PulseScope scope([&] {
      if (++beats == 3) throw Enough();
    });
    std::atomic<int> done{0};
    constexpr std::size_t more_than_can_be_done = 1'000'000'000;
    EXPECT_THROW(share(more_than_can_be_done, threads, [&](std::size_t) { ++done; }), Enough);
    EXPECT_GE(done, 2);
  }
}

} // namespace
} // namespace goingrate
