// Reads the lines that `rubric decode --format jsonl` prints back into packets.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/packet.h"
#include "codec/reflect/encode.h"
#include "codec/reflect/frame.h"
#include "codec/reflect/value.h"

namespace rubric::encode {

inline constexpr std::string_view kSchema = "rubric.decode/1";

/// A value that cannot be encoded: its place in the line, what was expected and given, and the
/// rule's id if there is one, in one sentence.
class RecordError : public std::runtime_error {
 public:
  RecordError(const std::string& path, const std::string& problem, ReqId rule = ReqId::kNone);
};

/// A packet together with its borrowed bytes.
class OwnedPacket {
 public:
  Packet packet;  ///< Without its bytes.
  std::vector<std::uint8_t> bytes;
  std::string interface_name;
  std::string comment;

  /// Returns the packet with its bytes; valid until this object changes.
  Packet view() const {
    Packet whole = packet;
    whole.bytes = Bytes(bytes.data(), bytes.size());
    whole.comment = comment;
    return whole;
  }
};

/// Decides between `raw` and the other members of a line:
/// - with `raw` it makes the packet from that. If the line is not marked malformed (`error`) and
///   has `fields`, these must agree with it, lest an edit be lost;
/// - without `raw` it makes it from `fields`, `stale`, `am` and `frame`. It computes missing sizes,
///   counts, the AM type of a named message and check sums.
/// A given check sum must fit, unless `error` says that it does not.
class RecordReader {
 public:
  explicit RecordReader(const reflect::Protocol& protocol);

  /// Reads a line. Throws RecordError.
  void read(const reflect::Value& line, OwnedPacket& out);

 private:
  using Value = reflect::Value;
  struct Plan {
    const reflect::Type* type = nullptr;
    Value values;
    const reflect::Switch* more = nullptr;  // As for reflect::encode.
    bool is_whole = false;                  // The fields are those of the frame, its headers too.
  };

  Plan plan(const Value& line, Framing framing) const;
  Plan plan_radio(const Value& line, const Value& am) const;
  Value with_am_type(const Value& line, Value am, const reflect::Type* carrier) const;
  // Returns whether the fields of the line are all of the packet.
  bool build(const Value& line, const OwnedPacket& around, std::vector<std::uint8_t>& out) const;
  void compare(const Value& line, const OwnedPacket& out);
  const reflect::Type* bare_type(const Value& line) const;

  const reflect::Protocol& protocol_;
  std::vector<std::uint8_t> built_;
  std::vector<std::uint8_t> stale_;
  reflect::Frame from_raw_;
  reflect::Frame from_fields_;
};

}  // namespace rubric::encode
