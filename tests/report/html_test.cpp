// The page: complete, self-contained, and without statements about unknown quantities.
#include "goingrate/report/json.hpp"
#include "goingrate/report/report.hpp"

#include "markup_checks.hpp"
#include "some_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace goingrate {
namespace {

using test::count_of;

using test::nan;
using test::some_report;
using test::swinging_beats;

// The page, checked for what must hold for every page.
std::string page_of(const Analysis& data) {
  std::string page = report_html(data);
  EXPECT_EQ(test::tag_fault(page), "");
  const std::string read = test::without_scripts(page);
  EXPECT_FALSE(test::has_word(read, "nan"));
  EXPECT_FALSE(test::has_word(read, "inf"));
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  return page;
}

// What the page holds for programs.
nlohmann::json json_in(const std::string& page) {
  const std::string begin = "<script type=\"application/json\" id=\"goingrate\">";
  const std::size_t at = page.find(begin);
  if (at == std::string::npos) return {};
  const std::size_t from = at + begin.size();
  return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

// The cells of the table row that begins with `heading`.
std::string row_of(const std::string& page, const std::string& heading) {
  const std::size_t at = page.find("<th scope=\"row\">" + heading + "</th>");
  if (at == std::string::npos) return {};
  return page.substr(at, page.find("</tr>", at) - at);
}

TEST(HtmlReportTest, ARateAndItsSigmaAreShownOnceWithWhatTheyCover) {
  const std::string page = test::without_scripts(page_of(some_report()));
  EXPECT_EQ(row_of(page, "rate"), "") << "the rate is one of the key figures";
  EXPECT_NE(page.find("± allows for how the rate varied on the way"), std::string::npos);
}

TEST(HtmlReportTest, TheQOfARingDownIsAKeyFigureWhereItIsDetermined) {
  Analysis data = some_report();
  EXPECT_EQ(page_of(data).find("<dt>Quality factor Q</dt>"), std::string::npos);
  data.fit.decay = Decay{0.046, {190.0, 2.0}, {600.0, 5.0}};
  EXPECT_NE(page_of(data).find("<dt>Quality factor Q</dt><dd><strong>190.0 ± 2.0</strong><br>at an "
                               "amplitude of 46 mrad"),
            std::string::npos);
  data.fit.decay->q = {nan, nan};
  EXPECT_EQ(page_of(data).find("<dt>Quality factor Q</dt>"), std::string::npos);
}

TEST(HtmlReportTest, HasEveryPartInItsPlace) {
  const std::string page = page_of(some_report());
  std::size_t at = 0;
  for (const char* part : {"<h1>Clock report: clock.csv",
                           "id=\"summary\"",
                           "<div class=\"says\">",
                           "id=\"key-figures\"",
                           "id=\"diary\"",
                           "id=\"figures\"",
                           "id=\"figure-rate\"",
                           "id=\"figure-amplitude\"",
                           "id=\"figure-time-residual\"",
                           "id=\"figure-amplitude-residual\"",
                           "id=\"figure-error\"",
                           "id=\"figure-rate-amplitude\"",
                           "id=\"figure-drive-history\"",
                           "id=\"figure-spectrum\"",
                           "id=\"figure-deviation\"",
                           "id=\"figure-correlation\"",
                           "id=\"figure-intervals\"",
                           "id=\"figure-profiles\"",
                           "id=\"fit\"",
                           "id=\"drive\"",
                           "id=\"stability\"",
                           "id=\"reading\""}) {
    const std::size_t next = page.find(part, at);
    ASSERT_NE(next, std::string::npos) << part;
    at = next;
  }
}

TEST(HtmlReportTest, AFreeSwingIsShownAsNoClock) {
  Analysis data = some_report();
  data.fit.model.escapement = Escapement::none;
  const std::string page = page_of(data);
  for (const char* part : {"id=\"figure-rate\"", "id=\"fit\"", "id=\"diary\""})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  for (const char* part : {"id=\"figure-error\"", "id=\"figure-deviation\"", "id=\"drive\"",
                           "#drive\"", "id=\"stability\"", "#stability\""})
    EXPECT_EQ(page.find(part), std::string::npos) << part;
}

TEST(HtmlReportTest, TheSquaredAmplitudesAreOnTheScaleThatWasFitted) {
  Analysis data = some_report();
  data.fit.decay.emplace();
  const auto widest = [&] {
    for (const Figure& figure : report_figures(data))
      if (figure.id == "period-amplitude") {
        const auto& squared = figure.series.front().x;
        return *std::max_element(squared.begin(), squared.end());
      }
    return 0.0;
  };
  const double as_logged = widest();
  ASSERT_GT(as_logged, 0.0);
  data.fit.parameters.push_back({"amplitude_scale", "", ParameterStatus::free, 0.5, 0.01});
  EXPECT_NEAR(widest() / as_logged, 4.0, 1e-12); // rounding
}

TEST(HtmlReportTest, NeedsNothingFromOutside) {
  // plotly.js names addresses, none of which it calls; page.js offers no button that would.
  const std::string page = test::without_scripts(page_of(some_report()));
  const std::string space = "xmlns=\"http://www.w3.org/2000/svg\"";
  EXPECT_EQ(count_of(page, "http://"), count_of(page, space));
  EXPECT_EQ(count_of(page, "https://"), 0U);
  EXPECT_EQ(count_of(page, "src="), 0U);
  EXPECT_EQ(count_of(page, "href="), count_of(page, "href=\"#"));
  EXPECT_EQ(count_of(page, "url("), 0U);
  EXPECT_EQ(count_of(page, "@import"), 0U);
}

TEST(HtmlReportTest, MayFetchNothingFromAnywhere) {
  const std::string html = page_of(some_report());
  const std::size_t policy = html.find("<meta http-equiv=\"Content-Security-Policy\"");
  ASSERT_NE(policy, std::string::npos);
  EXPECT_LT(policy, html.find("<style")) << "it holds for what comes after it";
  const std::string words = html.substr(policy, html.find('>', policy) - policy);
  EXPECT_NE(words.find("default-src 'none';"), std::string::npos) << words;
  EXPECT_EQ(words.find("http:"), std::string::npos) << words;
}

TEST(HtmlReportTest, ParametersTheLogDoesNotTellHaveNoFigure) {
  Analysis data = some_report();
  const std::string shown = page_of(data);
  const std::size_t at = shown.find("id=\"figure-correlation\"");
  const std::string matrix = shown.substr(at, shown.find("</svg>", at) - at);
  EXPECT_NE(matrix.find(">T0 1<"), std::string::npos) << matrix;
  EXPECT_NE(matrix.find(">−0.40<"), std::string::npos);
  EXPECT_EQ(matrix.find(">μ"), std::string::npos);
  data.fit.parameters.resize(0);
  data.fit.correlated.resize(1);
  const std::string bare = page_of(data);
  EXPECT_EQ(bare.find("figure-correlation"), std::string::npos);
  EXPECT_EQ(bare.find("figure-intervals"), std::string::npos);
}

TEST(HtmlReportTest, EveryLinkHasItsAnchor) {
  const std::string page = page_of(some_report());
  for (std::size_t at = page.find("href=\"#"); at != std::string::npos;
       at = page.find("href=\"#", at + 1)) {
    const std::string id = page.substr(at + 7, page.find('"', at + 7) - at - 7);
    EXPECT_EQ(count_of(page, "id=\"" + id + "\""), 1U) << id;
  }
}

TEST(HtmlReportTest, EscapesWhatComesFromTheLog) {
  Analysis data = some_report();
  data.log.source = "<b>&\"";
  data.log.assumptions = {{"<script>alert(1)</script>"}};
  data.log.issues = {{3, 1, IssueKind::unreadable, "<i>\x02\xc3", "left & out", 3}};
  const std::string page = page_of(data);
  EXPECT_NE(page.find("<h1>Clock report: &lt;b&gt;&amp;&quot;</h1>"), std::string::npos);
  EXPECT_EQ(count_of(page, "<script>alert"), 0U);
  EXPECT_EQ(count_of(page, "alert(1)</script>"), 0U);
  const nlohmann::json held = json_in(page);
  EXPECT_EQ(held["rate"]["assumptions"][0], "<script>alert(1)</script>");
  EXPECT_EQ(held["rate"]["source"], "<b>&\"");
  EXPECT_NE(page.find("&lt;i&gt;\xEF\xBF\xBD\xEF\xBF\xBD</td>"), std::string::npos);
}

TEST(HtmlReportTest, AnUndeterminedParameterShowsTheWordAndNoNumber) {
  const std::string page = page_of(some_report());
  const std::string row = row_of(page, "μ (mu)");
  EXPECT_NE(row.find("undetermined"), std::string::npos);
  EXPECT_EQ(row.find('7'), std::string::npos) << row;
  EXPECT_EQ(test::without_scripts(page).find("0.777"), std::string::npos)
      << "its correlation is that of its prior";
  EXPECT_EQ(row_of(page, "fast gain"), "");
}

TEST(HtmlReportTest, ParametersComeWithTheirUncertaintyAndStatus) {
  const std::string page = page_of(some_report());
  EXPECT_NE(row_of(page, "T0").find("2.99990 ± 0.00010"), std::string::npos) << row_of(page, "T0");
  EXPECT_NE(row_of(page, "ε (epsilon)").find("(8.00 ± 0.10)×10⁻⁵"), std::string::npos);
  EXPECT_NE(row_of(page, "φ0 (phi0)").find("held fixed"), std::string::npos);
  EXPECT_NE(row_of(page, "decay time").find("6000 ± 30"), std::string::npos);
}

TEST(HtmlReportTest, AFitThatFailedHasNoNumbers) {
  Analysis data = some_report();
  data.fit.status = FitStatus::no_valid_model;
  data.fit.termination = "no valid start";
  const std::string page = page_of(data);
  EXPECT_NE(page.find("no values to report"), std::string::npos);
  EXPECT_NE(page.find("no valid start"), std::string::npos);
  EXPECT_EQ(row_of(page, "T0"), "");
  EXPECT_EQ(row_of(page, "decay time"), "");
  EXPECT_EQ(page.find("figure-time-residual"), std::string::npos);
  EXPECT_EQ(page.find(">model</text>"), std::string::npos);
}

TEST(HtmlReportTest, WithoutAmplitudesHasNoFigureOfThem) {
  const std::string page = page_of(some_report(500, false));
  EXPECT_EQ(page.find("figure-amplitude"), std::string::npos);
  EXPECT_EQ(page.find("Amplitude at the start"), std::string::npos);
}

TEST(HtmlReportTest, AShortLogWithNothingFoundOutIsStillAPage) {
  Analysis data;
  data.log.source = "short.txt";
  data.beats = swinging_beats(3, false);
  data.rate = summarise_rates(data.beats, 3.0);
  data.fit.status = FitStatus::no_valid_model;
  const std::string page = page_of(data);
  EXPECT_NE(page.find("No sudden change"), std::string::npos);
  EXPECT_NE(page.find("The log is too short for it."), std::string::npos);
}

TEST(HtmlReportTest, ShowsTheFirstTwentyFaultyLinesAndCountsTheRest) {
  Analysis data = some_report();
  for (std::size_t i = 0; i < 33; ++i)
    data.log.issues.push_back({i + 1, 0, IssueKind::unreadable, "FAULT", "left out", i + 1});
  const std::string page = page_of(data);
  EXPECT_EQ(count_of(page, ">FAULT<"), 20U);
  EXPECT_NE(page.find("… and 13 more."), std::string::npos);
}

TEST(HtmlReportTest, CutsAFaultyLineThatIsVeryLong) {
  Analysis data = some_report();
  data.log.issues = {{1, 1, IssueKind::unreadable, std::string(1'000'000, 'x'), "left out", 1}};
  EXPECT_LT(test::without_scripts(page_of(data)).size(), 500'000U);
}

TEST(HtmlReportTest, ListsTheGapsThatWereLeftOpen) {
  Analysis data = some_report();
  data.numbered.gaps = {{50, 1, 1.0, true}, {777, 412, 0.61, false}};
  const std::string page = page_of(data);
  EXPECT_NE(row_of(page, "777").find("412"), std::string::npos);
  EXPECT_EQ(row_of(page, "50"), "");
}

TEST(HtmlReportTest, WritesAnUpperLimitAsOne) {
  const std::string page = page_of(some_report());
  EXPECT_NE(row_of(page, "slow drive, rms").find("at most 0.4 %"), std::string::npos);
  EXPECT_NE(row_of(page, "jitter of the sensor").find("not known"), std::string::npos);
}

TEST(HtmlReportTest, ReadsOnAPhoneInTheDarkAndOnPaper) {
  const std::string page = page_of(some_report());
  EXPECT_NE(page.find("<html lang=\"en\">"), std::string::npos);
  EXPECT_NE(page.find("name=\"viewport\""), std::string::npos);
  EXPECT_NE(page.find("prefers-color-scheme:dark"), std::string::npos);
  EXPECT_NE(page.find("@media print"), std::string::npos);
  EXPECT_EQ(count_of(page, "<table>"),
            count_of(page, "class=\"scroll\" role=\"region\" tabindex=\"0\""));
}

TEST(HtmlReportTest, HoldsTheResultForPrograms) {
  const Analysis data = some_report();
  const std::string page = page_of(data);
  EXPECT_EQ(json_in(page), nlohmann::json::parse(report_json(data)));
  EXPECT_EQ(json_in(page)["summary"].size(), report_sentences(data).size());
  for (const std::string& sentence : report_sentences(data))
    EXPECT_NE(page.find(sentence), std::string::npos) << sentence;
}

TEST(HtmlReportTest, NamesTheFileAndNotItsFolder) {
  Analysis data = some_report();
  data.log.source = "/home/somebody/clock.csv";
  const std::string page = page_of(data);
  EXPECT_NE(page.find("<h1>Clock report: clock.csv</h1>"), std::string::npos);
  EXPECT_EQ(test::without_scripts(page).find("somebody"), std::string::npos);
}

TEST(HtmlReportTest, ACellOnANarrowScreenNamesItsColumn) {
  const std::string page = page_of(some_report());
  EXPECT_NE(row_of(page, "ε (epsilon)").find("data-label=\"value ± σ\">(8.00"), std::string::npos)
      << row_of(page, "ε (epsilon)");
  for (const char* format : {"svg", "png", "csv"})
    EXPECT_GT(count_of(page, "data-format=\"" + std::string(format) + "\""), 0U) << format;
}

TEST(HtmlReportTest, AMonthOfBeats) {
  const std::string page = page_of(some_report(900'000));
  EXPECT_LT(page.size(), 5'000'000U);
  EXPECT_LT(test::without_scripts(page).size(), 600'000U);
  EXPECT_LT(test::without_scripts(page_of(some_report(28'800))).size(), 500'000U);
}

TEST(HtmlReportTest, RatesOfSinglePeriodsHaveTheUnitThatFitsThem) {
  const auto rates_of = [](double jitter_s) {
    Analysis data = some_report();
    for (std::size_t i = 0; i < data.beats.size(); i += 2)
      data.beats[i].time = data.beats[i].time + jitter_s;
    data.rate = summarise_rates(data.beats, 3.0);
    data.rate.rate_excess = 1e-6; // of the log: 86 ms/day
    data.stretches.clear();
    return report_figures(data).front();
  };
  const Figure quiet = rates_of(0.0), noisy = rates_of(1e-3);
  EXPECT_EQ(quiet.y.unit, "ms/day");
  EXPECT_EQ(noisy.y.unit, "s/day");
  // 1 ms from one period of 3 s to the next; the beats' own scatter is a hundredth of it.
  EXPECT_NEAR(std::abs(noisy.series.front().y[10]), 1e-3 / 3.0 * 86400.0, 2.0);
}

TEST(HtmlReportTest, AProfileGoesThroughThePointsThatWereFitted) {
  Analysis data = some_report();
  data.fit.parameters = {{"T0", "s", ParameterStatus::free, 2.0, 0.1},
                         {"mu", "", ParameterStatus::free, 1.0, 0.1},
                         {"phi0", "rad", ParameterStatus::fixed, 0.03, nan}};
  data.fit.parameters[0].profile = {
      {1.8, 3.8415}, {1.9, 1.0}, {2.0, 0.0}, {2.2, 1.0}, {2.5, 3.8415}};
  data.fit.parameters[1].profile = {{0.9, 1.0}, {1.0, 0.0}, {1.1, 1.0}};
  const auto figures = report_figures(data);
  const auto figure = std::find_if(figures.begin(), figures.end(),
                                   [](const Figure& f) { return f.id == "profiles"; });
  ASSERT_NE(figure, figures.end());
  ASSERT_EQ(figure->series.size(), 2u) << "the fixed one has none";
  const auto fall_at = [&](std::size_t series, double z) {
    const Series& curve = figure->series[series];
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      if (std::abs(curve.x[i] - z) < 1e-9) return curve.y[i];
    return nan;
  };
  EXPECT_NEAR(fall_at(0, -2.0), 3.8415, 1e-12); // rounding, here and below
  EXPECT_NEAR(fall_at(0, -1.0), 1.0, 1e-12);
  EXPECT_NEAR(fall_at(0, 0.0), 0.0, 1e-12);
  EXPECT_NEAR(fall_at(0, 1.0), 0.25, 1e-12) << "halfway to an end at two sigma";
  EXPECT_NEAR(fall_at(0, 2.0), 1.0, 1e-12);
  EXPECT_NEAR(fall_at(0, 5.0), 3.8415, 1e-12);
  EXPECT_NEAR(figure->series[1].x.front(), -1.0, 1e-12) << "nothing beyond the points";
  EXPECT_NEAR(figure->series[1].x.back(), 1.0, 1e-12);
}

} // namespace
} // namespace goingrate
