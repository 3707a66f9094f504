// Property: whatever bytes come, in whatever format and pieces, the output of `rubric decode` lies
// within the packet; its JSON lines are JSON and contain the packet's bytes, its CSV has a cell a
// column, its text holds nothing that a terminal would obey.
#include <cstddef>
#include <cstdint>
#include <memory>

#include "codec/containers/reader.h"
#include "codec/reflect/registry.h"
#include "fuzz/support/decode_checks.h"
#include "fuzz/support/decode_input.h"
#include "fuzz/support/require.h"
#include "tools/format/csv.h"
#include "tools/format/jsonl.h"
#include "tools/format/text.h"

namespace {

using namespace rubric;
using fuzz::check_json;
using fuzz::check_nodes;
using fuzz::check_text;
using fuzz::require;

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
      format::TextOptions options{
          .color = (i & 2) != 0, .hex = (i & 1) != 0, .units = (i & 4) != 0};
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

  format::Record record{.frame = &printers.frame};
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
