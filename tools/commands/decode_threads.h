// Decodes the packets of a long capture in several threads.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "codec/containers/packet.h"
#include "tools/cli/specs.h"
#include "tools/format/buffer.h"
#include "tools/format/record.h"

namespace rubric::tools {

/// What decoding some frames, one after the other, gave.
struct DecodedPart {
  std::uint64_t frames = 0;
  std::uint64_t malformed = 0;
  std::uint64_t shown = 0;
  bool bad = false;  ///< A frame was malformed, or noted where --strict is given.
  std::vector<cli::OtherSpecs::Hint> hints;
};

/// Keeps packets in batches, lets threads decode one batch each, and passes on what each batch gave
/// in the order of the packets.
class DecodeThreads {
 public:
  /// Decodes a packet and prints it, with the facts that `record` has of its run.
  using Decode = std::function<void(const Packet& packet, const format::Record& record,
                                    format::Buffer& out, DecodedPart& part)>;
  /// Takes what a batch gave, in its turn, in any thread. Returns false if no more is wanted.
  using Take = std::function<bool(format::Buffer& out, const DecodedPart& part)>;

  /// `make` is called once for each thread.
  DecodeThreads(std::size_t threads, const std::function<Decode()>& make, Take take);
  ~DecodeThreads();
  DecodeThreads(const DecodeThreads&) = delete;
  DecodeThreads& operator=(const DecodeThreads&) = delete;

  /// Takes a packet; its bytes and the interface's name are borrowed. Returns false if no more is
  /// wanted.
  bool add(const Packet& packet, const format::Record& record);
  /// Waits until all packets were taken. Throws what a thread threw.
  void finish();

 private:
  struct Kept {
    Packet packet;
    format::Record record;
  };
  struct Batch {
    std::uint64_t place = 0;
    std::vector<Kept> kept;
    std::vector<std::uint8_t> bytes;  // Of the packets; never moves once there is one.
    std::deque<std::string> names;    // Of their interfaces.
    format::Buffer out;
    DecodedPart part;
    std::exception_ptr thrown;

    void clear();
  };

  void run(const Decode& decode);
  void take_decoded(std::unique_lock<std::mutex>& lock);
  void end();
  bool pass_on();
  void begin_batch(std::size_t bytes);
  Bytes keep(Bytes bytes);

  const Take take_;
  std::unique_ptr<Batch> filling_;
  std::uint64_t batches_ = 0;

  std::mutex mutex_;
  std::condition_variable came_;   // A batch, or the end.
  std::condition_variable taken_;  // A batch was passed on.
  std::deque<std::unique_ptr<Batch>> waiting_;
  std::map<std::uint64_t, std::unique_ptr<Batch>> decoded_;  // By place.
  bool taking_ = false;                                      // A thread passes batches on.
  std::vector<std::unique_ptr<Batch>> free_;
  std::uint64_t turn_ = 0;  // The place of the batch that is passed on next.
  bool ended_ = false;
  bool wanted_ = true;
  std::exception_ptr thrown_;
  std::vector<std::thread> threads_;
};

}  // namespace rubric::tools
