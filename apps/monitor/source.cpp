#include "source.hpp"

#include "child.hpp"
#include "sound_events.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>
#include <utility>

namespace goingrate::apps {

namespace {

constexpr std::string_view sound_prefix = "arecord:";

struct Speed {
  int baud;
  speed_t code;
};
constexpr std::array speeds{Speed{1200, B1200},     Speed{2400, B2400},     Speed{4800, B4800},
                            Speed{9600, B9600},     Speed{19200, B19200},   Speed{38400, B38400},
                            Speed{57600, B57600},   Speed{115200, B115200}, Speed{230400, B230400},
                            Speed{460800, B460800}, Speed{921600, B921600}};

// The two parts of DEVICE:SPEED; both empty for other sources.
std::pair<std::string, std::string> serial_parts(const std::string& source) {
  const std::size_t colon = source.rfind(':');
  if (!source.starts_with("/dev/") || colon == source.npos) return {};
  return {source.substr(0, colon), source.substr(colon + 1)};
}

speed_t code_of(const std::string& speed) {
  for (const Speed& known : speeds)
    if (std::to_string(known.baud) == speed) return known.code;
  throw ArgumentError("the speed of the serial line", speed,
                      "one of 1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, "
                      "921600");
}

} // namespace

bool is_file(const std::string& source) {
  std::error_code unknown;
  return std::filesystem::is_regular_file(source == "-" ? "/dev/stdin" : source, unknown);
}

bool ends_for_good(const std::string& source) { return source == "-" || is_file(source); }

double lateness_of(const std::string& source) {
  return source.starts_with(sound_prefix) ? sound_lateness_s : 0.0;
}

void check_source(const std::string& source) {
  if (const auto [device, speed] = serial_parts(source); !device.empty()) (void)code_of(speed);
}

OpenSource::OpenSource(const std::string& source) : path_(source) {
  const auto [device, speed] = serial_parts(source);
  if (source.starts_with(sound_prefix))
    open_sound(source.substr(sound_prefix.size()));
  else if (!device.empty())
    open_serial(device, speed);
  else if (std::error_code unknown; std::filesystem::is_fifo(source, unknown))
    // Open for writing too: writers may come and go, and opening does not wait for the first one.
    held_ = ::open(source.c_str(), O_RDWR | O_CLOEXEC);
}

OpenSource::~OpenSource() {
  if (held_ >= 0) ::close(held_);
  if (listener_ > 0) {
    ::kill(listener_, SIGTERM);
    ::waitpid(listener_, nullptr, 0);
  }
}

// Raw, eight bits, no parity, no control lines, as microcontrollers write.
void OpenSource::open_serial(const std::string& device, const std::string& speed) {
  const speed_t code = code_of(speed);
  held_ = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  termios settings{};
  if (held_ < 0 || ::tcgetattr(held_, &settings) != 0)
    throw InputError({device}, std::strerror(errno), "a serial line");
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  ::cfsetispeed(&settings, code);
  ::cfsetospeed(&settings, code);
  if (::tcsetattr(held_, TCSANOW, &settings) != 0)
    throw InputError({device}, std::strerror(errno), "a serial line of that speed");
  path_ = device;
}

// A process of its own turns the sound into lines.
void OpenSource::open_sound(const std::string& device) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0)
    throw InputError({device}, std::strerror(errno), "a pipe");
  const pid_t parent = ::getpid();
  listener_ = ::fork();
  if (listener_ == 0) {
    stand_alone(pipe[1]);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL); // also where the monitor is killed
    if (::getppid() != parent) std::_Exit(1);
    std::_Exit(write_sound_events(device, pipe[1]));
  }
  ::close(pipe[1]);
  held_ = pipe[0];
  if (listener_ < 0) throw InputError({device}, std::strerror(errno), "a process");
  path_ = fmt::format("/dev/fd/{}", pipe[0]);
}

} // namespace goingrate::apps
