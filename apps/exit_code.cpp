#include "exit_code.hpp"

#include "common.hpp"

#include "goingrate/analysis/batch.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/clock_run.hpp"

#include <exception>
#include <fmt/format.h>
#include <new>
#include <stdexcept>
#include <string_view>

namespace goingrate::apps {

namespace {

constexpr const char* out_of_memory =
    "this needs more memory than there is: take a part of the log (split it, or leave out every "
    "other line), or fewer periods or realisations at a time";

// The likeliest other readings, each with the options that choose it.
std::string other_readings(const ImpossibleReading& error) {
  std::string text;
  for (const OtherReading& other : error.others())
    text += fmt::format("  if {}: {}\n", other.words, options_for(other));
  return text;
}

// For an option that must be left out, a sentence that begins with the reason.
std::string words_for_option(const ArgumentError& error) {
  constexpr std::string_view leave_out = "left out: ";
  if (!error.legal().starts_with(leave_out)) return std::string("--") + error.what();
  return fmt::format("{}; leave --{} {} out", error.legal().substr(leave_out.size()), error.name(),
                     error.value());
}

std::string words_for(const ArgumentError& error, const CLI::App* program) {
  if (program == nullptr) return error.what();
  for (const CLI::App* command : program->get_subcommands())
    if (command->get_option_no_throw("--" + error.name()) != nullptr)
      return words_for_option(error);
  return error.what();
}

} // namespace

Failure current_failure(const CLI::App* program) {
  try {
    throw;
  } catch (const ImpossibleReading& error) {
    return {bad_input, error.what(), other_readings(error)};
  } catch (const InputError& error) {
    return {bad_input, error.what()};
  } catch (const UsageError& error) {
    return {wrong_usage, error.what()};
  } catch (const UnfinishedBatch& error) {
    return {wrong_usage, fmt::format("{}: --resume does the rest; delete that file to begin "
                                     "the batch again",
                                     error.what())};
  } catch (const NoStationarySwing& error) {
    return {no_result, error.what()};
  } catch (const ArgumentError& error) {
    return {wrong_usage, words_for(error, program)};
  } catch (const NumericsError& error) {
    return {no_result, error.what()};
  } catch (const OutputError& error) {
    return {no_output, error.what()};
  } catch (const std::bad_alloc&) {
    return {bad_input, out_of_memory};
  } catch (const std::length_error&) { // of a vector longer than any memory
    return {bad_input, out_of_memory};
  } catch (const std::exception& error) {
    return {our_fault, error.what()};
  }
}

} // namespace goingrate::apps
