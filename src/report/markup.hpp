// Makes text safe inside HTML and XML, and typesets numbers.
#pragma once

#include <string>
#include <string_view>

namespace goingrate {

/// Escapes & < > " ', and replaces invalid UTF-8 and control characters other than newline and tab
/// by U+FFFD.
std::string escape_markup(std::string_view text);

/// The first whole characters of `text` that fit into `bytes`; if anything was cut off, an ellipsis
/// of three more bytes follows.
std::string shortened(std::string_view text, std::size_t bytes);

/// An integer as superscript digits.
std::string superscript(int number);

/// A number as C prints it ("-1.5e-07"), with typographic minus signs and powers of ten.
std::string typeset(std::string_view number);

/// `with_sigma`, typeset; "not known" for a value that is not finite.
std::string measured(double value, double sigma, int digits = 6);

/// `value` with `digits` significant digits, typeset; "not known" if it is not finite.
std::string plain_number(double value, int digits = 3);

} // namespace goingrate
