// An HTTP server in which no client can use more than its share of memory, time and threads.
#pragma once

#include "client_shares.hpp"

#include <httplib.h>
#include <mutex>
#include <set>
#include <string>

namespace goingrate::apps {

/// Answers GET and HEAD, one request per connection. It reads the request itself: 8 KiB at most, in
/// five seconds at most, without a body. The library behind it sees only the path and the host: no
/// ranges, no encodings (MonitorServerTest).
class GuardedServer : public httplib::Server {
public:
  /// `most_connections` of one address are answered at a time. A path that is `endless` may be
  /// answered for as long as its client listens, any other for a minute.
  GuardedServer(int most_connections, std::string endless)
      : shares_(most_connections), endless_(std::move(endless)) {}

  /// Breaks every connection off and stops listening: nothing waits for a client any more, however
  /// slow it is (MonitorServerTest.NoClientHoldsTheEnd).
  void end();

private:
  bool process_and_close_socket(socket_t socket) override;
  void answer(socket_t socket);
  bool take_in(socket_t socket);
  void let_go(socket_t socket);

  ClientShares shares_;
  std::string endless_;
  std::mutex mutex_;
  std::set<socket_t> connections_; // being answered
  bool ends_ = false;
};

} // namespace goingrate::apps
