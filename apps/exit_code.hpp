// How the command ends, and why: one table for a command alone and for a job of a batch.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace goingrate::apps {

/// Exit codes that scripts rely on.
enum ExitCode {
  done = 0,
  our_fault = 1,
  wrong_usage = 2,
  bad_input = 3,
  no_result = 4,
  no_output = 5
};

/// What a command says where it cannot do what was asked.
struct Failure {
  ExitCode code = our_fault;
  std::string message;
  std::string advice{}; ///< whole lines of our own that follow
};

/// What the exception that is being handled means; to be called from a catch block. An argument
/// that is an option of the program's command is named by it: "--fix = 't0': must be ...".
Failure current_failure(const CLI::App* program = nullptr);

} // namespace goingrate::apps
