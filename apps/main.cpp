// goingrate: the command. Each subcommand lives in a file of its own.
#include "common.hpp"
#include "exit_code.hpp"
#include "help.hpp"
#ifdef GOINGRATE_MONITOR
#include "monitor/monitor.hpp"
#endif
#include "terminal.hpp"
#include "usage.hpp"

#include "base/printable.hpp"
#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <iostream>
#include <string>
#include <string_view>
#include <sys/resource.h>
#include <vector>

namespace {

using namespace goingrate::apps; // exit codes, words

// Prints an error. `advice` follows as whole lines. A message that cannot be written is dropped.
int complain(ExitCode code, std::string_view what, const std::string& advice = {}) {
  std::fputs(fmt::format("{} {}\n{}", painted("goingrate:", Paint::error),
                         goingrate::printable(what), advice)
                 .c_str(),
             stderr);
  return code;
}

// On Ctrl-C and similar signals temporary files are removed, then the signal takes its usual
// effect.
extern "C" void end_by_signal(int number) {
  goingrate::discard_drafts();
  std::signal(number, SIG_DFL);
  std::raise(number);
}

void heed_signals() {
  // Writing to a closed pipe or beyond a size limit is to fail as an output error, not to kill.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU})
    if (std::signal(number, end_by_signal) == SIG_IGN)
      std::signal(number, SIG_IGN); // as nohup asks
}

// Many realisations need many open files; the soft limit is often lower than the system allows.
void allow_many_files() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

// Flushes standard output after --help and --version. If the reader closed the pipe, that is fine.
int after_standard_output() {
  errno = 0;
  std::cout.flush();
  const bool written = std::cout.good() && std::fflush(stdout) == 0;
  return written || errno == EPIPE ? done : complain(no_output, "cannot write standard output");
}

std::vector<std::string> command_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

void add_commands(CLI::App& program, const goingrate::apps::GlobalOptions& global) {
  using namespace goingrate;
  apps::add_simulate(program, global);
  apps::add_rate(program, global);
  apps::add_fit(program, global);
  apps::add_spectrum(program, global);
  apps::add_stability(program, global);
  apps::add_report(program, global);
  apps::add_compare(program, global);
  apps::add_map(program, global);
  apps::add_chart(program, global);
  apps::add_paper(program, global);
  apps::add_batch(program, global);
#ifdef GOINGRATE_MONITOR
  apps::add_monitor(program, global);
#endif
  apps::add_help(program);
}

// What is wrong with the words of a command line. CLI11's own texts speak of its types.
std::string usage_words(const CLI::ParseError& error) {
  const std::string what = error.what();
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr)
    if (const std::size_t at = what.find(" is required"); at != std::string::npos) {
      std::string name = what.substr(0, at);
      if (!name.starts_with('-'))
        std::transform(name.begin(), name.end(), name.begin(),
                       [](unsigned char c) { return std::toupper(c); });
      return name + " is missing";
    }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr)
    if (const std::size_t at = what.find(": 1 required "); at != std::string::npos)
      return what.substr(0, at) + ": expected a value after it";
  return what;
}

// Reports a usage error, or prints the help that was asked for.
int explain(const CLI::App& program, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) {
    program.exit(error);
    return after_standard_output();
  }
  const auto commands = program.get_subcommands();
  std::string name = "goingrate";
  if (!commands.empty()) name += " " + commands.front()->get_name();
  if (const auto unexpected = unexpected_word(program, name))
    return complain(wrong_usage, *unexpected);
  return complain(wrong_usage,
                  fmt::format("{} ({} --help lists the options)", usage_words(error), name));
}

// Answers --complete (for the shell) and --man (for the build), which --help does not list.
bool answer_hidden(CLI::App& program, const std::vector<std::string>& words) {
  if (words.empty()) return false;
  if (words.front() == "--man") {
    std::fputs(manual_page(program).c_str(), stdout);
    return true;
  }
  if (words.front() != "--complete") return false;
  add_batch_jobs(program);
  for (const std::string& word : completions(program, {words.begin() + 1, words.end()}))
    std::fputs((word + '\n').c_str(), stdout);
  return true;
}

// The words of the command line, the last first, as CLI11 takes them. The "--" that parts a batch's
// options from those of its jobs is for people: each is known by its name.
std::vector<std::string> parser_words(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  const auto is_word = [](const std::string& word) { return !word.starts_with('-'); };
  const auto command = std::find_if(words.begin(), words.end(), is_word);
  if (command != words.end() && *command == "batch") {
    const auto mark = std::find(words.begin(), words.end(), "--");
    if (mark != words.end()) words.erase(mark);
  }
  for (std::string& word : words) { // every name of standard output becomes "-"
    const std::size_t value = word.starts_with("--") ? word.find('=') + 1 : 0; // 0 without "="
    if (goingrate::is_standard_output(std::string_view(word).substr(value)))
      word.replace(value, std::string::npos, "-");
  }
  std::reverse(words.begin(), words.end());
  return words;
}

int run(CLI::App& program, int argc, char** argv) {
  if (argc == 1) { // called without any word: show the help
    std::fputs(program.help().c_str(), stderr);
    return complain(wrong_usage, "no command was given");
  }
  if (answer_hidden(program, {argv + 1, argv + argc})) return after_standard_output();
  const std::string_view first(argv[1]);
  const auto names = command_names(program);
  if (!first.starts_with('-') && std::find(names.begin(), names.end(), first) == names.end())
    return complain(wrong_usage, fmt::format("'{}' is not a command ({})", first,
                                             did_you_mean(first, names, "goingrate --help")));
  try {
    program.parse(parser_words(argc, argv));
  } catch (const CLI::ParseError& error) {
    return explain(program, error);
  }
  return after_standard_output();
}

} // namespace

int main(int argc, char** argv) {
  using namespace goingrate;
  heed_signals();
  allow_many_files();
  keep_all_inputs();
  CLI::App program{"Fits, diagnoses and simulates pendulum clocks from their timing logs.",
                   "goingrate"};
  program.set_version_flag("--version", "goingrate " GOINGRATE_VERSION);
  program.require_subcommand(1);
  program.fallthrough();
  apps::narrow_help(program);
  program.footer("A log of the passages of a pendulum is all that is needed: goingrate report LOG\n"
                 "gives a summary and a page. goingrate COMMAND --help lists the options of a\n"
                 "command, with an example; goingrate help lists what else is explained.");
  apps::GlobalOptions global;
  program.add_flag("--quiet", global.quiet, "no notes on standard error");
  try {
    add_commands(program, global);
    return run(program, argc, argv);
  } catch (const ClosedPipe&) { // the reader of standard output has all it wanted
    return done;
  } catch (const std::exception&) {
    const apps::Failure failure = apps::current_failure(&program);
    return complain(failure.code, failure.message, failure.advice);
  }
}
