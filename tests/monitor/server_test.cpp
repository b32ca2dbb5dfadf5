#include "client_shares.hpp"
#include "server.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <chrono>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <sys/time.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace goingrate::apps {
namespace {

// A client that says what it likes.
class Client {
public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    const timeval patience{20, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  }
  Client(Client&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  ~Client() {
    if (socket_ >= 0) ::close(socket_);
  }

  // Whether all of it could be sent; some may still be in the sockets' buffers.
  [[nodiscard]] bool says(std::string_view text) const {
    while (!text.empty()) {
      const auto count = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
      if (count <= 0) return false;
      text.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }
  // How much of a text said again and again could be sent, up to 120 MB.
  [[nodiscard]] std::size_t floods(std::string_view text) const {
    std::size_t taken = 0;
    while (taken < 120'000'000 && says(text))
      taken += text.size();
    return taken;
  }
  // Up to so many bytes, or all there is.
  [[nodiscard]] std::string hears(std::size_t most = std::string::npos) const {
    std::string text;
    std::array<char, 4096> piece{};
    while (text.size() < most) {
      const auto count = ::recv(socket_, piece.data(), piece.size(), 0);
      if (count <= 0) break;
      text.append(piece.data(), static_cast<std::size_t>(count));
    }
    return text;
  }

private:
  int socket_;
};

std::size_t most_memory_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmHWM:") {
      std::size_t kilobytes = 0;
      status >> kilobytes;
      return kilobytes / 1024;
    }
  return 0;
}

class MonitorServerTest : public testing::Test {
protected:
  MonitorServerTest() : server_({"127.0.0.1", 0}) {
    WatchAnswers answers;
    answers.now = R"({"beats":7})";
    answers.minutes = std::string(10000, 'm');
    server_.publish(answers);
  }
  [[nodiscard]] std::string ask(const std::string& request) const {
    const Client client(server_.port());
    EXPECT_TRUE(client.says(request));
    return client.hears();
  }
  [[nodiscard]] std::string get(const std::string& path) const {
    return ask("GET " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }

  static constexpr std::size_t little_mb = 30; // 64 threads' stacks and buffers
  MonitorServer server_;
};

TEST_F(MonitorServerTest, Answers) {
  EXPECT_TRUE(get("/api/now").ends_with("{\"beats\":7}"));
  EXPECT_TRUE(get("/").starts_with("HTTP/1.1 200"));
  EXPECT_TRUE(get("/nothing").starts_with("HTTP/1.1 404"));
  EXPECT_TRUE(
      ask("GET /api/now HTTP/1.1\r\nHost: evil.example\r\n\r\n").starts_with("HTTP/1.1 403"));
  EXPECT_TRUE(
      ask("GET /api/now HTTP/1.1\r\nhOsT:  localhost \r\n\r\n").starts_with("HTTP/1.1 200"));
  EXPECT_TRUE(ask("nonsense\r\n\r\n").starts_with("HTTP/1.1 400"));
}

TEST_F(MonitorServerTest, APortIsListenedAtByOne) {
  EXPECT_THROW(MonitorServer({"127.0.0.1", server_.port()}), OutputError);
  EXPECT_TRUE(get("/").starts_with("HTTP/1.1 200")); // it answers still
}

TEST_F(MonitorServerTest, ARequestHasEightKilobytes) {
  const std::string megabyte(1 << 20, 'a');
  const std::size_t before = most_memory_mb();
  std::string many_fields;
  for (int i = 0; i < 10000; ++i)
    many_fields += "X-" + std::to_string(i) + ": " + std::string(90, 'b') + "\r\n";
  constexpr std::size_t socket_bytes = 16 << 20; // what sockets of a computer may hold
  for (const auto& [begin, goes_on] : {std::pair<std::string, std::string>{"GET /", megabyte},
                                       {"GET / HTTP/1.1\r\nHost: localhost\r\nX: ", megabyte},
                                       {"GET / HTTP/1.1\r\nHost: localhost\r\n", many_fields}}) {
    const Client client(server_.port());
    EXPECT_TRUE(client.says(begin));
    EXPECT_LT(client.floods(goes_on), socket_bytes) << begin;
  }
  const std::string full = "GET /api/now HTTP/1.1\r\nHost: localhost\r\nX: ";
  EXPECT_TRUE(ask(full + std::string(8000, 'a') + "\r\n\r\n").starts_with("HTTP/1.1 200"));
  EXPECT_TRUE(ask(full + std::string(9000, 'a') + "\r\n\r\n").starts_with("HTTP/1.1 431"));
  EXPECT_LT(most_memory_mb(), before + little_mb);
}

TEST_F(MonitorServerTest, NoRequestHasABody) {
  const std::size_t before = most_memory_mb();
  const std::string part = "100000\r\n" + std::string(1 << 20, 'z') + "\r\n";
  for (const char* field : {"Transfer-Encoding: chunked", "Content-Length: 1000000000"})
    for (const std::string method : {"GET", "POST"}) {
      const Client client(server_.port());
      EXPECT_TRUE(
          client.says(method + " /api/now HTTP/1.1\r\nHost: localhost\r\n" + field + "\r\n\r\n"));
      EXPECT_TRUE(client.hears(12).starts_with(method == "GET" ? "HTTP/1.1 413" : "HTTP/1.1 405"));
      EXPECT_LT(client.floods(part), 16U << 20);
    }
  EXPECT_LT(most_memory_mb(), before + little_mb);
}

TEST_F(MonitorServerTest, AnAnswerIsGivenWholeAndOnce) {
  std::string ranges = "0-";
  for (int i = 1; i < 1500; ++i)
    ranges += ",0-";
  const std::size_t before = most_memory_mb();
  const std::string answer =
      ask("GET /api/minutes HTTP/1.1\r\nHost: localhost\r\nRange: bytes=" + ranges + "\r\n\r\n");
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200"));
  EXPECT_LT(answer.size(), 11000U); // 10,000 and a head
  EXPECT_LT(most_memory_mb(), before + little_mb);
}

TEST_F(MonitorServerTest, AHeadIsNoListener) {
  for (int i = 0; i < 20; ++i)
    EXPECT_TRUE(
        ask("HEAD /events HTTP/1.1\r\nHost: localhost\r\n\r\n").starts_with("HTTP/1.1 200"));
  const Client listener(server_.port());
  EXPECT_TRUE(listener.says("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  EXPECT_TRUE(listener.hears(12).starts_with("HTTP/1.1 200"));
}

// Sixteen may listen; one more is told to ask again, and is let in when another has gone.
TEST_F(MonitorServerTest, OneListenerTooManyIsToldToWait) {
  const std::string request = "GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n";
  std::vector<Client> listeners;
  for (int i = 0; i < 16; ++i) {
    listeners.emplace_back(server_.port());
    EXPECT_TRUE(listeners.back().says(request));
    EXPECT_TRUE(listeners.back().hears(12).starts_with("HTTP/1.1 200")) << i;
  }
  {
    const Client one_more(server_.port());
    EXPECT_TRUE(one_more.says(request));
    ASSERT_TRUE(one_more.hears(12).starts_with("HTTP/1.1 503"));
  }
  const std::string refusal = ask(request);
  EXPECT_NE(refusal.find("Retry-After: 10"), std::string::npos) << refusal;
  EXPECT_TRUE(get("/api/now").ends_with("{\"beats\":7}")); // one that is refused may ask for this
  listeners.pop_back();
  bool is_let_in = false;
  for (int second = 0; second < 60 && !is_let_in; ++second) { // what is sent every five shows who has gone
    const Client next(server_.port());
    EXPECT_TRUE(next.says(request));
    is_let_in = next.hears(12).starts_with("HTTP/1.1 200");
    if (!is_let_in) std::this_thread::sleep_for(std::chrono::seconds(1));
  }
  EXPECT_TRUE(is_let_in);
}

// Clients that stop in the middle of a request, that listen to events, that do not read their answer.
TEST(MonitorServerEndTest, NoClientHoldsTheEnd) {
  auto server = std::make_unique<MonitorServer>(ListenAddress{"127.0.0.1", 0});
  WatchAnswers answers;
  answers.minutes = std::string(16'000'000, 'm'); // more than sockets hold
  server->publish(answers);
  std::vector<Client> clients;
  for (const char* request : {"G", "GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n",
                              "GET /api/minutes HTTP/1.1\r\nHost: localhost\r\n\r\n"})
    for (int i = 0; i < 10; ++i) {
      clients.emplace_back(server->port());
      EXPECT_TRUE(clients.back().says(request));
    }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const auto began = std::chrono::steady_clock::now();
  server.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20)); // a busy computer
}

// A client that sends a byte at a time must not keep a thread: a request has to come within 5 s.
TEST_F(MonitorServerTest, ARequestHasFiveSeconds) {
  const Client client(server_.port());
  const auto began = std::chrono::steady_clock::now();
  while (client.says("G") && std::chrono::steady_clock::now() - began < std::chrono::minutes(1))
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(30)); // a busy computer
}

TEST_F(MonitorServerTest, AnAddressIsRefusedBeyondItsShare) {
  std::vector<Client> slow;
  for (int i = 0; i < 60; ++i) {
    slow.emplace_back(server_.port());
    (void)slow.back().says("G");
  }
  const auto refused = std::count_if(slow.begin(), slow.end(), [](const Client& client) {
    return client.hears(12).starts_with("HTTP/1.1 429");
  });
  EXPECT_GE(refused, 1);                                    // a refusal can be lost on its way
  EXPECT_TRUE(get("/api/now").starts_with("HTTP/1.1 200")); // once the slow ones are given up
}

TEST(ClientSharesTest, AnAddressHasItsShare) {
  ClientShares shares(3);
  const ClientShares::Time start{};
  const auto asks = [&](const std::string& address, double after_s) {
    const auto at = start + std::chrono::milliseconds(static_cast<int>(after_s * 1000.0));
    const bool may_enter = shares.enter(address, at);
    if (may_enter) shares.leave(address);
    return may_enter;
  };
  for (int i = 0; i < 100; ++i)
    EXPECT_TRUE(asks("10.0.0.1", 0.0)) << i;
  EXPECT_FALSE(asks("10.0.0.1", 0.0));
  EXPECT_TRUE(asks("10.0.0.2", 0.0)); // another's
  for (int i = 0; i < 5; ++i)         // fifty a second
    EXPECT_TRUE(asks("10.0.0.1", 0.1)) << i;
  EXPECT_FALSE(asks("10.0.0.1", 0.1));
  for (const char* address : {"2001:db8::1", "2001:db8::2", "2001:db8::3"})
    EXPECT_TRUE(shares.enter(address, start));
  EXPECT_FALSE(shares.enter("2001:db8::4", start)); // of the same network
  EXPECT_TRUE(shares.enter("2001:db8:0:1::1", start));
  shares.leave("2001:db8::2");
  EXPECT_TRUE(shares.enter("2001:db8::4", start));
}

} // namespace
} // namespace goingrate::apps
