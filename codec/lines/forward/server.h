// A serial forwarder: passes packets of a source to all clients, and packets of clients to the
// source.
#pragma once

#include <poll.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "codec/lines/capture_file.h"
#include "codec/lines/forward/backlog.h"
#include "codec/lines/forward/client.h"
#include "codec/lines/forward/source.h"

namespace rubric::forward {

/// The source, the clients, and the delay that one client may cause.
struct ServerOptions {
  Source::Options source;
  std::string bind = "127.0.0.1";
  std::uint16_t port = 9002;                ///< 0: a free one.
  std::size_t clients_max = 64;             ///< Fewer where the system allows fewer descriptors.
  std::size_t backlog_bytes = 1024 * 1024;  ///< A client that is further behind is cut off.
  Client::Limits limits;                    ///< packet_max is the source's.
  bool reconnect = false;
  bool verbose = false;
  std::string write;  ///< A capture of what goes by; empty: none.
  lines::CaptureFile::Mode write_mode = lines::CaptureFile::Mode::kGrow;
  lines::Rotation rotation;
  std::function<bool(Bytes)> passes;  ///< Says which packets clients get; null: all.
};

/// Totals of the forwarded packets.
struct Counts {
  std::uint64_t from_source = 0;
  std::uint64_t malformed = 0;
  std::uint64_t withheld = 0;  ///< From the source, and not passed on.
  std::uint64_t to_source = 0;
  std::uint64_t unconfirmed = 0;
  std::uint64_t not_sent = 0;  ///< Taken from clients and never written.
  std::uint64_t served = 0;    ///< Clients.
  std::uint64_t cut_off = 0;
  std::uint64_t refused = 0;
};

/// Runs in one thread, which waits only for everything at once.
class Server {
 public:
  /// Listens from now on. Throws lines::Broken if that fails.
  explicit Server(const ServerOptions& options);

  /// Runs until asked to stop, or until the source is gone and is not to be opened again. Prints on
  /// stdout where it listens, once the source is open, and events on stderr. Returns false if the
  /// source is gone. Throws std::system_error if it cannot wait any more.
  bool run();
  /// Returns whether the capture is not whole; stderr has the reason.
  bool capture_failed() const { return capture_failed_; }
  const Counts& counts() const { return counts_; }

 private:
  using Time = lines::SteadyTime;

  Source::Handlers handlers();
  void on_packet(Bytes bytes);
  void on_given(bool confirmed);

  void announce();
  void open_source(Time now);
  void turn_source(short found, Time now);
  void connected();
  void lose_source(const std::string& why, Time now);
  void give_packets(Time now);

  void accept_clients(Time now);
  void admit(lines::Descriptor socket, Time now);
  bool make_room(Time now);
  bool end_most_silent(Time now);
  void write_clients(Time now);
  void remove_clients();
  void drain();

  void turn();
  bool write_due(Time now) const;
  std::optional<Time> next() const;
  /// Fills polled_: the listener, the source, the clients.
  void wait(std::optional<Time> until);

  ServerOptions options_;
  Counts counts_;
  std::optional<lines::CaptureFile> capture_;
  bool capture_failed_ = false;
  lines::Descriptor listener_;
  SocketAddress here_;
  Source source_;
  Backlog backlog_;
  std::vector<std::unique_ptr<Client>> clients_;
  std::vector<pollfd> polled_;
  std::size_t turn_ = 0;           // The client whose packet is next for the source.
  std::uint64_t written_end_ = 0;  // The backlog's end when clients were last written to.
  Time written_at_{};
  std::optional<Time> open_at_;    // The source is closed, and is to be opened then.
  std::optional<Time> accept_at_;  // There was no room for a connection; try again then.
  bool announced_ = false;
  bool lost_ = false;  // The source is gone, and that was said.
  bool over_ = false;
  bool unconfirmed_ = false;  // The mote does not confirm, and that was said.
  bool full_ = false;         // There are too many clients, and that was said.
};

}  // namespace rubric::forward
