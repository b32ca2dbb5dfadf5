// The command's errors for input that it cannot use: a table of malformed logs, scenarios and
// command lines, each with its exit code and the telling part of its message.
#include "support/command_fixture.hpp"

#include <algorithm>
#include <cctype>
#include <zlib.h>

namespace {

using namespace goingrate::test;

struct Malformed {
  std::string name;
  std::string arguments; // of the command
  std::string file;      // what is in bad.log and bad.toml; not written if there is none
  int code;
  std::string message; // part of what is said on standard error
};

void PrintTo(const Malformed& bad, std::ostream* out) { *out << bad.name; }

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i)
    all += text;
  return all;
}

// Steady beats, each time followed by `after`.
std::string beats(int count, const std::string& after = "", double step = 2.0) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += fmt::format("{:.6f}{}\n", 100.0 + step * i + 1e-5 * (i % 3), after);
  return text;
}

std::string packed(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::string out(text.size() + 100, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::string with_byte_changed(std::string text, std::size_t at) {
  text[at] = static_cast<char>(text[at] ^ 0x55);
  return text;
}

std::string utf16(const std::string& text) {
  std::string wide;
  for (const char c : text)
    wide += {c, '\0'};
  return wide;
}

const std::string no_text = "a log in plain text";
const std::string nuls(4096, '\0');

std::vector<Malformed> logs() {
  const std::string rate = "rate bad.log -o out.csv";
  return {
      {"Empty", rate, "", 3, "bad.log:1:1: found an empty file, expected a log"},
      {"BlankLines", rate, "\n\n  \n\t\n", 3, "found no line of data"},
      {"OnlyComments", rate, "# a\n% b\n", 3, "found no line of data"},
      {"OnlyAHeader", rate, "time_s,edge\n", 3, "found a header and 0 events"},
      {"NoTime", rate, "amplitude_rad,temperature_c\n0.05,20\n0.05,20\n0.05,20\n", 3,
       "bad.log:1:1: found 'amplitude_rad,temperature_c', expected a column with a time"},
      {"OneEvent", rate, "12.5\n", 3, "found 1 event, expected at least 3"},
      {"TwoEvents", rate, "12.5\n14.5\n", 3, "bad.log:2:1: found 2 events, expected at least 3"},
      {"Prose", rate, "Once upon a time\nthere was a clock.\n", 3, "bad.log:1:1: found 'Once upon"},
      {"Program", rate,
       std::string("\x7f"
                   "ELF\x02\x01\x01\0\0\0\n\x01\x02",
                   13),
       3, "bad.log:1:5: found the binary byte 0x02, expected " + no_text},
      {"Picture", rate, "\x89PNG\r\n\x1a\n" + repeated("\x01\x02\n", 10), 3, "binary byte 0x1a"},
      {"Utf16", rate, "\xff\xfe" + utf16(beats(5)), 3, "found text in UTF-16"},
      {"Utf16BigEndian", rate, "\xfe\xff" + utf16(beats(5)), 3, "found text in UTF-16"},
      {"Utf16WithoutMark", rate, utf16(beats(5)), 3, "bad.log:1:2: found the binary byte 0x00"},
      {"OnlyNuls", rate, nuls, 3, "found the binary byte 0x00"},
      {"Directory", "rate . -o out.csv", "", 3,
       "files, none of them a log, expected logs of a clock"},
      {"Absent", "rate no.log -o out.csv", "", 3, "no.log: found no file of that name"},
      {"ConstantTimes", rate + " --format timestamps", repeated("5.5\n", 20), 3,
       "two events at one time in most places"},
      {"TimesTooLarge", rate + " --format timestamps", repeated("5000000000000000000.5\n", 5), 3,
       "bad.log:1:1: found 5 unusable lines out of 5, here first: a time beyond 4e18 s"},
      {"Overflow", rate, "1e400\n2e400\n3e400\n", 3, "bad.log:1:1: found '1e400'"},
      {"NoSuchDates", rate, repeated("2013-02-30 10:00:00\n", 5), 3, "'2013-02-30 10:00:00'"},
      {"DatesGoneWrong", rate,
       "2013-02-22 10:00:00\n2013-02-22 10:00:02\n2013-02-22 10:00:04\n" +
           repeated("2013-02-22 10:61:00\n", 4),
       3, "bad.log:4:1: found 4 unusable lines out of 7"},
      {"MostlyBad", rate, "1.5\n3.5\n5.5\nx\ny\nz\nu\n", 3,
       "bad.log:4:1: found 4 unusable lines out of 7, here first: 'x' instead of a time"},
      {"CounterThatFalls", rate, "500\n7\n900\n300\n20\n800\n100\n650\n3\n", 3,
       "whole numbers that do not rise"},
      {"AllMissed", rate, repeated("nan\n", 20), 3, "bad.log:1:1: found 'nan'"},
      {"AllMissedPhase", rate + " --format phase", "1e-6\n" + repeated("0\n", 20), 3,
       "found 1 value, expected at least 3"},
      {"AllNines", rate, repeated("9999.999\n", 20), 3, "expected"},
      {"LineWithoutEnd", rate, std::string((16U << 20) + 300000, '7'), 3,
       "bad.log:1:1: found '7777777777"},
      {"LineWithoutEndLater", rate, beats(50) + std::string((16U << 20) + 300000, '7'), 3,
       "bad.log:51:1: found a line of more than 16777216 bytes"},
      {"TooManyColumns", rate, repeated(repeated("1,", 300) + "\n", 5), 3, "more than 256 columns"},
      {"OpenQuote", rate, "\"Time (s),\"Angle\n\"0.1,1\n\"0.2,2\n", 3, "bad.log:1:1: found"},
      {"OnlySeparators", rate, repeated(",,,,\n", 20), 3, "bad.log:1:1: found ',,,,'"},
      {"WildTable", rate, "5 1 9\n1 8 2\n7 3 3\n2 2 8\n6 1 4\n", 3,
       "expected a known layout\n  if column 1 holds the times: --column time=1"},
      {"PeriodOfAFemtosecond", rate + " --unit s", "1e-15\n2e-15\n3e-15\n4e-15\n", 3, "expected"},
      {"PackedAndCut", rate, packed(beats(500)).substr(0, 700), 3,
       "bad.log: found gzip data that end early, expected a whole .gz file"},
      {"PackedAndDamaged", rate, with_byte_changed(packed(beats(500)), 300), 3,
       "bad.log: found damaged gzip data"},
      {"PackedHeaderAlone", rate, "\x1f\x8b", 3, "found gzip data that end early"},
      {"PackedNothing", rate, packed(""), 3, "found an empty file"},
      {"PackedWrongSum", rate, with_byte_changed(packed(beats(50)), packed(beats(50)).size() - 6),
       3, "found damaged gzip data"},
      {"NumbersForPhase", "stability bad.log --data phase -o out.csv", "1e-6\nx\n2e-6\n", 3,
       "found 2 values, expected at least 3"},
      {"WordAmongPhases", "stability bad.log --data phase -o out.csv", "1e-6\nx\n2e-6\n4e-6\n", 0,
       "bad.log:2:1: found 'x', expected a number: line left out"},
      {"TwoColumnsForPhase", "stability bad.log --data phase -o out.csv", "1e-6 5\n2e-6 5\n", 3,
       "found 2 values, expected at least 3"},
      {"NoFileForPhase", "stability bad.log --data phase -o out.csv", "", 3, "an empty file"},
      {"FitOfNothing", "fit bad.log -o out.csv", "time_s\n", 3, "found a header and 0 events"},
      {"ReportOfWords", "report bad.log -o out.csv", "tick tock\n", 3, "found 'tick tock'"},
      {"SpectrumOfNothing", "spectrum bad.log -o out.csv", "", 3, "found an empty file"},
      // What a power cut leaves is read, and told.
      {"NulsInTheMiddle", rate, beats(30) + nuls + "\n" + beats(60).substr(31 * 11), 0,
       "bad.log:31:1: bytes that are not text: '\\x00"},
      {"NulsInTheMiddleOfALine", rate, beats(30) + "16" + nuls + beats(60).substr(31 * 11), 0,
       "line left out"},
      {"NulsAtTheEnd", rate, beats(30) + nuls, 0, "bad.log:31:1: bytes that are not text"},
  };
}

std::vector<Malformed> options() {
  const auto rate = [](const std::string& rest) { return "rate bad.log -o out.csv " + rest; };
  const auto fit = [](const std::string& rest) { return "fit bad.log -o out.csv " + rest; };
  const std::string good = beats(40), table = "time_s,amplitude_rad\n" + beats(40, ",0.05");
  return {
      {"ColumnBeyond", rate("--column time=4"), table, 2,
       "column = 'time=4': must be a place from 1 to 2"},
      {"ColumnZero", rate("--column time=0"), table, 2, "must be a place from 1 to 2"},
      {"ColumnOfNoRole", rate("--column tide=1"), table, 2, "must be ROLE=PLACE[:UNIT]"},
      {"ColumnWithoutPlace", rate("--column time"), table, 2,
       "column = 'time': must be ROLE=PLACE"},
      {"ColumnOfNoName", rate("--column time=when"), table, 2,
       "must be a number from 1, or one of time_s, amplitude_rad"},
      {"ColumnOfAbsurdUnit", rate("--column time=1:furlong"), table, 2,
       "column = 'time=1:furlong': must be"},
      {"UnknownFormat", rate("--format sundial"), good, 2, "found sundial, expected one of native"},
      {"WrongFormatAngle", rate("--format angle"), good, 3, "columns for a time and an angle"},
      {"WrongFormatNative", rate("--format native"), good, 3, "a header row with time_s"},
      {"WrongFormatClockError", rate("--format clock-error"), good, 3,
       "bad.log:1:1: found '100.000000', expected columns for a label and the clock's error"},
      {"NoSuchChannel", rate("--channel chZ"), beats(40, " chA"), 3,
       "bad.log:1:1: found 40 lines of other channels, expected lines of channel chZ"},
      {"UnknownUnit", rate("--unit fortnight"), good, 2, "found fortnight, expected one of s,"},
      {"NegativeWrap", rate("--wrap -5"), good, 2, "--wrap: -5 is not a number from 0 on"},
      {"TinyWrap", rate("--wrap 1e-300"), good, 2, "wrap = 1e-300"},
      {"WordForWrap", rate("--wrap never"), good, 2, "--wrap"},
      {"NoPeriod", rate("--nominal-period 0"), good, 2,
       "--nominal-period: 0 is not a number above 0"},
      {"NegativePeriod", rate("--nominal-period -2"), good, 2, "--nominal-period"},
      {"EndlessPeriod", rate("--nominal-period 1e300"), good, 2, "must be between 1e-09 and 1e9 s"},
      {"WordForPeriod", rate("--nominal-period two"), good, 2, "--nominal-period"},
      {"PeriodThatIsNone", rate("--nominal-period nan"), good, 2, "nan is not a number"},
      {"ProbabilityThatIsNone", rate("--gap-probability nan"), good, 2, "nan is not a number"},
      {"NoTau", rate("--tau0 0"), good, 2, "--tau0"},
      {"EndlessTau", rate("--tau0 1e300 --format phase"), good, 2, "tau0 = "},
      {"LikelierThanCertain", rate("--gap-probability 1.5"), good, 2, "--gap-probability"},
      {"FlagWiderThanTheSwing", rate("--flag-width 7"), good, 2, "--flag-width"},
      {"WordForOffset", rate("--sensor-offset left"), good, 2,
       "sensor-offset = 'left': must be a number"},
      {"OffsetThatCannotBeTold", rate("--sensor-offset auto"), good, 4,
       "cannot find the sensor's offset from the vertical"},
      {"RestAngleBeyondPi", rate("--rest-angle 7"), good, 2, "rest-angle = 7: must be between"},
      {"StrictReading", rate("--strict"), beats(3) + "x\n" + beats(5).substr(33), 3,
       "bad.log:4:1: found 'x', expected a time in seconds (where faults are mended: line left "
       "out)"},
      {"UnknownOption", rate("--frobnicate"), good, 2, "--frobnicate"},
      {"FixWhatIsNot", fit("--fix eps=1"), good, 2, "eps"},
      {"FixWithoutValue", fit("--fix epsilon"), good, 2, "fix = 'epsilon': must be NAME=VALUE"},
      {"FixToAWord", fit("--fix epsilon=small"), good, 2, "fix = 'small': must be a number, for epsilon"},
      {"FixToMinus", fit("--fix epsilon=-1"), good, 2, "epsilon"},
      {"PriorWithoutSigma", fit("--prior epsilon=1e-4"), good, 2, "NAME=VALUE+-SIGMA"},
      {"PriorWithNegativeSigma", fit("--prior epsilon=1e-4+--1"), good, 2, "prior"},
      {"EventBeyondTheEnd", fit("--event 99999:mu"), good, 2, "99999"},
      {"EventWithoutName", fit("--event 10:"), good, 2, "event"},
      {"EventWithoutCycle", fit("--event mu"), good, 2, "event = 'mu'"},
      {"EventAtNoTime", fit("--event soons:mu"), good, 2,
       "event = 'soons:mu': must be a time in seconds"},
      {"UnknownModel", fit("--model guess"), good, 2, "found guess, expected one of averaged1"},
      {"TauThatIsNoMultiple", "stability bad.log --taus 3 -o out.csv", good, 2, "3"},
      {"TauThatIsNoNumber", "stability bad.log --taus long -o out.csv", good, 2,
       "taus = 'long': must be octave, decade, all, or numbers in seconds"},
      {"UnknownKind", "stability bad.log --kind sdev -o out.csv", good, 2,
       "found sdev, expected one of adev"},
      {"NoLog", "rate -o out.csv", good, 2, "LOG is missing"},
      {"OneLogTwice", rate("bad.log"), good, 2, "log = 'bad.log': must be named only once: it"},
      {"UnknownCommand", "tick bad.log", good, 2,
       "'tick' is not a command (goingrate --help lists them)"},
      {"MisspeltCommand", "reprot bad.log", good, 2, "(did you mean report?)"},
      {"MisspeltOption", rate("--formt periods"), good, 2,
       "found --formt, expected an option of goingrate rate (did you mean --format?)"},
      {"MisspeltOptionWithItsValue", rate("--nominalperiod=2"), good, 2,
       "found --nominalperiod, expected an option of goingrate rate (did you mean "
       "--nominal-period?)"},
      {"MisspeltOptionThatTakesTheLog", "rate --quite", good, 2, "(did you mean --quiet?)"},
      {"OptionOfNoCommand", rate("--pendulum"), good, 2,
       "found --pendulum, expected an option of goingrate rate (goingrate rate --help lists them)"},
      {"UnknownLetter", rate("-z"), good, 2, "found -z, expected an option of goingrate rate"},
      {"NoSuchFolder", "rate bad.log -o no/such/out.csv", good, 5, "cannot write no/such/out.csv"},
  };
}

std::vector<Malformed> scenarios() {
  const std::string run = "simulate bad.toml -o out.csv";
  const std::string clock = "[clock]\nepsilon = 2.5e-4\nmu = 2e-5\nphi0 = 0.03\n";
  const std::string good = clock + "[run]\nperiods = 20\n";
  const auto set = [](const std::string& change) {
    return "simulate bad.toml -o out.csv --set " + change;
  };
  return {
      {"UnknownKey", run, "[clock]\nepsilom = 1\n", 3,
       "bad.toml:2:1: found unknown key 'clock.epsilom', expected one of nominal_period, epsilon"},
      {"MisspeltKey", run, "[clock]\nepsilom = 1\n", 3, "(did you mean epsilon?)"},
      {"MisspeltSection", run, good + "[sensr]\nmissed = 0\n", 3, "(did you mean sensor?)"},
      {"UnknownSection", run, good + "[clok]\nmu = 1\n", 3, "bad.toml:7:2: found unknown section"},
      {"Syntax", run, "[clock]\nepsilon = = 3\n", 3, "bad.toml:2:11: found text that is not TOML"},
      {"OpenText", run, good + "method = \"map\n", 3, "bad.toml:7:"},
      {"KeyTwice", run, "[clock]\nmu = 1e-5\nmu = 2e-5\n", 3, "bad.toml:3:"},
      {"DeepNesting", run, "a = " + std::string(5000, '[') + "\n", 3,
       "found text that is not TOML"},
      {"BinaryScenario", run, std::string("\x01\x02\x00\x03", 4), 3, "bad.toml:1:1: found text"},
      {"NoText", run, "", 3, "bad.toml: found run = no length"},
      {"ScenarioTooLong", run, good + repeated("# and so on\n", 100000), 3,
       "bad.toml: found 1200066 bytes, expected a scenario of at most 1048576"},
      {"NoScenario", "simulate no.toml -o out.csv", "", 3, "no.toml: found no file of that name"},
      {"NegativeEpsilon", run, "[clock]\nepsilon = -1e-4\n[run]\nperiods = 9\n", 3,
       "bad.toml:2:11: found epsilon = -0.0001, expected at least 0 and below 1"},
      {"NoLength", run, clock + "[run]\nmethod = 'map'\n", 3,
       "bad.toml:5:1: found run = no length"},
      {"TwoLengths", run, good + "duration = 30.0\n", 3, "found run = periods and duration"},
      {"NoPeriods", run, clock + "[run]\nperiods = 0\n", 3, "bad.toml:6:11: found periods = 0"},
      {"EndlessRun", run, clock + "[run]\nperiods = 9000000000000000000\n", 3,
       "between 1 and 1e12"},
      {"PeriodsInHalves", run, clock + "[run]\nperiods = 2.5\n", 3, "expected a whole number"},
      {"TextForNumber", run, "[clock]\nepsilon = 'small'\n", 3,
       "bad.toml:2:11: found clock.epsilon = 'small', expected a number"},
      {"Infinite", run, "[clock]\nepsilon = inf\n", 3, "expected a finite number"},
      {"UnknownMethod", run, good + "method = 'magic'\n", 3, "expected \"auto\" or \"direct\""},
      {"UnknownEscapement", run, "[clock]\nescapement = 'anchor'\n", 3, "\"constant-torque\""},
      {"SectionThatIsNone", run, "clock = 3\n", 3, "expected a section [clock]"},
      {"EventThatIsNoTable", run, "event = [3]\n" + good, 3, "bad.toml:1:9: found"},
      {"EventWithoutDate", run, good + "[[event]]\nmu = 3e-5\n", 3,
       "found event = neither at_period nor at"},
      {"EventOutOfRange", run, good + "[[event]]\nat_period = 5\nmu = -3e-5\n", 3,
       "bad.toml:9:6: found mu = "},
      {"ProfileOfOnePoint", run, good + "[[event]]\n[clock.x]\n", 3, "bad.toml:8:"},
      {"ProfileThatGoesBack", run,
       "[clock]\nescapement='profile'\nrising=[[0.1,0],[0,1e-5]]\n[run]\nperiods=9\n", 3,
       "bad.toml:3:8: found rising"},
      {"SineWithoutPeriod", run, good + "[drive]\nsine = [{amplitude = 0.1}]\n", 3,
       "bad.toml:8:9: found drive.sine without period"},
      {"NoSeries", run, good + "[drive]\nseries = 'no.csv'\n", 3, "no.csv: found no regular file"},
      {"SeriesOfWords", run, good + "[drive]\nseries = 'bad.toml'\n", 3, "bad.toml:2:1: found"},
      {"SeriesIsAFolder", run, good + "[drive]\nseries = '.'\n", 3, "found no regular file"},
      {"MoreThanAllMissed", run, good + "[sensor]\nmissed = 2\n", 3, "bad.toml:8:10: found missed"},
      {"GateWithoutFlag", run, good + "[sensor]\nedges = 'gate'\n", 3, "flag_width"},
      {"SetUnknownKey", set("clock.epsilom=1"), good, 2,
       "--set clock.epsilom=1: found unknown key 'clock.epsilom'"},
      {"SetMisspeltKey", set("clock.epsilonn=1"), good, 2, "(did you mean epsilon?)"},
      {"SetNegative", set("clock.epsilon=-1"), good, 2,
       "--set clock.epsilon=-1: found epsilon = -1, expected at least 0 and below 1"},
      {"SetWithoutValue", set("clock.epsilon"), good, 2,
       "--set clock.epsilon: found no '=', expected KEY=VALUE"},
      {"SetToAWord", set("clock.mu=lots"), good, 2,
       "--set clock.mu=lots: found clock.mu = 'lots', expected a number"},
      {"SetUnknownMethod", set("run.method=magic"), good, 2, "--set run.method=magic: found"},
      {"SetWithoutKey", set("=3"), good, 2, "--set =3: found text that is not TOML"},
      {"SetASection", set("clock=3"), good, 2,
       "--set clock=3: found 'clock', which is not a section"},
      {"NegativeSeed", run + " --seed -1", good, 2,
       "--seed: -1 is not a number from 0 to 2^64 - 1"},
      {"EndlessSeed", run + " --seed 99999999999999999999", good, 2, "--seed: 9999"},
      {"NoRealisations", run + " --realisations 0", good, 2, "--realisations"},
      {"ClockThatStalls", run + " --set clock.epsilon=0.1 --set start.amplitude=0.04", good, 4,
       "nothing was written"},
      {"ClockWithoutDrive", run + " --set clock.escapement=none", good, 4,
       "this clock has no stationary swing"},
      {"ClockTooWeakToGo", run + " --set clock.mu=1e-7", good, 4,
       "this clock has no stationary swing"},
  };
}

std::vector<Malformed> all_of_them() {
  auto all = logs();
  for (auto&& more : {options(), scenarios()})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

class MalformedTest : public CommandTest, public testing::WithParamInterface<Malformed> {};

TEST_P(MalformedTest, IsAnsweredInWords) {
  const Malformed& bad = GetParam();
  put("bad.log", bad.file);
  put("bad.toml", bad.file);
  put("out.csv", "precious");
  const Outcome outcome = run(bad.arguments);
  EXPECT_EQ(outcome.code, bad.code) << outcome.err;
  EXPECT_NE(outcome.err.find(bad.message), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(content(folder_ / "out.csv") == "precious", bad.code != 0) << "the output file";
  EXPECT_LE(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 12) << outcome.err;
  EXPECT_LE(outcome.err.size(), 1600U) << outcome.err;
  EXPECT_EQ(outcome.err.find(":0:0"), std::string::npos) << outcome.err;
  if ((bad.file + bad.arguments).find("nan") == std::string::npos) {
    EXPECT_EQ(outcome.err.find("nan"), std::string::npos) << outcome.err;
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    EXPECT_EQ(entry.path().string().find(".part-"), std::string::npos) << entry.path();
}

INSTANTIATE_TEST_SUITE_P(Inputs, MalformedTest, testing::ValuesIn(all_of_them()),
                         [](const auto& entry) { return entry.param.name; });

} // namespace
