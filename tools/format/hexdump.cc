#include "tools/format/hexdump.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tools/format/put.h"
#include "tools/format/style.h"

namespace rubric::format {
namespace {

using reflect::Decoded;
using reflect::Node;
using reflect::NodeKind;

constexpr std::size_t kRowBytes = 16;
constexpr std::size_t kLineChars = 100;
constexpr std::string_view kIndent = "        ";
constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
constexpr int kNobody = -1;
constexpr int kStale = -2;

/// Returns a byte's field, by the order of leaves; kNobody or kStale.
std::vector<int> owners(const Record& record, std::vector<std::string>& names) {
  const Decoded& decoded = record.decoded();
  std::vector<int> owner(decoded.bytes.size(), kNobody);
  std::vector<std::size_t> around;
  for (std::size_t i = 0; i < decoded.node_count(); ++i) {
    const Node& node = decoded[i];
    while (!around.empty() && i >= decoded[around.back()].end) around.pop_back();
    if (node.kind == NodeKind::kStruct || node.kind == NodeKind::kStructArray) {
      around.push_back(i);
      continue;
    }
    // One more name than the field's own is enough: "dest.pid".
    const reflect::Field* outer = around.empty() ? nullptr : decoded[around.back()].field;
    std::string name =
        outer ? fmt::format("{}.{}", outer->name, node.field->name) : std::string(node.field->name);
    for (std::uint32_t k = 0; k < node.size; ++k) {
      owner[node.offset + k] = static_cast<int>(names.size());
    }
    names.push_back(std::move(name));
  }
  for (std::size_t i = 0; i < decoded.stale_count(); ++i) {
    const reflect::Range range = decoded.stale()[i];
    for (std::uint32_t k = 0; k < range.size; ++k) owner[range.offset + k] = kStale;
  }
  return owner;
}

char letter(int owner) {
  if (owner == kStale) return '~';
  return owner < 0 ? ' ' : kLetters[static_cast<std::size_t>(owner) % kLetters.size()];
}

Style style_of(int owner) {
  if (owner == kStale) return Style::kDim;
  return owner < 0 ? Style::kPlain : Style::kField;
}

/// Prints the rows of one frame.
class Dump {
 public:
  Dump(const Record& record, bool color, Buffer& out)
      : record_(record), styled_(out, color), out_(out), owner_(owners(record, names_)) {}

  void print() {
    const std::size_t size = owner_.size();
    for (std::size_t row = 0; row < size; row += kRowBytes) {
      const std::size_t end = std::min(row + kRowBytes, size);
      bytes(row, end);
      if (!styled_.color()) letters(row, end);
    }
    if (!styled_.color()) key();
  }

 private:
  bool is_fault(std::size_t i) const {
    return record_.frame->malformed() && record_.frame->error.offset_bytes == i;
  }

  void bytes(std::size_t row, std::size_t end) {
    const Bytes bytes = record_.packet().bytes;
    out_.append(kIndent);
    styled_.put(Style::kDim, fmt::format("{:04x} ", row));
    for (std::size_t i = row; i < end; ++i) {
      out_.append(i == row + kRowBytes / 2 ? "  " : " ");
      const Style style = is_fault(i) ? Style::kError : style_of(owner_[i]);
      styled_.begin(style, static_cast<std::size_t>(std::max(owner_[i], 0)));
      out_.append(fmt::format("{:02x}", bytes[i]));
      styled_.end();
    }
    const std::size_t missing = kRowBytes - (end - row);
    out_.append(3 * missing + (end - row <= kRowBytes / 2) + 2, ' ');
    for (std::size_t i = row; i < end; ++i) {
      const char c = static_cast<char>(bytes[i]);
      out_.append(c >= ' ' && c <= '~' ? c : '.');
    }
    out_.append('\n');
  }

  void letters(std::size_t row, std::size_t end) {
    std::string line(kIndent);
    line += "     ";
    for (std::size_t i = row; i < end; ++i) {
      line += i == row + kRowBytes / 2 ? "  " : " ";
      line += letter(owner_[i]);
      // A dash where the field continues.
      const bool goes_on = owner_[i] >= 0 && i + 1 < owner_.size() && owner_[i + 1] == owner_[i];
      line += is_fault(i) ? '!' : goes_on ? '-' : ' ';
    }
    while (line.ends_with(' ')) line.pop_back();
    out_.append(line);
    out_.append('\n');
  }

  void key() {
    std::string line(kIndent);
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::string entry = fmt::format("{} {}", letter(static_cast<int>(i)), names_[i]);
      if (line.size() + entry.size() > kLineChars) {
        out_.append(line);
        out_.append('\n');
        line = kIndent;
      }
      if (line.size() > kIndent.size()) line += "  ";
      line += entry;
    }
    if (line.size() == kIndent.size()) return;
    out_.append(line);
    out_.append('\n');
  }

  const Record& record_;
  Styled styled_;
  Buffer& out_;
  std::vector<std::string> names_;
  std::vector<int> owner_;
};

}  // namespace

void append_hexdump(const Record& record, bool color, Buffer& out) {
  Dump(record, color, out).print();
}

}  // namespace rubric::format
