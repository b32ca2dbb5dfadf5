#include "leftovers.hpp"

#include <climits>
#include <fcntl.h>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <sys/file.h>
#include <unistd.h>

namespace goingrate {

namespace {

namespace fs = std::filesystem;

// No other program names its files like this, so that only our own files are removed.
constexpr std::string_view mark = ".part-goingrate-";
constexpr std::size_t letters = 6; // as mkostemp makes them

// The names of all drafts in a folder, whichever process wrote them.
std::set<std::string> drafts_in(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code unreadable; // then nothing is swept there
  for (fs::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
       entry.increment(unreadable)) {
    std::string name = entry->path().filename().string();
    if (name.find(mark) != std::string::npos) names.insert(std::move(name));
  }
  return names;
}

std::map<std::string, std::set<std::string>>& folders() {
  static auto& known = *new std::map<std::string, std::set<std::string>>; // outlives every draft
  return known;
}

void unlink_if_nobodys(const fs::path& draft) {
  const int file = ::open(draft.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return;
  if (::flock(file, LOCK_EX | LOCK_NB) == 0) ::unlink(draft.c_str());
  ::close(file);
}

} // namespace

std::string draft_prefix(const std::string& target) {
  const fs::path path(target);
  const std::size_t most = NAME_MAX - mark.size() - letters - std::string_view(old_suffix).size();
  const std::string name = path.filename().string().substr(0, most);
  return (path.parent_path() / name).string() + std::string(mark);
}

void sweep(const std::string& target) {
  const fs::path prefix(draft_prefix(target));
  const fs::path folder = prefix.parent_path().empty() ? "." : prefix.parent_path();
  auto known = folders().find(folder.string());
  if (known == folders().end()) known = folders().emplace(folder.string(), drafts_in(folder)).first;
  const std::string begins = prefix.filename().string();
  auto& names = known->second;
  for (auto name = names.lower_bound(begins); name != names.end() && name->starts_with(begins);
       name = names.erase(name)) {
    const std::string_view rest = std::string_view(*name).substr(begins.size());
    // The old file of an interrupted commit may be the only one there is.
    const bool old = rest.size() > letters && rest.substr(letters) == old_suffix;
    std::error_code unknown;
    if (rest.size() == letters || (old && fs::exists(target, unknown)))
      unlink_if_nobodys(folder / *name);
  }
}

void forget_folders() { folders().clear(); }

} // namespace goingrate
