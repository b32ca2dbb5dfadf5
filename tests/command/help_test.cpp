// The command's help: topics, options, examples.
#include "support/command_fixture.hpp"

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace goingrate::test;
namespace fs = std::filesystem;

TEST_F(CommandTest, HelpExplainsItsTopics) {
  const Outcome list = run("help");
  ASSERT_EQ(list.code, 0);
  for (const char* topic : {"formats", "scenario", "noise", "diary", "identifiability"}) {
    EXPECT_NE(list.out.find(topic), std::string::npos);
    EXPECT_GT(run(std::string("help ") + topic).out.size(), 500u) << topic;
  }
  EXPECT_EQ(run("help clocks").code, 2);
}

// What the reader of scenarios expects in a section, from its complaint about a key it does not
// know.
std::vector<std::string> keys_it_names(const std::string& complaint) {
  std::vector<std::string> keys;
  const std::string begin = "expected one of ";
  const std::size_t at = complaint.find(begin);
  if (at == std::string::npos) return keys;
  std::istringstream list(complaint.substr(at + begin.size()));
  for (std::string key; std::getline(list, key, ',');) {
    key.erase(0, key.find_first_not_of(' '));
    keys.push_back(key.substr(0, key.find_first_of(" \n")));
  }
  return keys;
}

TEST_F(CommandTest, HelpNamesEveryKeyOfAScenario) {
  const std::string help = run("help scenario").out;
  put("s.toml", "[zzzzz]\n");
  const std::vector<std::string> sections = keys_it_names(run("simulate s.toml").err);
  EXPECT_GE(sections.size(), 8u);
  for (const std::string& section : sections) {
    const std::size_t at = help.find("[" + section + "]");
    ASSERT_NE(at, std::string::npos) << section;
    const std::size_t end = std::min(help.find("\n[", at), help.find("\n--set", at));
    const std::string part = help.substr(at, end - at);
    put("s.toml", (section == "event" ? "[[event]]" : "[" + section + "]") + "\nzzzzz = 1\n");
    const std::vector<std::string> keys = keys_it_names(run("simulate s.toml").err);
    EXPECT_FALSE(keys.empty()) << section;
    for (const std::string& key : keys)
      EXPECT_NE(part.find(key), std::string::npos) << section << ": " << key << '\n' << part;
  }
}

TEST_F(CommandTest, HelpOnFormatsNamesEveryOptionThatReads) {
  const std::string help = run("help formats").out, options = run("rate --help").out;
  const std::size_t group = options.find("How the log is read");
  ASSERT_NE(group, std::string::npos);
  std::istringstream lines(options.substr(group, options.find("\n\n", group) - group));
  std::vector<std::string> names{"--flag-width", "--sensor-offset", "--both-edges",
                                 "--nominal-period"};
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("  --")) names.push_back(line.substr(2, line.find(' ', 2) - 2));
  EXPECT_GE(names.size(), 12u);
  for (const std::string& name : names)
    EXPECT_NE(help.find(name), std::string::npos) << name;
}

TEST_F(CommandTest, EachHelpHasAnExampleThatRuns) {
  fs::create_symlink(source / "data", folder_ / "data");
  for (const char* command : {"simulate", "rate", "fit", "spectrum", "stability", "report",
                              "compare", "map", "chart", "paper", "help"}) {
    const Outcome help = run(fmt::format("{} --help", command));
    EXPECT_EQ(help.code, 0);
    const std::size_t at = help.out.find("Example:");
    ASSERT_NE(at, std::string::npos) << command;
    std::string example = help.out.substr(help.out.find("goingrate ", at) + 10);
    for (std::size_t k; (k = example.find("\\\n")) != std::string::npos;)
      example.erase(k, 2);
    while (!example.empty() && (example.back() == '\n' || example.back() == ' '))
      example.pop_back();
    EXPECT_EQ(run(example).code, 0) << example;
  }
}

// The longest line in characters, not bytes.
std::size_t widest_line(const std::string& text) {
  std::size_t widest = 0, width = 0;
  for (const char c : text) {
    if (c == '\n')
      width = 0;
    else if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U)
      widest = std::max(widest, ++width);
  }
  return widest;
}

TEST_F(CommandTest, HelpAndSummaryFitATerminalOfEightyColumns) {
  EXPECT_LE(widest_line(run("--help").out), 80u);
  for (const char* command : {"simulate", "rate", "fit", "spectrum", "stability", "report", "map",
                              "chart", "paper", "compare", "help"})
    EXPECT_LE(widest_line(run(std::string(command) + " --help").out), 80u) << command;
  for (const char* topic : {"", "formats", "scenario", "noise", "diary", "identifiability"})
    EXPECT_LE(widest_line(run(std::string("help ") + topic).out), 80u) << topic;
  for (const char* log : {"interruption", "jump"}) {
    const std::string path = (source / "data/logs" / (std::string(log) + ".csv")).string();
    const Outcome report = run("report " + path + " -o r.html");
    EXPECT_LE(widest_line(report.out), 80u) << report.out;
    EXPECT_LE(std::count(report.out.begin(), report.out.end(), '\n'), 40) << report.out;
  }
}

TEST_F(CommandTest, HelpListsEveryCommand) {
  const Outcome help = run("--help");
  for (const char* name :
       {"report", "rate", "fit", "spectrum", "stability", "compare", "simulate", "map", "chart",
        "paper"})
    EXPECT_NE(help.out.find(fmt::format("\n  {} ", name)), std::string::npos) << name;
  EXPECT_EQ(run("--version").out.substr(0, 10), "goingrate ");
}

} // namespace
