#include "markup.hpp"

#include "base/printable.hpp"
#include "goingrate/report/tables.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace goingrate {

namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD"; // U+FFFD

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

void append_escaped(std::string& out, char c) {
  switch (c) {
  case '&':
    out += "&amp;";
    return;
  case '<':
    out += "&lt;";
    return;
  case '>':
    out += "&gt;";
    return;
  case '"':
    out += "&quot;";
    return;
  case '\'':
    out += "&#39;";
    return;
  default:
    break;
  }
  const auto code = static_cast<unsigned char>(c);
  const bool control = (code < 0x20 && c != '\n' && c != '\t') || code == 0x7F;
  if (control)
    out += replacement;
  else
    out += c;
}

} // namespace

std::string escape_markup(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    if (length == 0)
      out += replacement;
    else if (length == 1)
      append_escaped(out, text[0]);
    else
      out += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

std::string shortened(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return std::string(text);
  while (bytes > 0 && continues(text[bytes]))
    --bytes; // never cut a character in two
  return std::string(text.substr(0, bytes)) + "…";
}

std::string superscript(int number) {
  static constexpr std::string_view digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out;
  for (const char c : fmt::format("{}", number))
    out += c == '-' ? std::string_view("⁻") : digits[c - '0'];
  return out;
}

std::string typeset(std::string_view number) {
  std::string out;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == '-') {
      out += "−";
    } else if (number[i] == 'e') {
      int exponent = 0;
      const bool negative = number.substr(i + 1, 1) == "-";
      if (negative || number.substr(i + 1, 1) == "+") ++i;
      for (; i + 1 < number.size() && number[i + 1] >= '0' && number[i + 1] <= '9'; ++i)
        exponent = 10 * exponent + (number[i + 1] - '0');
      out += "×10" + superscript(negative ? -exponent : exponent);
    } else {
      out += number[i];
    }
  }
  return out;
}

std::string measured(double value, double sigma, int digits) {
  if (!std::isfinite(value)) return "not known";
  return typeset(with_sigma(value, sigma, digits));
}

std::string plain_number(double value, int digits) {
  return measured(value, std::numeric_limits<double>::quiet_NaN(), digits);
}

} // namespace goingrate
