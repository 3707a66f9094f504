// The common part of all lines that are a stream of bytes.
#pragma once

#include <functional>
#include <utility>

#include "codec/lines/packet_line.h"
#include "codec/lines/stream.h"

namespace rubric::lines {

class StreamLine : public PacketLine {
 public:
  /// Makes the connection before a deadline, or throws Broken.
  using Connect = std::function<ByteStream(SteadyTime deadline)>;
  explicit StreamLine(Connect connect) : connect_(std::move(connect)) {}

  bool open(SteadyTime deadline) override;
  void close() override { stream_.close(); }

 protected:
  /// Starts a new stream and drops what was read from an earlier one.
  virtual void begin(SteadyTime deadline) = 0;
  /// Takes bytes.
  virtual void take(Bytes bytes) = 0;

  /// Reads some bytes. Returns false when the time is over.
  bool read_some(SteadyTime deadline);
  /// Closes it, and throws Broken.
  [[noreturn]] void broken(const std::string& why);
  void put(Bytes bytes, SteadyTime deadline) { stream_.write(bytes, deadline); }

 private:
  Connect connect_;
  ByteStream stream_;
};

}  // namespace rubric::lines
