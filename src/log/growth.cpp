#include "growth.hpp"

#include <algorithm>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

namespace goingrate {

namespace {
constexpr std::size_t remembered_bytes = 64; // bytes: some lines, which identify the log
}

void Growth::took(const char* bytes, std::size_t count, std::uint64_t end) {
  end_ = end;
  last_.append(bytes + (count - std::min(count, remembered_bytes)),
               std::min(count, remembered_bytes));
  last_.erase(0, last_.size() - std::min(last_.size(), remembered_bytes));
}

bool Growth::is_replaced(int descriptor, const std::string& path) {
  struct stat open {};
  struct stat named {};
  const bool there = ::fstat(descriptor, &open) == 0 && ::stat(path.c_str(), &named) == 0;
  return there && (open.st_ino != named.st_ino || open.st_dev != named.st_dev);
}

bool Growth::begins_anew(int descriptor, const std::string& path) const {
  if (is_replaced(descriptor, path)) return true;
  std::string now(last_.size(), '\0');
  const ssize_t count =
      ::pread(descriptor, now.data(), now.size(), static_cast<off_t>(end_ - last_.size()));
  return count >= 0 && now.substr(0, static_cast<std::size_t>(count)) != last_;
}

} // namespace goingrate
