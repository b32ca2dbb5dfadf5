#include "archive.hpp"

#include "day_columns.hpp"
#include "held_notes.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/log/reading.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fstream>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace goingrate::apps {

namespace {

constexpr std::string_view origin_words = "# the source's second 0: ";

[[noreturn]] void fail(const std::string& path) { throw OutputError(path, std::strerror(errno)); }

// Cuts a file after its last whole line: a power failure may leave part of a line, or zeros, at the
// end. Any other fault is left for a person to see.
void cut_torn_line(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t written = text.find_last_not_of('\0');
  const std::size_t end = written == text.npos ? text.npos : text.rfind('\n', written);
  const std::size_t whole = end == text.npos ? 0 : end + 1;
  if (whole < text.size() && ::truncate(path.c_str(), static_cast<off_t>(whole)) != 0) fail(path);
}

// A new file survives a power failure only once its entry in the folder is on disk.
void sync_folder(const std::string& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) fail(folder);
  const bool done = ::fsync(descriptor) == 0;
  ::close(descriptor);
  if (!done) fail(folder);
}

// Without this, the free memory that glibc holds back grows over years to half of that in use.
void give_back_free_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

// Whether the line is a row, whose time counts from 1970, and not a header.
bool is_event(const std::string& line) {
  return !line.empty() && line.front() >= '0' && line.front() <= '9';
}

bool is_day(const std::string& name) {
  return name.size() == 14 && name.ends_with(".csv") && name[4] == '-' && name[7] == '-';
}

} // namespace

std::string day_of(const Instant& time) {
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(static_cast<std::time_t>(time.seconds)));
}

HeardEvent as_stored(HeardEvent event) {
  double& width_s = event.values.width_s;
  if (!std::isnan(width_s)) {
    // A row has the leading edge, and its reader adds half of the width.
    width_s = std::strtod(format_instant(Instant::from_seconds(width_s), archive_decimals).c_str(),
                          nullptr);
    event.time = event.time + -0.5 * width_s;
  }
  if (const auto time = parse_instant(format_instant(event.time, archive_decimals)))
    event.time = *time;
  if (!std::isnan(width_s)) event.time = event.time + 0.5 * width_s;
  if (!std::isnan(event.amplitude_rad))
    event.amplitude_rad = std::strtod(fmt::format("{:.9g}", event.amplitude_rad).c_str(), nullptr);
  return event;
}

Archive::Archive(std::string folder) : folder_(std::move(folder)) {
  columns_.amplitude = true;
  columns_.decimals = archive_decimals;
  std::error_code failed;
  const bool is_new = std::filesystem::create_directories(folder_, failed);
  if (failed) throw OutputError(folder_, failed.message());
  if (is_new) sync_folder(std::filesystem::absolute(folder_).lexically_normal().parent_path());
  lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) fail(folder_);
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    throw OutputError(folder_, "another process is writing to this archive");
  }
  read_last_day();
}

Archive::~Archive() {
  close_day();
  if (lock_ >= 0) ::close(lock_);
}

void Archive::read_last_day() {
  const auto all = days();
  if (all.empty()) return;
  cut_torn_line(path_of(all.back()));
  // A day that was only begun may have no header or events yet.
  bool has_header = false;
  for (auto day = all.rbegin(); day != all.rend() && !last_time_; ++day) {
    const auto header = header_of(path_of(*day));
    if (header && !std::exchange(has_header, true)) columns_ = *header;
    if (!origin_) origin_ = origin_of_day(*day);
    if (const auto events = events_of(*day); !events.empty()) {
      last_time_ = events.back().time;
      last_edge_ = events.back().edge;
    }
  }
}

// The last origin that is noted in the day's file.
std::optional<Instant> Archive::origin_of_day(const std::string& day) const {
  std::optional<Instant> origin;
  std::ifstream file(path_of(day));
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(origin_words))
      origin = parse_instant(std::string_view(line).substr(origin_words.size()));
  return origin;
}

std::vector<std::string> Archive::days() const {
  std::vector<std::string> days;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    if (const std::string name = entry.path().filename().string(); is_day(name))
      days.push_back(name.substr(0, name.size() - 4));
  std::sort(days.begin(), days.end());
  return days;
}

std::vector<std::string> Archive::days_between(const std::string& after,
                                               const std::string& before) const {
  auto days = this->days();
  std::erase_if(days, [&](const std::string& day) { return !(day > after && day < before); });
  return days;
}

std::vector<Beat> Archive::events_of(const std::string& day) const {
  try {
    return read_log_file(path_of(day)).events;
  } catch (const InputError&) { // fewer events than a log has: read one by one
    return few_events_of(day);
  }
}

std::vector<Beat> Archive::few_events_of(const std::string& day) const {
  std::vector<Beat> events;
  try {
    LogFollower log(path_of(day), {}, [](std::string_view) { return false; });
    while (const auto event = log.next())
      events.push_back(*event);
  } catch (const InputError&) { // nothing but comments
  }
  return events;
}

std::string Archive::path_of(const std::string& day) const { return folder_ + "/" + day + ".csv"; }

void Archive::close_day() {
  if (file_ < 0) return;
  ::fdatasync(file_);
  ::close(file_);
  file_ = -1;
  unsynced_.clear();
  sync_failed_ = false;
}

void Archive::describe(const NativeColumns& columns) {
  columns_ = columns;
  columns_.amplitude = true;
  columns_.decimals = archive_decimals;
}

void Archive::open_day(const std::string& day) {
  sync(); // the day before; if this fails, the day stays open and the next event tries again
  close_day();
  give_back_free_memory();
  const std::string path = path_of(day);
  struct stat found {};
  const bool is_new = ::stat(path.c_str(), &found) != 0 || found.st_size == 0;
  if (!is_new) cut_torn_line(path);
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file_ < 0) fail(path);
  synced_bytes_ = ::lseek(file_, 0, SEEK_END);
  day_ = day;
  const auto header = header_of(path);
  if (header) {
    day_columns_ = *header;
  } else {
    day_columns_ = columns_;
    std::string head = native_log_header(columns_);
    if (origin_)
      head += fmt::format("{}{}\n", origin_words, format_instant(*origin_, archive_decimals));
    write_or_close(head);
    has_origin_ = true;
  }
  try {
    sync_folder(folder_);
  } catch (const OutputError&) { // the file itself may be lost, and the events in it
    close_day();
    throw;
  }
}

// Closes the day if its header cannot be written: no line may be in a file without a header.
void Archive::write_or_close(const std::string& header) {
  try {
    write(header);
  } catch (const OutputError&) {
    close_day();
    throw;
  }
}

// Writes whole lines by one call. If only a part can be written, the file is cut back to before it.
void Archive::write(const std::string& text) {
  struct stat before {};
  if (::fstat(file_, &before) != 0) fail(path_of(day_));
  if (before.st_nlink == 0) { // somebody removed it: the next event creates it again
    close_day();
    throw OutputError(path_of(day_), "the file was removed");
  }
  constexpr std::size_t max_unsynced_bytes = 4 << 20; // the lines of a day and a half
  if (sync_failed_ && unsynced_.size() + text.size() > max_unsynced_bytes)
    throw OutputError(path_of(day_),
                      "4 MB of earlier lines could not be saved to disk: no more are kept");
  is_synced_ = false;
  const auto written = ::write(file_, text.data(), text.size());
  if (written == static_cast<ssize_t>(text.size())) {
    unsynced_ += text;
    return;
  }
  const int error = written < 0 ? errno : ENOSPC;
  if (::ftruncate(file_, before.st_size) != 0) { // opening the day again cuts off the torn line
    close_day();
  }
  throw OutputError(path_of(day_), std::strerror(error));
}

void Archive::append(const HeardEvent& event) {
  const std::string day = day_of(event.time);
  if (file_ < 0 || day != day_) open_day(day);
  if (!has_origin_ && origin_) write_origin();
  std::string text;
  if (event.edge == Edge::down && !day_columns_.edge) // else it would be read as an upward one
    text = fmt::format("# down {}\n", format_instant(event.time, archive_decimals));
  else
    append_native_line(text, event, event.values, day_columns_);
  if (const auto words = words_of(beside(event.values, day_columns_)); !words.empty())
    text += fmt::format("# beside:{}\n", words);
  write(text);
  last_time_ = event.time;
  last_edge_ = event.edge;
}

void Archive::note(const std::string& text, const Instant& at) {
  if (file_ < 0) open_day(day_of(last_time_ && at < *last_time_ ? *last_time_ : at));
  write("# " + text + "\n");
}

std::vector<std::string> Archive::notes_of(const std::string& day) const {
  std::ifstream file(path_of(day));
  std::vector<std::string> notes;
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("# ")) notes.push_back(line.substr(2));
  return notes;
}

bool Archive::holds(const Instant& time) const {
  const auto events = events_of(day_of(time));
  return std::any_of(events.begin(), events.end(),
                     [&](const Beat& event) { return event.time == time; });
}

std::vector<std::string> Archive::last_notes() const {
  const auto all = days();
  std::vector<std::string> notes;
  bool has_event = false;
  for (auto day = all.rbegin(); day != all.rend() && !has_event; ++day) {
    std::vector<std::string> of_day;
    std::ifstream file(path_of(*day));
    for (std::string line; std::getline(file, line);)
      if (line.starts_with("# ")) {
        of_day.push_back(line.substr(2));
      } else if (is_event(line)) {
        has_event = true;
        of_day.clear();
      }
    notes.insert(notes.begin(), of_day.begin(), of_day.end());
  }
  return notes;
}

void Archive::set_origin(const Instant& origin) {
  origin_ = origin;
  has_origin_ = false;
}

void Archive::write_origin() {
  write(fmt::format("{}{}\n", origin_words, format_instant(*origin_, archive_decimals)));
  has_origin_ = true;
}

void Archive::sync() {
  if (is_synced_) return;
  if (file_ >= 0) {
    if (sync_failed_) write_unsynced_again();
    sync_failed_ = ::fdatasync(file_) != 0;
    if (sync_failed_) fail(path_of(day_));
    synced_bytes_ += static_cast<std::int64_t>(unsynced_.size());
    unsynced_.clear();
  }
  is_synced_ = true;
}

// After a failed sync the system regards its pages as clean, so the next sync would report success
// without having written them. Writing the same text to the same place makes them dirty again.
void Archive::write_unsynced_again() const {
  const std::string path = path_of(day_);
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC); // file_ can only append
  if (file < 0) fail(path);
  const auto written = ::pwrite(file, unsynced_.data(), unsynced_.size(), synced_bytes_);
  const int error = written < 0 ? errno : ENOSPC;
  ::close(file);
  if (written == static_cast<ssize_t>(unsynced_.size())) return;
  errno = error;
  fail(path);
}

} // namespace goingrate::apps
