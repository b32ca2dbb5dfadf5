// Figures: what is drawn, what is left out, and that nothing odd ever reaches the SVG.
#include "goingrate/report/figure.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/report/gnuplot.hpp"
#include "markup_checks.hpp"
#include "report/figure_axes.hpp"

#include "support/nan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

namespace goingrate {
namespace {

using test::count_of;

using test::nan;
constexpr double infinity = std::numeric_limits<double>::infinity();
using Style = Series::Style;

Figure figure_of(std::vector<Series> series, bool logarithmic = false) {
  return {"test",
          "A title",
          "A caption",
          {"time", "s", logarithmic},
          {"rate", "s/day", logarithmic},
          std::move(series)};
}

Series series_of(Style style, std::vector<double> y) {
  Series series{style, "label", {}, std::move(y)};
  for (std::size_t i = 0; i < series.y.size(); ++i)
    series.x.push_back(static_cast<double>(i + 1));
  if (style == Style::bars || style == Style::band) {
    for (const double value : series.y) {
      series.low.push_back(value - 1.0);
      series.high.push_back(value + 1.0);
    }
  }
  return series;
}

// The text of the figure, checked for what must hold for every figure.
std::string drawn(const Figure& figure) {
  std::string text = svg(figure);
  EXPECT_EQ(test::tag_fault(text), "");
  EXPECT_FALSE(test::has_word(text, "nan")) << text;
  EXPECT_FALSE(test::has_word(text, "inf")) << text;
  return text;
}

// The data of the path with the given class; empty if there is none.
std::string path_of(const std::string& text, const std::string& kind) {
  const std::size_t at = text.find("class=\"" + kind);
  if (at == std::string::npos) return {};
  const std::size_t begin = text.find(" d=\"", at) + 4;
  return text.substr(begin, text.find('"', begin) - begin);
}

// The heights of all points "Mx y" and "Lx y" of a path.
std::vector<double> heights(const std::string& path) {
  std::vector<double> result;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (path[i] != 'M' && path[i] != 'L') continue;
    result.push_back(std::strtod(path.c_str() + path.find(' ', i), nullptr));
  }
  return result;
}

std::vector<double> noise(std::size_t count) {
  std::vector<double> values;
  std::uint64_t state = 1;
  for (std::size_t i = 0; i < count; ++i) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL; // Knuth's congruences
    values.push_back(static_cast<double>(state >> 40) / static_cast<double>(1 << 24));
  }
  return values;
}

TEST(FigureTest, WithoutSeriesSaysThatItHasNothingToShow) {
  EXPECT_NE(drawn(figure_of({})).find("no values to show"), std::string::npos);
}

TEST(FigureTest, WithoutDrawableValuesSaysSoInEveryStyle) {
  for (const Style style : {Style::line, Style::points, Style::band, Style::bars}) {
    for (const auto& y :
         {std::vector<double>{}, {nan, nan}, {infinity, -infinity}, {1e300, -1e300}})
      EXPECT_NE(drawn(figure_of({series_of(style, y)})).find("no values to show"),
                std::string::npos);
    EXPECT_NE(drawn(figure_of({series_of(style, {0.0, -2.0})}, true)).find("no values to show"),
              std::string::npos);
  }
}

TEST(FigureTest, DrawsASinglePointInEveryStyle) {
  for (const bool logarithmic : {false, true}) {
    EXPECT_NE(path_of(drawn(figure_of({series_of(Style::line, {5.0})}, logarithmic)), "line"), "");
    EXPECT_NE(path_of(drawn(figure_of({series_of(Style::points, {5.0})}, logarithmic)), "mark"),
              "");
    EXPECT_NE(path_of(drawn(figure_of({series_of(Style::bars, {5.0})}, logarithmic)), "bar"), "");
    EXPECT_NE(path_of(drawn(figure_of({series_of(Style::band, {5.0})}, logarithmic)), "band"), "");
  }
}

TEST(FigureTest, DrawsAConstantSeriesFlat) {
  for (const double level : {0.0, 1.0, -3e-9, 86400.0, 1e9 + 0.1}) {
    const auto y =
        heights(path_of(drawn(figure_of({series_of(Style::line, {level, level, level})})), "line"));
    ASSERT_EQ(y.size(), 3U);
    EXPECT_EQ(y[0], y[1]);
    EXPECT_EQ(y[0], y[2]);
  }
}

TEST(FigureTest, SurvivesExtremeRanges) {
  drawn(figure_of({series_of(Style::line, {-1e150, 1e150})}));
  drawn(figure_of({series_of(Style::line, {1e-300, 1e150})}, true));
  drawn(figure_of({series_of(Style::line, {1e-320, 2e-320})}));
  drawn(figure_of({series_of(Style::line, {1e9, std::nextafter(1e9, 2e9)})}));
  drawn(figure_of({series_of(Style::line, {1.0, infinity, 2.0, nan, -infinity, 3.0})}));
}

TEST(FigureTest, BreaksALineWhereAValueIsMissing) {
  const std::string whole = drawn(figure_of({series_of(Style::line, {1, 2, 3, 4, 5})}));
  const std::string broken = drawn(figure_of({series_of(Style::line, {1, 2, nan, 4, 5})}));
  EXPECT_EQ(count_of(path_of(whole, "line"), "M"), 1U);
  EXPECT_EQ(count_of(path_of(broken, "line"), "M"), 2U);
}

TEST(FigureTest, LeavesMissingPointsOut) {
  const std::string text = drawn(figure_of({series_of(Style::points, {1, nan, 3, infinity, 5})}));
  EXPECT_EQ(count_of(path_of(text, "mark"), "M"), 3U);
}

TEST(FigureTest, LeavesNonPositiveValuesOfALogarithmicAxisOut) {
  const std::string text = drawn(figure_of({series_of(Style::points, {1, 0, 100, -5})}, true));
  EXPECT_EQ(count_of(path_of(text, "mark"), "M"), 2U);
}

TEST(FigureTest, EndsABarThatReachesBelowZeroAtTheFootOfALogarithmicAxis) {
  Series bars{Style::bars, "", {1, 10}, {1, 10}, {-1, 5}, {2, 20}};
  EXPECT_EQ(count_of(path_of(drawn(figure_of({bars}, true)), "bar"), "V"), 2U);
}

TEST(FigureTest, KeepsASingleSpikeInALongSeries) {
  for (const double spike : {50.0, -50.0}) {
    auto y = noise(100'000);
    y[54'321] = spike;
    const std::string line = drawn(figure_of({series_of(Style::line, y)}));
    auto at = heights(path_of(line, "line"));
    std::sort(at.begin(), at.end()); // the drawing is 320 high, the noise a fiftieth of it
    EXPECT_GT(spike > 0 ? at[1] - at[0] : at[at.size() - 1] - at[at.size() - 2], 250.0);
    // In a cloud it stands at the rim, outside all dots.
    const std::string cloud = drawn(figure_of({series_of(Style::points, y)}));
    const std::string rim = path_of(cloud, "mark rim");
    ASSERT_EQ(count_of(rim, "M"), 1U);
    const double height = heights(rim).front();
    auto dots = heights(path_of(cloud, "dots"));
    std::sort(dots.begin(), dots.end());
    EXPECT_TRUE(spike > 0 ? height < dots.front() : height > dots.back());
    EXPECT_GT(dots.back() - dots.front(), 250.0) << "the noise fills the drawing";
  }
}

TEST(FigureTest, ACrowdOfFewPointsIsAllDots) {
  Series series = series_of(Style::points, noise(330));
  for (double& x : series.x)
    x = x < 329.0 ? std::fmod(x, 5.0) : 1000.0; // five columns hold nearly all
  const std::string text = drawn(figure_of({series}));
  EXPECT_EQ(count_of(path_of(text, "dots"), "M"), 330U);
  EXPECT_EQ(count_of(text, "class=\"body"), 0U);
}

TEST(FigureTest, ALongSeriesStaysSmall) {
  for (const Style style : {Style::line, Style::points, Style::band}) {
    EXPECT_LT(drawn(figure_of({series_of(style, noise(28'800))})).size(), 626U * 100U);
    EXPECT_LT(drawn(figure_of({series_of(style, noise(900'000))})).size(), 626U * 100U);
  }
}

TEST(FigureTest, ALongSeriesFullOfGapsStaysSmall) {
  auto y = noise(500'000);
  for (std::size_t i = 0; i < y.size(); i += 2)
    y[i] = nan;
  for (const Style style : {Style::line, Style::points, Style::band})
    EXPECT_LT(drawn(figure_of({series_of(style, y)})).size(), 626U * 100U);
}

TEST(FigureTest, ThinnedLinesKeepEveryColumnsExtremes) {
  // Two thousand points a column; each holds one low and one high point.
  std::vector<double> y(1'000'000, 0.0);
  for (std::size_t i = 500; i + 500 < y.size(); i += 1000)
    y[i] = i % 2000 == 500 ? 1.0 : -1.0;
  const auto at = heights(path_of(drawn(figure_of({series_of(Style::line, y)})), "line"));
  const double top = *std::min_element(at.begin(), at.end());
  const double foot = *std::max_element(at.begin(), at.end());
  EXPECT_GE(std::count(at.begin(), at.end(), top), 490);
  EXPECT_GE(std::count(at.begin(), at.end(), foot), 490);
}

TEST(FigureTest, TicksComeInStepsOfOneTwoOrFive) {
  const std::string text = drawn(figure_of({series_of(Style::line, {0, 10})}));
  for (const char* label : {">0<", ">2<", ">4<", ">6<", ">8<", ">10<"})
    EXPECT_NE(text.find(label), std::string::npos) << label;
}

TEST(FigureTest, PutsAFactorIntoTheTitleSoThatLabelsStayShort) {
  const std::string small = drawn(figure_of({series_of(Style::line, {0, 3e-7})}));
  EXPECT_NE(small.find("rate (10⁻⁹ s/day)"), std::string::npos);
  EXPECT_NE(small.find(">300<"), std::string::npos);
  const std::string large = drawn(figure_of({series_of(Style::line, {0, 4e6})}));
  EXPECT_NE(large.find("rate (10⁶ s/day)"), std::string::npos);
}

TEST(FigureTest, PutsAnOffsetIntoTheTitleWhereValuesDifferLittle) {
  const std::string text = drawn(figure_of({series_of(Style::line, {1364774403.0, 1364774413.0})}));
  EXPECT_NE(text.find("rate − 1364774"), std::string::npos);
  EXPECT_EQ(count_of(text, ">1364774"), 0U);
}

TEST(FigureTest, LogarithmicTicksAreDecades) {
  const std::string text = drawn(figure_of({series_of(Style::line, {1e-7, 1e-4})}, true));
  for (const char* label : {">10⁻⁷<", ">10⁻⁶<", ">10⁻⁵<", ">10⁻⁴<"})
    EXPECT_NE(text.find(label), std::string::npos) << label;
}

TEST(FigureTest, HasALegendOnlyForMoreThanOneSeries) {
  Series first = series_of(Style::line, {1, 2});
  Series second = first;
  second.label = "other";
  EXPECT_EQ(count_of(drawn(figure_of({first})), "label"), count_of("aria-labelledby", "label"));
  const std::string both = drawn(figure_of({first, second}));
  EXPECT_NE(both.find(">label<"), std::string::npos);
  EXPECT_NE(both.find(">other<"), std::string::npos);
}

TEST(FigureTest, TellsSeriesOfOneColourApartByDashes) {
  const Series line = series_of(Style::line, {1, 2});
  const std::string text = drawn(figure_of({line, line}));
  EXPECT_NE(path_of(text, "line k0"), "");
  EXPECT_NE(path_of(text, "line k1"), "");
}

TEST(FigureTest, EscapesEveryText) {
  Figure figure = figure_of({series_of(Style::line, {1, 2}), series_of(Style::line, {2, 3})});
  const std::string bad = "<b>&\"'\x01\xff";
  figure.id = figure.title = figure.caption = figure.x.label = figure.y.unit = bad;
  figure.series[0].label = bad;
  figure.markers = {{1.5, bad}};
  const std::string text = drawn(figure);
  EXPECT_EQ(text.find("<b>"), std::string::npos);
  EXPECT_EQ(text.find('\x01'), std::string::npos);
  EXPECT_EQ(text.find('\xff'), std::string::npos);
  EXPECT_EQ(count_of(text, "&lt;b&gt;&amp;&quot;&#39;"), 6U);
}

TEST(FigureTest, DrawsMarkersInsideOnly) {
  Figure figure = figure_of({series_of(Style::line, {1, 2, 3})});
  figure.markers = {{2.0, "in"}, {100.0, "out"}, {nan, "nowhere"}};
  const std::string text = drawn(figure);
  EXPECT_EQ(count_of(text, "class=\"marker\""), 1U);
  EXPECT_EQ(text.find(">out<"), std::string::npos);
}

TEST(FigureTest, LabelsOfMarkersCoverNothing) {
  Figure figure = figure_of({series_of(Style::line, {1, 2, 3}), series_of(Style::line, {3, 2, 1})});
  figure.markers = {{1.0, "first"}, {1.001, "second"}}; // too close for one row
  const std::string text = drawn(figure);
  const auto number_after = [&](std::size_t from, const std::string& key) {
    const std::size_t at = text.find(key, from);
    EXPECT_NE(at, std::string::npos) << key;
    return std::stod(text.substr(at + key.size()));
  };
  const double frame = number_after(text.find("class=\"frame\""), " y=\"");
  const std::size_t first = text.find("class=\"note\"");
  const double lower = number_after(first, " y=\""),
               upper = number_after(text.find("class=\"note\"", first + 1), " y=\"");
  EXPECT_LT(lower, frame);
  EXPECT_LT(upper, lower - 13.0) << "a row of its own";
  const double legend = number_after(text.find("M", text.find("line k0", text.find("frame"))), " ");
  EXPECT_LT(legend, upper - 13.0) << "and the legend is above";
}

TEST(FigureTest, TheLastLabelOfAnAxisIsNotCut) {
  Figure figure = figure_of({series_of(Style::line, {1, 2, 3})});
  figure.x.logarithmic = true;
  figure.series[0].x = {1.0, 100.0, 900000.0}; // the axis ends at 10^6
  const std::string text = drawn(figure);
  const std::size_t label = text.find(">10⁶<");
  ASSERT_NE(label, std::string::npos) << text;
  const std::size_t x = text.rfind(" x=\"", label) + 4;
  EXPECT_LE(std::stod(text.substr(x)) + 0.5 * 3 * 11.0, 720.0); // three letters of eleven
}

TEST(FigureTest, TakesTheWidthItIsGivenAndSpeaksToAScreenReader) {
  const std::string text = drawn(figure_of({series_of(Style::line, {1, 2})}));
  const std::string opening = text.substr(0, text.find('>'));
  EXPECT_EQ(opening.find(" width="), std::string::npos);
  EXPECT_NE(opening.find("viewBox=\"0 0 720 "), std::string::npos);
  EXPECT_NE(opening.find("role=\"img\""), std::string::npos);
  EXPECT_NE(text.find(">A title</title>"), std::string::npos);
  EXPECT_NE(text.find(">A caption</desc>"), std::string::npos);
}

TEST(FigureTest, AFileOfItsOwnHoldsItsStyle) {
  const std::string text = standalone_svg(figure_of({series_of(Style::line, {1, 2})}));
  EXPECT_EQ(test::tag_fault(text), "");
  EXPECT_NE(text.find("<style>"), std::string::npos);
}

TEST(FigureTest, RefusesVectorsOfDifferentLength) {
  Series series = series_of(Style::line, {1, 2});
  series.x.pop_back();
  EXPECT_THROW(svg(figure_of({series})), ArgumentError);
  Series bars = series_of(Style::bars, {1, 2});
  bars.low.pop_back();
  EXPECT_THROW(svg(figure_of({bars})), ArgumentError);
}

// A thousand rates that scatter by one, the last tenth two higher, and one bad period.
Figure cloud_with_an_outlier(double outlier) {
  Figure figure{"rate", "Rate", "", {"time", "s"}, {"rate", "s/day"}, {}};
  Series points{Series::Style::points, "each period", {}, {}, {}, {}, 0};
  for (int i = 0; i < 1000; ++i) {
    points.x.push_back(i);
    points.y.push_back(std::sin(7.0 * i * i) + (i >= 900 ? 2.0 : 0.0));
  }
  points.y[300] = outlier;
  figure.series = {points};
  return figure;
}

TEST(FigureTest, TheBulkOfACloudSetsTheAxis) {
  const FigureAxes axes = figure_axes(cloud_with_an_outlier(600.0));
  EXPECT_TRUE(axes.clipped);
  EXPECT_GT(axes.y.to, 3.0) << "the step is seen";
  EXPECT_LT(axes.y.to, 5.0) << "and not hidden by the outlier";
  EXPECT_LT(axes.y.from, -1.0);
  EXPECT_GT(axes.y.from, -2.0);
  const FigureAxes plain = figure_axes(cloud_with_an_outlier(4.0));
  EXPECT_FALSE(plain.clipped) << "what is not far off has its place";
  EXPECT_GT(plain.y.to, 4.0);
}

TEST(FigureTest, WhatLiesBeyondStandsAtTheRim) {
  const Figure figure = cloud_with_an_outlier(-600.0);
  const SeriesWithin inside = within(figure.series.front(), figure_axes(figure));
  ASSERT_EQ(inside.beyond.size(), 1U);
  EXPECT_EQ(inside.beyond[0].x, 300.0);
  EXPECT_FALSE(inside.beyond[0].above);
  EXPECT_TRUE(std::isnan(inside.inside.y[300]));
  EXPECT_EQ(test::count_of(svg(figure), "class=\"mark rim c0\""), 1U);
  EXPECT_EQ(test::count_of(svg(cloud_with_an_outlier(0.0)), "rim"), 0U);
  EXPECT_NE(gnuplot_script({figure}, "rate").find("pointtype 11"), std::string::npos);
}

TEST(FigureTest, ALineAloneIsShownInFull) {
  Figure figure = cloud_with_an_outlier(600.0);
  figure.series[0].style = Series::Style::line;
  const FigureAxes axes = figure_axes(figure);
  EXPECT_FALSE(axes.clipped);
  EXPECT_GT(axes.y.to, 600.0);
}

} // namespace
} // namespace goingrate
