#include "goingrate/log/weather.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"
#include "support/scratch_folder.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {
namespace {

class WeatherTest : public test::ScratchFolderTest {
protected:
  // A log of `beats` beats of 2 s.
  static ClockLog clock(int beats, const std::string& first = "") {
    std::string text;
    for (int i = 0; i < beats; ++i)
      text += first.empty() ? fmt::format("{}.01\n", 2 * i)
                            : fmt::format("{} {:02}:{:02}:{:02}.01\n", first, 10 + 2 * i / 3600,
                                          2 * i / 60 % 60, 2 * i % 60);
    return read_log(text, "clock");
  }
  ClockLog joined(ClockLog log, const std::string& weather, WeatherRequest request = {}) const {
    put("w.csv", weather);
    request.files = {path("w.csv")};
    join_weather(log, request);
    return log;
  }
  void refused(const ClockLog& log, const std::string& weather, const std::string& words) const {
    try {
      (void)joined(log, weather);
      FAIL() << words;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
};

TEST_F(WeatherTest, LiesOnTheLineBetweenReadings) {
  const ClockLog log = joined(
      clock(301), "time_s,temperature_c,pressure_mbar,humidity_percent\n0,20,1000,40\n300,23,1003,"
                  "43\n600,20,999.9,99\n");
  ASSERT_EQ(log.columns.temperature_c.size(), 301u);
  for (std::size_t i = 0; i < 150; ++i) {
    const double t = log.events[i].time.to_double();
    EXPECT_NEAR(log.columns.temperature_c[i], 20.0 + t / 100.0, 1e-12); // rounding
    EXPECT_NEAR(log.columns.pressure_mbar[i], 1000.0 + t / 100.0, 1e-12); // roundings of 1000
    EXPECT_NEAR(log.columns.humidity_percent[i], 40.0 + t / 100.0, 1e-13); // roundings of 40
  }
  EXPECT_TRUE(std::isnan(log.columns.temperature_c[300])) << "after the last reading";
  ASSERT_EQ(log.weather.size(), 3u);
  EXPECT_EQ(log.weather[1].quantity, "pressure");
  EXPECT_EQ(log.weather[0].readings, 3u);
  EXPECT_EQ(log.weather[0].events_without, 1u);
  EXPECT_EQ(log.weather[0].step_s, 300.0);
}

TEST_F(WeatherTest, InterpolatesWithItsSigma) {
  // The rms error of interpolated values over what is stated: 1 for independent errors of readings,
  // less for a random walk and a smooth course.
  struct Course {
    double white, walk, swing;
    double least, most; // of the ratio; three standard deviations of 2000 readings, some 5 %
  };
  for (const Course& course : {Course{0.1, 0.0, 0.0, 0.95, 1.05}, Course{0.0, 0.1, 0.0, 0.82, 0.91},
                               Course{0.0, 0.0, 1.0, 0.0, 0.5}}) {
    RandomStream noise(7, StreamPurpose::temperature_noise);
    const ClockLog log = clock(60001);
    std::vector<double> truth;
    double walk = 0.0;
    for (const Beat& event : log.events) {
      truth.push_back(20.0 + walk + course.swing * std::sin(event.time.to_double() / 1000.0));
      walk += course.walk * noise.normal();
    }
    std::string text = "time_s,temperature_c\n";
    for (std::size_t i = 0; i < truth.size(); i += 30)
      text += fmt::format("{}.01,{:.9f}\n", 2 * i, truth[i] + course.white * noise.normal());
    const ClockLog with = joined(log, text);
    double sum2 = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      sum2 += std::pow(with.columns.temperature_c[i] - truth[i], 2);
    const double ratio =
        std::sqrt(sum2 / static_cast<double>(truth.size())) / with.weather.at(0).sigma;
    EXPECT_GT(ratio, course.least) << course.white << ' ' << course.walk;
    EXPECT_LT(ratio, course.most) << course.white << ' ' << course.walk;
  }
}

TEST_F(WeatherTest, SmoothCoursesAreFollowedByASpline) {
  const auto rms_with = [&](int step_s) {
    std::string text = "time_s,temperature_c\n";
    for (int t = 0; t <= 40000; t += step_s)
      text += fmt::format("{},{:.9f}\n", t, std::sin(t / 1000.0));
    const ClockLog log = joined(clock(20000), text);
    double sum2 = 0.0;
    for (std::size_t i = 0; i < log.events.size(); ++i)
      sum2 += std::pow(log.columns.temperature_c[i] - std::sin(log.events[i].time.to_double() / 1e3),
                       2);
    return std::sqrt(sum2 / static_cast<double>(log.events.size()));
  };
  const double order = std::log2(rms_with(400) / rms_with(200));
  EXPECT_GT(order, 3.7); // four, and where both ends matter more
  EXPECT_LT(rms_with(500), 2e-3); // twelve readings a wave; four-point cubics leave 3e-3 here
}

TEST_F(WeatherTest, NothingIsDrawnOverHoles) {
  std::string text = "time_s,temperature_c\n";
  for (int t = 0; t <= 2000; t += 100)
    if (t < 500 || t > 1000) text += fmt::format("{},{}\n", t, t);
  const ClockLog log = joined(clock(1001), text);
  for (std::size_t i = 0; i < log.events.size(); ++i) {
    const double t = log.events[i].time.to_double();
    EXPECT_EQ(std::isnan(log.columns.temperature_c[i]), (t > 400.0 && t < 1100.0) || t > 2000.0)
        << t;
  }
  EXPECT_NE(log.assumptions.back().text.find("have none"), std::string::npos);
}

TEST_F(WeatherTest, UnitsAreThoseOfTheNamesOrOfTheSize) {
  struct Case {
    const char* header;
    double raw, celsius_or_mbar;
    std::vector<double> EventColumns::*column;
  };
  const auto temperature = &EventColumns::temperature_c, pressure = &EventColumns::pressure_mbar,
             humidity = &EventColumns::humidity_percent;
  for (const Case& c :
       {Case{"time (s),Temperature (°F)", 68.0, 20.0, temperature},
        Case{"time (s),Temp [K]", 293.15, 20.0, temperature},
        Case{"Zeit (s),Temperatur (°C)", 20.0, 20.0, temperature},
        Case{"time (s),room temp", 68.0, 20.0, temperature}, Case{"t (s),temp", 20.0, 20.0, temperature},
        Case{"time (s),Dew point (C),Temperature (C)", 20.0, 20.0, temperature},
        Case{"time (s),Barometer (inHg)", 29.92, 1013.208, pressure},
        Case{"time (s),pressure (mmHg)", 760.0, 1013.25, pressure},
        Case{"time (s),pressure", 101325.0, 1013.25, pressure},
        Case{"time (s),pressure", 101.325, 1013.25, pressure},
        Case{"time (s),pressure", 29.92, 1013.208, pressure},
        Case{"time (s),pressure", 999.9, 999.9, pressure},
        Case{"time (s),rel. humidity (%)", 99.0, 99.0, humidity},
        Case{"Zeit (s);Luftfeuchte (%)", 55.0, 55.0, humidity},
        Case{"time (s),RH", 0.45, 45.0, humidity}}) {
    std::string text = std::string(c.header) + "\n";
    const char separator = text.find(';') == std::string::npos ? ',' : ';';
    const bool third = std::count(text.begin(), text.end(), separator) == 2;
    for (const int t : {0, 300, 600, 900})
      text += fmt::format("{}{}{}{}\n", t, separator, third ? "7.5," : "", c.raw);
    const ClockLog log = joined(clock(301), text);
    ASSERT_FALSE((log.columns.*c.column).empty()) << c.header;
    EXPECT_NEAR((log.columns.*c.column)[10], c.celsius_or_mbar, 1e-3) << c.header << ' ' << c.raw;
  }
}

TEST_F(WeatherTest, DatesZonesAndOffsetsAreBroughtTogether) {
  const ClockLog log = clock(301, "2013-03-30"); // from 10:00 on
  const auto first = [](const ClockLog& with) { return with.columns.temperature_c.front(); };
  const std::string hours = "date and time,temperature (C)\n2013-03-30 10:00:00,20\n"
                            "2013-03-30 11:00:00,21\n2013-03-30 12:00:00,23\n";
  // The first beat is 0.01 s after ten, at 1 K an hour.
  EXPECT_NEAR(first(joined(log, hours)), 20.0, 1e-5);
  EXPECT_THROW((void)joined(log, hours, {.zone = "-01:00"}), InputError) << "begins an hour late";
  EXPECT_NEAR(first(joined(log, hours, {.zone = "+0100"})), 21.0, 1e-5); // likewise, at 2 K an hour
  EXPECT_NEAR(first(joined(log, hours, {.offset_s = -1800.0})), 20.5, 1e-5); // likewise
  const std::string zoned = "time,temperature (C)\n2013-03-30T12:00:00+02:00,20\n"
                            "2013-03-30T13:00:00+02:00,21\n2013-03-30T14:00:00+02:00,22\n";
  EXPECT_NEAR(first(joined(log, zoned, {.zone = "-05:00"})), 20.0, 1e-5) << "names its own";
  const std::string unix = "time,temperature (C)\n1364637600,20\n1364641200,21\n1364644800,22\n";
  EXPECT_NEAR(first(joined(log, unix)), 20.0, 1e-5); // likewise
  const std::string mjd = "MJD,temperature (C)\n56381.416666667,20\n56381.458333333,21\n"
                          "56381.5,22\n";
  EXPECT_NEAR(first(joined(log, mjd)), 20.0, 1e-5); // likewise
  EXPECT_THROW(joined(log, hours, {.zone = "Dublin"}), ArgumentError);
}

TEST_F(WeatherTest, DatesWithoutAZoneAreInThatOfTheLog) {
  std::string text;
  for (int i = 0; i < 60; ++i)
    text += fmt::format("2013-03-30T10:{:02}:{:02}+01:00\n", i / 30, 2 * i % 60);
  const ClockLog log = joined(read_log(text, "clock"), "time,temperature (C)\n2013-03-30 10:00:00,20\n"
                                                       "2013-03-30 11:00:00,21\n");
  EXPECT_NEAR(log.columns.temperature_c.front(), 20.0, 1e-12); // a beat at the reading's own time
}

TEST_F(WeatherTest, FilesOfTwoCadencesHaveNoHoles) {
  std::string slow = "time_s,temperature_c\n", fast = slow;
  for (int t = 0; t < 300; t += 60)
    slow += fmt::format("{},20\n", t);
  for (int t = 300; t <= 600; t += 2)
    fast += fmt::format("{},20\n", t);
  put("slow.csv", slow);
  put("fast.csv", fast);
  ClockLog log = clock(299);
  join_weather(log, {.files = {path("slow.csv"), path("fast.csv")}});
  EXPECT_EQ(log.weather.at(0).events_without, 0u);
}

TEST_F(WeatherTest, FilesByDayAreJoinedAndTwoSensorsRefused) {
  put("1.csv", "time_s,temperature_c\n0,20\n100,21\n200,22\n");
  put("2.csv", "time_s,temperature_c\n300,23\n400,24\n500,25\n600,26\n");
  put("3.csv", "time_s,temperature_c,pressure_mbar\n0,1,1000\n600,2,1001\n");
  ClockLog log = clock(301);
  join_weather(log, {.files = {path("2.csv"), path("1.csv")}});
  // The beat is 0.01 s late, at 1 K in 100 s.
  EXPECT_NEAR(log.columns.temperature_c[125], 22.5, 2e-4);
  EXPECT_EQ(log.weather[0].readings, 7u);
  log = clock(301);
  EXPECT_THROW(join_weather(log, {.files = {path("1.csv"), path("3.csv")}}), InputError);
}

TEST_F(WeatherTest, WhatCannotBeIsRefusedInWords) {
  const ClockLog log = clock(301);
  refused(log, "time_s,width\n0,20\n300,21\n600,22\n", "expected a header that names a time, and a");
  refused(log, "0,20\n300,21\n600,22\n", "expected a header");
  refused(log, "time_s,temperature_c\n", "");
  refused(log, "time_s,temperature_c\n0,nan\n300,nan\n600,nan\n", "3 lines without a temperature");
  refused(log, "time_s,temperature_c\n0,20\n", "found 1 reading, expected at least 2");
  refused(log, "date,temperature_c\n2013-03-30 10:00:00,20\n2013-03-30 11:00:00,21\n",
          "w.csv:2:1: found dates, expected times without a date, as in clock");
  refused(log, "time_s,temperature_c\n10000,20\n10300,21\n10600,22\n", "no temperature beside");
  ClockLog warm = read_log("time_s,temperature_c\n0,20\n2,20\n4,20\n6,20\n", "warm.csv");
  refused(warm, "time_s,temperature_c\n0,20\n300,21\n600,22\n", "warm.csv has a temperature of its");
}

TEST_F(WeatherTest, DensityIsThatOfPublishedTables) {
  constexpr double mercury = 1.333224; // mbar a millimetre
  const std::vector<double> temperature{10.0, 15.0, 20.0, 20.0, std::nan("")},
      pressure{730.0 * mercury, 1013.25, 1013.25, 1013.25, 1000.0},
      humidity{40.0, 0.0, 50.0, std::nan(""), 50.0};
  const std::vector<double> density = air_density(temperature, pressure, humidity);
  EXPECT_NEAR(density[0], 1.19569, 1e-5);    // Gupta, Mass Metrology, table of moist air
  EXPECT_NEAR(density[1], 1.2255, 5e-5);     // dry, of real air: ISO 2533's 1.2250 over Z = 0.99959
  EXPECT_NEAR(density[2], 1.1992, 1.2e-4);   // CIPM-81/91, which is 6.4e-5 lower, rounded
  EXPECT_TRUE(std::isnan(density[3])); // no jump to another humidity in a hole
  EXPECT_EQ(air_density(temperature, pressure)[2], density[2]) << "50 % where there is none at all";
  EXPECT_TRUE(std::isnan(density[4]));
  const std::vector<double> wet = air_density(std::vector{20.0}, std::vector{1013.25},
                                              std::vector{100.0});
  EXPECT_NEAR(wet[0], density[2] - 0.5 * 23.39e2 * 0.378 / (287.05 * 293.15), 3e-5); // ideal vapour
}

} // namespace
} // namespace goingrate
