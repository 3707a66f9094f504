#include "codec/containers/hdlc_reader.h"

#include <algorithm>
#include <cstring>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/frame_scan.h"
#include "codec/containers/serial_frame.h"
#include "codec/runtime/hdlc.h"

namespace rubric {
namespace {

using Pointer = const std::uint8_t*;

template <CpuPath kPath>
Pointer find_special(Pointer begin, Pointer end) {
  if constexpr (kPath == CpuPath::kWide) return find_special_wide(begin, end);
  if constexpr (kPath == CpuPath::kVector) return find_special_vector(begin, end);
  return find_special_portable(begin, end);
}

Pointer find_flag(Pointer begin, Pointer end) {
  const void* at = std::memchr(begin, kHdlcFlag, static_cast<std::size_t>(end - begin));
  return at == nullptr ? end : static_cast<Pointer>(at);
}

template <CpuPath kPath>
std::uint16_t crc(Bytes bytes) {
  if constexpr (kPath == CpuPath::kWide) return crc16_wide(bytes);
  if constexpr (kPath == CpuPath::kVector) return crc16_vector(bytes);
  return crc16_portable(bytes);
}

}  // namespace

HdlcReader::HdlcReader(const ReaderOptions& options, CpuPath path) : path_(path) {
  Interface stream{.name = options.interface_name};
  interfaces_.push_back(stream);
  packet_.framing = Framing::kHdlc;
  packet_.direction = options.direction;
}

void HdlcReader::feed(Bytes chunk, PacketSink sink) {
  if (chunk.empty()) return;
  switch (path_) {
    case CpuPath::kWide: feed_with<CpuPath::kWide>(chunk, sink); break;
    case CpuPath::kVector: feed_with<CpuPath::kVector>(chunk, sink); break;
    case CpuPath::kPortable: feed_with<CpuPath::kPortable>(chunk, sink); break;
  }
  chunk_offset_ += chunk.size();
}

template <CpuPath kPath>
void HdlcReader::feed_with(Bytes chunk, PacketSink sink) {
  Pointer p = chunk.begin();
  const Pointer end = chunk.end();
  const auto offset_of = [&](Pointer at) {
    return chunk_offset_ + static_cast<std::uint64_t>(at - chunk.begin());
  };
  if (open_) {
    const Pointer flag = find_flag(p, end);
    hold<kPath>(p, flag);
    if (flag == end) return;
    deliver_held<kPath>(sink);
    p = flag + 1;
  }
  ScanBatch batch;
  for (;;) {
    if constexpr (kPath != CpuPath::kPortable) {
      p = scan_frames(p, end, batch, kPath);
      for (std::size_t i = 0; i < batch.count; ++i) {
        const ScannedFrame& frame = batch.frames[i];
        packet_.offset_bytes = offset_of(frame.wire);
        deliver_usual(Bytes(frame.content, frame.size_bytes), frame.crc, sink);
      }
      if (batch.count == kScanBatch) continue;
    }
    while (p != end && *p == kHdlcFlag) ++p;
    if (p == end) return;
    const Pointer special = find_special<kPath>(p, end);
    if (special != end && *special == kHdlcFlag) {
      packet_.offset_bytes = offset_of(p);
      deliver<kPath>(Bytes(p, static_cast<std::size_t>(special - p)), sink);
      p = special + 1;
      continue;
    }
    open_ = true;
    open_offset_ = offset_of(p);
    const Pointer flag = find_flag(special, end);
    hold<kPath>(p, flag);
    if (flag == end) return;
    deliver_held<kPath>(sink);
    p = flag + 1;
  }
}

// Adds raw bytes without flags to the frame in the buffer.
template <CpuPath kPath>
void HdlcReader::hold(Pointer begin, Pointer end) {
  while (begin != end) {
    if (escaping_) {
      escaping_ = false;
      const auto byte = static_cast<std::uint8_t>(*begin++ ^ kHdlcXor);
      if (held_ < kHdlcKeptMax) {
        buffer_[held_++] = byte;
      } else {
        ++dropped_;
      }
      continue;
    }
    // A full buffer still has to count, so the excess is unescaped in portions into nowhere.
    std::array<std::uint8_t, 256 + kUnescapeSlack> nowhere;
    const bool full = held_ == kHdlcKeptMax;
    const std::size_t room = full ? nowhere.size() - kUnescapeSlack : kHdlcKeptMax - held_;
    std::uint8_t* const out = full ? nowhere.data() : buffer_.data() + held_;
    const Pointer stop = begin + std::min(room, static_cast<std::size_t>(end - begin));
    const std::uint8_t* const out_end = kPath == CpuPath::kPortable
                                            ? unescape_portable(begin, stop, out, &escaping_)
                                            : unescape_vector(begin, stop, out, &escaping_);
    const auto written = static_cast<std::size_t>(out_end - out);
    if (full) {
      dropped_ += written;
    } else {
      held_ += written;
    }
    begin = stop;
  }
}

template <CpuPath kPath>
void HdlcReader::deliver(Bytes content, PacketSink sink) {
  const std::size_t size = content.size();
  const int kind = content[0];
  if (size < kSerialContentMin || size > serial_content_max(kind)) {
    // Frames delivered in place keep the bound too, so that splits do not matter.
    packet_.dropped_bytes = size > kHdlcKeptMax ? size - kHdlcKeptMax : 0;
    content = content.first(std::min(size, kHdlcKeptMax));
    return deliver_damaged(content, check_serial_content(content, kPath), sink);
  }
  deliver_usual(content, crc<kPath>(content.first(size - kSerialCrcBytes)), sink);
}

// A frame of a size that may be sound, and the CRC that it should have.
inline void HdlcReader::deliver_usual(Bytes content, std::uint16_t crc_wanted, PacketSink sink) {
  const std::size_t crc_at = content.size() - kSerialCrcBytes;
  const int kind = content[0];
  const std::size_t begin = serial_kind_has_seq(kind) ? 2 : 1;
  packet_.kind = kind;
  packet_.serial_seq = begin == 2 ? content[1] : kAbsent;
  packet_.crc = load_le16(content.data() + crc_at);
  packet_.bytes = content.sub(begin, crc_at - begin);
  if (crc_wanted == packet_.crc) [[likely]] {
    packet_.error = Error{Fault::kNone, 0, ReqId::kNone};
  } else {
    packet_.error = fail(Fault::kCrc, crc_at, "WIRE-SERIAL-CRC"_rule).error;
  }
  sink(packet_);
}

void HdlcReader::deliver_damaged(Bytes content, const Error& error, PacketSink sink) {
  split_serial_content(content, packet_);
  packet_.error = error;
  sink(packet_);
  packet_.dropped_bytes = 0;
}

template <CpuPath kPath>
void HdlcReader::deliver_held(PacketSink sink) {
  const Bytes content(buffer_.data(), held_);
  packet_.offset_bytes = open_offset_;
  packet_.dropped_bytes = dropped_;
  if (escaping_) {
    deliver_damaged(content, fail(Fault::kAborted, held_, "WIRE-HDLC-ESCAPE"_rule).error, sink);
  } else if (dropped_ != 0) {
    deliver_damaged(content, check_serial_content(content, kPath), sink);
  } else {
    deliver<kPath>(content, sink);
  }
  restart();
}

void HdlcReader::finish(PacketSink sink) {
  if (open_) {
    packet_.offset_bytes = open_offset_;
    packet_.dropped_bytes = dropped_;
    const Error error = fail(Fault::kCut, held_, "WIRE-HDLC-FLAG"_rule).error;
    deliver_damaged(Bytes(buffer_.data(), held_), error, sink);
  }
  restart();
  chunk_offset_ = 0;
}

void HdlcReader::restart() {
  open_ = false;
  escaping_ = false;
  held_ = 0;
  dropped_ = 0;
}

}  // namespace rubric
