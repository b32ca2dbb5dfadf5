#include "zip.hpp"

#include "base/inputs.hpp"
#include "base/printable.hpp"
#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <zip.h>

namespace goingrate {

namespace {

namespace fs = std::filesystem;

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, Discard>;

Archive open_archive(const std::string& path) {
  note_input(path);
  int code = 0;
  Archive archive(zip_open(path.c_str(), ZIP_RDONLY, &code));
  if (archive) return archive;
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string words = zip_error_strerror(&error);
  zip_error_fini(&error);
  throw InputError({path}, fmt::format("a ZIP that cannot be read ({})", words), "a whole ZIP");
}

struct Entry {
  std::string name;
  std::uint64_t bytes = 0;
};

// Nothing is written to disk, but no telephone writes such a name.
bool leads_out(std::string_view name) {
  if (name.empty() || name.front() == '/' || name.find('\\') != name.npos) return true;
  for (const fs::path& part : fs::path(name))
    if (part == "..") return true;
  return false;
}

Entry entry_at(zip_t* archive, const std::string& path, zip_uint64_t index) {
  zip_stat_t found;
  const bool is_known = zip_stat_index(archive, index, ZIP_FL_ENC_GUESS, &found) == 0 &&
                        (found.valid & ZIP_STAT_NAME) != 0 && (found.valid & ZIP_STAT_SIZE) != 0;
  if (!is_known) throw InputError({path}, "a damaged entry", "a whole ZIP");
  if (leads_out(found.name))
    throw InputError({path}, fmt::format("an entry named '{}'", printable(found.name)),
                     "names that stay inside the ZIP");
  return {found.name, found.size};
}

std::size_t depth_of(std::string_view name) {
  return static_cast<std::size_t>(std::count(name.begin(), name.end(), '/'));
}

bool is_hidden(const std::string& name) {
  return fs::path(name).filename().string().starts_with('.');
}

/// One entry, unpacked as it is read.
class ZipSource : public ByteSource {
public:
  ZipSource(Archive archive, std::string path, zip_uint64_t index, std::uint64_t bytes)
      : path_(std::move(path)), archive_(std::move(archive)), bytes_(bytes),
        file_(zip_fopen_index(archive_.get(), index, 0)) {
    if (file_ == nullptr)
      throw InputError({path_},
                       fmt::format("an entry that cannot be read ({})",
                                   zip_error_strerror(zip_get_error(archive_.get()))),
                       "one that is neither encrypted nor damaged");
  }
  ZipSource(const ZipSource&) = delete;
  ZipSource& operator=(const ZipSource&) = delete;
  ~ZipSource() override { zip_fclose(file_); }

  std::size_t read(char* to, std::size_t size) override {
    const zip_int64_t count = zip_fread(file_, to, size);
    if (count < 0 || taken_ + static_cast<std::uint64_t>(count) > bytes_)
      throw InputError({path_},
                       count < 0 ? "damaged ZIP data" : "more bytes than the ZIP says it has",
                       "a ZIP that unpacks");
    taken_ += static_cast<std::uint64_t>(count);
    return static_cast<std::size_t>(count);
  }
  [[nodiscard]] std::optional<std::uint64_t> size() const override { return bytes_; }
  [[nodiscard]] std::uint64_t taken() const override { return taken_; }

private:
  std::string path_;
  Archive archive_;
  std::uint64_t bytes_, taken_ = 0;
  zip_file_t* file_;
};

// Where the name of an entry begins in a path that goes on beyond a ZIP.
std::optional<std::size_t> entry_begins(const std::string& path) {
  std::error_code ignored;
  if (fs::exists(path, ignored)) return {};
  for (std::size_t at = path.find('/', 1); at != path.npos; at = path.find('/', at + 1))
    if (is_zip(path.substr(0, at))) return at + 1;
  return {};
}

void refuse_more_than(std::uint64_t limit, std::uint64_t bytes, const std::string& path) {
  if (bytes > limit)
    throw InputError({path}, fmt::format("a ZIP that unpacks to more than {} bytes", limit),
                     "no more, or a higher limit for what may be unpacked");
}

} // namespace

bool is_zip(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;
  std::string first(4, '\0');
  return std::ifstream(path, std::ios::binary).read(first.data(), 4) && first == "PK\x03\x04";
}

std::vector<std::string> files_in_zip(const std::string& path, std::uint64_t unpacked_limit) {
  constexpr zip_int64_t most_entries = 100'000;
  const Archive archive = open_archive(path);
  const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
  if (count > most_entries)
    throw InputError({path}, fmt::format("{} entries", count),
                     fmt::format("at most {}", most_entries));
  std::vector<Entry> files;
  std::size_t highest = std::numeric_limits<std::size_t>::max();
  for (zip_int64_t i = 0; i < count; ++i) {
    Entry entry = entry_at(archive.get(), path, static_cast<zip_uint64_t>(i));
    if (entry.name.ends_with('/') || is_hidden(entry.name)) continue;
    highest = std::min(highest, depth_of(entry.name));
    files.push_back(std::move(entry));
  }
  std::erase_if(files, [&](const Entry& entry) { return depth_of(entry.name) > highest; });
  std::vector<std::string> paths;
  std::uint64_t bytes = 0;
  for (const Entry& entry : files) {
    bytes += std::min(entry.bytes, std::numeric_limits<std::uint64_t>::max() - bytes);
    refuse_more_than(unpacked_limit, bytes, path);
    paths.push_back(path + "/" + entry.name);
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::unique_ptr<ByteSource> open_in_zip(const std::string& path, std::uint64_t unpacked_limit) {
  const auto begins = entry_begins(path);
  if (!begins) return nullptr;
  const std::string zip = path.substr(0, *begins - 1), name = path.substr(*begins);
  Archive archive = open_archive(zip);
  const zip_int64_t index = zip_name_locate(archive.get(), name.c_str(), ZIP_FL_ENC_GUESS);
  if (index < 0) throw InputError({zip}, "no file of that name in it", name);
  const Entry entry = entry_at(archive.get(), zip, static_cast<zip_uint64_t>(index));
  refuse_more_than(unpacked_limit, entry.bytes, path);
  return std::make_unique<ZipSource>(std::move(archive), path, static_cast<zip_uint64_t>(index),
                                     entry.bytes);
}

} // namespace goingrate
