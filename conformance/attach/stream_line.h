// What all lines have in common that are a stream of bytes.
#pragma once

#include <functional>
#include <utility>

#include "conformance/attach/packet_line.h"
#include "conformance/attach/stream.h"

namespace rubric::attach {

class StreamLine : public PacketLine {
 public:
  /// Makes the connection before a deadline, or throws runner::TargetBroken.
  using Connect = std::function<ByteStream(SteadyTime deadline)>;
  explicit StreamLine(Connect connect) : connect_(std::move(connect)) {}

  void open(SteadyTime deadline) override;
  void close() override { stream_.close(); }

 protected:
  /// The stream is new: what was read of an earlier one is nothing any more.
  virtual void begin(SteadyTime deadline) = 0;
  /// Bytes came.
  virtual void take(Bytes bytes) = 0;

  /// False when the time is over.
  bool read_some(SteadyTime deadline);
  /// Closes it, and throws runner::TargetBroken.
  [[noreturn]] void broken(const std::string& why);
  void put(Bytes bytes, SteadyTime deadline) { stream_.write(bytes, deadline); }

 private:
  Connect connect_;
  ByteStream stream_;
};

}  // namespace rubric::attach
