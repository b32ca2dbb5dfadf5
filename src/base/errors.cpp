#include "goingrate/base/errors.hpp"

#include "base/printable.hpp"

#include <fmt/format.h>

namespace goingrate {

ArgumentError::ArgumentError(std::string_view name, double value, std::string_view legal)
    : std::invalid_argument(printable(fmt::format("{} = {}: must be {}", name, value, legal))),
      name_(name), value_(fmt::format("{}", value)), legal_(legal) {}

ArgumentError::ArgumentError(std::string_view name, std::string_view value, std::string_view legal)
    : std::invalid_argument(printable(fmt::format("{} = '{}': must be {}", name, value, legal))),
      name_(name), value_(value), legal_(legal) {}

namespace {
std::string located(const TextPlace& place) {
  if (place.line == 0) return place.file; // the whole file
  return fmt::format("{}:{}:{}", place.file, place.line, place.column);
}
} // namespace

InputError::InputError(TextPlace place, std::string_view found, std::string_view expected)
    : std::runtime_error(
          printable(fmt::format("{}: found {}, expected {}", located(place), found, expected))),
      place_(std::move(place)) {}

OutputError::OutputError(std::string_view path, std::string_view reason)
    : std::runtime_error(printable(fmt::format("cannot write {}: {}", path, reason))) {}

} // namespace goingrate
