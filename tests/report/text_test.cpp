#include "goingrate/report/tables.hpp"

#include "report/figure_axes.hpp"
#include "report/parameter_words.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <set>
#include <sstream>
#include <string>

namespace goingrate {
namespace {

TEST(TextTest, AValueIsRoundedToTwoDigitsOfItsSigma) {
  EXPECT_EQ(with_sigma(2.00031234, 0.000123), "2.00031 ± 0.00012");
  EXPECT_EQ(with_sigma(1273.262, 13.4), "1273 ± 13");
  EXPECT_EQ(with_sigma(-0.5, 0.25), "-0.50 ± 0.25");
  EXPECT_EQ(with_sigma(2.49995e-4, 2.1e-8), "(2.49995 ± 0.00021)×10⁻⁴");
  EXPECT_EQ(with_sigma(0.0, 3e-9), "(0.0 ± 3.0)×10⁻⁹");
}

TEST(TextTest, WithoutASigmaThereIsNone) {
  EXPECT_EQ(with_sigma(1.5, 0.0), "1.5");
  EXPECT_EQ(with_sigma(1.5, NAN), "1.5");
  EXPECT_EQ(with_sigma(-2.5e-7, NAN, 2), "-2.5×10⁻⁷");
  EXPECT_EQ(with_sigma(2997.0, NAN, 3), "2997");
  EXPECT_EQ(with_sigma(0.0, NAN, 3), "0");
}

TEST(TextTest, SymbolsAndNumbersAsInPrint) {
  EXPECT_EQ(in_symbols("mu@1 moves by 4.2e+02 sigma"), "μ@1 moves by 420 σ");
  EXPECT_EQ(in_symbols("phi0 1.06e-06, T0/(2 pi epsilon)"), "φ0 1.06×10⁻⁶, T0/(2 π ε)");
  EXPECT_EQ(in_symbols("averaged2, 16,700: 0.5."), "averaged2, 16,700: 0.5.");
  // What is typed into a command stays.
  EXPECT_EQ(in_symbols("lambda0 (--prior lambda0=VALUE+-SIGMA)"),
            "λ0 (--prior lambda0=VALUE+-SIGMA)");
}

TEST(TextTest, NoDigitsBeyondThoseOfADouble) {
  EXPECT_EQ(with_sigma(46.0000000000000142, 3e-15), "46");
  EXPECT_EQ(with_sigma(46.0, 1e-12), "46.0000000000000 ± 0.0000000000010");
}

Decay some_decay(double widest_rad) {
  Decay decay{0.5 * widest_rad, {600.0, 5.0}, {190.0, 2.0}, {}, {}};
  decay.q_at_amplitude = {{0.1 * widest_rad, {700.0, 5.0}}, {widest_rad, {500.0, 5.0}}};
  decay.laws.resize(2);
  decay.laws[0].friction = "linear";
  decay.laws[1].friction = "quadratic";
  return decay;
}

TEST(TextTest, QThatDiffersBetweenIsTold) {
  Decay decay = some_decay(0.3);
  decay.q_at_amplitude = {{0.002, {247.0, 2.5}}, {0.1, {250.0, 0.03}}, {0.3, {249.2, 0.06}}};
  const std::string text = decay_text(decay);
  EXPECT_NE(text.find("from 249.200 ± 0.060 at 300 mrad to 250.000 ± 0.030 at 100 mrad"),
            std::string::npos)
      << text;
}

TEST(TextTest, ADecayHasOneUnitOfAngle) {
  const std::string narrow = decay_text(some_decay(0.2)), wide = decay_text(some_decay(0.7));
  EXPECT_NE(narrow.find("from 500.0 ± 5.0 at 200 mrad to 700.0 ± 5.0 at 20 mrad"),
            std::string::npos)
      << narrow;
  EXPECT_EQ(narrow.find(" rad"), std::string::npos) << narrow;
  EXPECT_EQ(wide.find("mrad"), std::string::npos) << wide;
}

TEST(TextTest, AQThatDoesNotChangeIsSaidNotTo) {
  Decay decay = some_decay(0.2);
  decay.q_at_amplitude.front().q.value = decay.q_at_amplitude.back().q.value + 3.0; // 0.4 sigma
  EXPECT_NE(decay_sentences(decay).find("Q is the same for wide and small swings"),
            std::string::npos)
      << decay_sentences(decay);
}

// Values may agree because they are vague.
TEST(TextTest, AQThatMayChangeIsNotSaidToBeTheSame) {
  const auto says = [](const Decay& decay, const char* words) {
    EXPECT_NE(decay_sentences(decay).find(words), std::string::npos) << decay_sentences(decay);
  };
  Decay decay = some_decay(0.4);
  decay.q_at_amplitude = {{0.187, {1035.0, 327.0}}, {0.385, {687.0, 52.0}}};
  says(decay, "Whether Q changes with the swing this log leaves open: it is 687 ± 52 at 385 mrad "
              "and 1035 ± 327 at 187 mrad.");
  decay.laws[0].behind = 318.0; // the linear law is excluded
  says(decay, "How much Q changes with the swing this log leaves open");
  decay.q_at_amplitude = {{0.187, {690.0, 5.0}}, {0.385, {687.0, 5.0}}};
  says(decay, "How much Q changes with the swing this log leaves open");
  decay.q_at_amplitude = {{0.1, {NAN, NAN}}, {0.385, {687.0, 5.0}}};
  says(decay, "This log leaves open what Q is at other amplitudes.");
}

TEST(TextTest, ScattersAndSharesAreShownInUnitsOfTheirSize) {
  FitSummary fit;
  fit.parameters = {
      {"jitter_rms", "s", ParameterStatus::free, 2e-5, 1e-6, 1.9e-5, 2.1e-5, 1.8e-5, 2.2e-5},
      {"drive_rms", "", ParameterStatus::free, 0.05, 0.01, 0.04, 0.06, 0.03, 0.07}};
  fit.alternatives = {{"averaged1", 1.0, "lambda0 moves by 46 sigma"}};
  const std::string text = fit_text(fit);
  for (const char* words : {"20.0 ± 1.0 µs", "5.0 ± 1.0 %", "λ0 moves by 46 σ"})
    EXPECT_NE(text.find(words), std::string::npos) << words << " is not in\n" << text;
}

TEST(TextTest, AFitHasOneUnitOfAngle) {
  FitSummary fit;
  fit.parameters = {
      {"phi0", "rad", ParameterStatus::fixed, 0.03, NAN, NAN, NAN, NAN, NAN},
      {"lambda0", "rad", ParameterStatus::free, 0.04, 1e-5, 0.03999, 0.04001, 0.03998, 0.04002}};
  fit.combinations = {
      {"stationary amplitude", "where drive and friction balance", "rad", 0.045, 1e-5}};
  fit.quality.amplitude_rms_rad = 1e-5;
  fit.model_amplitude_rad = {0.04, 0.045};
  const std::string narrow = fit_text(fit);
  for (const char* words : {"30 mrad (fixed)", "40.000 ± 0.010 mrad", "45.000 ± 0.010 mrad",
                            "amplitude residual rms 10 µrad"})
    EXPECT_NE(narrow.find(words), std::string::npos) << words << " is not in\n" << narrow;
  EXPECT_EQ(narrow.find(" rad"), std::string::npos) << narrow;
  fit.model_amplitude_rad = {0.7};
  EXPECT_EQ(fit_text(fit).find("mrad"), std::string::npos);
}

TEST(TextTest, AFreeSwingHasItsQInTheUnitOfItsAngles) {
  FitSummary fit;
  fit.decay = some_decay(0.2);
  fit.q_factor = {"Q", "at 0.1 rad, whichever law of friction", "", 190.0, 2.0};
  const std::string text = fit_text(fit);
  EXPECT_NE(text.find("at 100 mrad, whichever law of friction"), std::string::npos) << text;
  EXPECT_EQ(text.find(" rad"), std::string::npos) << text;
}

TEST(TextTest, TheOddsOfALawAreInWords) {
  Decay decay = some_decay(0.2);
  decay.laws[1].behind = 2.0 * std::log(400.0);
  EXPECT_NE(decay_sentences(decay).find("quadratic, is 400 times less likely"), std::string::npos);
  decay.laws[1].behind = 1e4;
  EXPECT_NE(decay_sentences(decay).find("is more than a million times less likely"),
            std::string::npos);
  decay.laws[1].behind = 2.0;
  EXPECT_NE(decay_sentences(decay).find("none is 20 times less likely than it"), std::string::npos);
}

Beat beat(std::int64_t cycle, double t, BeatFlag flag = BeatFlag::good, std::uint16_t segment = 0) {
  return {Instant::from_seconds(t), cycle, NAN, 0, segment, flag};
}

TEST(TextTest, BouncesAreCountedWhereThereAreAny) {
  Beats beats;
  beats.missed = 3;
  const auto first_line = [&] {
    const std::string text = rate_text(beats, RateSummary{}, SensorFindings{});
    return text.substr(0, text.find('\n'));
  };
  EXPECT_NE(first_line().find("; 3 missed, 0 spurious, 1 segment"), std::string::npos);
  beats.bounces = 2;
  EXPECT_NE(first_line().find("; 3 missed, 0 spurious, 2 bounces, 1 segment"), std::string::npos);
  // Both directions, without the downward passages of cycles 1 and 2.
  const auto down = [](std::int64_t cycle) {
    return beat(cycle, 2.0 * static_cast<double>(cycle) + 1.0, BeatFlag::down);
  };
  beats.beats = {beat(0, 0.0), down(0),      beat(1, 2.0), beat(2, 4.0),
                 down(3),      beat(4, 8.0), down(4),      beat(5, 10.0)};
  beats.has_downward = true;
  EXPECT_NE(first_line().find("; 3 missed (and 2 of the other direction), 0"), std::string::npos)
      << first_line();
}

// One beat 0.3 s late, and one that is missing while something else is seen half a period off.
TEST(TextTest, ABeatOutOfItsTimeIsDisplaced) {
  Beats beats;
  beats.beats = {beat(0, 0.0), beat(0, 2.3, BeatFlag::spurious), beat(2, 4.0),
                 beat(3, 6.0), beat(3, 9.0, BeatFlag::spurious), beat(5, 10.0)};
  beats.missed = 2;
  beats.spurious = 2;
  const std::string text = rate_text(beats, RateSummary{}, SensorFindings{});
  EXPECT_NE(text.find("; 1 missed, 1 spurious, 1 displaced, 1 segment"), text.npos) << text;
}

TEST(TextTest, FaultsOfALogThatIsSplitAreThoseOfThePartThatIsAnalysed) {
  Beats beats;
  beats.beats = {beat(0, 0.0),
                 beat(4, 8.0),
                 beat(4, 8.3, BeatFlag::bounce),
                 beat(100, 201.0, BeatFlag::good, 1),
                 beat(100, 201.4, BeatFlag::spurious, 1),
                 beat(101, 203.0, BeatFlag::good, 1),
                 beat(103, 207.0, BeatFlag::good, 1)};
  beats.segments = 2;
  beats.missed = 4;
  beats.spurious = 1;
  beats.bounces = 1;
  const std::string text = rate_text(beats, RateSummary{}, SensorFindings{});
  EXPECT_NE(text.find("; 1 missed, 1 spurious, 2 segments\n"), text.npos) << text;
}

TEST(TextTest, ValuesWithoutAPeriodHaveARateAlone) {
  Beats beats;
  RateSummary summary;
  summary.nominal_is_known = true;
  summary.nominal_period_s = 10.0;
  summary.crossings = 7;
  const std::string text = rate_text(beats, summary, SensorFindings{}, false);
  EXPECT_EQ(text.substr(0, 9), "7 values ") << text;
  EXPECT_EQ(text.find("period"), text.npos) << text;
  EXPECT_NE(rate_text(beats, summary).find("mean period"), text.npos);
}

TEST(TextTest, TheRateTableHasARowForEveryEventAndEveryMissingBeat) {
  Beats beats;
  beats.beats = {beat(0, 0.0),    beat(0, 0.4, BeatFlag::spurious),  beat(1, 2.0), beat(3, 6.0),
                 beat(53, 106.0), beat(54, 108.5, BeatFlag::good, 1)};
  const std::string table = rate_table(beats, 2.0);
  EXPECT_EQ(table, "cycle,time_s,period_s,rate_excess,rate_s_per_day,amplitude_rad,flags\n"
                   "0,0.000000000,,,,,\n"
                   ",0.400000000,,,,,spurious\n"
                   "1,2.000000000,2,0.000000e+00,0.000000,,\n"
                   "2,,,,,,missed\n"
                   "3,6.000000000,2,0.000000e+00,0.000000,,\n"
                   "4,,,,,,gap of 49\n"
                   "53,106.000000000,2,0.000000e+00,0.000000,,\n"
                   "54,108.500000000,,,,,split\n");
}

TEST(TextTest, TheRateTableTellsAStepFromOtherSplitsAndShowsRivals) {
  Beats beats;
  beats.beats = {beat(0, 0.0), beat(1, 2.0), beat(1, 2.001, BeatFlag::rival),
                 beat(2, 4.7, BeatFlag::good, 1), beat(3, 6.7, BeatFlag::good, 1)};
  beats.gaps = {{1, 0, 0.0, false, GapKind::step}};
  const std::string table = rate_table(beats, 2.0);
  EXPECT_NE(table.find("2,4.700000000,,,,,step\n"), std::string::npos) << table;
  EXPECT_NE(table.find(",2.001000000,,,,,rival\n"), std::string::npos) << table;
  EXPECT_EQ(table.find("split"), std::string::npos) << table;
}

TEST(TextTest, AnUndeterminedParameterIsAWord) {
  FitSummary fit;
  fit.parameters = {{"epsilon", "", ParameterStatus::undetermined, NAN, NAN, NAN}};
  const std::string text = fit_text(fit);
  EXPECT_NE(text.find("ε (epsilon)    undetermined"), std::string::npos);
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

FitSummary fit_with_every_status() {
  const double infinite = std::numeric_limits<double>::infinity();
  FitSummary fit;
  fit.parameters = {
      {"T0", "s", ParameterStatus::fixed, 2.0, NAN, NAN, NAN, NAN, NAN},
      {"epsilon", "", ParameterStatus::undetermined, NAN, NAN, NAN, NAN, NAN, NAN},
      {"mu@2", "", ParameterStatus::free, 2.5e-5, 2e-8, 2.498e-5, 2.502e-5, 2.496e-5, 2.504e-5},
      {"jitter_rms", "s", ParameterStatus::prior, 0.1, 0.05, 0.04, 0.15, -infinite, 0.25}};
  return fit;
}

TEST(TextTest, TheParametersStandInColumns) {
  FitSummary fit = fit_with_every_status();
  fit.parameters[2].model_shift = -0.99;
  fit.parameters.push_back(
      {"a_name_that_is_long", "s", ParameterStatus::free, 0.25, 0.002, 0.248, 0.252, 0.246, 0.254});
  fit.notes = {{NoteKind::dynamics,
                "a note of more words than a terminal of eighty columns has room for on one line"}};
  const std::string text = fit_text(fit);
  std::istringstream lines(text);
  std::set<std::size_t> values, remarks;
  constexpr std::size_t value_from = 22; // behind the longest name
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(characters(line), 80u) << line;
    if (line.find(" ± ") == std::string::npos) continue;
    values.insert(characters(line.substr(0, line.find_first_of("(0123456789", value_from))));
    remarks.insert(characters(line.substr(0, line.rfind("  ") + 2)));
  }
  EXPECT_EQ(values.size(), 1u) << text;
  EXPECT_EQ(remarks.size(), 1u) << text;
}

TEST(TextTest, TheChanceOfChiSquaredSaysWhatItAllowsFor) {
  FitSummary fit;
  fit.quality.p_value = 0.5;
  EXPECT_NE(fit_text(fit).find("allows for"), std::string::npos) << "the jitter's uncertainty";
  fit.quality.of_innovations = true;
  EXPECT_EQ(fit_text(fit).find("allows for"), std::string::npos) << "there is none";
}

TEST(TextTest, ALineIsListedWithItsSidebands) {
  DriveAnalysis drive;
  drive.rate_spectrum.emplace();
  drive.lines = {{0.1, 1e-5, 1e-7, 0.0, 100.0, 1e-40, {}},
                 {0.1002, 2e-6, 1e-7, 0.0, 10.0, 1e-9, 0},
                 {0.0998, 1e-6, 1e-7, 0.0, 10.0, 1e-9, 0}};
  EXPECT_EQ(sideband_text(drive.lines, 0),
            "and 2 beside it, of up to 20 % of it: it changes with time");
  EXPECT_EQ(sideband_text(drive.lines, 1), "");
  const std::string text = drive_text(drive);
  EXPECT_NE(text.find("and 2 beside it"), std::string::npos) << text;
  EXPECT_EQ(text.find("9.98"), std::string::npos) << text;
  drive.rate_spectrum->resolution_hz = 1e-5;
  const std::vector<ExpectedPeriod> tide{{1.0 / 0.1002, "tide"}};
  EXPECT_NE(drive_text(drive, tide).find("tide"), std::string::npos) << "it may be one of its own";
}

DeviationRow deviation_row(std::size_t m, double value, int alpha) {
  return {static_cast<double>(m), m, 1000, value, 0.9 * value, 1.1 * value, alpha, true};
}

TEST(TextTest, ASlopeThatIsNoNoisesIsCalledByNoName) {
  DeviationTable table{DeviationKind::oadev, 1.0, {}};
  table.rows = {deviation_row(1, 4e-6, 0), deviation_row(4, 2e-6, 0), deviation_row(16, 1e-6, 0)};
  const std::string noise = deviation_findings(table);
  EXPECT_NE(noise.find("white rate): the rate is random"), std::string::npos) << noise;
  EXPECT_NE(noise.find("nothing else moved the clock"), std::string::npos) << noise;
  table.rows.back().value = 8e-6;
  const std::string jump = deviation_findings(table);
  EXPECT_EQ(jump.find("the rate is random"), std::string::npos) << jump;
  EXPECT_NE(jump.find("(slope +0.25): neighbouring values look like white rate,"),
            std::string::npos)
      << jump;
  EXPECT_NE(jump.find("slope is -0.5."), std::string::npos) << jump;
  EXPECT_NE(jump.find("A step or a trend"), std::string::npos) << jump;
  EXPECT_EQ(jump.find("Expected time error"), std::string::npos) << jump;
  EXPECT_NE(jump.find("No time error is predicted"), std::string::npos) << jump;
  for (const std::string& text : {noise, jump}) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(characters(line), 80u) << line;
  }
}

TEST(TextTest, TheParametersAsLatex) {
  const std::string table = fit_latex(fit_with_every_status());
  EXPECT_EQ(table, "% needs \\usepackage{booktabs}\n"
                   "\\begin{tabular}{llll}\n\\toprule\n"
                   "Parameter & Value & Unit & 95\\,\\% interval about the value \\\\\n\\midrule\n"
                   "$T_0$ & $2$ (fixed) & s &  \\\\\n"
                   "$\\varepsilon$ & undetermined &  &  \\\\\n"
                   "$\\mu$ at event 2 & $(2.5000 \\pm 0.0020) \\times 10^{-5}$ &  &  \\\\\n"
                   "jitter\\_rms & $0.100 \\pm 0.050$ & s & open to $+0.15$ \\\\\n"
                   "\\bottomrule\n\\end{tabular}\n");
}

TEST(TextTest, TheParametersAsCsvHaveAllDigitsAndEmptyFields) {
  EXPECT_EQ(fit_csv(fit_with_every_status()),
            "name,value,sigma,low68,high68,low95,high95,unit,status\n"
            "T0,2,,,,,,s,fixed\n"
            "epsilon,,,,,,,,undetermined\n"
            "mu@2,2.5000000000000001e-05,2e-08,2.4980000000000001e-05,2.5020000000000001e-05,"
            "2.4960000000000002e-05,2.5040000000000001e-05,,free\n"
            "jitter_rms,0.10000000000000001,0.050000000000000003,0.040000000000000001,"
            "0.14999999999999999,,0.25,s,prior\n");
}

TEST(TextTest, AnHonestMissIsNoTable) {
  FitSummary fit;
  fit.status = FitStatus::no_valid_model;
  fit.termination = "why";
  EXPECT_EQ(fit_text(fit), "no fit: why\n");
}

TEST(TextTest, LongLinesAreBrokenAtBlanks) {
  EXPECT_EQ(wrapped("short", 10), "short");
  EXPECT_EQ(wrapped("exactly 10", 10), "exactly 10");
  EXPECT_EQ(wrapped("exactly 10 and", 10), "exactly 10\nand");
  EXPECT_EQ(wrapped("  one two three\nnext\n", 9, 2), "  one two\n    three\nnext\n");
  EXPECT_EQ(wrapped("µµµµ µµµµ", 9), "µµµµ µµµµ") << "characters, not bytes";
  EXPECT_EQ(wrapped("{aaa,bbb,ccc}", 9), "{aaa,bbb,\nccc}");
  EXPECT_EQ(wrapped("unbreakable word", 5), "unbreakable\nword");
  EXPECT_EQ(wrapped("unbreakable", 5), "unbreakable");
}

} // namespace
} // namespace goingrate
