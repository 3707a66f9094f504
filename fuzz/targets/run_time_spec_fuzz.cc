// Property: whatever bytes come as a message of a spec that is read at run time, what is shown of
// them lies within them, is JSON, and holds nothing that a terminal would obey; a sound message is
// made again from its fields.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fuzz/support/decode_checks.h"
#include "fuzz/support/require.h"
#include "spec/compiler/emit/tables/built_tables.h"
#include "spec/compiler/load/load.h"
#include "tools/cli/specs.h"
#include "tools/encode/record.h"
#include "tools/format/jsonl.h"
#include "tools/format/text.h"

namespace {

using namespace rubric;
using fuzz::require;

// What no shipped spec has.
constexpr std::string_view kPlain = R"(
meta: {id: plain, endian: be, encoding: UTF-8}
seq:
  - {id: version, type: b4}
  - {id: flag, type: b1}
  - {id: rest, type: b19}
  - {id: length, type: u1, valid: {max: 40}}
  - {id: sized, type: str, size: length, pad-right: 32}
  - {id: name, type: str, size: 8, terminator: 0, encoding: ascii}
  - {id: label, type: strz}
  - {id: amount, type: u1, valid: {max: 9}}
  - {id: amounts, type: u2, repeat: expr, repeat-expr: amount}
  - {id: bytes, terminator: 10, eos-error: false}
  - {id: number, type: u2, if: flag}
  - {id: part, type: low_bits_first, if: version == 4}
  - {id: chosen, type: {switch-on: version, cases: {1: low_bits_first, 2: items}}}
  - {id: list, type: items, repeat: expr, repeat-expr: length % 4}
  - {id: less, size: length - 3, if: version == 5}
  - {id: tail, type: str, size-eos: true}
types:
  items:
    seq: [{id: count, type: u1}, {id: values, type: u2, repeat: expr, repeat-expr: count % 5}]
  low_bits_first:
    seq: [{id: a, type: b3}, {id: b, type: b13}, {id: c, type: b16}]
)";

const reflect::Protocol& plain() {
  static rubricc::Model model;
  static const std::unique_ptr<rubricc::BuiltTables> tables = [] {
    rubricc::Diagnostics mistakes;
    rubricc::load_spec_text("plain.ksy", std::string(kPlain), model, mistakes);
    rubricc::check_model(model, mistakes, rubricc::CheckFor::kRunTime);
    require(mistakes.empty(), "the target's own spec is sound");
    return std::make_unique<rubricc::BuiltTables>(model);
  }();
  return *tables->of("plain").protocol;
}

/// One spec with its readers and writers.
struct Spec {
  explicit Spec(const reflect::Protocol& of) : protocol(of), jsonl(of, false), text(of, {}) {}

  const reflect::Protocol& protocol;
  format::JsonlFormatter jsonl;
  format::TextFormatter text;
};

const std::vector<std::unique_ptr<Spec>>& specs() {
  static const std::vector<std::unique_ptr<Spec>> all = [] {
    std::vector<std::unique_ptr<Spec>> out;
    out.push_back(std::make_unique<Spec>(plain()));
    for (const auto& [name, text] : cli::shipped_specs()) {
      if (name != "tinyos") out.push_back(std::make_unique<Spec>(cli::protocol_of(name)));
    }
    return out;
  }();
  return all;
}

// Returns the line without the bytes that the last member but one repeats in hex.
std::string without_raw(std::string_view line) {
  const std::size_t raw = line.rfind(",\"raw\":");
  return std::string(line.substr(0, raw)) + std::string(line.substr(line.rfind(",\"error\":")));
}

std::string_view print(Spec& spec, const reflect::Frame& frame, format::Record& record,
                       format::Buffer& out) {
  record.frame = &frame;
  out = format::Buffer(64);  // Small: a writer that asks for too little room is found out.
  spec.jsonl.print(record, out);
  return out.view();
}

// Writes the message without its raw bytes. NaNs of any kind are written as one, so that what
// counts is how the bytes read again.
void check_written(Spec& spec, const reflect::Type& type, std::string_view line) {
  encode::OwnedPacket written;
  const std::string given = without_raw(line);
  encode::RecordReader(spec.protocol).read(encode::parse_json(given), written);
  const Packet packet = written.view();
  reflect::Frame frame;
  reflect::FrameDecoder(spec.protocol, &type).decode(packet, frame);
  format::Record record;
  format::Buffer out{64};
  require(without_raw(print(spec, frame, record, out)) == given,
          "a sound message is made again from its fields");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  Spec& spec = *specs()[data[0] % specs().size()];
  const reflect::Protocol& protocol = spec.protocol;
  const reflect::Type& type = *protocol.types[data[1] % protocol.type_count];

  Packet packet{.framing = Framing::kBare, .bytes = Bytes(data + 2, size - 2)};
  reflect::Frame frame;
  reflect::FrameDecoder(protocol, &type).decode(packet, frame);
  fuzz::check_nodes(frame.decoded);

  format::Record record{.frame = &frame};
  format::Buffer out{64};
  spec.text.print(record, out);
  fuzz::check_text(out.view(), false);
  const std::string line(print(spec, frame, record, out));
  fuzz::check_json(line, record);
  const bool all_stale = frame.decoded.stale_count() < reflect::Decoded::kMaxStale;
  if (!frame.malformed() && all_stale) check_written(spec, type, line);
  return 0;
}
