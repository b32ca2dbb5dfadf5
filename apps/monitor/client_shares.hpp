// How much of a server each client may have.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <unordered_map>

namespace goingrate::apps {

/// Counts the connections and the requests of every address, so that no client keeps others from
/// being answered. Of an IPv6 address the network counts, since a client may use any
/// address of its network.
class ClientShares {
public:
  using Time = std::chrono::steady_clock::time_point;

  /// One address may have `most_connections` at a time.
  explicit ClientShares(int most_connections) : most_connections_(most_connections) {}

  /// Whether a connection of the address may be answered now; then leave() must follow.
  bool enter(const std::string& address, Time now);
  void leave(const std::string& address);

private:
  struct Client {
    int connections = 0;
    double requests_left = 0.0;
    Time counted_at;
  };
  void forget_idle(Time now);

  int most_connections_;
  std::mutex mutex_;
  std::unordered_map<std::string, Client> clients_;
};

} // namespace goingrate::apps
