// The report as an HTML page: its skeleton, its style sheet and the order of its sections.
#include "goingrate/report/json.hpp"
#include "goingrate/report/report.hpp"

#include "embedded.hpp"
#include "markup.hpp"
#include "page.hpp"
#include "page_data.hpp"
#include "report_figures.hpp"
#include "wording.hpp"

#include <array>
#include <fmt/format.h>
#include <utility>

namespace goingrate {

namespace page {

Table::Table(std::string caption, std::vector<std::string> headings)
    : caption_(escape_markup(caption)) {
  for (const std::string& heading : headings)
    headings_.push_back(escape_markup(heading));
}

void Table::row(const std::vector<std::string>& cells) {
  // Cells up to this size are kept on one line: long enough for a number with its sigma.
  constexpr std::size_t unbroken_bytes = 36;
  rows_ += "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool is_value = cells[i].size() <= unbroken_bytes;
    // On a narrow screen, cells are stacked and each needs its column heading as a label.
    const std::string label = i > 0 && headings_.size() > 2 && i < headings_.size()
                                  ? " data-label=\"" + headings_[i] + "\""
                                  : "";
    rows_ +=
        i == 0 ? "<th scope=\"row\">" : (is_value ? "<td class=\"value\"" : "<td") + label + ">";
    rows_ += escape_markup(cells[i]) + (i == 0 ? "</th>" : "</td>");
  }
  rows_ += "</tr>\n";
}

std::string Table::html() const {
  std::string head;
  for (const std::string& heading : headings_)
    head += "<th scope=\"col\">" + heading + "</th>";
  return fmt::format("<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{0}\">\n"
                     "<table>\n<caption>{0}</caption>\n<thead><tr>{1}</tr></thead>\n"
                     "<tbody>\n{2}</tbody>\n</table>\n</div>\n",
                     caption_, head, rows_);
}

std::string section(std::string_view id, std::string_view title, std::string_view body) {
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, escape_markup(title),
                     body);
}

std::string paragraph(std::string_view text) {
  return fmt::format("<p>{}</p>\n", escape_markup(text));
}

} // namespace page

namespace {

// Light by default. The dark scheme changes colours only, and only on a screen: paper stays light.
constexpr std::string_view page_style = R"(
:root{color-scheme:light dark;--text:#1b1b1b;--soft:#555;--paper:#fff;--panel:#f4f4f1;--grid:#d9d9d9;--warn:#a33c00}
@media screen and (prefers-color-scheme:dark){:root{--text:#e8e6e3;--soft:#a9a6a1;--paper:#15171a;--panel:#1f2226;
--grid:#3a3f45;--warn:#f0a35e;--c0:#56B4E9;--c1:#E69F00;--c2:#2BC093;--c3:#DE9BC0;--c4:#E8702A;--c5:#7FA8FF;--c7:#fff}}
*{box-sizing:border-box}
body{margin:0 auto;padding:1rem;max-width:60rem;background:var(--paper);color:var(--text);font:1rem/1.5 system-ui,sans-serif}
h1{font-size:1.6rem;line-height:1.25;overflow-wrap:anywhere}
h2{font-size:1.25rem;margin:2rem 0 .5rem;border-bottom:1px solid var(--grid)}
h3{font-size:1.05rem;margin:1.2rem 0 .3rem}
a{color:inherit}
nav ul{display:flex;flex-wrap:wrap;gap:.2rem 1rem;margin:0;padding:0;list-style:none}
.says p{max-width:44rem;margin:.5rem 0}
.says p:first-child{font-size:1.2rem;line-height:1.4;font-weight:600}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(15rem,1fr));gap:.6rem;margin:.5rem 0}
.cards div{padding:.6rem .8rem;background:var(--panel)}
.cards dt{color:var(--soft);font-size:.85rem}
.cards dd{margin:0;font-size:.85rem;color:var(--soft)}
.cards strong{font-size:1.15rem;color:var(--text)}
.words dt{font-weight:600}.words dd{margin:0 0 .5rem;max-width:44rem}
.scroll{overflow-x:auto;margin:.8rem 0}
.scroll:focus-visible{outline:2px solid currentColor;outline-offset:2px}
table{border-collapse:collapse;font-size:.88rem;font-variant-numeric:tabular-nums}
caption{text-align:left;font-weight:600;padding-bottom:.2rem}
th,td{padding:.25rem .9rem .25rem 0;text-align:left;vertical-align:top;border-bottom:1px solid var(--grid)}
thead th{color:var(--soft);font-weight:600;vertical-align:bottom}
tbody th{font-weight:400}
.value{white-space:nowrap}
figure{margin:1.5rem 0}
figcaption{color:var(--soft);font-size:.88rem}
/* Each figure is a static drawing until page.js replaces it by an interactive one and marks what holds it as drawn.
Print shows the static one. */
.live{display:none;margin:.5rem 0;touch-action:pan-y}
.live:focus-visible{outline:2px solid currentColor;outline-offset:2px}
.hint{display:none;color:var(--soft);font-size:.88rem}
@media screen{.drawn .live,.hint.drawn{display:block}.drawn .still{display:none}
/* Panels that are drawn as one plot leave their titles and captions below it: each title leads its caption. */
.joint.drawn figure{margin:.4rem 0}.joint.drawn h3,.joint.drawn figcaption{display:inline;font-size:.88rem}
.joint.drawn h3::after{content:". "}}
.save{display:none;margin:.2rem 0;font-size:.88rem;color:var(--soft)}
button{font:inherit;color:var(--text);background:var(--panel);border:1px solid var(--grid);border-radius:3px;padding:.1rem .6rem}
button:hover{border-color:currentColor}
button:focus-visible,a:focus-visible{outline:2px solid currentColor;outline-offset:2px}
@media screen{.drawn .save{display:block}}
li{overflow-wrap:anywhere}td,th{overflow-wrap:break-word}
@media screen and (max-width:50rem){.value{white-space:normal}}
@media screen and (max-width:40rem){
table,thead,tbody,tr,th,td,caption{display:block}
thead{position:absolute;width:1px;height:1px;overflow:hidden;clip-path:inset(50%)}
tr{padding:.5rem 0;border-bottom:1px solid var(--grid)}
th,td{padding:.05rem 0;border:0}
tbody th{font-weight:600}
td[data-label]::before{content:attr(data-label) ": ";color:var(--soft)}}
.warning{padding:.6rem .8rem;border-left:4px solid var(--warn);background:var(--panel);font-weight:600}
@page{size:A4;margin:16mm}
@media print{body{max-width:none;padding:0;font-size:10pt}nav{display:none}
figure,tr,.cards div,.says p{break-inside:avoid}figure svg{max-height:8.6cm}
h2,h3,caption,thead,.words dt{break-after:avoid}tbody tr:first-child{break-before:avoid}.scroll{overflow:visible}.value{white-space:normal}}
)";

} // namespace

std::string_view page::style() { return page_style; }

namespace {

std::string figure_html(const Figure& figure, std::string_view live) {
  return fmt::format(
      "<figure aria-label=\"{0}\">\n<h3>{0}</h3>\n{1}<div class=\"still\">\n{2}</div>\n"
      "<figcaption>{3}</figcaption>\n</figure>\n",
      escape_markup(figure.title), live, svg(figure), escape_markup(figure.caption));
}

// The element in which page.js draws a plot, and its save buttons. The tabindex lets the element
// take the focus, without which it receives no key presses.
std::string live_place(const std::vector<Figure>& figures, std::size_t from, std::size_t to) {
  std::string titles;
  for (std::size_t i = from; i < to; ++i)
    titles += (i == from ? "" : "; ") + figures[i].title;
  return fmt::format("<div class=\"live\" tabindex=\"0\" role=\"group\" aria-label=\"{0}\"></div>\n"
                     "<p class=\"save\" role=\"group\" aria-label=\"Save: {0}\">Save as "
                     "<button type=\"button\" data-format=\"svg\">SVG</button> "
                     "<button type=\"button\" data-format=\"png\">PNG</button> "
                     "<button type=\"button\" data-format=\"csv\">CSV</button></p>\n",
                     escape_markup(titles));
}

constexpr std::string_view hint =
    "<p class=\"hint\">Drag across a figure to zoom (on a telephone, use the buttons above it); "
    "double-click to see everything again. With the keyboard, focus a figure: + and − zoom, ← and "
    "→ move, 0 shows "
    "everything. Figures that share the time axis zoom together. The axes are set by the bulk of "
    "the "
    "values; a triangle at the edge marks a value beyond them, which appears when you point at "
    "it.</p>\n";

std::string figures_section(const Analysis& data, const std::vector<Figure>& figures) {
  if (figures.empty())
    return page::section("figures", "Figures",
                         page::paragraph("The log is too short for figures."));
  std::string body = std::string(hint);
  if (const Wording words(data); words.is_dated())
    body += page::paragraph(
        fmt::format("Times in the figures count from the first beat, {}.", words.moment(0.0)));
  const std::vector<std::size_t> begins = plot_begins(figures);
  for (std::size_t p = 0; p + 1 < begins.size(); ++p) {
    const std::string live = live_place(figures, begins[p], begins[p + 1]);
    const bool is_single = begins[p + 1] - begins[p] == 1;
    if (!is_single) body += "<div class=\"joint\">\n" + live;
    for (std::size_t i = begins[p]; i < begins[p + 1]; ++i)
      body += figure_html(figures[i], is_single ? live : "");
    if (!is_single) body += "</div>\n";
  }
  return page::section("figures", "Figures", body);
}

// The summary: a paragraph for each sentence.
std::string sentences(const Analysis& data) {
  std::string html = "<div class=\"says\">\n";
  for (const std::string& sentence : report_sentences(data))
    html += page::paragraph(sentence);
  return html + "</div>\n";
}

// The whole report as JSON, for programs that are given only the page.
std::string json_element(const Analysis& data) {
  return fmt::format("<script type=\"application/json\" id=\"goingrate\">{}</script>\n",
                     report_json_for_script(data));
}

// The scripts go last in the page, so that its text is readable while a slow browser loads them.
std::string scripts(const std::vector<Figure>& figures) {
  if (plotly_script().empty() || figures.empty()) return {};
  return fmt::format("<script type=\"application/json\" id=\"figure-data\">{}</script>\n"
                     "<script>{}</script>\n<script>{}</script>\n<script>{}</script>\n",
                     page_data(figures), plotly_script(), series_script(), page_script());
}

// The browser must fetch nothing from a network, even if markup in a log got past the escaping. The
// page's own scripts and styles are inline; plotly.js makes its images as data: and blob: URLs.
constexpr std::string_view content_policy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; base-uri 'none'; form-action 'none'";

struct Part {
  std::string_view id, title;
  bool is_of_a_clock; ///< false for a pendulum that swings freely
};

constexpr std::array<Part, 8> parts{{{"key-figures", "Key figures", false},
                                     {"diary", "Diary", false},
                                     {"figures", "Figures", false},
                                     {"fit", "Fit", false},
                                     {"drive", "Drive", true},
                                     {"stability", "Stability", true},
                                     {"reading", "How the log was read", false},
                                     {"words", "Words", false}}};

std::string contents(const Analysis& data) {
  std::string html = "<nav aria-label=\"Contents\"><ul>\n";
  for (const Part& part : parts)
    if (!part.is_of_a_clock || !swings_freely(data))
      html += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", part.id, part.title);
  return html + "</ul></nav>\n";
}

} // namespace

std::string report_html(const Analysis& data) {
  const std::string name = escape_markup(file_name(data.log.source));
  std::string html =
      fmt::format("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                  "<meta http-equiv=\"Content-Security-Policy\" content=\"{4}\">\n"
                  "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
                  "<title>Clock report: {0}</title>\n<style>{1}{2}</style>\n</head>\n<body>\n"
                  "<header>\n<h1>Clock report: {0}</h1>\n{3}</header>\n<main>\n",
                  name, page::style(), figure_style(), contents(data), content_policy);
  const std::vector<Figure> figures = report_figures(data);
  html += page::section("summary", "What the log says", sentences(data));
  const bool is_clock = !swings_freely(data);
  html += page::key_figures(data) + page::diary(data) + figures_section(data, figures) +
          page::fit(data) + (is_clock ? page::drive(data) + page::stability(data) : "") +
          page::reading(data) + page::words();
  return html + "</main>\n" + json_element(data) + scripts(figures) + "</body>\n</html>\n";
}

} // namespace goingrate
