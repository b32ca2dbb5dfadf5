#include "guarded_server.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <fmt/format.h>
#include <netdb.h>
#include <optional>
#include <poll.h>
#include <string_view>
#include <sys/socket.h>
#include <unistd.h>

namespace goingrate::apps {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t most_request_bytes = 8192; // what servers commonly take
constexpr std::chrono::seconds request_time{5};  // a modem sends that much in two
constexpr std::chrono::seconds answer_time{60};  // 600 kB, a long list, at 10 kB/s
constexpr std::chrono::seconds silence_time{10}; // in which a client takes nothing

int milliseconds_until(Clock::time_point end) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
  return static_cast<int>(std::max<std::int64_t>(0, left.count()));
}

bool becomes_ready(socket_t socket, short events, Clock::time_point end) {
  pollfd descriptor{socket, events, 0};
  return ::poll(&descriptor, 1, milliseconds_until(end)) > 0;
}

std::string address_of(socket_t socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  std::array<char, NI_MAXHOST> name{};
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
      ::getnameinfo(reinterpret_cast<sockaddr*>(&address), size, name.data(), name.size(), nullptr,
                    0, NI_NUMERICHOST) != 0)
    return {};
  return name.data();
}

// The request up to the empty line; nullopt for a client that is too slow or has gone. A request
// that is too long is cut at the limit, without an empty line.
std::optional<std::string> read_head(socket_t socket) {
  const auto end = Clock::now() + request_time;
  std::string head;
  std::array<char, most_request_bytes> piece{};
  while (head.find("\r\n\r\n") == head.npos) {
    if (head.size() >= most_request_bytes) return head;
    if (!becomes_ready(socket, POLLIN, end)) return {};
    const auto count = ::recv(socket, piece.data(), most_request_bytes - head.size(), MSG_DONTWAIT);
    if (count <= 0) return {};
    head.append(piece.data(), static_cast<std::size_t>(count));
  }
  return head;
}

// The request, or the status with which it is refused.
struct Asked {
  std::string path, passed_on;
  const char* refusal = nullptr;
};

bool is_alike(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return x == y || ((x ^ y) == 0x20 && (x | 0x20) >= 'a' && (x | 0x20) <= 'z');
  });
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

Asked asked_in(std::string_view head) {
  Asked asked;
  const auto refused = [&](const char* status) {
    asked.refusal = status;
    return asked;
  };
  if (head.find("\r\n\r\n") == head.npos) return refused("431 Request Header Fields Too Large");
  const std::string_view line = head.substr(0, head.find("\r\n"));
  const auto space = line.find(' '), last = line.rfind(' ');
  if (space == line.npos || last == space) return refused("400 Bad Request");
  const std::string_view method = line.substr(0, space);
  if (method != "GET" && method != "HEAD") return refused("405 Method Not Allowed");
  asked.path = line.substr(space + 1, last - space - 1);
  asked.passed_on = fmt::format("{} {} HTTP/1.1\r\nConnection: close\r\n", method, asked.path);
  for (head.remove_prefix(line.size() + 2); !head.starts_with("\r\n");) {
    const std::string_view field = head.substr(0, head.find("\r\n"));
    head.remove_prefix(field.size() + 2);
    const std::string_view name = field.substr(0, field.find(':'));
    const std::string_view value = trimmed(field.substr(std::min(field.size(), name.size() + 1)));
    if (is_alike(name, "Transfer-Encoding") || (is_alike(name, "Content-Length") && value != "0"))
      return refused("413 Content Too Large");
    if (is_alike(name, "Host")) asked.passed_on += fmt::format("Host: {}\r\n", value);
  }
  asked.passed_on += "\r\n";
  return asked;
}

// Gives the library the request, and the client the answer.
class Exchange : public httplib::Stream {
public:
  Exchange(socket_t socket, std::string_view request, bool is_endless)
      : socket_(socket), request_(request), is_endless_(is_endless) {}

  [[nodiscard]] bool is_readable() const override { return !request_.empty(); }
  [[nodiscard]] bool is_writable() const override {
    return becomes_ready(socket_, POLLOUT, end_of_patience());
  }
  ssize_t read(char* to, std::size_t size) override {
    const std::size_t count = std::min(size, request_.size());
    std::copy_n(request_.begin(), count, to);
    request_.remove_prefix(count);
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* text, std::size_t size) override {
    for (std::size_t done = 0; done < size;) {
      if (!becomes_ready(socket_, POLLOUT, end_of_patience())) return -1;
      const auto count = ::send(socket_, text + done, size - done, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count <= 0) return -1;
      done += static_cast<std::size_t>(count);
    }
    return static_cast<ssize_t>(size);
  }
  // Needed only by the library's log.
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  [[nodiscard]] socket_t socket() const override { return socket_; }

private:
  [[nodiscard]] Clock::time_point end_of_patience() const {
    const auto silent = Clock::now() + silence_time;
    return is_endless_ ? silent : std::min(silent, began_ + answer_time);
  }

  socket_t socket_;
  std::string_view request_;
  bool is_endless_;
  Clock::time_point began_ = Clock::now();
};

void refuse(socket_t socket, std::string_view status) {
  const std::string text = fmt::format(
      "HTTP/1.1 {}\r\nContent-Length: 0\r\nConnection: close\r\nRetry-After: 1\r\n\r\n", status);
  (void)::send(socket, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

// If it is closed with something left to read, a connection drops the answer that is on its way.
void close_politely(socket_t socket, bool may_wait) {
  ::shutdown(socket, SHUT_WR);
  const auto end = Clock::now() + std::chrono::milliseconds(may_wait ? 500 : 0);
  std::array<char, most_request_bytes> rest{};
  constexpr int most_pieces = 16;
  for (int piece = 0; piece < most_pieces; ++piece)
    if (!becomes_ready(socket, POLLIN, end) ||
        ::recv(socket, rest.data(), rest.size(), MSG_DONTWAIT) <= 0)
      break;
  ::close(socket);
}

} // namespace

void GuardedServer::answer(socket_t socket) {
  const auto head = read_head(socket);
  if (!head) return;
  const Asked asked = asked_in(*head);
  if (asked.refusal != nullptr) return refuse(socket, asked.refusal);
  Exchange exchange(socket, asked.passed_on, asked.path == endless_);
  bool is_closed = false;
  process_request(exchange, true, is_closed, nullptr);
}

// Whether the connection may be answered: false once the server is ending.
bool GuardedServer::take_in(socket_t socket) {
  const std::lock_guard lock(mutex_);
  if (!ends_) connections_.insert(socket);
  return !ends_;
}

// Called before the connection is closed, after which another may get its number.
void GuardedServer::let_go(socket_t socket) {
  const std::lock_guard lock(mutex_);
  connections_.erase(socket);
}

void GuardedServer::end() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    for (const socket_t socket : connections_) // what waits for it goes on at once, with a failure
      ::shutdown(socket, SHUT_RDWR);
  }
  stop();
}

bool GuardedServer::process_and_close_socket(socket_t socket) {
  if (!take_in(socket)) {
    ::close(socket);
    return false;
  }
  const std::string address = address_of(socket);
  const bool may_enter = shares_.enter(address, Clock::now());
  if (may_enter) {
    answer(socket);
    shares_.leave(address);
  } else {
    refuse(socket, "429 Too Many Requests");
  }
  let_go(socket);
  close_politely(socket, may_enter);
  return true;
}

} // namespace goingrate::apps
