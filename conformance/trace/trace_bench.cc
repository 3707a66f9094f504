// Measures how fast traces are read and written.
#include <benchmark/benchmark.h>

#include <string>

#include "conformance/trace/concrete.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"

namespace rubric::trace {
namespace {

constexpr int kLines = 20000;

AmFrame join_reply() {
  AmFrame frame{5, 1, 0, 15, {0, 11, 0, 5, 0, 0, 1, 2, 0, 7}};
  return frame;
}

// Returns a log as a run writes it: frames with their bytes, and news for the application.
std::string log_text() {
  std::string text =
      "%rtr 1\n%profile paper\n%node m5 mote id=5 iut\n%node sA sink id=1 island=11\ncase a\n";
  const Message joined = Message::named("joined")
                             .with("address", Value::address(11, 5))
                             .with("result", Value::names("success"));
  for (int i = 0; i < kLines; i += 2) {
    put_line(frame_line(i, "m5", Op::kGiven, "rA", LinkKind::kRadio, join_reply()), text);
    text += '\n';
    put_line(app_line(i, "m5", Op::kEmits, "app", joined), text);
    text += '\n';
  }
  return text;
}

std::string golden_text() {
  std::string text = "%rtr 1\n%node m5 mote id=5 iut\n";
  for (int i = 0; i < kLines; i += 4) {
    text += "case c" + std::to_string(i) + "\n" +
            "a: 0        m5 < app join(telosb_demo light|temp|humid led)\n"
            "b: a+0..50  m5 > rA  join_request(seq_num=$q ...)  [J1-REQUEST J1-DEST]\n"
            "   b+2      m5 < rA  am=1->5 join_reply(island_addr=11 mote_addr=5 seq_num=$q ...)\n"
            "   0..480   m5 !> rA ack_join(*)  [J4-SEQ]  ; none of it\n";
  }
  return text;
}

void read(benchmark::State& state, const std::string& text, bool whole) {
  for (auto _ : state) {
    const Parsed parsed = whole ? parse(text, "log") : parse_syntax(text, "log");
    if (!parsed.ok()) return state.SkipWithError(parsed.errors().c_str());
    benchmark::DoNotOptimize(parsed.file.cases.data());
  }
  state.SetItemsProcessed(state.iterations() * kLines);
}

void read_log(benchmark::State& state) { read(state, log_text(), true); }
void read_golden(benchmark::State& state) { read(state, golden_text(), true); }
void read_syntax(benchmark::State& state) { read(state, golden_text(), false); }
void write_log(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(log_text());
  state.SetItemsProcessed(state.iterations() * kLines);
}

BENCHMARK(read_log)->Unit(benchmark::kMillisecond);
BENCHMARK(read_golden)->Unit(benchmark::kMillisecond);
BENCHMARK(read_syntax)->Unit(benchmark::kMillisecond);
BENCHMARK(write_log)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rubric::trace
