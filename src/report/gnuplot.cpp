#include "goingrate/report/gnuplot.hpp"

#include "gnuplot_script.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <memory>
#include <spawn.h>
#include <sstream>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace goingrate {

namespace {

// A file without a name, which disappears when it is closed, however the program ends.
class Scratch {
public:
  Scratch() : file_(std::tmpfile()) {
    if (!file_) throw OutputError("a temporary file", std::strerror(errno));
  }
  [[nodiscard]] int descriptor() const { return ::fileno(file_.get()); }
  void write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size() ||
        std::fflush(file_.get()) != 0)
      throw OutputError("a temporary file", std::strerror(errno));
    std::rewind(file_.get()); // the child that inherits it reads from its beginning
  }
  [[nodiscard]] std::string content() {
    std::rewind(file_.get());
    std::string text;
    std::array<char, 65536> piece{};
    while (const std::size_t read = std::fread(piece.data(), 1, piece.size(), file_.get()))
      text.append(piece.data(), read);
    return text;
  }

private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Closer> file_;
};

struct Outcome {
  bool ended_well = false, hung = false;
  std::string out, err;
};

// Standard streams are files, not pipes, so that neither side waits for the other.
class Streams {
public:
  Streams(const Scratch& in, const Scratch& out, const Scratch& err) {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawn_file_actions_adddup2(&actions_, in.descriptor(), STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions_, out.descriptor(), STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions_, err.descriptor(), STDERR_FILENO);
  }
  Streams(const Streams&) = delete;
  Streams& operator=(const Streams&) = delete;
  ~Streams() { ::posix_spawn_file_actions_destroy(&actions_); }
  [[nodiscard]] const posix_spawn_file_actions_t* actions() const { return &actions_; }

private:
  posix_spawn_file_actions_t actions_{};
};

// The child's exit status. A child that does not end in time is killed, and has no status.
std::optional<int> status_within(pid_t child, std::chrono::milliseconds patience) {
  using namespace std::chrono_literals;
  const auto end = std::chrono::steady_clock::now() + patience;
  for (auto pause = 1ms;; pause = std::min(2 * pause, 20ms)) { // a fifth of the usual time
    int status = 0;
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) throw OutputError("gnuplot", std::strerror(errno));
    if (std::chrono::steady_clock::now() > end) break;
    std::this_thread::sleep_for(pause);
  }
  ::kill(child, SIGKILL);
  while (::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
  return {};
}

// Runs gnuplot without a shell; nullopt if gnuplot is not installed.
std::optional<Outcome> run_gnuplot(std::string_view option, std::string_view script,
                                   std::chrono::milliseconds patience) {
  Scratch in, out, err;
  in.write(script);
  std::string program = "gnuplot";
  std::string argument(option);
  const std::array<char*, 3> arguments{program.data(), argument.data(), nullptr};
  pid_t child = 0;
  const int failed = ::posix_spawnp(&child, program.c_str(), Streams(in, out, err).actions(),
                                    nullptr, arguments.data(), environ);
  if (failed != 0) return std::nullopt;
  const auto status = status_within(child, patience);
  const bool ended_well = status && WIFEXITED(*status) && WEXITSTATUS(*status) == 0;
  return Outcome{ended_well, !status, out.content(), err.content()};
}

// The end of the text on one line, because the last part of a message says most.
std::string in_one_line(std::string_view text) {
  constexpr std::size_t most_characters = 400;
  std::string line;
  for (const char c :
       text.substr(text.size() > most_characters ? text.size() - most_characters : 0)) {
    const bool blank = static_cast<unsigned char>(c) <= ' ';
    if (!blank)
      line += c;
    else if (!line.empty() && line.back() != ' ')
      line += ' ';
  }
  return line.empty() ? "it did not say why" : line;
}

} // namespace

bool gnuplot_is_installed() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/bin:/usr/bin"); // a shell's default
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string program = (folder.empty() ? "." : folder) + "/gnuplot";
    struct stat status {};
    if (::stat(program.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
        ::access(program.c_str(), X_OK) == 0)
      return true;
  }
  return false;
}

std::optional<std::string> printed_figure(const std::vector<Figure>& figures, PrintFormat format,
                                          const std::string& target,
                                          std::chrono::milliseconds patience) {
  const bool pdf = format == PrintFormat::pdf;
  // -d: ignore the user's own settings, so that the figure looks as it should.
  const auto outcome =
      run_gnuplot("-d", pdf ? script_for_pdf(figures) : script_for_png(figures), patience);
  if (!outcome) return std::nullopt;
  if (outcome->hung)
    throw OutputError(target,
                      fmt::format("gnuplot was given up after {} s", patience.count() / 1000));
  const std::string_view begins = pdf ? "%PDF" : "\x89PNG";
  if (!outcome->ended_well || !outcome->out.starts_with(begins))
    throw OutputError(target, "gnuplot failed: " + in_one_line(outcome->err));
  return outcome->out;
}

} // namespace goingrate
