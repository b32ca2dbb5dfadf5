// The read-only web server of a monitor.
#pragma once

#include "watch_json.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace goingrate::apps {

/// HOST:PORT.
struct ListenAddress {
  std::string host = "127.0.0.1";
  int port = 8080;
};
/// Throws ArgumentError naming `option` for anything else.
ListenAddress parse_address(const std::string& text);

/// Serves the page, /api/…, /metrics and /events (server-sent events) from 64 threads of its own,
/// of which one address has at most half; as many connections may wait for a thread. The cost of a
/// request is bounded (GuardedServer). At most sixteen clients listen to events, others are asked
/// to come again. If it listens to this computer alone, a request for a name other than localhost
/// or an address is refused, so that no page of the web can read it through a name of its own.
class MonitorServer {
public:
  /// Listens at once. Throws OutputError if the address cannot be used.
  explicit MonitorServer(const ListenAddress& address);
  /// Breaks off answers that are not finished.
  ~MonitorServer();

  /// Sets the answers from now on.
  void publish(const WatchAnswers& answers);
  /// The port, also where 0 asked for any.
  [[nodiscard]] int port() const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The page, one file that asks the server it came from.
extern const char* const monitor_page;

} // namespace goingrate::apps
