// Property: whatever bytes come, in whatever format and pieces, the output of `rubric decode` lies
// within the packet; its JSON lines are JSON and contain the packet's bytes, its CSV has a cell a
// column, its text holds nothing that a terminal would obey.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "codec/containers/reader.h"
#include "codec/reflect/registry.h"
#include "fuzz/support/decode_input.h"
#include "fuzz/support/require.h"
#include "tools/encode/json.h"
#include "tools/format/csv.h"
#include "tools/format/jsonl.h"
#include "tools/format/text.h"

namespace {

using namespace rubric;
using fuzz::require;

void check_nodes(const reflect::Decoded& decoded) {
  for (std::size_t i = 0; i < decoded.node_count(); ++i) {
    const reflect::Node& node = decoded[i];
    require(node.offset + node.size <= decoded.bytes.size(), "a field lies within the packet");
    require(node.end > i && node.end <= decoded.node_count(), "nodes are nested");
  }
  for (std::size_t i = 0; i < decoded.stale_count(); ++i) {
    require(decoded.stale()[i].offset + decoded.stale()[i].size <= decoded.bytes.size(),
            "stale bytes lie within the packet");
  }
}

void check_json(std::string_view text, const format::Record& record) {
  require(!text.empty() && text.find('\n') == text.size() - 1, "a frame is one line of JSON");
  const reflect::Value line = encode::parse_json(text);  // Throws where it is not JSON in UTF-8.
  const auto member = [&](std::string_view key) {
    const reflect::Value* const found = line.find(key);
    return found ? *found : reflect::Value::of_array({});
  };
  require(member("schema").text == "rubric.decode/1", "a line says what it is");
  require(member("error").is(reflect::Value::Kind::kNull) == !record.frame->malformed(),
          "a line says what is malformed");
  std::string hex;
  for (const std::uint8_t byte : record.packet().bytes) {
    hex += "0123456789abcdef"[byte >> 4];
    hex += "0123456789abcdef"[byte & 15];
  }
  require(member("raw").text == hex, "a line holds the packet's bytes");
}

// RFC 4180: cells that are quoted may hold commas, line breaks and doubled quotes.
std::size_t count_cells(std::string_view row) {
  std::size_t cells = 1;
  bool quoted = false;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i] == '"') quoted = !quoted;
    cells += row[i] == ',' && !quoted;
    require(quoted || row[i] != '\n' || i + 1 == row.size(), "a frame is one row");
  }
  require(!quoted, "quotes are closed");
  return cells;
}

void check_text(std::string_view text, bool color) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (color && c == 0x1B) {
      require(text.substr(i, 2) == "\x1b[", "an escape begins a colour");
      i = std::min(text.find('m', i), text.size() - 1);
      continue;
    }
    require((c >= ' ' && c != 0x7F) || c == '\n', "text holds no control characters");
  }
  require(text.ends_with('\n'), "text ends with its line");
}

/// Everything that prints, each once for every way to ask for it.
struct Printers {
  const reflect::Protocol& protocol = *reflect::find_protocol("rubicon");
  reflect::FrameDecoder decoder{protocol};
  format::JsonlFormatter jsonl[2] = {{protocol, false}, {protocol, true}};
  format::CsvFormatter csv{protocol, {}};
  std::unique_ptr<format::TextFormatter> text[8];
  std::size_t columns = 0;
  reflect::Frame frame;
  format::Buffer out{64};  // Small: a writer that asks for too little room is found out.

  Printers() {
    for (unsigned i = 0; i < 8; ++i) {
      format::TextOptions options;
      options.hex = (i & 1) != 0;
      options.color = (i & 2) != 0;
      options.units = (i & 4) != 0;
      text[i] = std::make_unique<format::TextFormatter>(protocol, options);
    }
    csv.begin(out);
    columns = count_cells(out.view());
  }

  std::string_view print(format::Formatter& formatter, const format::Record& record) {
    out = format::Buffer(64);
    formatter.print(record, out);
    return out.view();
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < fuzz::DecodeInput::kHeadBytes) return 0;
  static Printers printers;
  const fuzz::DecodeInput input = fuzz::read_decode_input(data, size);
  ReaderOptions options;
  if (input.hex_radio) options.hex_framing = Framing::kRadio;
  const std::unique_ptr<Reader> reader = make_reader(input.format, options);
  if (reader == nullptr) return 0;  // Its format cannot be found out, or is JSON.

  format::Record record;
  record.frame = &printers.frame;
  auto take = [&](const Packet& packet) {
    printers.decoder.decode(packet, printers.frame);
    check_nodes(printers.frame.decoded);
    const std::vector<Interface>& interfaces = reader->interfaces();
    record.interface_name = packet.interface_id < interfaces.size()
                                ? std::string_view(interfaces[packet.interface_id].name)
                                : std::string_view();
    record.time_ns = packet.time_ns;
    check_json(printers.print(printers.jsonl[input.units], record), record);
    require(count_cells(printers.print(printers.csv, record)) == printers.columns,
            "a cell for each column");
    const unsigned text = (input.hex ? 1u : 0u) | (input.color ? 2u : 0u) | (input.units ? 4u : 0u);
    check_text(printers.print(*printers.text[text], record), input.color);
    ++record.index;
    ++record.number;
  };
  reader->feed(input.first, take);
  reader->feed(input.rest, take);
  reader->finish(take);
  return 0;
}
