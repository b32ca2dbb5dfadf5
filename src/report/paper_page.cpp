// The paper's companion: section by section what the paper says, and what a new computation gives.
#include "goingrate/report/paper.hpp"

#include "markup.hpp"
#include "page.hpp"
#include "paper_chapters.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <span>

namespace goingrate {

namespace {

using paper::Chapter;
using paper::Equation;

template <class List> bool holds(const List& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

std::string equations_html(std::span<const Equation> equations) {
  std::string html;
  for (const Equation& equation : equations)
    if (!equation.math.empty())
      html += fmt::format("<div class=\"equation\"><math display=\"block\"><mrow>{}</mrow></math>"
                          "<span>({})</span></div>\n",
                          equation.math, equation.number);
  return html;
}

std::string number_cell(double value, double sigma, const std::string& unit) {
  if (std::isnan(value)) return "–";
  const std::string text = sigma > 0.0 ? measured(value, sigma) : plain_number(value, 7);
  return unit.empty() ? text : text + " " + unit;
}

std::string numbers_html(const Chapter& chapter, const PaperResults& results) {
  page::Table table("Numbers of this section",
                    {"", "where", "the paper", "by its method", "here", "why they differ"});
  for (const PaperNumber& number : results.numbers) {
    if (!holds(chapter.wheres, number.where)) continue;
    table.row({number.what, number.where, number.printed.empty() ? "–" : number.printed,
               number_cell(number.by_paper, 0.0, number.unit),
               number_cell(number.ours, number.sigma, number.unit), number.why});
  }
  return table.empty() ? "" : table.html();
}

std::string budget_html(const PaperResults& results) {
  page::Table table("The gain of clock C, part by part", {"part", "rate"});
  for (const BudgetPart& part : results.budget)
    table.row({part.what, typeset(fmt::format("{:+.4e}", part.rate))});
  return table.html();
}

std::string figures_html(const Chapter& chapter, const PaperResults& results) {
  std::string html;
  for (const PaperFigure& figure : results.figures) {
    if (!holds(chapter.figures, figure.name)) continue;
    html += fmt::format("<figure>\n<h3>{}</h3>\n{}<figcaption>{}</figcaption>\n</figure>\n",
                        escape_markup(figure.figure.title), svg(figure.figure),
                        escape_markup(figure.figure.caption));
  }
  return html;
}

// Equations are centred, with their names at the right.
constexpr std::string_view equation_style =
    ".equation{display:flex;align-items:center;gap:1rem;margin:.6rem 0}.equation math{flex:1;"
    "font-size:1.15rem}.equation span{color:var(--soft);font-size:.85rem}"
    "@media print{.equation,section>p{break-inside:avoid}}";

} // namespace

std::string paper_page(const PaperResults& results) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>Hoyng's paper, computed again</title>\n<style>{}{}{}</style>\n</head>\n<body>\n"
      "<header>\n<h1>Hoyng’s paper, computed again</h1>\n{}</header>\n<main>\n",
      page::style(), figure_style(), equation_style,
      page::paragraph("A companion to P. Hoyng, “Dynamics and performance of clock pendulums”. "
                      "Each section gives the paper’s equations by their numbers there, its figures "
                      "drawn from runs made now, and its numbers in three columns: as printed, by "
                      "the paper’s method, and by the full equation of motion. Where they "
                      "differ, the last column says why."));
  for (const Chapter& chapter : paper::chapters()) {
    std::string body = page::paragraph(chapter.words) + equations_html(chapter.equations) +
                       figures_html(chapter, results) + numbers_html(chapter, results);
    if (chapter.id == "circular") body += budget_html(results);
    html += page::section(chapter.id, chapter.title, body);
  }
  return html + "</main>\n</body>\n</html>\n";
}

} // namespace goingrate
