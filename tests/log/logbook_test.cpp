#include "goingrate/log/logbook.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/log/reading.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(LogbookTest, ReadsWhatKeepersWrite) {
  const Logbook book = parse_logbook("\xef\xbb\xbf# Trinity\r\n"
                                     "what;time;note;value;sigma\r\n"
                                     "wind;2013-03-30 18:00;;;\r\n"
                                     "rate;2013-03-30 10:15;\"a penny; off\";-0,25;0,05\r\n"
                                     "\r\n"
                                     "clean;31.03.2013;oiled;;\r\n",
                                     "book");
  ASSERT_EQ(book.entries.size(), 3u);
  EXPECT_EQ(book.origin, TimeOrigin::epoch);
  const LogbookEntry& rate = book.entries[0]; // in order of time
  EXPECT_EQ(rate.what, LogbookWord::rate);
  EXPECT_EQ(rate.time.seconds, 1364638500);
  EXPECT_EQ(rate.value, -0.25);
  EXPECT_EQ(rate.sigma, 0.05);
  EXPECT_EQ(rate.note, "a penny; off");
  EXPECT_EQ(rate.line, 4u);
  EXPECT_FALSE(rate.whole_day);
  EXPECT_TRUE(std::isnan(book.entries[1].value));
  EXPECT_TRUE(book.entries[2].whole_day);
}

TEST(LogbookTest, ANoteInTheEndMayHoldCommas) {
  const Logbook book =
      parse_logbook("time,what,value,sigma,note\n3600,rate,0.5,,up a turn, then half back\n", "b");
  EXPECT_EQ(book.entries.at(0).note, "up a turn, then half back");
  EXPECT_EQ(book.origin, TimeOrigin::none);
}

TEST(LogbookTest, WhatIsWrongIsNamedWithItsPlace) {
  const auto refused = [](std::string_view text, std::string_view words) {
    try {
      (void)parse_logbook(text, "book");
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string_view(error.what()).find(words), std::string_view::npos) << error.what();
    }
  };
  refused("", "found an empty file");
  EXPECT_TRUE(parse_logbook("time,what\n", "book").entries.empty()) << "as of a quiet clock";
  refused("time,wat\n1,rate\n", "book:1:6: found 'wat', expected one of time, what, value, sigma, "
                                "note (did you mean what?)");
  refused("time,what\n1,wound\n", "book:2:3: found 'wound', expected one of rate, weight,");
  refused("time,what\nsoon,rate\n", "book:2:1: found 'soon', expected a date");
  refused("time,what\n,rate\n", "book:2:1: found nothing");
  refused("time,what,value\n5,rate,much\n", "book:2:8: found 'much', expected a number, or nothing");
  refused("time,what,value\n5,wind,3\n", "found '3', expected no value beside wind");
  refused("time,what,sigma\n5,rate,-3\n", "a negative sigma");
  refused("time,what\n5,rate\n2013-03-30,rate\n", "times of one kind");
  refused("time,note,what\n5,a,b,rate\n", "quote a field");
}

TEST(LogbookTest, WhatIsWrittenIsReadAgain) {
  const std::string text = "time,what,value,sigma,note\n"
                           "2013-03-30 10:15:00,rate,-0.25,0.05,\"a, b\"\n"
                           "2013-03-30 18:00:07,stop,,,\n";
  EXPECT_EQ(logbook_text(parse_logbook(text, "b")), text);
}

TEST(LogbookTest, TimesAreBroughtToThoseOfTheLog) {
  ClockLog log;
  log.origin = TimeOrigin::mjd;
  const Logbook book = parse_logbook("time,what\n2013-03-30 10:15,rate\n", "b");
  EXPECT_EQ(brought_to(log, book).entries[0].time.seconds, 1364638500 + 40587LL * 86400);
  EXPECT_EQ(logbook_text(brought_to(log, book)), logbook_text(book));
  log.origin = TimeOrigin::none;
  EXPECT_THROW((void)brought_to(log, book), InputError);
}

} // namespace
} // namespace goingrate
