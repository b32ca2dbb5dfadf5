#include "unread_lines.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace goingrate::apps {

UnreadLines::UnreadLines(const std::string& folder) : path_(folder + "/.unread") {
  std::ifstream file(path_, std::ios::binary);
  text_.assign(std::istreambuf_iterator<char>(file), {});
  text_.resize(text_.rfind('\n') + 1); // a line that a failure of power tore
}

void UnreadLines::hold(std::string_view text) {
  const std::size_t end = text.rfind('\n') + 1;
  if (end <= text_.size()) return;
  const int file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  const std::string_view more = text.substr(text_.size(), end - text_.size());
  const bool is_safe = file >= 0 &&
                       ::pwrite(file, more.data(), more.size(), static_cast<off_t>(text_.size())) ==
                           static_cast<ssize_t>(more.size()) &&
                       ::fdatasync(file) == 0;
  const int error = errno;
  if (file >= 0) ::close(file);
  if (!is_safe) throw OutputError(path_, std::strerror(error));
  text_ += more;
}

void UnreadLines::clear() {
  if (text_.empty()) return;
  ::unlink(path_.c_str());
  text_.clear();
}

void UnreadLines::give_up() {
  constexpr std::ptrdiff_t most_lines = 400; // a log's reader looks no further
  if (std::count(text_.begin(), text_.end(), '\n') >= most_lines) clear();
}

} // namespace goingrate::apps
