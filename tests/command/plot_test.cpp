// Figures as files: every format, what is missing, what fails.
#include "support/command_fixture.hpp"

#include "goingrate/report/gnuplot.hpp"

namespace {

using namespace goingrate::test;
namespace fs = std::filesystem;

class PlotTest : public CommandTest {
protected:
  void SetUp() override {
    CommandTest::SetUp();
    log_ = (source / "data/logs/jump.csv").string();
  }
  // A gnuplot that complains and fails.
  [[nodiscard]] std::string with_broken_gnuplot() const {
    fs::create_directory(folder_ / "bin");
    put("bin/gnuplot", "#!/bin/sh\necho 'no such font' >&2\nexit 3\n");
    fs::permissions(folder_ / "bin/gnuplot", fs::perms::owner_all);
    return "PATH=\"$PWD/bin:$PATH\"";
  }
  [[nodiscard]] bool begins(const fs::path& file, std::string_view magic) const {
    return content(folder_ / file).starts_with(magic);
  }

  std::string log_;
};

constexpr const char* without_gnuplot = "PATH=/nonexistent";

TEST_F(PlotTest, EveryFigureOfAReportIsDrawnInEveryFormat) {
  if (!goingrate::gnuplot_is_installed()) GTEST_SKIP() << "no gnuplot here";
  const Outcome outcome = run("report " + log_ + " -o r.html --figures f");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::size_t figures = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "f")) {
    if (entry.path().extension() != ".svg") continue;
    ++figures;
    const fs::path stem = fs::path("f") / entry.path().stem();
    EXPECT_TRUE(begins(stem.string() + ".svg", "<svg")) << stem;
    EXPECT_TRUE(begins(stem.string() + ".pdf", "%PDF-")) << stem;
    EXPECT_TRUE(begins(stem.string() + ".png", "\x89PNG\r\n")) << stem;
    EXPECT_TRUE(begins(stem.string() + ".gp", "# ")) << stem;
    EXPECT_TRUE(begins(stem.string() + ".csv", "series,\"")) << stem;
  }
  EXPECT_GE(figures, 7u);
  // The script is whole: gnuplot draws it where it lies.
  fs::remove(folder_ / "f/rate.pdf");
  EXPECT_EQ(std::system(fmt::format("cd '{}/f' && gnuplot rate.gp", folder_.string()).c_str()), 0);
  EXPECT_TRUE(begins("f/rate.pdf", "%PDF-"));
}

TEST_F(PlotTest, WithoutGnuplotTheRestIsWrittenAndOneNoteSaysSo) {
  const Outcome outcome = run("report " + log_ + " -o r.html --figures f", without_gnuplot);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(begins("f/rate.svg", "<svg"));
  EXPECT_TRUE(begins("f/rate.gp", "# "));
  EXPECT_TRUE(begins("f/rate.csv", "series"));
  EXPECT_FALSE(fs::exists(folder_ / "f/rate.pdf"));
  EXPECT_FALSE(fs::exists(folder_ / "f/rate.png"));
  const std::size_t note = outcome.err.find("gnuplot-nox");
  ASSERT_NE(note, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("gnuplot-nox", note + 1), std::string::npos) << "said once";
}

TEST_F(PlotTest, AGnuplotThatFailsIsExitFiveWithItsMessage) {
  put("r.html", "precious");
  const Outcome outcome = run("report " + log_ + " -o r.html --figures f", with_broken_gnuplot());
  EXPECT_EQ(outcome.code, 5);
  EXPECT_NE(outcome.err.find("no such font"), std::string::npos) << outcome.err;
  EXPECT_EQ(content(folder_ / "r.html"), "precious");
  EXPECT_FALSE(fs::exists(folder_ / "f/rate.svg")) << "all or none";
}

struct Case {
  const char* name;
  std::string arguments;
};

std::vector<Case> every_command(const std::string& log) {
  return {
      {"rate", "rate " + log + " -o out.csv"},
      {"fit", "fit " + log + " --fix T0=2 --event 150:mu --model averaged1 --noise jitter"},
      {"spectrum", "spectrum " + log + " --fix T0=2 --event 150:mu"},
      {"stability", "stability " + log},
      {"stability mdev", "stability " + log + " --kind mdev"},
      {"simulate", "simulate " + (source / "data/scenarios/jump.toml").string() + " -o log.csv"},
      {"report", "report " + log + " -o r.html"},
      {"map", "map --points 9"},
      {"chart", "chart --periods 200 --repetitions 1"}};
}

TEST_F(PlotTest, EveryCommandDrawsItsFigure) {
  const bool prints = goingrate::gnuplot_is_installed();
  for (const Case& command : every_command(log_)) {
    for (const auto& [file, magic] : {std::pair{"p.svg", "<svg"},
                                      {"p.gp", "# "},
                                      {"p.pdf", "%PDF-"},
                                      {"p.PNG", "\x89PNG\r\n"}}) {
      const bool printed =
          fs::path(file).extension() != ".svg" && fs::path(file).extension() != ".gp";
      if (printed && !prints) continue;
      // The rest of a command's work is the same for every format.
      if (printed && std::string(command.name) == "chart") continue;
      const Outcome outcome = run(command.arguments + " --plot " + file);
      EXPECT_EQ(outcome.code, 0) << command.name << ' ' << file << outcome.err;
      EXPECT_TRUE(begins(file, magic)) << command.name << ' ' << file;
      fs::remove(folder_ / file);
    }
  }
}

TEST_F(PlotTest, AnotherExtensionIsWrongUsage) {
  for (const Case& command : every_command(log_)) {
    const Outcome outcome = run(command.arguments + " --plot figure.jpg");
    EXPECT_EQ(outcome.code, 2) << command.name;
    for (const char* known : {".svg", ".pdf", ".png", ".gp"})
      EXPECT_NE(outcome.err.find(known), std::string::npos) << command.name << outcome.err;
  }
}

TEST_F(PlotTest, WhatHasNoFigureIsWrongUsage) {
  EXPECT_EQ(run("chart --limits --plot p.svg").code, 2);
  EXPECT_EQ(run("rate - --follow --plot p.svg < /dev/null").code, 2);
  EXPECT_EQ(run("simulate " + scenario("jump") + " -o l.csv --realisations 3 --plot p.svg").code,
            2);
}

TEST_F(PlotTest, WithoutGnuplotAPrintedFigureIsRefusedBeforeTheWork) {
  put("p.pdf", "precious");
  const Outcome outcome = run("rate no-such.log --plot p.pdf", without_gnuplot);
  EXPECT_EQ(outcome.code, 5) << "the log is not even looked for";
  EXPECT_NE(outcome.err.find("gnuplot-nox"), std::string::npos) << outcome.err;
  EXPECT_EQ(content(folder_ / "p.pdf"), "precious");
  EXPECT_EQ(run("rate " + log_ + " -o out.csv --plot p.svg", without_gnuplot).code, 0);
}

TEST_F(PlotTest, AStackHoldsEveryFigure) {
  ASSERT_EQ(run("report " + log_ + " -o r.html --plot p.svg").code, 0);
  const std::string stack = content(folder_ / "p.svg");
  for (const char* id :
       {"figure-rate\"", "figure-time-residual\"", "figure-spectrum\"", "figure-deviation\""})
    EXPECT_NE(stack.find(id), std::string::npos) << id;
  ASSERT_EQ(run("simulate " + scenario("jump") + " -o l.csv --plot p.svg").code, 0);
  const std::string course = content(folder_ / "p.svg");
  EXPECT_NE(course.find("figure-amplitude\""), std::string::npos);
  EXPECT_NE(course.find("class=\"marker\""), std::string::npos) << "the jump";
}

} // namespace
