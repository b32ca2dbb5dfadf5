#include "base/workers.hpp"

#include "support/sanitizers.hpp"

#include <gtest/gtest.h>
#include <mutex>
#include <set>
#include <stdexcept>
#include <sys/resource.h>
#include <vector>

namespace goingrate {
namespace {

// How often each piece was done, and how many threads took part.
struct Done {
  std::vector<int> calls;
  std::size_t threads = 0;
};

Done counted(std::size_t count, std::size_t threads) {
  Done done{std::vector<int>(count), 0};
  std::mutex counting;
  share_out(count, threads, [&] {
    const std::lock_guard lock(counting);
    ++done.threads;
    return [&](std::size_t i) { ++done.calls[i]; };
  });
  return done;
}

TEST(WorkersTest, EachPieceIsDoneOnce) {
  for (const std::size_t threads : {0, 1, 3, 64}) {
    const Done done = counted(1000, threads);
    EXPECT_EQ(done.calls, std::vector<int>(1000, 1)) << threads;
    EXPECT_EQ(done.threads, std::max<std::size_t>(threads, 1));
  }
  EXPECT_EQ(counted(2, 64).threads, 2u);
}

TEST(WorkersTest, AnExceptionEndsTheWorkAndComesOut) {
  std::atomic<int> begun{0};
  EXPECT_THROW(share(1000000, 4,
                     [&](std::size_t) {
                       ++begun;
                       throw std::runtime_error("no");
                     }),
               std::runtime_error);
  EXPECT_LE(begun, 4);
}

TEST(WorkersTest, APartOfSharedWorkIsNotSharedAgain) {
  for (const std::size_t threads : {1, 2})
    share(2, threads, [&](std::size_t) { EXPECT_EQ(counted(100, 8).threads, 1u); });
  EXPECT_EQ(counted(100, 8).threads, 8u);
}

TEST(WorkersTest, IfNoThreadCanStartTheCallerDoesTheWork) {
  GOINGRATE_NEEDS_MEMORY_LIMITS();
  GTEST_FLAG_SET(death_test_style, "threadsafe"); // a fresh process, without stacks to use again
  const auto in_little_room = [] {
    constexpr rlim_t address_space_bytes = 1 << 20; // less than the program has: no stack fits
    const rlimit limit{address_space_bytes, address_space_bytes};
    ::setrlimit(RLIMIT_AS, &limit);
    const Done done = counted(100, 64);
    std::exit(done.threads == 1 && done.calls == std::vector<int>(100, 1) ? 0 : 1);
  };
  EXPECT_EXIT(in_little_room(), testing::ExitedWithCode(0), "");
}

} // namespace
} // namespace goingrate
