#include "client_shares.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>

namespace goingrate::apps {

namespace {

// A page asks for five things when it is opened and for one a second from then on. The limits allow
// twenty pages to be opened at the same moment.
constexpr double requests_a_second = 50.0, requests_at_once = 100.0;

// The part of an address that identifies a client: of an IPv6 address the network, its first half.
std::string client_of(const std::string& address) {
  std::array<char, sizeof(in6_addr)> binary{};
  if (::inet_pton(AF_INET6, address.c_str(), binary.data()) != 1) return address;
  const in6_addr* six = reinterpret_cast<const in6_addr*>(binary.data());
  if (IN6_IS_ADDR_V4MAPPED(six)) return address;
  return {binary.data(), binary.size() / 2};
}

double seconds(ClientShares::Time::duration time) {
  return std::chrono::duration<double>(time).count();
}

} // namespace

bool ClientShares::enter(const std::string& address, Time now) {
  const std::lock_guard lock(mutex_);
  constexpr std::size_t many_clients = 1024; // take 100 kB
  if (clients_.size() >= many_clients) forget_idle(now);
  const auto [found, is_new] = clients_.try_emplace(client_of(address));
  Client& client = found->second;
  const double since_s = is_new ? 0.0 : seconds(now - client.counted_at);
  client.requests_left =
      is_new ? requests_at_once
             : std::min(requests_at_once, client.requests_left + requests_a_second * since_s);
  client.counted_at = now;
  if (client.requests_left < 1.0 || client.connections >= most_connections_) return false;
  client.requests_left -= 1.0;
  ++client.connections;
  return true;
}

void ClientShares::leave(const std::string& address) {
  const std::lock_guard lock(mutex_);
  if (const auto found = clients_.find(client_of(address)); found != clients_.end())
    --found->second.connections;
}

// Forgets clients without a connection whose allowance is full again: new ones are treated alike.
void ClientShares::forget_idle(Time now) {
  constexpr double full_again_s = requests_at_once / requests_a_second;
  std::erase_if(clients_, [&](const auto& entry) {
    const Client& client = entry.second;
    return client.connections == 0 && seconds(now - client.counted_at) > full_again_s;
  });
}

} // namespace goingrate::apps
