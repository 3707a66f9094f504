#include "tools/format/text_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/format/json_nodes.h"
#include "tools/format/plain_value.h"
#include "tools/format/put.h"

namespace rubric::format {
namespace {

using reflect::Decoded;
using reflect::Field;
using reflect::Kind;
using reflect::Node;
using reflect::NodeKind;

constexpr std::uint32_t kMaxElements = 24;

/// Prints the nodes of one frame, counting leaves as the hex dump does.
class FieldPrinter {
 public:
  FieldPrinter(const Record& record, FieldStyle style, Styled& styled)
      : decoded_(record.decoded()), style_(style), styled_(styled), out_(styled.out()) {
    turn_ = 0;
    for (std::size_t i = 0; i < record.frame->payload_node; ++i) turn_ += is_leaf(decoded_[i]);
  }

  void message(std::size_t node) {
    for (std::size_t i = node + 1; i < decoded_[node].end; i = decoded_[i].end) member(i);
  }

 private:
  static bool is_leaf(const Node& node) {
    return node.kind == NodeKind::kNumber || node.kind == NodeKind::kNumberArray ||
           node.kind == NodeKind::kBytes;
  }
  bool is_message(const Node& node) const {
    const auto* end = decoded_.path() + decoded_.path_count();
    return node.type && std::find(decoded_.path(), end, node.type) != end;
  }
  bool is_pair(std::size_t node) const {
    return decoded_[node].end == node + 3 && decoded_[node + 1].kind == NodeKind::kNumber &&
           decoded_[node + 2].kind == NodeKind::kNumber;
  }

  void member(std::size_t i) {
    const Node& node = decoded_[i];
    if (node.kind == NodeKind::kStruct && is_message(node)) {
      styled_.put(Style::kDim, "| ");
      message(i);
      return;
    }
    if (node.kind == NodeKind::kStruct && node.end == i + 1) return;  // Cut off before its start.
    name(*node.field, node.kind == NodeKind::kStruct && !is_pair(i) ? "{" : "=");
    value(i);
    out_.append(' ');
  }

  void name(const Field& field, std::string_view behind) {
    styled_.begin(Style::kDim);
    out_.append(field.name);
    out_.append(behind);
    styled_.end();
  }

  // Prints a structure that is no pair after its opening brace.
  void value(std::size_t i) {
    const Node& node = decoded_[i];
    switch (node.kind) {
      case NodeKind::kNumber: leaf([&] { number(*node.field, node.value); }); break;
      case NodeKind::kNumberArray: leaf([&] { numbers(node); }); break;
      case NodeKind::kBytes:
        leaf([&] {
          append_hex_short(decoded_.bytes.sub(node.offset, node.size), kMaxHexBytes, out_);
        });
        break;
      case NodeKind::kStruct: structure(i); break;
      case NodeKind::kStructArray: structures(i); break;
    }
  }

  template <class Print>
  void leaf(Print print) {
    if (style_.in_turns) styled_.begin(Style::kField, turn_);
    ++turn_;
    print();
    if (style_.in_turns) styled_.end();
  }

  void structure(std::size_t i) {
    if (is_pair(i)) {
      value(i + 1);
      out_.append(':');
      value(i + 2);
      return;
    }
    message(i);
    if (out_.view().back() == ' ') out_.shrink(out_.size() - 1);
    styled_.put(Style::kDim, "}");
  }

  void structures(std::size_t i) {
    out_.append('[');
    for (std::size_t k = i + 1; k < decoded_[i].end; k = decoded_[k].end) {
      if (k != i + 1) out_.append(' ');
      if (!is_pair(k)) styled_.put(Style::kDim, "{");
      structure(k);
    }
    out_.append(']');
  }

  void number(const Field& field, std::int64_t value) {
    if (style_.units && field.unit) {
      out_.append(fmt::format("{:.6g}{}", converted(field, value), field.unit->symbol));
    } else if (field.mask) {
      append_bits(*field.mask, value, out_);
    } else if (const char* name =
                   field.enumeration ? reflect::enum_name(*field.enumeration, value) : nullptr) {
      out_.append(name);
    } else if (field.kind == Kind::kFloat) {
      out_.append(fmt::format("{}", float_of_bits(static_cast<std::uint32_t>(value))));
    } else {
      out_.commit(put_int(out_.reserve(kMaxIntChars), value));
    }
  }

  void numbers(const Node& node) {
    const std::uint8_t* at = decoded_.bytes.data() + node.offset;
    out_.append('[');
    for (std::uint32_t k = 0; k < node.count && k < kMaxElements; ++k) {
      if (k) out_.append(' ');
      number(*node.field, reflect::load_number(*node.field, at));
      at += node.field->width_bytes;
    }
    if (node.count > kMaxElements) out_.append(fmt::format(" ..{} in all", node.count));
    out_.append(']');
  }

  const Decoded& decoded_;
  const FieldStyle style_;
  Styled& styled_;
  Buffer& out_;
  std::size_t turn_ = 0;
};

}  // namespace

void append_fields(const Record& record, FieldStyle style, Styled& styled) {
  FieldPrinter(record, style, styled).message(record.frame->payload_node);
}

void append_hex_short(Bytes bytes, std::size_t most, Buffer& out) {
  if (bytes.empty()) return out.append("(empty)");
  const std::size_t shown = std::min(bytes.size(), most);
  out.commit(put_hex(out.reserve(2 * shown), bytes.first(shown)));
  if (shown < bytes.size()) out.append(fmt::format("..({} bytes)", bytes.size()));
}

}  // namespace rubric::format
