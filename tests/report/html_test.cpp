// The page: complete, self-contained, and silent about what is not known.
#include "goingrate/report/report.hpp"

#include "markup_checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace goingrate {
namespace {

using test::count_of;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<Beat> swinging_beats(std::size_t count, bool with_amplitude) {
  std::vector<Beat> beats;
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<double>(i);
    const double late = 1e-5 * std::sin(1e4 * n) - 3e-5 * n; // scatter, and gaining
    beats.push_back({Instant{1364774403, 0.25} + (3.0 * n + late), static_cast<std::int64_t>(i),
                     with_amplitude ? 0.046 + 1e-4 * std::sin(n / 500.0) : nan,
                     static_cast<std::uint32_t>(i + 1), 0, BeatFlag::good});
  }
  return beats;
}

FitSummary some_fit(const std::vector<Beat>& beats, bool with_amplitude) {
  FitSummary fit;
  fit.chosen_by = "asked for";
  fit.parameters = {
      {"T0", "s", ParameterStatus::free, 2.9999, 0.0001, 2.9998, 3.0, 2.9997, 3.0001},
      {"epsilon", "", ParameterStatus::prior, 8e-5, 1e-6, 7.9e-5, 8.1e-5, 7.8e-5, 8.2e-5},
      {"mu", "", ParameterStatus::undetermined, 7.77e-6, 7.77e-6, 7.77},
      {"phi0", "rad", ParameterStatus::fixed, 0.03, nan, nan}};
  for (FittedParameter& p : fit.parameters)
    if (std::isfinite(p.low95))
      p.profile = {
          {p.low95, 4.0}, {p.low68, 1.0}, {p.value, 0.0}, {p.high68, 1.0}, {p.high95, 4.0}};
  fit.correlated = {"T0", "epsilon", "mu"};
  fit.correlation = {{1.0, -0.4, 0.777}, {-0.4, 1.0, 0.05}, {0.777, 0.05, 1.0}};
  fit.combinations = {{"decay time", "T0/(2 pi epsilon)", "s", 6000.0, 30.0},
                      {"fast gain", "2 mu/(pi lambda)", "", nan, nan}};
  fit.q_factor = {"Q", "1/(2 epsilon)", "", 6250.0, 80.0};
  fit.rate_s_per_day = {"rate", "T0/mean period - 1", "s/day", 0.86, 0.02};
  fit.quality = {100.0, 98.0, 0.4, false, 0.5, 1e-5, with_amplitude ? 1e-5 : nan, 10.0, 12.0};
  fit.alternatives = {{"averaged1, constant-torque", 12.0, "chosen"}};
  fit.residual_s.assign(beats.size(), 1e-6);
  fit.model_amplitude_rad.assign(beats.size(), 0.046);
  if (with_amplitude) fit.amplitude_residual_rad.assign(beats.size(), 1e-5);
  return fit;
}

Analysis some_report(std::size_t count = 500, bool with_amplitude = true) {
  Analysis data;
  data.log.source = "clock.csv";
  data.log.has_amplitude = with_amplitude;
  data.log.assumptions = {{"times are seconds"}};
  data.beats = swinging_beats(count, with_amplitude);
  data.numbered.beats = data.beats;
  data.rate = summarise_rates(data.beats, 3.0);
  data.fit = some_fit(data.beats, with_amplitude);
  data.diary.changes = {{100, 300.0, -2e-5, with_amplitude ? -1e-6 : nan, 20.0},
                        {200, 600.0, 2e-5, with_amplitude ? 1e-6 : nan, 18.0}};
  Interruption stop{data.diary.changes[0], data.diary.changes[1], 0.046, 0.044, -2e-5, {}, {}};
  stop.decay = Relaxation{6000.0, 40.0, 300.0, 0.0, 1e-5, true, nan, nan};
  stop.recovery = Relaxation{3100.0, 50.0, 900.0, 0.046, 1e-5, false, 3050.0, 3200.0};
  data.diary.interruptions = {stop};
  data.drive.rate_spectrum =
      Spectrum{{0.0, 0.001, 0.002, 0.01, 0.1}, {1, 2e-9, 1e-9, 3e-10, 1e-9}, 0.001, 2.0, 1, 0, 8};
  data.drive.response = DriveResponse{3e-4, -1e-4, 0.003};
  DriveSplit split;
  split.split_hz = 0.003;
  split.fast = {0.01, 0.009, 0.011};
  split.slow = {0.002, 0.0, 0.004};
  split.jitter_s = {nan, nan, nan};
  split.slow_time_s = nan;
  split.costs = {{86400.0, {0.1, 0.09, 0.11}, {0.0, 0.0, 0.2}},
                 {7.0 * 86400.0, {0.3, 0.27, 0.33}, {0.0, 0.0, 1.2}}};
  split.jitter_density = {1e-20, 1e-15, 1e-14, 1e-12, 1e-9};
  split.fast_density = {1e-10, 1e-10, 1e-10, 1e-10, 1e-10};
  split.slow_density = std::vector<double>(5, 0.0);
  data.drive.split = split;
  DriveHistory history;
  for (int i = 0; i < 20; ++i)
    history.points.push_back({75.0 * i, 1.0 + 0.001 * i, 0.002});
  history.from_rate = true;
  data.history = history;
  data.drive.lines = {{0.0167, 1e-5, 1e-6, 0.0, 50.0, 1e-9}};
  data.deviation = {DeviationKind::oadev,
                    3.0,
                    {{3.0, 1, 498, 5e-6, 4.8e-6, 5.2e-6, 2, true},
                     {6.0, 2, 496, 2e-6, nan, nan, 0, false},
                     {300.0, 100, 0, nan, nan, nan, 0, false}}};
  return data;
}

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

// The cells of the table row that begins with `heading`.
std::string row_of(const std::string& page, const std::string& heading) {
  const std::size_t at = page.find("<th scope=\"row\">" + heading + "</th>");
  if (at == std::string::npos) return {};
  return page.substr(at, page.find("</tr>", at) - at);
}

TEST(HtmlReportTest, TheWeeksCostIsNamedWhereItIsKnown) {
  Analysis data = some_report();
  EXPECT_NE(page_of(data).find("What they cost in a week: 0.3 s and at most 1.2 s"),
            std::string::npos);
  data.drive.split->costs.resize(1); // of a day
  EXPECT_EQ(page_of(data).find("What they cost in a week"), std::string::npos);
}

TEST(HtmlReportTest, HasEveryPartInItsPlace) {
  const std::string page = page_of(some_report());
  std::size_t at = 0;
  for (const char* part : {"<h1>The going of clock.csv",
                           "id=\"summary\"",
                           "<pre",
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
  EXPECT_EQ(matrix.find(">mu"), std::string::npos);
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
  EXPECT_NE(page.find("<h1>The going of &lt;b&gt;&amp;&quot;</h1>"), std::string::npos);
  EXPECT_EQ(count_of(page, "<script>alert"), 0U);
  EXPECT_NE(page.find("&lt;i&gt;\xEF\xBF\xBD\xEF\xBF\xBD</td>"), std::string::npos);
}

TEST(HtmlReportTest, AnUndeterminedParameterShowsTheWordAndNoNumber) {
  const std::string page = page_of(some_report());
  const std::string row = row_of(page, "mu");
  EXPECT_NE(row.find("undetermined"), std::string::npos);
  EXPECT_EQ(row.find('7'), std::string::npos) << row;
  EXPECT_EQ(test::without_scripts(page).find("0.777"), std::string::npos)
      << "its correlation is that of its prior";
  EXPECT_EQ(row_of(page, "fast gain"), "");
}

TEST(HtmlReportTest, ParametersComeWithTheirUncertaintyAndStatus) {
  const std::string page = page_of(some_report());
  EXPECT_NE(row_of(page, "T0").find("2.99990 ± 0.00010"), std::string::npos) << row_of(page, "T0");
  EXPECT_NE(row_of(page, "epsilon").find("(8.00 ± 0.10)×10⁻⁵"), std::string::npos);
  EXPECT_NE(row_of(page, "phi0").find("held fixed"), std::string::npos);
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

TEST(HtmlReportTest, AMonthOfBeats) {
  const std::string page = page_of(some_report(900'000));
  EXPECT_LT(page.size(), 4'000'000U);
  EXPECT_LT(test::without_scripts(page).size(), 600'000U);
  EXPECT_LT(test::without_scripts(page_of(some_report(28'800))).size(), 500'000U);
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
  EXPECT_NEAR(fall_at(0, -2.0), 3.8415, 1e-4);
  EXPECT_NEAR(fall_at(0, -1.0), 1.0, 1e-9);
  EXPECT_NEAR(fall_at(0, 0.0), 0.0, 1e-9);
  EXPECT_NEAR(fall_at(0, 1.0), 0.25, 1e-9) << "halfway to an end at two sigma";
  EXPECT_NEAR(fall_at(0, 2.0), 1.0, 1e-9);
  EXPECT_NEAR(fall_at(0, 5.0), 3.8415, 1e-4);
  EXPECT_NEAR(figure->series[1].x.front(), -1.0, 1e-9) << "nothing beyond the points";
  EXPECT_NEAR(figure->series[1].x.back(), 1.0, 1e-9);
}

} // namespace
} // namespace goingrate
