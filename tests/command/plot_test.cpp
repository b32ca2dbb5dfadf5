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
    EXPECT_TRUE(begins(stem.string() + ".csv", "series,x,y,low,high\n")) << stem;
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

} // namespace
