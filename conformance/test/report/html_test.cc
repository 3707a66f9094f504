// Parts of the page: frames by field, cases as files, and text that stays in its place.
#include "conformance/test/report/html.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "codec/containers/link_record.h"
#include "codec/containers/reader.h"
#include "conformance/test/report/case_files.h"
#include "conformance/test/report/case_source.h"
#include "conformance/test/report/folder_testing.h"
#include "conformance/test/report/frame_view.h"
#include "conformance/test/report/log_lines.h"
#include "conformance/test/suite/run.h"
#include "conformance/test/suite/tests/testing.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"

namespace rubric::suite {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// Returns all cases of the kit on the reference machine.
const SuiteRun& whole() {
  static const SuiteRun run = [] {
    static const Cases cases = Cases::own();
    Plan plan{.cases = cases.all()};
    SuiteRun out;
    out.implementations.push_back(suite::run(
        "machine", [] { return std::make_unique<testing::FakeAttachment>(); }, plan));
    return out;
  }();
  return run;
}

const CaseRun& one(const std::string& name) {
  for (const CaseRun& each : whole().implementations[0].cases) {
    if (each.name == name) return each;
  }
  throw std::runtime_error("no case " + name);
}

TEST(FrameView, EachByteOfEachFrameHasItsField) {
  std::size_t frames = 0;
  for (const CaseRun& each : whole().implementations[0].cases) {
    trace::Scope scope{.nodes = each.nodes, .links = each.links};
    const trace::Case log = each.result.log.read();
    for (const trace::Line* line : log.lines()) {
      if (!line->bytes) continue;
      const FrameView view = view_frame(*line->bytes, scope.link(line->link).value());
      EXPECT_EQ(view.hex.size(), 2 * line->bytes->size());
      std::size_t next = 0;
      for (const FrameField& field : view.fields) {
        EXPECT_EQ(field.offset_bytes, next) << each.name << ": " << field.path;
        next += field.size_bytes;
      }
      EXPECT_EQ(next, line->bytes->size()) << each.name;
      ++frames;
    }
  }
  EXPECT_GT(frames, 1000u);
}

TEST(FrameView, FieldsHaveTheirNamesAndValues) {
  // A join_request of mote 5 to AM 1: telosb_demo with light, temp and humid.
  const std::string packet("\x00\x00\x01\x00\x05\x06\x00\x0e\x03\xe8\x01\x00\x43\x01", 14);
  const FrameView view = view_frame(packet, trace::LinkKind::kRadio);
  std::map<std::string, std::string> values;
  for (const FrameField& field : view.fields) values[field.path] = field.value;
  EXPECT_EQ(values["am.dest"], "1");
  EXPECT_EQ(values["am.src"], "5");
  EXPECT_EQ(values["seq_num"], "1000");
  EXPECT_EQ(values["mote_desc.mote_type"], "1 (telosb_demo)");
  EXPECT_EQ(values["mote_desc.transducers"], "light|temp|humid");
}

TEST(FrameView, WhatIsNoPacketIsBytes) {
  const FrameView view = view_frame("\x01\x02", trace::LinkKind::kRadio);
  ASSERT_EQ(view.fields.size(), 1u);
  EXPECT_EQ(view.fields[0].path, "(no packet)");
  EXPECT_TRUE(view_frame("", trace::LinkKind::kSerial).fields.empty());
  const FrameView unknown =
      view_frame(std::string("\0\0\1\0\5\2\0\xEE\7\7", 10), trace::LinkKind::kRadio);
  EXPECT_EQ(unknown.fields.back().path, "(no field)");
  EXPECT_EQ(unknown.fields.back().size_bytes, 2u);
}

TEST(LogLines, AFrameThatTwoNodesShowIsOne) {
  const CaseRun& timeline = one("timeline");
  const trace::Case log = timeline.result.log.read();
  const std::vector<const trace::Line*> lines = log.lines();
  const std::vector<std::size_t> before = first_seen(lines);
  std::size_t heard = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i]->op != trace::Op::kGiven || !lines[i]->am) {
      EXPECT_EQ(before[i], kNoLine);
      continue;
    }
    // Every node is under test here, so another node has sent what this one is given.
    ASSERT_NE(before[i], kNoLine) << trace::print(*lines[i]);
    EXPECT_EQ(lines[before[i]]->op, trace::Op::kEmits);
    EXPECT_EQ(lines[before[i]]->message, lines[i]->message);
    ++heard;
  }
  EXPECT_GT(heard, 30u);
}

// A line stands for a later one of another node: as it is sent, for 40 ticks, or given at once;
// once for each node.
TEST(LogLines, AFrameIsGivenToANodeOnce) {
  const trace::Parsed parsed = trace::parse_syntax(
      "%rtr 1\ncase c\n"
      "@0  m5 > rA am=5->1 join_request(seq_num=1 ...) | 00\n"
      "@1  sA < rA am=5->1 join_request(seq_num=1 ...) | 00\n"
      "@1  sB < rA am=5->1 join_request(seq_num=1 ...) | 00\n"
      "@2  sA < rA am=5->1 join_request(seq_num=1 ...) | 00\n"  // Another one.
      "@2  sB < rA am=5->1 join_request(seq_num=1 ...) | 00\n"
      "@2  sB < rA am=5->1 join_request(seq_num=2 ...) | 00\n"
      "@2  sC < rA am=4->1 join_request(seq_num=1 ...) | 00\n"
      "@2  sC < rB am=5->1 join_request(seq_num=1 ...) | 00\n"
      "@40 sC < rA am=5->1 join_request(seq_num=1 ...) | 00\n"
      "@41 sD < rA am=5->1 join_request(seq_num=1 ...) | 00\n"
      "@50 sA > serA am=1->9 join_reply(seq_num=1 ...) | 00\n"
      "@51 b  < serA am=7->8 join_reply(seq_num=1 ...) | 00\n",
      "x");
  ASSERT_EQ(parsed.errors(), "");
  EXPECT_THAT(
      first_seen(parsed.file.cases[0].lines()),
      ElementsAre(kNoLine, 0, 0, kNoLine, 3, kNoLine, kNoLine, kNoLine, 0, kNoLine, kNoLine, 10));
}

TEST(LogLines, PeersAreTheNodesThatAreMeant) {
  const CaseRun& accept = one("j4.accept");  // m5, sA of island 11 and sB of island 12.
  std::map<std::string, std::vector<std::size_t>> peers;
  const trace::Case log = accept.result.log.read();
  for (const trace::Line* line : log.lines()) {
    peers[line->message.name] = peers_of(accept.nodes, *line);
  }
  EXPECT_THAT(peers["join"], ElementsAre());
  EXPECT_THAT(peers["join_request"], ElementsAre(1, 2));  // Both sinks have the address 1.
  EXPECT_THAT(peers["join_reply"], ElementsAre(1));       // It names island 11.
}

TEST(CaseFiles, LogsAreReadAgain) {
  for (const CaseRun& each : whole().implementations[0].cases) {
    const trace::Parsed parsed = trace::parse(case_rtr(each), each.name);
    ASSERT_TRUE(parsed.ok()) << parsed.errors();
    ASSERT_EQ(parsed.file.cases.size(), 1u);
    const trace::Case& read = parsed.file.cases[0];
    EXPECT_EQ(read.name, each.name);
    const trace::Case log = each.result.log.read();
    const auto lines = log.lines();
    const auto again = read.lines();
    const auto iuts = std::ranges::count_if(each.nodes, &trace::NodeHeader::iut);
    ASSERT_EQ(again.size(), lines.size() + iuts);  // Each ends with a line of its own.
    for (std::size_t i = 0; i < lines.size(); ++i) {
      EXPECT_EQ(trace::print(*again[i]), trace::print(*lines[i]));
    }
    std::vector<trace::NodeHeader> nodes = each.nodes;
    for (trace::NodeHeader& node : nodes) node.whole = node.iut;  // The log has all of them.
    EXPECT_EQ(trace::scope_of(parsed.file, read).nodes, nodes);
  }
}

// An implementation that passed a case passes its own log.
TEST(CaseFiles, LogsAreGoldenTraces) {
  for (const CaseRun& each : whole().implementations[0].cases) {
    const Cases again = Cases::of_text(case_rtr(each), each.name);
    testing::FakeAttachment machine;
    const CaseRun second = run_one(again.all().at(0), machine, "", std::nullopt);
    EXPECT_EQ(second.result.verdict, runner::CaseVerdict::kPass)
        << runner::explain(second.result, each.name);
  }
}

struct Captured {
  std::map<std::string, std::size_t> packets;  // By interface.
  std::size_t bad = 0;
  std::int64_t last_ns = 0;
};
Captured read_capture(const std::string& text) {
  Captured out;
  const auto reader = make_reader(InputFormat::kPcapng);
  auto take = [&](const Packet& packet) {
    ++out.packets[reader->interfaces().at(packet.interface_id).name];
    if (packet.error.fault != Fault::kNone) ++out.bad;
    out.last_ns = packet.time_ns;
  };
  reader->feed(Bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), take);
  reader->finish(take);
  return out;
}

TEST(CaseFiles, CapturesHaveEachFrameOnce) {
  const Captured timeline = read_capture(case_pcapng(one("timeline")));
  std::size_t radio = 0;
  std::size_t serial = 0;
  std::int64_t last = 0;
  const trace::Case log = one("timeline").result.log.read();
  for (const trace::Line* line : log.lines()) {
    if (line->op != trace::Op::kEmits || !line->bytes) continue;
    if (line->link == "rA") ++radio;
    if (line->link == "serA") ++serial;
    last = line->time.from;
  }
  EXPECT_THAT(timeline.packets, ElementsAre(std::pair("rA", radio), std::pair("serA", serial)));
  EXPECT_EQ(timeline.bad, 0u);
  EXPECT_EQ(timeline.last_ns, last * 1'000'000'000 / 1024);
}

TEST(CaseFiles, NoCaptureWithoutFramesOrOfPeisAlone) {
  CaseRun silent = one("j4.accept");
  silent.result.log = {};
  EXPECT_EQ(case_pcapng(silent), "");
  for (const CaseRun& each : whole().implementations[0].cases) {
    const std::string capture = case_pcapng(each);
    if (capture.empty()) continue;
    const Captured read = read_capture(capture);
    EXPECT_EQ(read.bad, 0u) << each.name;
    EXPECT_FALSE(read.packets.contains("peis")) << each.name;
  }
}

TEST(CaseFiles, NamesAreSafe) {
  EXPECT_EQ(safe_name("tiny 0.3"), "tiny_0.3");
  EXPECT_EQ(safe_name("../../etc"), "_.._.._etc");
  EXPECT_EQ(safe_name("j4.accept#2"), "j4.accept~2");
  EXPECT_EQ(safe_name(""), "_");
  EXPECT_EQ(safe_name(".."), "_..");
  EXPECT_EQ(safe_name("a\xC3\xA4\n\"<%"), "a______");
  EXPECT_EQ(safe_name(std::string(300, 'x')).size(), 80u);
}

TEST(CaseSource, IsTheCaseWithItsHeaders) {
  CaseSources sources;
  const std::vector<SourceLine> lines = sources.of(whole(), one("j4.accept"));
  ASSERT_GT(lines.size(), 12u);
  EXPECT_EQ(lines[0].text, "%rtr 1");
  EXPECT_EQ(lines[5].text, "case j4.accept");
  EXPECT_EQ(lines[5].number, 8u);
  EXPECT_THAT(lines.back().text, HasSubstr("[J4-CONTENT]"));
  SuiteRun users = whole();
  users.traces = {"conformance/cases/j4.rtr"};
  EXPECT_EQ(sources.of(users, one("j4.accept")).size(), lines.size());
  CaseRun gone = one("j4.accept");
  gone.file = "no/such.rtr";
  EXPECT_TRUE(CaseSources().of(users, gone).empty());
}

// Returns a run whose texts try to end the script element, or to look like a placeholder.
SuiteRun hostile(const std::string& word) {
  SuiteRun run;
  for (int i = 0; i < 2; ++i) {
    ImplementationRun& out = run.implementations.emplace_back();
    out.target = word;
    out.identity = {word, "", {machine::Role::kMote}, false};
    out.cases = {one("j4.accept"), one("j4.accept")};
    out.cases[1].repeat = 1;
    out.cases[1].stderr_text = word;
  }
  return run;
}

TEST(Html, DataStaysInItsPlace) {
  for (const char* word : {"</script><script>alert(1)</script>", "<!-- <script>",
                           "@SCRIPT@ @NONCE@", "\xFF\xFE\xC3("}) {
    const SuiteRun run = hostile(word);
    const std::string text =
        html_data(run, nullptr, {{CaseLinks(), CaseLinks()}, {CaseLinks(), CaseLinks()}});
    EXPECT_THAT(text, Not(HasSubstr("<")));
    const Json data = Json::parse(text);
    EXPECT_EQ(data["implementations"].size(), 2u);
    if (word[0] != '\xFF') {
      EXPECT_EQ(data["implementations"][0]["name"], word);
      EXPECT_EQ(data["cases"][0]["runs"][1]["stderr"], word);
    }
    Folder folder;
    report(run, folder.path());
    const std::string page = folder.read("index.html");
    EXPECT_NE(page.find(text.substr(0, 60)), std::string::npos);
    std::size_t ends = 0;
    for (std::size_t at = 0; (at = page.find("</script", at)) != std::string::npos; ++at) ++ends;
    EXPECT_EQ(ends, 2u) << word;
  }
}

TEST(Html, FilesInTheFolderHaveNamesOfTheirOwn) {
  Folder folder;
  report(hostile("../../x"), folder.path());
  EXPECT_THAT(folder.files(),
              ElementsAre("cases/_.._.._x_~1/j4.accept.pcapng", "cases/_.._.._x_~1/j4.accept.rtr",
                          "cases/_.._.._x_~1/j4.accept~2.pcapng",
                          "cases/_.._.._x_~1/j4.accept~2.rtr", "cases/_.._.._x_~2/j4.accept.pcapng",
                          "cases/_.._.._x_~2/j4.accept.rtr", "cases/_.._.._x_~2/j4.accept~2.pcapng",
                          "cases/_.._.._x_~2/j4.accept~2.rtr", "index.html", "report.files"));
}

TEST(Html, APolicyWithANonceOfItsOwn) {
  std::set<std::string> nonces;
  for (int i = 0; i < 3; ++i) {
    Folder folder;
    report(hostile("x"), folder.path());
    const std::string page = folder.read("index.html");
    const std::size_t at = page.find("script-src 'nonce-");
    ASSERT_NE(at, std::string::npos);
    const std::string nonce = page.substr(at + 18, 32);
    EXPECT_EQ(nonce.find_first_not_of("0123456789abcdef"), std::string::npos) << nonce;
    nonces.insert(nonce);
    EXPECT_THAT(page, HasSubstr("default-src 'none'"));
    EXPECT_THAT(page, HasSubstr("<style nonce=\"" + nonce + "\">"));
    EXPECT_THAT(page, Not(HasSubstr("@NONCE@")));
    EXPECT_THAT(page, Not(HasSubstr("unsafe-inline")));
    EXPECT_THAT(page, Not(HasSubstr("https://")));
  }
  EXPECT_EQ(nonces.size(), 3u);
}

TEST(Html, SaysWhereItCannotWrite) {
  Folder folder;
  std::ofstream(folder.path() / "taken") << "a file";
  try {
    report(hostile("x"), folder.path() / "taken" / "report");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("taken"));
  }
}

TEST(HtmlData, AChartSaysWhenWhatIsMissingCameAfterAll) {
  for (const bool late : {false, true}) {
    SuiteRun run;
    ImplementationRun& out = run.implementations.emplace_back();
    out.cases = {one("j4.accept")};
    runner::Failure failure{.expected = "0..3 m5 > rA ack_join(*)", .to = 3, .node = "m5"};
    if (late) failure.elsewhere = 5;
    out.cases[0].result.failures = {failure};
    out.cases[0].result.verdict = runner::CaseVerdict::kFail;
    const Json data = Json::parse(html_data(run, nullptr, {{CaseLinks{"a.rtr", ""}}}));
    const Json& shown = data["cases"][0]["runs"][0];
    const std::string chart = data["charts"][shown["chart"].get<std::size_t>()];
    EXPECT_THAT(chart, HasSubstr(late ? "no ack_join, it came at 5" : "no ack_join<"));
  }
}

TEST(HtmlData, KnowsTheEarlierRunAndWhatBrokeARule) {
  SuiteRun run;
  ImplementationRun& out = run.implementations.emplace_back();
  out.identity.name = "machine";
  out.cases = {one("j4.accept")};
  CaseRun& broken = out.cases[0];
  broken.result.verdict = runner::CaseVerdict::kFail;
  const trace::Case log = broken.result.log.read();
  const std::vector<const trace::Line*> lines = log.lines();
  std::size_t at = 0;
  while (lines[at]->message.name != "ack_join") ++at;
  runner::Failure failure{.place = {14, 1},
                          .requirements = {"J4-ACK"},
                          .time = static_cast<runner::Ticks>(lines[at]->time.from),
                          .expected = "0..300 m5 !> rA ack_join(*)",
                          .text = "it emitted rA " + trace::print(lines[at]->message),
                          .forbidden = true,
                          .node = lines[at]->node};
  broken.result.failures = {failure};
  EarlierRun earlier;
  earlier.verdicts[{"machine", "j4.accept"}] = "pass";
  earlier.verdicts[{"machine", "j4.gone"}] = "weak";
  const Json data = Json::parse(html_data(run, &earlier, {{CaseLinks{"a.rtr", ""}}}));
  const Json& shown = data["cases"][0]["runs"][0];
  EXPECT_EQ(shown["earlier"], "pass");
  EXPECT_EQ(data["gone"], Json::parse(R"([{"implementation": "machine", "name": "j4.gone",
                                           "was": "weak"}])"));
  EXPECT_EQ(shown["rtr"], "a.rtr");
  EXPECT_EQ(shown["failures"][0]["row"], at);
  const std::string chart = data["charts"][shown["chart"].get<std::size_t>()];
  EXPECT_THAT(
      chart, HasSubstr("<g class=\"rc-row rc-marked\" data-lines=\"" + std::to_string(at) + "\">"));
  EXPECT_THAT(chart, HasSubstr("\u25c0 ack_join"));
  EXPECT_EQ(data["rules"]["J4-ACK"]["level"], "MUST");
  const Json& row = shown["log"][at];
  EXPECT_EQ(data["frames"][row["frame"].get<std::size_t>()]["text"],
            trace::print(lines[at]->message));
}

}  // namespace
}  // namespace rubric::suite
