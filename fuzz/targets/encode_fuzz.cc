// Property: any text as lines of `rubric encode` is refused with a reason, or makes packets which
// decode to lines that make the same packets again, even without their raw bytes.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "codec/reflect/registry.h"
#include "fuzz/support/require.h"
#include "tools/encode/members.h"
#include "tools/encode/record.h"
#include "tools/format/jsonl.h"

namespace {

using namespace rubric;
using encode::OwnedPacket;
using fuzz::require;
using reflect::Value;

const reflect::Protocol& protocol() { return *reflect::find_protocol("rubicon"); }

// Returns false if the line is refused.
bool read(const Value& line, OwnedPacket& out) {
  encode::RecordReader reader(protocol());
  try {
    reader.read(line, out);
    return true;
  } catch (const encode::RecordError& error) {
    require(*error.what() != '\0', "a refusal has a reason");
    return false;
  }
}

std::string decoded(const OwnedPacket& owned, const reflect::Type* bare) {
  const Packet packet = owned.view();
  reflect::Frame frame;
  reflect::FrameDecoder(protocol(), bare).decode(packet, frame);
  format::Record shown{
      .interface_name = owned.interface_name, .time_ns = packet.time_ns, .frame = &frame};
  format::Buffer out;
  format::JsonlFormatter(protocol(), false).print(shown, out);
  return std::string(out.view());
}

// Returns the type of a bare packet, which a line names itself.
const reflect::Type* bare_type(const Value& line) {
  const Value* path = line.find("path");
  if (path && path->is(Value::Kind::kArray) && !path->items.empty()) {
    return reflect::find_type(protocol(), path->items[0].text);
  }
  const Value* message = line.find("message");
  return message ? reflect::find_type(protocol(), message->text) : nullptr;
}

void same(const OwnedPacket& a, const OwnedPacket& b) {
  require(a.bytes == b.bytes, "the bytes are the same");
  require(a.interface_name == b.interface_name, "the interface is the same");
  const Packet& x = a.packet;
  const Packet& y = b.packet;
  require(x.framing == y.framing && x.direction == y.direction && x.time_ns == y.time_ns &&
              x.offset_bytes == y.offset_bytes,
          "framing, direction, time and place are the same");
  require(x.kind == y.kind && x.serial_seq == y.serial_seq && x.crc == y.crc && x.fcs == y.fcs &&
              x.dropped_bytes == y.dropped_bytes && x.error.fault == y.error.fault,
          "what the frame says is the same");
}

// Returns whether a line's fields hold all of a frame, apart from which NaN it was
// (tools/commands/decode_format.md).
bool is_whole(const Value& line, const std::string& text) {
  return line.find("fields")->is(Value::Kind::kObject) &&
         line.find("error")->is(Value::Kind::kNull) && text.find("\"NaN\"") == std::string::npos;
}

void come_back(const OwnedPacket& owned, const reflect::Type* bare) {
  const std::string text = decoded(owned, bare);
  Value line = encode::parse_json(text);
  OwnedPacket again;
  require(read(line, again), "a line of decode is read");
  same(owned, again);
  if (!is_whole(line, text)) return;
  const auto raw = std::find(line.keys.begin(), line.keys.end(), "raw") - line.keys.begin();
  line.items[static_cast<std::size_t>(raw)] = Value{};
  require(read(line, again), "a line of decode without raw is read");
  same(owned, again);
}

void one_line(std::string_view text) {
  try {
    const Value line = encode::parse_json(text);
    OwnedPacket owned;
    if (read(line, owned)) come_back(owned, bare_type(line));
  } catch (const encode::JsonError& error) {
    require(error.column() >= 1 && error.column() <= text.size() + 1, "the column is in the line");
    require(*error.what() != '\0', "it says what was expected");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text(reinterpret_cast<const char*>(data), size);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    one_line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return 0;
}
