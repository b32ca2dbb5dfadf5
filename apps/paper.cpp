// goingrate paper: the paper's figures and numbers, computed again.
#include "plot.hpp"
#include "print_page.hpp"
#include "progress.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/report/paper.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <string>
#include <vector>

namespace goingrate::apps {

namespace {

struct PaperCommand {
  std::string folder;
  std::string figure;
  std::string json;
  PaperOptions paper;
};

// What the names of the figures begin with.
const std::vector<std::string> figure_names{
    "amplitude_phase", "modesc",  "rate",    "jump_zoom", "jump",      "quasistat",
    "noise",           "impulse", "optdriv", "moments",   "harmonics", "length"};

// Said at once: the figures take minutes.
void check_figure(const std::string& wanted) {
  for (const std::string& name : figure_names)
    if (name.starts_with(wanted) || wanted.starts_with(name)) return;
  throw ArgumentError("figure", wanted,
                      fmt::format("the beginning of {}", fmt::join(figure_names, ", ")));
}

void run(const PaperCommand& options, const GlobalOptions& global) {
  check_figure(options.figure);
  const bool in_folder = !options.folder.empty();
  check_writable({options.json, in_folder ? inside(options.folder, "paper.md") : ""});
  const PaperResults results = [&] {
    StepLine now(global.quiet, "computing the paper's figures and numbers");
    PaperOptions paper = options.paper;
    paper.now = [&](std::string_view what) { now(what); };
    return recompute_paper(paper);
  }();
  Files files{{options.json, paper_json(results)}};
  if (in_folder) {
    bool found = options.figure.empty();
    for (const PaperFigure& figure : results.figures) {
      if (!options.figure.empty() && !figure.name.starts_with(options.figure)) continue;
      found = true;
      add_figure(options.folder, figure.name, figure.figure, files);
    }
    tell_of_missing_gnuplot(global);
    if (!found) throw ArgumentError("figure", options.figure, "the beginning of a figure's name");
    files.emplace_back(inside(options.folder, "paper.md"), paper_text(results));
    files.emplace_back(inside(options.folder, "paper.html"), paper_page(results));
  }
  files.push_back({options.json == "-" ? "" : "-", paper_text(results)});
  write_whole_files(files);
  if (in_folder &&
      !print_page(inside(options.folder, "paper.html"), inside(options.folder, "paper.pdf")))
    say(global, "paper.pdf was not made: no Chromium or Chrome was found to print paper.html");
}

} // namespace

void add_paper(CLI::App& program, const GlobalOptions& global) {
  auto* command =
      program.add_subcommand("paper", "the paper's figures and numbers, by its method and by ours");
  auto options = std::make_shared<PaperCommand>();
  auto* folder = command->add_option(
      "-o,--output", options->folder,
      "folder for paper.html, a companion to the paper (paper.pdf where Chromium is "
      "installed), paper.md, and the figures (SVG, PDF, PNG, gnuplot, CSV)");
  auto* figure = command->add_option("--figure", options->figure,
                                     fmt::format("only the figures whose names begin with this: {}",
                                                 fmt::join(figure_names, ", ")));
  offers(figure, figure_names)->needs(folder);
  command->add_option("--periods", options->paper.periods,
                      "length of the noisy run, at least 10000; the paper's is 4774648");
  command->add_option("--seed", options->paper.seed, "seed of the driving noise")
      ->check(seed_range());
  add_json_option(*command, options->json);
  command->footer("Example:\n  goingrate paper -o paper --figure jump --periods 100000");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps
