#include "conformance/test/report/frame_view.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/generated/tinyos/tables.h"
#include "codec/reflect/am_frames.h"
#include "codec/reflect/decode.h"
#include "codec/reflect/fault_text.h"
#include "conformance/trace/schema.h"
#include "conformance/trace/value_text.h"

namespace rubric::suite {
namespace {

using reflect::Decoded;
using reflect::Node;
using reflect::NodeKind;

std::string number(const reflect::Field& field, const reflect::Type& owner, std::int64_t value) {
  std::string out = field.enumeration
                        ? reflect::number_text(field, value)
                        : trace::value_text(trace::Domain::of(field, owner).show(value));
  if (field.unit) {
    const double physical = static_cast<double>(value) * field.unit->scale + field.unit->offset;
    out += fmt::format(" = {:.4g} {}", physical, field.unit->symbol);
  }
  return out;
}

/// Makes rows of the nodes of a decoded message that begins at `base`.
class Rows {
 public:
  Rows(const Decoded& decoded, std::uint32_t base, std::vector<FrameField>& out)
      : decoded_(decoded), base_(base), out_(out) {}

  void children(std::size_t parent, const std::string& path) {
    for (std::size_t i = parent + 1; i < decoded_[parent].end; i = decoded_[i].end) {
      const Node& node = decoded_[i];
      one(i, path.empty() ? node.field->name : path + "." + node.field->name,
          *decoded_[parent].type);
    }
  }

 private:
  void one(std::size_t i, const std::string& path, const reflect::Type& owner) {
    const Node& node = decoded_[i];
    switch (node.kind) {
      case NodeKind::kNumber: return add(node, path, number(*node.field, owner, node.value));
      case NodeKind::kStruct: return children(i, path);
      case NodeKind::kNumberArray: {
        std::string all;
        for (std::uint32_t k = 0; k < node.count; ++k) {
          const std::uint8_t* at =
              decoded_.bytes.data() + node.offset + k * node.field->width_bytes;
          all += (k ? " " : "") + number(*node.field, owner, reflect::load_number(*node.field, at));
        }
        return add(node, path, std::move(all));
      }
      case NodeKind::kBytes: return add(node, path, text_in(node));
      case NodeKind::kStructArray: {
        std::size_t k = 0;
        for (std::size_t at = i + 1; at < node.end; at = decoded_[at].end) {
          children(at, fmt::format("{}[{}]", path, k++));
        }
        return;
      }
    }
  }

  void add(const Node& node, const std::string& path, std::string value) {
    if (node.size == 0) return;
    out_.push_back({base_ + node.offset, node.size, path, std::move(value)});
  }

  std::string text_in(const Node& node) const {
    const std::string text(reinterpret_cast<const char*>(decoded_.bytes.data()) + node.offset,
                           node.size);
    const bool readable = text.size() > 1 && std::all_of(text.begin(), text.end(), [](char c) {
                            return c >= ' ' && c < 0x7F;
                          });
    return readable ? '"' + text + '"' : std::string();
  }

  const Decoded& decoded_;
  std::uint32_t base_;
  std::vector<FrameField>& out_;
};

void add_head(Bytes packet, std::vector<FrameField>& out) {
  const reflect::Type& header = tinyos::tables::types::kAmHeader;
  for (std::uint16_t i = 0; i < header.field_count; ++i) {
    const reflect::Field& field = header.fields[i];
    const auto at = static_cast<std::uint32_t>(field.fixed_offset);
    const std::int64_t value = reflect::load_number(field, packet.data() + at);
    const bool all = field.width_bytes == 2 && value == trace::kAmAll;
    out.push_back({at, field.width_bytes, i == 0 ? field.name : std::string("am.") + field.name,
                   std::to_string(value) + (all ? " (all)" : "")});
  }
}

// Adds stale bytes after a message, and other bytes without a name.
void add_gaps(std::size_t size, std::vector<FrameField>& fields) {
  std::stable_sort(fields.begin(), fields.end(), [](const FrameField& a, const FrameField& b) {
    return a.offset_bytes < b.offset_bytes;
  });
  std::vector<FrameField> out;
  std::uint32_t at = 0;
  const auto gap = [&](std::uint32_t end) {
    if (end > at) out.push_back({at, end - at, "(no field)", ""});
  };
  for (FrameField& field : fields) {
    gap(field.offset_bytes);
    at = std::max(at, field.offset_bytes + field.size_bytes);
    out.push_back(std::move(field));
  }
  gap(static_cast<std::uint32_t>(size));
  fields = std::move(out);
}

}  // namespace

FrameView view_frame(std::string_view packet, trace::LinkKind link) {
  FrameView out;
  trace::put_hex(packet, out.hex);
  trace::AmFrame frame;
  if (!trace::parse_packet(packet, frame)) {
    if (!packet.empty()) {
      out.fields.push_back({0, static_cast<std::uint32_t>(packet.size()), "(no packet)", ""});
    }
    return out;
  }
  const auto* const data = reinterpret_cast<const std::uint8_t*>(packet.data());
  add_head(Bytes(data, packet.size()), out.fields);
  const reflect::Type* type = trace::Schema::get().payload_type(link, frame.type);
  if (type) {
    Decoded decoded;
    const Bytes bytes(frame.payload.data(), frame.payload.size());
    decoded.clear(bytes);
    reflect::decode(*type, bytes, reflect::Tail::kStale, true, decoded);
    if (decoded.node_count() > 0)
      Rows(decoded, reflect::kAmHeaderBytes, out.fields).children(0, "");
  }
  add_gaps(packet.size(), out.fields);
  return out;
}

}  // namespace rubric::suite
