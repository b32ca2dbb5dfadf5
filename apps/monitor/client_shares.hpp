// Limits on the connections and requests of each client of the server.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <unordered_map>

namespace goingrate::apps {

/// Counts connections and requests by client, so that none can keep the others from being answered.
/// A client is an IPv4 address or an IPv6 network (64 bits), since a client may use any address of
/// its network.
class ClientShares {
public:
  using Time = std::chrono::steady_clock::time_point;

  /// A client may have `most_connections` at a time.
  explicit ClientShares(int most_connections) : most_connections_(most_connections) {}

  /// Counts a new connection and returns true if it may be answered now. Then leave() must be
  /// called when it ends.
  bool enter(const std::string& address, Time now);
  void leave(const std::string& address);

private:
  struct Client {
    int connections = 0;
    double requests_left = 0.0;
    Time counted_at; // when requests_left was last updated
  };
  void forget_idle(Time now);

  int most_connections_;
  std::mutex mutex_;
  std::unordered_map<std::string, Client> clients_;
};

} // namespace goingrate::apps
