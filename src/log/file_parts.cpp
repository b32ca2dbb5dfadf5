#include "file_parts.hpp"

#include "beginning.hpp"
#include "weather_quantities.hpp"
#include "zip.hpp"

#include "base/robust.hpp"
#include "sound/recording.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <set>

namespace goingrate {

namespace {

namespace fs = std::filesystem;

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
    std::error_code ignored;
    if (at->is_regular_file(ignored) && !at->path().filename().string().starts_with('.'))
      files.push_back(at->path().string());
  }
  if (failed) throw InputError({folder}, failed.message(), "a folder that you may read");
  std::sort(files.begin(), files.end());
  return files;
}

bool is_folder(const std::string& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

bool holds_weather(const Layout& layout) {
  return std::any_of(weather_quantities.begin(), weather_quantities.end(),
                     [&](const WeatherQuantity& quantity) { return layout.find(quantity.role); });
}

double usual_step_s(const std::vector<Beat>& events) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < events.size(); ++i)
    steps.push_back(events[i].time - events[i - 1].time);
  return steps.empty() ? 0.0 : median(steps);
}

bool has_names(const Layout& layout) {
  return std::any_of(layout.columns.begin(), layout.columns.end(),
                     [](const LogColumn& column) { return !column.name.empty(); });
}

/// Looks at the files, first each by itself, then by the others at those that do not tell.
class Looking {
public:
  explicit Looking(ReadingOptions options) : options_(std::move(options)) {
    options_.strict = false;
    options_.progress = nullptr;
  }

  std::vector<FilePart> run(const std::vector<std::string>& paths,
                            std::vector<Assumption>& assumptions) {
    for (const std::string& path : paths) {
      if (!holds_files(path)) {
        add(path, false);
        continue;
      }
      for (const std::string& file :
           is_zip(path) ? files_in_zip(path, options_.unpacked_limit) : files_in(path))
        add(file, true);
    }
    look_by_others();
    leave_weather_out(assumptions);
    leave_out(paths, assumptions);
    return std::move(parts_);
  }

private:
  struct Open { // a part that has no layout of its own yet, or none with names
    bool in_folder = false;
    std::exception_ptr fault; // why it is not a log by itself
  };

  void add(const std::string& path, bool in_folder) {
    std::error_code ignored;
    if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
      throw ArgumentError("log", path, "a regular file, as every one of several logs");
    if (path == "-") throw ArgumentError("log", path, "a file, as every one of several logs");
    if (!known_.insert(fs::weakly_canonical(path, ignored).string()).second)
      throw ArgumentError("log", path,
                          "named only once: it is named twice, or lies in a folder that is named");
    FilePart part;
    part.path = path;
    Open open{in_folder, nullptr};
    try {
      look_at(part, nullptr);
    } catch (const InputError&) {
      open.fault = std::current_exception();
    }
    parts_.push_back(std::move(part));
    open_.push_back(std::move(open));
  }

  // Reads the part's head by its own layout, or as if it had the layout `known`.
  void look_at(FilePart& part, const Layout* known) {
    LineReader lines(open_source(part.path, options_.unpacked_limit), part.path);
    const std::string_view head = lines.head(head_lines);
    part.lines_expected = lines.lines_expected();
    part.is_recording = is_sound(head);
    if (part.is_recording) return;
    ClockLog said;
    said.source = part.path;
    Layout layout;
    if (known != nullptr) {
      layout = *known;
      layout.first_line = part.layout.columns.empty() ? 1 : part.layout.first_line;
    } else {
      layout = settle_layout(head, lines.whole_is_in_head(), said, options_);
    }
    ClockLog log;
    log.source = part.path;
    RowReader rows(layout, options_, log);
    LineReader first(head, part.path);
    add_rows(first, rows, nullptr);
    const bool badly = known != nullptr ? 4 * rows.rejected() > rows.data_lines()
                                        : 2 * rows.rejected() > rows.data_lines();
    if (badly)
      throw InputError(
          log.place(layout.first_line),
          fmt::format("{} unusable lines out of {}", rows.rejected(), rows.data_lines()),
          "a log of which at least half can be read");
    part.layout = std::move(layout);
    part.said = std::move(said);
    part.step_s = usual_step_s(log.events);
    part.date = date_of(part.layout, log, rows);
  }

  // The date in the middle of the head: a logger's clock may not be set yet at its beginning.
  static std::optional<Instant> date_of(const Layout& layout, const ClockLog& log,
                                        const RowReader& rows) {
    std::vector<Instant> times;
    for (const Beat& event : log.events)
      times.push_back(event.time);
    for (const AngleSample& sample : rows.samples())
      times.push_back(sample.time);
    if (log.grid || times.empty()) return {};
    const Instant middle = times[times.size() / 2];
    return are_dates(layout, middle) ? std::optional(middle) : std::nullopt;
  }

  // The file to go by: one with names, or else the longest.
  [[nodiscard]] const FilePart* example() const {
    const FilePart* best = nullptr;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (open_[i].fault || parts_[i].is_recording) continue;
      if (has_names(parts_[i].layout)) return &parts_[i];
      if (best == nullptr || parts_[i].lines_expected > best->lines_expected) best = &parts_[i];
    }
    return best;
  }

  void look_by_others() {
    const FilePart* found = example();
    if (found == nullptr) return;
    const Layout layout = found->layout;
    constexpr std::size_t fewest_lines = 8; // enough to tell their layout
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      FilePart& part = parts_[i];
      const bool tells = !open_[i].fault && (has_names(part.layout) || !has_names(layout)) &&
                         part.lines_expected >= fewest_lines;
      if (tells || &part == found || part.is_recording) continue;
      if (!open_[i].fault && part.layout.columns.size() != layout.columns.size()) continue;
      try {
        look_at(part, &layout);
        open_[i].fault = nullptr;
      } catch (const InputError&) { // it stays what it was by itself
      }
    }
  }

  // Leaves out, from a folder, weather readings that are much rarer than another file's times.
  void leave_weather_out(std::vector<Assumption>& assumptions) {
    constexpr double times_rarer = 10.0;
    const auto is_beside_a_log = [&](std::size_t at) {
      for (std::size_t i = 0; i < parts_.size(); ++i)
        if (!open_[i].fault && parts_[i].step_s > 0.0 &&
            times_rarer * parts_[i].step_s < parts_[at].step_s)
          return true;
      return false;
    };
    std::vector<std::size_t> weather;
    for (std::size_t i = 0; i < parts_.size(); ++i)
      if (open_[i].in_folder && !open_[i].fault && holds_weather(parts_[i].layout) &&
          is_beside_a_log(i))
        weather.push_back(i);
    for (auto at = weather.rbegin(); at != weather.rend(); ++at) {
      assumptions.push_back({fmt::format("left out as the weather beside the log: {}",
                                         fs::path(parts_[*at].path).filename().string()),
                             Setting::weather, parts_[*at].path});
      parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(*at));
      open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(*at));
    }
  }

  void leave_out(const std::vector<std::string>& paths, std::vector<Assumption>& assumptions) {
    std::vector<FilePart> kept;
    std::exception_ptr first;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (!open_[i].fault) {
        kept.push_back(std::move(parts_[i]));
        continue;
      }
      if (!first) first = open_[i].fault;
      if (!open_[i].in_folder) std::rethrow_exception(open_[i].fault);
      try {
        std::rethrow_exception(open_[i].fault);
      } catch (const InputError& error) {
        assumptions.push_back({fmt::format("left out as no log: {}", error.what())});
      }
    }
    if (kept.empty() && parts_.size() == 1) std::rethrow_exception(first);
    if (kept.empty())
      throw InputError({paths.front()},
                       parts_.empty() ? "an empty folder or archive"
                                      : fmt::format("{} files, none of them a log", parts_.size()),
                       "logs of a clock");
    parts_ = std::move(kept);
    for (const FilePart& part : parts_)
      if (part.is_recording && parts_.size() > 1)
        throw InputError({part.path}, "a recording of sound among several files",
                         "one recording by itself: nothing says when another began");
  }

  ReadingOptions options_;
  std::set<std::string> known_; // paths
  std::vector<FilePart> parts_;
  std::vector<Open> open_; // one a part
};

// Refuses files some of which have dates, or days of one kind beside seconds of another: these are
// not times of one clock.
void refuse_mixed_dates(const std::vector<FilePart>& parts) {
  const FilePart& first = parts.front();
  const auto in_mjd = [](const FilePart& part) {
    const auto time = part.layout.find(ColumnRole::time);
    return time && part.layout.columns[*time].unit == in_days;
  };
  for (const FilePart& part : parts) {
    const TextPlace place{part.path, part.layout.first_line, 1};
    if (part.date.has_value() != first.date.has_value())
      throw InputError(place, part.date ? "dates" : "times without a date",
                       fmt::format("times as in {}", first.path));
    if (in_mjd(part) != in_mjd(first))
      throw InputError(place, in_mjd(part) ? "times in days (MJD)" : "times that are no MJD",
                       fmt::format("times as in {}", first.path));
  }
}

std::string names_of(const std::vector<FilePart>& parts) {
  constexpr std::size_t most_named = 5;
  std::string names;
  for (std::size_t i = 0; i < std::min(most_named, parts.size()); ++i)
    names += (i > 0 ? ", " : "") + fs::path(parts[i].path).filename().string();
  return parts.size() > most_named ? names + ", …" : names;
}

} // namespace

bool holds_files(const std::string& path) { return is_folder(path) || is_zip(path); }

std::vector<FilePart> file_parts(const std::vector<std::string>& paths,
                                 const ReadingOptions& options,
                                 std::vector<Assumption>& assumptions) {
  std::vector<FilePart> parts = Looking(options).run(paths, assumptions);
  refuse_mixed_dates(parts);
  const bool dated = parts.front().date.has_value();
  if (dated)
    std::stable_sort(parts.begin(), parts.end(),
                     [](const FilePart& a, const FilePart& b) { return *a.date < *b.date; });
  if (parts.size() > 1)
    assumptions.push_back(
        {fmt::format("{} files are one log, in the order {}: {}", parts.size(),
                     dated ? "of their dates" : "given, or of their names", names_of(parts))});
  return parts;
}

} // namespace goingrate
