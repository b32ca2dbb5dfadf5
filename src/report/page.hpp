// The parts of the report's page. Every function returns HTML; texts from outside are escaped here.
#pragma once

#include "goingrate/report/report.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace goingrate::page {

/// A table that scrolls sideways on a narrow screen and can be reached by the keyboard. Cells are
/// plain text; the first of a row is its heading.
class Table {
public:
  Table(std::string caption, std::vector<std::string> headings);
  void row(const std::vector<std::string>& cells);
  [[nodiscard]] bool empty() const { return rows_.empty(); }
  [[nodiscard]] std::string html() const;

private:
  std::string caption_;
  std::vector<std::string> headings_;
  std::string rows_;
};

/// <section> with a heading; `id` is its anchor.
std::string section(std::string_view id, std::string_view title, std::string_view body);
std::string paragraph(std::string_view text);

/// A duration in the unit that suits it: "42.5 s", "8.02 h".
std::string duration_text(double seconds);

// Sections of the page about the log itself.
std::string key_figures(const Analysis& data);
std::string diary(const Analysis& data);
std::string stability(const Analysis& data);
std::string reading(const Analysis& data);

// Sections of the page about the model fitted to it.
std::string fit(const Analysis& data);
std::string drive(const Analysis& data);

/// The style sheet of all pages, except for their figures.
std::string_view style();

/// The glossary: the meanings of the page's words and symbols.
std::string words();

} // namespace goingrate::page
