#include "print_page.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace goingrate::apps {

namespace {

// Called in the child: does not return if the program exists.
void become(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words)
    arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execvp(arguments.front(), arguments.data());
}

[[noreturn]] void browse(const std::string& page, const std::string& pdf,
                         const std::string& profile) {
  const int nowhere = ::open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    ::dup2(nowhere, stream);
  for (const char* browser :
       {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable"}) {
    std::vector<std::string> words{"timeout",
                                   "-k",
                                   "5",
                                   "60",
                                   browser,
                                   "--headless",
                                   "--disable-gpu",
                                   "--no-pdf-header-footer",
                                   "--user-data-dir=" + profile,
                                   "--print-to-pdf=" + pdf,
                                   "file://" + page};
    if (::geteuid() == 0) words.insert(words.end() - 1, "--no-sandbox"); // else it refuses root
    if (std::system((std::string("command -v ") + browser + " > /dev/null").c_str()) == 0)
      become(std::move(words));
  }
  std::_Exit(127);
}

} // namespace

bool print_page(const std::string& page, const std::string& pdf) {
  std::error_code failed;
  const auto folder = std::filesystem::temp_directory_path(failed);
  std::string profile = (failed ? "/tmp" : folder.string()) + "/goingrate-print-XXXXXX";
  if (::mkdtemp(profile.data()) == nullptr) return false;
  const std::string draft = profile + "/page.pdf";
  const pid_t child = ::fork();
  if (child == 0) browse(std::filesystem::absolute(page).string(), draft, profile);
  int status = 0;
  while (child > 0 && ::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const bool is_made = child > 0 && status == 0 && std::filesystem::exists(draft, failed);
  const std::string beside = pdf + ".part";
  if (is_made) std::filesystem::copy_file(draft, beside, failed); // may be another file system
  if (is_made && !failed) std::filesystem::rename(beside, pdf, failed);
  std::error_code ignored;
  std::filesystem::remove_all(profile, ignored);
  return is_made && !failed;
}

} // namespace goingrate::apps
