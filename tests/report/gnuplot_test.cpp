// Figures for print: the script contains everything to be drawn, no text can become a command, and
// gnuplot draws it.
#include "goingrate/report/gnuplot.hpp"

#include "goingrate/base/errors.hpp"

#include "support/nan.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include <gtest/gtest.h>

namespace goingrate {
namespace {

namespace fs = std::filesystem;

using test::nan;

std::size_t lines_with(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at)
    ++count;
  return count;
}

// One of every style.
Figure every_style() {
  return {"all",
          "All of them",
          "A caption.",
          {"time τ", "s"},
          {"rate × λ²", "µs"},
          {{Series::Style::line, "line", {0, 1, nan, 2, 3}, {1, 2, 3, nan, 1}},
           {Series::Style::points, "points", {0, 1, 2}, {1, 2, 1}, {}, {}, 1},
           {Series::Style::band, "band", {0, 1, 2}, {}, {0, 1, 0}, {1, 2, 1}, 2},
           {Series::Style::bars, "bars", {0, 1, 2}, {1, 1, 1}, {0.5, nan, 0.5}, {2, nan, 2}, 3}},
          {{1.5, "2"}, {99.0, "outside"}}};
}

Figure matrix() {
  return {"matrix",
          "A matrix",
          "",
          {"", "", false, {"1", "2"}},
          {"", "", false, {"a 1", "b 2"}},
          {{Series::Style::cells, "", {0, 1, 0, 1}, {0, 0, 1, 1}, {1.0, -0.5, -0.5, 1.0}}}};
}

Figure cloud(std::size_t count, bool logarithmic) {
  Figure figure{"cloud", "", "", {"x", "", logarithmic}, {"y", "", logarithmic}, {{}}};
  Series& series = figure.series.front();
  series.style = Series::Style::points;
  for (std::size_t i = 0; i < count; ++i) {
    series.x.push_back(1.0 + static_cast<double>(i));
    series.y.push_back(2.0 + std::sin(static_cast<double>(i * i)));
  }
  return figure;
}

bool is_whole_pdf(const std::string& text) {
  return text.starts_with("%PDF-") && text.find("%%EOF") != std::string::npos;
}

bool is_whole_png(const std::string& text) {
  return text.starts_with("\x89PNG\r\n") && text.find("IEND") != std::string::npos;
}

class GnuplotTest : public testing::Test {
protected:
  void SetUp() override {
    if (!gnuplot_is_installed()) GTEST_SKIP() << "no gnuplot here";
  }
};

TEST_F(GnuplotTest, EveryStyleIsDrawn) {
  const std::vector<std::vector<Figure>> cases{{every_style()},
                                               {matrix()},
                                               {cloud(5000, false)},
                                               {cloud(5000, true)},
                                               {{"none", "", "", {}, {}, {}}},
                                               {every_style(), cloud(200, true), matrix()}};
  for (const auto& figures : cases) {
    EXPECT_TRUE(is_whole_pdf(printed_figure(figures, PrintFormat::pdf, "f.pdf").value()))
        << figures.front().id;
    EXPECT_TRUE(is_whole_png(printed_figure(figures, PrintFormat::png, "f.png").value()))
        << figures.front().id;
  }
}

TEST_F(GnuplotTest, NoTextBecomesACommand) {
  const std::string trace =
      (std::filesystem::temp_directory_path() / "goingrate-gnuplot-trace").string();
  std::filesystem::remove(trace);
  const std::vector<std::string> texts{"'; system('touch " + trace + "'); '",
                                       "`touch " + trace + "`",
                                       "\n!touch " + trace + "\n",
                                       "$(touch " + trace + ")",
                                       "EOD\n!touch " + trace,
                                       "%s %n 100 %",
                                       "\\",
                                       "a_b^{c} {/=20 d}"};
  for (const std::string& evil : texts) {
    Figure figure = every_style();
    figure.title = figure.caption = figure.x.label = figure.y.unit = evil;
    figure.series[0].label = figure.markers[0].label = evil;
    Figure named = matrix();
    named.y.names = {evil, evil};
    EXPECT_TRUE(printed_figure({figure, named}, PrintFormat::png, "f.png")) << evil;
  }
  EXPECT_FALSE(std::filesystem::exists(trace));
}

TEST(GnuplotScriptTest, SaysAllThatIsToBeDrawn) {
  const std::string script = gnuplot_script({every_style()}, "it's");
  for (const char* part :
       {"set output 'it_s.pdf'", "set terminal pdfcairo", "set xlabel 'time τ (s)'",
        "set ylabel 'rate × λ² (µs)'", "with lines", "with points", "with filledcurves",
        "with vectors heads", "title 'band'", "set label '2'", "set arrow from first 1.5"})
    EXPECT_NE(script.find(part), std::string::npos) << part << '\n' << script;
  EXPECT_EQ(script.find("outside"), std::string::npos) << "a marker beyond the axis";
  EXPECT_EQ(script.find("nan"), std::string::npos) << script;
}

TEST(GnuplotScriptTest, PanelsOfOneGroupShareTheirAxis) {
  Figure upper = every_style(), lower = every_style(), other = every_style();
  upper.group = lower.group = "course";
  lower.series[0].x.back() = 30.0;
  const std::string script = gnuplot_script({upper, lower, other}, "stack");
  EXPECT_EQ(lines_with(script, "set xlabel 'time τ (s)'"), 2u)
      << "the upper leaves it to the lower";
  EXPECT_EQ(lines_with(script, "set xlabel ''"), 1u);
  EXPECT_EQ(lines_with(script, "set xrange [-0.3:30.3]"), 2u) << script.substr(0, 2000);
}

TEST(GnuplotScriptTest, NumbersThatWouldRunIntoEachOtherAreThinned) {
  Figure figure = every_style();
  figure.markers.clear();
  figure.series = {{Series::Style::line, "line", {-0.01, 0.01}, {1.0, 2.0}}};
  const std::string script = gnuplot_script({figure}, "f");
  EXPECT_NE(script.find("'0.000' 0 0"), std::string::npos) << script.substr(0, 1500);
  EXPECT_NE(script.find("'' 0.002 1, '0.004' 0.004 0"), std::string::npos)
      << "eleven numbers of five characters have no room in 8.5 cm";
}

TEST(GnuplotScriptTest, ALongSeriesStaysSmall) {
  EXPECT_LT(gnuplot_script({cloud(1'000'000, false)}, "long").size(), 120'000u);
}

TEST(GnuplotScriptTest, VectorsOfDifferentLengthsAreRefused) {
  Figure figure = every_style();
  figure.series[1].y.pop_back();
  EXPECT_THROW((void)gnuplot_script({figure}, "f"), ArgumentError);
}

TEST(GnuplotProcessTest, OneThatHangsIsGivenUp) {
  const fs::path folder =
      fs::temp_directory_path() / ("goingrate-hanging-" + std::to_string(::getpid()));
  fs::create_directory(folder);
  std::ofstream(folder / "gnuplot") << "#!/bin/sh\nexec sleep 60\n";
  fs::permissions(folder / "gnuplot", fs::perms::owner_all);
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", (folder.string() + ":" + path).c_str(), 1);
  const auto began = std::chrono::steady_clock::now();
  std::string said;
  try {
    printed_figure({every_style()}, PrintFormat::pdf, "f.pdf", std::chrono::seconds(1));
  } catch (const OutputError& error) {
    said = error.what();
  }
  ::setenv("PATH", path.c_str(), 1);
  fs::remove_all(folder);
  EXPECT_EQ(said, "cannot write f.pdf: gnuplot was given up after 1 s");
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(10));
}

} // namespace
} // namespace goingrate
