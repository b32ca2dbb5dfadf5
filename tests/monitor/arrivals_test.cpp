#include "arrivals.hpp"

#include <gtest/gtest.h>

namespace goingrate::apps {
namespace {

// The clock beats every second.
class ArrivalsTest : public testing::Test {
protected:
  // Hands over the beats from `from` to `to` - 1, each in the second in which it happened, but with
  // a time that is off by `wrong_by_s`. Returns how many are believed, including beats that were
  // held back before.
  int hear(int from, int to, double wrong_by_s = 0.0) {
    int believed = 0;
    for (int n = from; n < to; ++n)
      for (const auto& arrival :
           arrivals_.add(event_at(Instant{n, 0.0} + wrong_by_s), static_cast<double>(n))) {
        ++believed;
        begun_anew_ += arrival.begins_anew ? 1 : 0;
      }
    return believed;
  }
  int left_out() { return static_cast<int>(arrivals_.take_left_out().size()); }

  Arrivals arrivals_;
  int begun_anew_ = 0;
};

// As if some bits of the logger's counter had been wrong for a while.
TEST_F(ArrivalsTest, WrongLinesThatAgreeAreLeftOut) {
  EXPECT_EQ(hear(0, 100), 100);
  int n = 100;
  for (const double wrong_by_s : {4294.967296, -65.536, 1e9, -90.0}) {
    EXPECT_EQ(hear(n, n + 15, wrong_by_s), 0) << wrong_by_s;
    EXPECT_EQ(hear(n + 15, n + 50), 35) << wrong_by_s;
    EXPECT_EQ(left_out(), 15) << wrong_by_s;
    n += 50;
  }
  EXPECT_EQ(begun_anew_, 0);
}

TEST_F(ArrivalsTest, AClockThatGoesAgainAfterASilenceIsBelievedSoon) {
  EXPECT_EQ(hear(0, 100), 100);
  EXPECT_EQ(hear(400, 402), 0);
  EXPECT_EQ(hear(402, 403), 3);
  EXPECT_EQ(hear(403, 500), 97);
  EXPECT_EQ(begun_anew_, 0);
  EXPECT_EQ(left_out(), 0);
}

TEST_F(ArrivalsTest, ASourceThatBeginsAgainIsBelievedWhenItGoesOn) {
  EXPECT_EQ(hear(0, 100), 100);
  EXPECT_EQ(hear(100, 200, -100.0), 100); // from 0 again
  EXPECT_EQ(begun_anew_, 1);
  EXPECT_EQ(left_out(), 0);
}

TEST_F(ArrivalsTest, AfterARestartAFirstLineIsNoLaterThanItCanBe) {
  arrivals_.go_on_from(event_at({50, 0.0}), 50.0);
  EXPECT_EQ(hear(100, 101, 900.0), 0);
  EXPECT_EQ(hear(101, 150), 49);
  EXPECT_EQ(left_out(), 1);
}

// Beats from an archive are not judged again: they were believed when they were stored.
TEST_F(ArrivalsTest, WhatIsStoredIsBelieved) {
  Arrivals replayed;
  for (const std::int64_t second : {0, 1, 2, 1000, 1001, 5000})
    EXPECT_FALSE(replayed.believe(event_at({second, 0.0})).begins_anew) << second;
  EXPECT_TRUE(replayed.believe(event_at({7, 0.0})).begins_anew);
}

// An old log is read from a file, whose end gives back what is held.
TEST_F(ArrivalsTest, WhatIsHeldAtTheEndOfAFileGoesOn) {
  for (int n = 0; n < 100; ++n)
    arrivals_.add(event_at({n, 0.0}));
  for (int n = 300; n < 310; ++n)
    EXPECT_TRUE(arrivals_.add(event_at({n, 0.0})).empty());
  EXPECT_EQ(arrivals_.rest().size(), 10U);
}

} // namespace
} // namespace goingrate::apps
