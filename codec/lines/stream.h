// Bytes to and from a socket or a device, under deadlines.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "codec/lines/packet_line.h"
#include "codec/lines/time.h"
#include "codec/runtime/bytes.h"

namespace rubric::lines {

/// Owns a descriptor. -1: it is not open.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor() { close(); }

  int get() const { return fd_; }
  bool is_open() const { return fd_ >= 0; }
  void close();

 private:
  int fd_ = -1;
};

/// Both functions throw Broken if the other end is gone, and `write` if the time is
/// over.
class ByteStream {
 public:
  ByteStream() = default;
  /// Takes a descriptor, which does not block from now on.
  explicit ByteStream(Descriptor descriptor);

  void write(Bytes bytes, SteadyTime deadline);
  /// Writes without waiting and returns how many bytes went; 0: none.
  std::size_t write_some(Bytes bytes);
  /// As write(), but leaves the stream open if it fails, so that what came before can be read.
  void write_or_keep(Bytes bytes, SteadyTime deadline);
  /// Reads the bytes at hand, at most out.size(), and returns their number; 0 if the time is over
  /// first.
  std::size_t read(MutableBytes out, SteadyTime deadline);

  bool is_open() const { return descriptor_.is_open(); }
  void close() { descriptor_.close(); }
  /// Returns the descriptor, to wait for several at once. -1: it is not open.
  int fd() const { return descriptor_.get(); }
  /// Signals the other end of a connection that nothing more comes from here. Does nothing for a
  /// device.
  void end_output();

 private:
  void write_all(Bytes bytes, SteadyTime deadline, bool keep);
  std::size_t send_some(Bytes bytes) const;

  Descriptor descriptor_;
};

/// The host of an address that names none.
constexpr const char* kThisHost = "127.0.0.1";
/// An Internet address as the user wrote it.
struct HostPort {
  std::string host;
  std::uint16_t port = 0;
};
/// Parses "HOST:PORT", or a port alone, which is on this host. Throws std::invalid_argument.
HostPort read_host_port(std::string_view text);

/// Connects, trying until `deadline`. Throws Broken.
ByteStream connect_tcp(const HostPort& to, SteadyTime deadline);

/// A port that others connect to.
class Listener {
 public:
  /// Stores the address; binds it when first asked for a connection.
  explicit Listener(HostPort at) : at_(std::move(at)) {}
  /// Returns the next connection. Throws Broken if none comes before `deadline`.
  ByteStream accept(SteadyTime deadline);

 private:
  HostPort at_;
  Descriptor descriptor_;
};

class StreamLine : public PacketLine {
 public:
  /// Makes the connection before a deadline, or throws Broken.
  using Connect = std::function<ByteStream(SteadyTime deadline)>;
  explicit StreamLine(Connect connect) : connect_(std::move(connect)) {}

  bool open(SteadyTime deadline) override;
  void close() override { stream_.close(); }
  int fd() const override { return stream_.fd(); }

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
