// goingrate: the command. Each subcommand lives in a file of its own.
#include "common.hpp"
#include "help.hpp"
#include "terminal.hpp"

#include "base/printable.hpp"
#include "base/spelling.hpp"
#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/clock_run.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <iostream>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <sys/resource.h>
#include <vector>

namespace {

// Exit codes that scripts rely on.
enum ExitCode {
  done = 0,
  our_fault = 1,
  wrong_usage = 2,
  bad_input = 3,
  no_result = 4,
  no_output = 5
};

// Prints an error. `advice` follows as whole lines. A message that cannot be written is dropped.
int complain(ExitCode code, std::string_view what, const std::string& advice = {}) {
  using namespace goingrate::apps;
  std::fputs(fmt::format("{} {}\n{}", painted("goingrate:", Paint::error),
                         goingrate::printable(what), advice)
                 .c_str(),
             stderr);
  return code;
}

constexpr std::string_view out_of_memory =
    "this needs more memory than there is: take a part of the log (split it, or leave out every "
    "other line), or fewer periods or realisations at a time";

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

// Flushes standard output after --help and --version. A reader that closed the pipe is no error.
int after_standard_output() {
  errno = 0;
  std::cout.flush();
  const bool written = std::cout.good() && std::fflush(stdout) == 0;
  return written || errno == EPIPE ? done : complain(no_output, "cannot write standard output");
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known,
                         const std::string& list) {
  const auto meant = goingrate::nearest_word(word, known);
  return meant ? fmt::format("did you mean {}?", *meant) : list + " lists them";
}

std::vector<std::string> command_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

void add_option_names(const CLI::App& command, std::vector<std::string>& names) {
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames())
      names.push_back("--" + name);
}

// An unknown option or a word too many. Reported before other errors, which often follow from it.
std::optional<std::string> unexpected_word(const CLI::App& program) {
  const std::vector<std::string> words = program.remaining(true);
  if (words.empty()) return {};
  const auto is_option = [](const std::string& word) { return word.size() > 1 && word[0] == '-'; };
  const auto option = std::find_if(words.begin(), words.end(), is_option);
  const auto commands = program.get_subcommands();
  const std::string command = commands.empty() ? "" : " " + commands.front()->get_name();
  if (option == words.end())
    return fmt::format("found {}, expected no more words after goingrate{}", words.front(),
                       command);
  std::vector<std::string> known;
  if (!commands.empty()) add_option_names(*commands.front(), known);
  add_option_names(program, known);
  const std::string name = option->substr(0, option->find('='));
  return fmt::format("found {}, expected an option of goingrate{} ({})", name, command,
                     did_you_mean(name, known, fmt::format("goingrate{} --help", command)));
}

// The options that give the likeliest other readings of the log.
std::string other_readings(const goingrate::ImpossibleReading& error) {
  std::string text;
  for (const goingrate::OtherReading& other : error.others())
    text += fmt::format("  if {}: {}\n", other.words, goingrate::apps::options_for(other));
  return text;
}

void add_commands(CLI::App& program, const goingrate::apps::GlobalOptions& global) {
  using namespace goingrate;
  apps::add_simulate(program, global);
  apps::add_rate(program, global);
  apps::add_fit(program, global);
  apps::add_spectrum(program, global);
  apps::add_stability(program, global);
  apps::add_report(program, global);
  apps::add_map(program, global);
  apps::add_chart(program, global);
  apps::add_paper(program, global);
  apps::add_help(program);
}

// Reports a usage error, or prints the help that was asked for.
int explain(const CLI::App& program, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) {
    program.exit(error);
    return after_standard_output();
  }
  if (const auto unexpected = unexpected_word(program)) return complain(wrong_usage, *unexpected);
  const auto commands = program.get_subcommands();
  return complain(wrong_usage,
                  fmt::format("{} (goingrate{} --help lists the options)", error.what(),
                              commands.empty() ? "" : " " + commands.front()->get_name()));
}

// The message of an ArgumentError; an argument that came from an option gets its dashes.
std::string words_for(const goingrate::ArgumentError& error, const CLI::App& program) {
  for (const CLI::App* command : program.get_subcommands())
    if (command->get_option_no_throw("--" + error.name()) != nullptr)
      return std::string("--") + error.what();
  return error.what();
}

// Answers --complete (for the shell) and --man (for the build), which --help does not list.
bool answer_hidden(CLI::App& program, const std::vector<std::string>& words) {
  using namespace goingrate::apps;
  if (words.empty()) return false;
  if (words.front() == "--man") {
    std::fputs(manual_page(program).c_str(), stdout);
    return true;
  }
  if (words.front() != "--complete") return false;
  for (const std::string& word : completions(program, {words.begin() + 1, words.end()}))
    std::fputs((word + '\n').c_str(), stdout);
  return true;
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
    program.parse(argc, argv);
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
  apps::GlobalOptions global;
  program.add_flag("--quiet", global.quiet, "no notes on standard error");
  try {
    add_commands(program, global);
    return run(program, argc, argv);
  } catch (const ImpossibleReading& error) {
    return complain(bad_input, error.what(), other_readings(error));
  } catch (const InputError& error) {
    return complain(bad_input, error.what());
  } catch (const apps::UsageError& error) {
    return complain(wrong_usage, error.what());
  } catch (const NoStationarySwing& error) {
    return complain(no_result, error.what());
  } catch (const ArgumentError& error) {
    return complain(wrong_usage, words_for(error, program));
  } catch (const NumericsError& error) {
    return complain(no_result, error.what());
  } catch (const ClosedPipe&) { // the reader of standard output closed the pipe: no error
    return done;
  } catch (const OutputError& error) {
    return complain(no_output, error.what());
  } catch (const std::bad_alloc&) {
    return complain(bad_input, out_of_memory);
  } catch (const std::length_error&) { // a size beyond any memory
    return complain(bad_input, out_of_memory);
  } catch (const std::exception& error) {
    return complain(our_fault, error.what());
  }
}
