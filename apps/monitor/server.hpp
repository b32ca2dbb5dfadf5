// What a monitor shows on the network: read only.
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
/// Throws ArgumentError naming `option` for what is no such address.
ListenAddress parse_address(const std::string& text);

/// Serves the page, /api/…, /metrics and /events (server-sent events) from threads of its own. A
/// request may have 8 KiB and takes or gives at most ten seconds at a time; a connection that says
/// nothing for two is closed; at most sixteen listen to events, others are told to come again.
class MonitorServer {
public:
  /// Listens at once. Throws OutputError if the address cannot be had.
  explicit MonitorServer(const ListenAddress& address);
  ~MonitorServer();

  /// From now on these are given.
  void publish(WatchAnswers answers);
  /// The port, also where 0 asked for any.
  [[nodiscard]] int port() const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The page, one file that asks the server it came from.
extern const char* const monitor_page;

} // namespace goingrate::apps
