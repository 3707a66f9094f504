// The transport level of motes, sinks and base stations.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>

#include "conformance/selftest/lawful_traffic/message.h"

namespace rubric::lawful {

class World;

/// Sequence numbers, Connectionless with acks and timeouts, the message dispatcher.
class Endpoint {
 public:
  Endpoint(World& world, int number, std::uint16_t tos_id, std::string role);
  virtual ~Endpoint() = default;
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  Address address() const { return address_; }

  /// Connectionless.send. Returns the sequence number, or kNoSeq when the buffer is full.
  std::uint16_t send(Address dest, std::uint8_t app, const Octets& body, bool reliable);

 protected:
  /// Takes a complete message at the network level; returns false when its buffer is full.
  virtual bool route(const NetMessage& message) = 0;
  /// Handles a message in the application.
  virtual void on_app(const NetMessage& message);

  /// Passes a message that is for this node to transport and application.
  void arrived(const NetMessage& message);
  bool send_unreliable(Address dest, const Octets& payload);
  std::uint16_t fresh_seq();
  void forget_transport();
  void event(const std::string& name, const std::string& fields) const;

  World& world_;
  Address address_;

 private:
  struct Pending {
    Address dest;
    std::uint8_t app;
    Octets body;
    int tries;
    std::uint64_t token;  ///< Names the timer.
  };
  std::uint16_t send_message(Address dest, std::uint8_t app, const Octets& body, bool reliable,
                             int tries, int seq);
  void timed_out(std::uint16_t seq, std::uint64_t token);
  void send_ack(const NetMessage& message);
  void ack_arrived(const NetMessage& message);

  int number_;
  std::uint16_t tos_id_;
  std::string role_;
  std::uint16_t next_seq_;
  bool paper_acks_;
  std::deque<std::uint16_t> recent_;  ///< Not to be used again soon.
  std::map<std::uint16_t, Pending> pending_;
  std::uint64_t next_token_ = 0;
};

std::string address_fields(const char* prefix, Address address);

}  // namespace rubric::lawful
