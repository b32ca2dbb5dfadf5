#include "server.hpp"

#include "guarded_server.hpp"

#include "goingrate/base/errors.hpp"

#include <arpa/inet.h>
#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <fmt/format.h>
#include <functional>
#include <future>
#include <mutex>
#include <semaphore>
#include <thread>

namespace goingrate::apps {

ListenAddress parse_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  ListenAddress address;
  std::string port = text;
  if (colon != text.npos) {
    address.host = text.substr(0, colon);
    port = text.substr(colon + 1);
    if (address.host.starts_with('[') && address.host.ends_with(']')) // IPv6
      address.host = address.host.substr(1, address.host.size() - 2);
  }
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  const bool is_port = error == std::errc() && end == port.data() + port.size() &&
                       address.port >= 0 && address.port <= 65535;
  if (!is_port || address.host.empty())
    throw ArgumentError("listen", text, "HOST:PORT, such as 127.0.0.1:8080");
  return address;
}

namespace {

bool is_address(const std::string& host) {
  std::array<unsigned char, sizeof(in6_addr)> binary{};
  return ::inet_pton(AF_INET, host.c_str(), binary.data()) == 1 ||
         ::inet_pton(AF_INET6, host.c_str(), binary.data()) == 1;
}

// HOST, HOST:PORT or [HOST]:PORT without the port.
std::string without_port(const std::string& host) {
  if (host.starts_with('[')) return host.substr(1, host.find(']') - 1);
  return host.substr(0, host.rfind(':'));
}

bool is_this_computer(const std::string& host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

// Threads that answer, and as many connections that wait for one; further ones are not accepted
// until there is room, so that no client takes the files that the archive needs.
class BoundedPool : public httplib::TaskQueue {
public:
  explicit BoundedPool(int threads)
      : pool_(static_cast<std::size_t>(threads)), room_(2 * threads) {}
  void enqueue(std::function<void()> task) override {
    while (!room_.try_acquire_for(std::chrono::milliseconds(100)))
      if (ends_) return;
    pool_.enqueue([this, task = std::move(task)] {
      task();
      room_.release();
    });
  }
  void shutdown() override {
    ends_ = true;
    pool_.shutdown();
  }

private:
  httplib::ThreadPool pool_;
  std::counting_semaphore<> room_;
  std::atomic<bool> ends_ = false;
};

} // namespace

struct MonitorServer::Parts {
  using Field = std::string WatchAnswers::*;

  void serve(const char* path, Field field, const char* type) {
    server.Get(path, [this, field, type](const httplib::Request&, httplib::Response& response) {
      const std::lock_guard lock(mutex);
      response.set_content(answers.*field, type);
    });
  }

  // Sends an event every second, or a comment when nothing is new, so that a listener that has gone
  // is noticed.
  bool send_event(std::uint64_t& seen, httplib::DataSink& sink) {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, std::chrono::seconds(5), [&] { return ends || serial != seen; });
    if (ends) {
      sink.done();
      return true;
    }
    const std::string text = serial == seen ? ":\n\n" : "data: " + answers.now + "\n\n";
    seen = serial;
    lock.unlock();
    return sink.write(text.data(), text.size());
  }

  void serve_events() {
    server.Get("/events", [this](const httplib::Request&, httplib::Response& response) {
      constexpr int most_listeners = 16;
      if (listeners.fetch_add(1) >= most_listeners) {
        listeners.fetch_sub(1);
        response.status = 503;
        response.set_header("Retry-After", "10"); // as the page does
        return;
      }
      response.set_chunked_content_provider(
          "text/event-stream",
          [this, seen = std::uint64_t{0}](std::size_t, httplib::DataSink& sink) mutable {
            return send_event(seen, sink);
          },
          [this](bool) { listeners.fetch_sub(1); });
    });
  }

  void refuse_other_names() {
    server.set_pre_routing_handler(
        [](const httplib::Request& request, httplib::Response& response) {
          const std::string host = without_port(request.get_header_value("Host"));
          if (host.empty() || host == "localhost" || is_address(host))
            return httplib::Server::HandlerResponse::Unhandled;
          response.status = 403;
          return httplib::Server::HandlerResponse::Handled;
        });
  }

  void set_up(const std::string& host) {
    if (is_this_computer(host)) refuse_other_names();
    // A port at which another program listens counts as taken; the library would share it.
    server.set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    server.new_task_queue = [] { return new BoundedPool(threads); };
    server.set_default_headers(
        {{"Content-Security-Policy",
          "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
          "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
         {"X-Content-Type-Options", "nosniff"},
         {"Referrer-Policy", "no-referrer"},
         {"Cache-Control", "no-store"}});
    server.Get("/", [](const httplib::Request&, httplib::Response& response) {
      response.set_content(monitor_page, "text/html; charset=utf-8");
    });
    serve("/api/now", &WatchAnswers::now, "application/json");
    serve("/api/minutes", &WatchAnswers::minutes, "application/json");
    serve("/api/hours", &WatchAnswers::hours, "application/json");
    serve("/api/days", &WatchAnswers::days, "application/json");
    serve("/api/alarms", &WatchAnswers::alarms, "application/json");
    serve("/api/breaks", &WatchAnswers::breaks, "application/json");
    serve("/metrics", &WatchAnswers::metrics, "text/plain; version=0.0.4");
    serve_events();
  }

  static constexpr int threads = 64;            // a connection holds one
  GuardedServer server{threads / 2, "/events"}; // one address leaves half of them to others
  std::thread thread;
  std::mutex mutex;
  std::condition_variable changed;
  WatchAnswers answers;
  std::uint64_t serial = 0;
  bool ends = false;
  std::atomic<int> listeners = 0;
  int port = 0;
};

MonitorServer::MonitorServer(const ListenAddress& address) : parts_(std::make_unique<Parts>()) {
  parts_->set_up(address.host);
  parts_->port = address.port;
  const bool bound = address.port == 0
                         ? (parts_->port = parts_->server.bind_to_any_port(address.host)) > 0
                         : parts_->server.bind_to_port(address.host, address.port);
  if (!bound)
    throw OutputError(fmt::format("{}:{}", address.host, address.port),
                      "cannot listen there: the port is taken, or the address is not this "
                      "computer's");
  std::promise<void> ended;
  const auto end = ended.get_future();
  parts_->thread = std::thread([this, ended = std::move(ended)]() mutable {
    parts_->server.listen_after_bind();
    ended.set_value();
  });
  // A server that does not run yet cannot be stopped.
  while (!parts_->server.is_running() &&
         end.wait_for(std::chrono::milliseconds(1)) == std::future_status::timeout) {
  }
}

MonitorServer::~MonitorServer() {
  {
    const std::lock_guard lock(parts_->mutex);
    parts_->ends = true;
  }
  parts_->changed.notify_all();
  parts_->server.end();
  parts_->thread.join();
}

void MonitorServer::publish(const WatchAnswers& answers) {
  {
    const std::lock_guard lock(parts_->mutex);
    parts_->answers = answers;
    ++parts_->serial;
  }
  parts_->changed.notify_all();
}

int MonitorServer::port() const { return parts_->port; }

} // namespace goingrate::apps
