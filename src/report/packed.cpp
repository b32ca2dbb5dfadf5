#include "packed.hpp"

#include "base/special_values.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

namespace goingrate {

namespace {

constexpr std::uint16_t missing_code = 65535;
constexpr double largest_code = 65534.0;

void append_bytes(std::string& bytes, std::uint64_t number, int count) {
  for (int i = 0; i < count; ++i)
    bytes += static_cast<char>((number >> (8 * i)) & 0xffU);
}

void append_block(std::string& bytes, std::span<const double> block) {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  for (const double value : block) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  if (least > greatest) least = greatest = 0.0;
  const double step = (greatest - least) / largest_code;
  append_bytes(bytes, std::bit_cast<std::uint64_t>(least), 8);
  append_bytes(bytes, std::bit_cast<std::uint64_t>(step), 8);
  for (const double value : block) {
    std::uint16_t number = missing_code;
    if (std::isfinite(value))
      number = step > 0.0 ? static_cast<std::uint16_t>(
                                std::clamp(std::round((value - least) / step), 0.0, largest_code))
                          : std::uint16_t{0};
    append_bytes(bytes, number, 2);
  }
}

std::string base64(const std::string& bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() / 3 * 4 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= count ? digits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

} // namespace

std::string packed(std::span<const double> values) {
  std::string bytes;
  bytes.reserve(2 * values.size() + 16 * (values.size() / packed_block + 1));
  for (std::size_t at = 0; at < values.size(); at += packed_block)
    append_block(bytes, values.subspan(at, std::min(packed_block, values.size() - at)));
  return base64(bytes);
}

std::vector<double> extremes(std::span<const double> values, std::size_t stretch) {
  std::vector<double> result;
  for (std::size_t from = 0; from < values.size(); from += stretch) {
    const auto part = values.subspan(from, std::min(stretch, values.size() - from));
    std::size_t low = part.size();
    std::size_t high = part.size();
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (!std::isfinite(part[i])) continue;
      if (low == part.size() || part[i] < part[low]) low = i;
      if (high == part.size() || part[i] > part[high]) high = i;
    }
    const bool known = low < part.size();
    result.push_back(known ? part[std::min(low, high)] : not_known);
    result.push_back(known ? part[std::max(low, high)] : not_known);
  }
  return result;
}

std::vector<double> quarters(std::span<const double> places, std::size_t stretch) {
  std::vector<double> result;
  for (std::size_t from = 0; from < places.size(); from += stretch) {
    const std::size_t count = std::min(stretch, places.size() - from);
    result.push_back(places[from + count / 4]);
    result.push_back(places[from + 3 * count / 4]);
  }
  return result;
}

} // namespace goingrate
