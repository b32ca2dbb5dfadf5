// The exceptions of goingrate.
//
// Bad arguments throw ArgumentError, unusable input throws InputError, an output that cannot be
// written throws OutputError. Numerical outcomes (stalled, not converged) are not exceptions: they
// are a status in the result of the function concerned.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace goingrate {

/// A function was called with an argument outside its documented range.
class ArgumentError : public std::invalid_argument {
public:
  /// `name` of the argument, the `value` it had, and the `legal` values in words.
  ArgumentError(std::string_view name, double value, std::string_view legal);
  /// The same for a value that is text.
  ArgumentError(std::string_view name, std::string_view value, std::string_view legal);
  /// The argument.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const std::string& value() const noexcept { return value_; } ///< as in what()
  [[nodiscard]] const std::string& legal() const noexcept { return legal_; } ///< in words

private:
  std::string name_, value_, legal_;
};

/// Where in a text something was found. Lines and columns count from 1; 0 means "the whole file".
struct TextPlace {
  std::string file;
  std::size_t line = 0;
  std::size_t column = 0;
};

/// An input (log or scenario) cannot be used. what() reads "file:line:column: found X, expected Y".
class InputError : public std::runtime_error {
public:
  /// `found` and `expected` in words; `place` names at least the file.
  InputError(TextPlace place, std::string_view found, std::string_view expected);
  /// Where the fault was found.
  [[nodiscard]] const TextPlace& place() const noexcept { return place_; }

private:
  TextPlace place_;
};

/// An input was read, but no numerical result could be found from it.
class NumericsError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An output could not be written; the target, if it existed, is as it was.
class OutputError : public std::runtime_error {
public:
  /// `path` as the user gave it, `reason` in words.
  OutputError(std::string_view path, std::string_view reason);
};

/// The reader of a pipe has closed it, as `head` does: no message is needed.
class ClosedPipe : public OutputError {
public:
  using OutputError::OutputError;
};

} // namespace goingrate
