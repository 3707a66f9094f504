#include "codec/containers/sf_reader.h"

namespace rubric {
namespace {

constexpr Error kSfSound{Fault::kNone, 0, ReqId::kNone};

}  // namespace

SfReader::SfReader(const ReaderOptions& options) {
  Interface stream{.name = options.interface_name};
  interfaces_.push_back(stream);
  packet_.framing = Framing::kSf;
  packet_.direction = options.direction;
}

UnitReader::Step SfReader::step(Bytes input, PacketSink sink) {
  if (!greeted_) {
    const bool magic = input[0] == kSfMagic;
    if (magic && input.size() < 2) return want(2);
    greeted_ = true;
    // Both sides use the lower of their two versions, so a higher one is no fault.
    if (magic && input[1] >= kSfVersion) return used(2);
    const std::size_t at = magic ? 1 : 0;
    deliver(input.first(at + 1), at + 1,
            fail(Fault::kHandshake, at, "WIRE-SF-HANDSHAKE"_rule).error, sink);
  }
  const std::size_t size = input[0];
  if (size == 0) {
    deliver(Bytes(), 0, fail(Fault::kEmpty, 0, "WIRE-SF-LENGTH"_rule).error, sink);
    return used(1);
  }
  if (input.size() <= size) return want(1 + size);
  deliver(input.sub(1, size), size, kSfSound, sink);
  return used(1 + size);
}

void SfReader::end(Bytes rest, PacketSink sink) {
  if (!rest.empty()) {
    const ReqId requirement = greeted_ ? "WIRE-SF-LENGTH"_rule : "WIRE-SF-HANDSHAKE"_rule;
    const std::size_t size = greeted_ ? rest[0] : 1;
    deliver(rest.from(1), size, fail(Fault::kCut, rest.size(), requirement).error, sink);
  }
  greeted_ = false;
}

void SfReader::deliver(Bytes bytes, std::size_t size_bytes, const Error& error, PacketSink sink) {
  packet_.offset_bytes = offset();
  packet_.bytes = bytes;
  packet_.dropped_bytes = size_bytes - bytes.size();
  packet_.error = error;
  sink(packet_);
}

}  // namespace rubric
