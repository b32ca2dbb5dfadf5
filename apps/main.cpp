// goingrate: the command. Each subcommand lives in a file of its own.
#include "common.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <iostream>
#include <string_view>

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

int complain(ExitCode code, const char* what) {
  std::fputs(fmt::format("goingrate: {}\n", what).c_str(), stderr); // lost if it cannot be written
  return code;
}

// Ctrl-C and its like leave no half file behind; the signal then does what it does.
extern "C" void end_by_signal(int number) {
  goingrate::discard_drafts();
  std::signal(number, SIG_DFL);
  std::raise(number);
}

void heed_signals() {
  std::signal(SIGPIPE, SIG_IGN); // a closed pipe is an output that cannot be written, not a crash
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(number, end_by_signal) == SIG_IGN)
      std::signal(number, SIG_IGN); // as nohup asks
}

// What --help and --version print.
bool standard_output_took_it() {
  std::cout.flush();
  return std::cout.good() && std::fflush(stdout) == 0;
}

} // namespace

int main(int argc, char** argv) {
  using namespace goingrate;
  heed_signals();
  CLI::App program{"Fits, diagnoses and simulates pendulum clocks from their timing logs.",
                   "goingrate"};
  program.set_version_flag("--version", "goingrate " GOINGRATE_VERSION);
  program.require_subcommand(1);
  program.fallthrough();
  apps::narrow_help(program);
  apps::GlobalOptions global;
  program.add_flag("--quiet", global.quiet, "no notes on standard error");
  try {
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
    if (argc == 1) { // somebody who looks what this is
      std::fputs(program.help().c_str(), stderr);
      return wrong_usage;
    }
    const std::string_view first(argv[1]);
    const auto all = program.get_subcommands([](const CLI::App*) { return true; });
    const auto has_name = [first](const CLI::App* command) { return command->get_name() == first; };
    if (!first.starts_with('-') && std::none_of(all.begin(), all.end(), has_name))
      return complain(wrong_usage,
                      fmt::format("'{}' is no command (--help lists them)", first).c_str());
    program.parse(argc, argv);
    return standard_output_took_it() ? done : complain(no_output, "cannot write standard output");
  } catch (const CLI::ParseError& error) {
    if (program.exit(error) != 0) return wrong_usage;
    return standard_output_took_it() ? done : complain(no_output, "cannot write standard output");
  } catch (const InputError& error) {
    return complain(bad_input, error.what());
  } catch (const ArgumentError& error) {
    return complain(wrong_usage, error.what());
  } catch (const apps::NumericsError& error) {
    return complain(no_result, error.what());
  } catch (const ClosedPipe&) {
    return no_output;
  } catch (const OutputError& error) {
    return complain(no_output, error.what());
  } catch (const std::exception& error) {
    return complain(our_fault, error.what());
  }
}
