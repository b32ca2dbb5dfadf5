#include "plot.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/report/gnuplot.hpp"

#include <algorithm>
#include <array>
#include <filesystem>

namespace goingrate::apps {

namespace {

namespace fs = std::filesystem;

constexpr const char* missing_gnuplot =
    "PDF and PNG need gnuplot (package gnuplot-nox), SVG does not";

std::string extension(const std::string& path) {
  std::string text = fs::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_printed(const std::string& path) {
  return extension(path) == ".pdf" || extension(path) == ".png";
}

std::string wrong_extension(const std::string& path) {
  static constexpr std::array<std::string_view, 4> known{".svg", ".pdf", ".png", ".gp"};
  if (std::find(known.begin(), known.end(), extension(path)) != known.end()) return {};
  return "'" + path + "' must end in .svg, .pdf, .png or .gp";
}

} // namespace

CLI::Option* add_plot_option(CLI::App& command, std::string& path, const std::string& what) {
  return command
      .add_option("--plot", path, what + ": .svg, .pdf, .png, or .gp, a script for gnuplot")
      ->check(CLI::Validator(wrong_extension, "FILE"))
      ->each([](const std::string& given) {
        if (is_printed(given) && !gnuplot_is_installed()) throw OutputError(given, missing_gnuplot);
      });
}

std::string plotted(const std::string& path, const std::vector<Figure>& figures) {
  if (path.empty()) return {};
  if (figures.empty()) throw NumericsError("nothing to draw in " + path);
  if (extension(path) == ".svg") return stacked_svg(figures);
  if (extension(path) == ".gp") return gnuplot_script(figures, fs::path(path).stem().string());
  const auto format = extension(path) == ".pdf" ? PrintFormat::pdf : PrintFormat::png;
  auto drawn = printed_figure(figures, format, path);
  if (!drawn) throw OutputError(path, missing_gnuplot);
  return std::move(*drawn);
}

Analysis drawn_data(const NumberedLog& loaded) {
  Analysis data;
  data.rate = summarise_rates(loaded.good, loaded.nominal_period_s);
  data.beats.assign(loaded.good.begin(), loaded.good.end());
  data.log.has_amplitude = loaded.log.has_amplitude;
  data.fit.status = FitStatus::no_valid_model;
  return data;
}

std::vector<Figure> figures_named(const Analysis& data,
                                  std::initializer_list<std::string_view> ids) {
  std::vector<Figure> figures = report_figures(data);
  std::erase_if(figures, [&](const Figure& figure) {
    return std::find(ids.begin(), ids.end(), figure.id) == ids.end();
  });
  return figures;
}

std::string inside(const std::string& folder, const std::string& name) {
  std::error_code exists; // if something is wrong with it, writing will say so
  fs::create_directories(folder, exists);
  return (fs::path(folder) / name).string();
}

void add_figure(const std::string& folder, const std::string& name, const Figure& figure,
                Files& files) {
  const std::string path = inside(folder, name);
  files.emplace_back(path + ".svg", standalone_svg(figure));
  files.emplace_back(path + ".csv", figure_csv(figure));
  files.emplace_back(path + ".gp", gnuplot_script({figure}, name));
  if (auto pdf = printed_figure({figure}, PrintFormat::pdf, path + ".pdf"))
    files.emplace_back(path + ".pdf", std::move(*pdf));
  if (auto png = printed_figure({figure}, PrintFormat::png, path + ".png"))
    files.emplace_back(path + ".png", std::move(*png));
}

void tell_of_missing_gnuplot(const GlobalOptions& global) {
  if (!gnuplot_is_installed()) say(global, missing_gnuplot);
}

} // namespace goingrate::apps
