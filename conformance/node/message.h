// A message in a buffer, and the circular buffers. (paper: The Network level)
#pragma once

#include <string.h>

#include "codec/generated/tinyos/am_header.h"
#include "codec/runtime/bytes.h"
#include "conformance/node/sizes.h"

namespace rubric {
namespace node {

/// The packet as it travels on the serial line: dispatch byte, AM header, payload. Messages for the
/// radio wait in the same form.
class Message {
 public:
  void set_header(uint16_t dest, uint16_t src, uint8_t type, size_t payload_bytes) {
    tinyos::AmHeader header;
    header.dispatch = tinyos::Dispatch::kActiveMessage;
    header.dest = dest;
    header.src = src;
    header.length = static_cast<uint8_t>(payload_bytes);
    header.type = type;
    Header::store(header, bytes_);
  }
  uint16_t dest() const { return Header::DestAt::load(bytes_); }
  uint16_t src() const { return Header::SrcAt::load(bytes_); }
  uint8_t type() const { return Header::TypeAt::load(bytes_); }
  Bytes packet() const { return Bytes(bytes_, kAmHeaderBytes + payload_bytes()); }
  Bytes payload() const { return Bytes(bytes_ + kAmHeaderBytes, payload_bytes()); }
  uint8_t* room() { return bytes_ + kAmHeaderBytes; }

  /// Sets, for a message that waits for the application, how many arrived before it, modulo 256.
  /// The group means nothing within the node.
  void set_arrival(uint8_t arrival) { Header::GroupAt::store(bytes_, arrival); }
  uint8_t arrival() const { return Header::GroupAt::load(bytes_); }

 private:
  using Header = tinyos::AmHeaderLayout;
  size_t payload_bytes() const { return Header::LengthAt::load(bytes_); }

  uint8_t bytes_[kAmHeaderBytes + kAmPayloadMax];
};
static_assert(sizeof(Message) <= kPaperMessageBytes, "a message is larger than the paper's");

/// The state of a circular buffer.
struct Ring {
  uint8_t room;
  uint8_t head;
  uint8_t count;
};

/// A circular buffer of messages, oldest first. Slots and state belong to somebody else, so that
/// buffers of all sizes share this code.
class Queue {
 public:
  Queue(Message* slots, Ring& ring) : slots_(slots), ring_(ring) {}

  bool empty() const { return ring_.count == 0; }
  bool full() const { return ring_.count == ring_.room; }
  uint8_t size() const { return ring_.count; }
  Message& operator[](uint8_t i) { return slots_[(ring_.head + i) % ring_.room]; }
  Message& front() { return slots_[ring_.head]; }
  /// Returns a place after the last; not when full.
  Message& push() { return (*this)[ring_.count++]; }
  void pop() {
    ring_.head = static_cast<uint8_t>((ring_.head + 1) % ring_.room);
    --ring_.count;
  }
  /// Removes the i-th oldest; the others keep their order.
  void erase(uint8_t i) {
    for (uint8_t k = i; k + 1 < size(); ++k) (*this)[k] = (*this)[static_cast<uint8_t>(k + 1)];
    --ring_.count;
  }
  void clear() { ring_.head = ring_.count = 0; }

 private:
  Message* slots_;
  Ring& ring_;
};

}  // namespace node
}  // namespace rubric
