#!/usr/bin/env python3
"""Keeps the house rules that a compiler does not: who may include whom, line lengths, file sizes.

Usage: tidy_test.py PROJECT_FOLDER. Prints each breach with its place; exit 1 if there is one.
"""

import json
import pathlib
import re
import subprocess
import sys

# A folder and the project's folders whose headers its files may include. Tests may include more.
ALLOWED = {
    "spec/compiler/main.cc": ["spec/compiler", "tools/cli/command.h", "tools/cli/exit_codes.h"],
    "spec/compiler": ["spec/compiler", "codec/runtime", "codec/reflect/schema.h",
                      "codec/reflect/suggest.h", "codec/text/text.h", "codec/text/yaml.h"],
    "codec/runtime": ["codec/runtime"],
    "codec/generated": ["codec/runtime", "codec/generated", "codec/reflect/schema.h"],
    "codec/containers": ["codec/runtime", "codec/containers"],
    "codec/reflect": ["codec/runtime", "codec/generated", "codec/containers", "codec/reflect",
                      "codec/tests"],
    "codec": ["codec"],
    "conformance/machine": ["codec/runtime", "codec/generated", "conformance/machine",
                            "conformance/generated/profiles.h"],
    "conformance/trace/events": ["codec", "conformance/trace", "conformance/machine"],
    "conformance/trace": ["codec", "conformance/trace"],
    "conformance/selftest/lawful_traffic/main.cc": ["conformance/selftest/lawful_traffic",
                                                    "tools/cli/command.h"],
    "conformance/adapters/machine": ["codec", "conformance", "tools/cli/command.h"],
    # Lawful traffic is written from the rules: it shares nothing with what it is a test of.
    "conformance/selftest/lawful_traffic": ["codec", "conformance/selftest/lawful_traffic"],
    # Written from the rules as well, and tried by what the reference machine passes.
    "conformance/node": ["codec/runtime", "codec/generated", "conformance/node"],
    "conformance/adapters/cpp": ["codec/runtime", "conformance/node", "conformance/adapters/cpp"],
    "conformance/adapters/firmware": ["codec/runtime", "codec/generated", "conformance/node",
                                      "conformance/adapters/firmware"],
    "conformance": ["codec", "conformance"],
    "fuzz": ["codec", "conformance", "spec/compiler", "fuzz", "tools"],
    # Skeletons leave the project, so they need nothing of it.
    "tools/skeletons": ["my_node.h"],
    # Reading, showing and writing frames needs nothing of the conformance kit.
    "tools/cli/specs.cc": ["codec", "spec/compiler", "tools/cli"],
    "tools/cli": ["codec", "tools/cli", "tools/format"],
    "tools/encode": ["codec", "tools/cli", "tools/encode", "tools/format"],
    "tools/format": ["codec", "tools/format"],
    "tools/commands/stats/": ["codec", "tools/cli", "tools/commands/explain",
                              "tools/commands/stats", "tools/format"],
    "tools/wireshark": ["codec", "tools/cli", "tools/format", "tools/wireshark"],
    "tools/commands/decode.cc": ["codec", "tools"],
    "tools": ["codec", "conformance", "tools"],
}
CODE = {".cc", ".h", ".py", ".js", ".java", ".nc", ".c", ".pml", ".cmake"}
SOURCES = CODE | {".ksy", ".md", ".sh", ".yaml"}
MAX_COLUMNS = 100
MAX_LINES = 600
MAX_FILES = 40  # Sources and headers of a folder, tests in Python and JavaScript among them.
COUNTED = {".cc", ".h", ".py", ".js", ".mjs"}
MAX_TOOLS = 15  # Entries of tools/.
# The one folder that sees the command line library, whose header costs more than a command.
COMMAND_LINE = re.compile(r"#include <CLI/")
# The wire is read in one way: by generated views and places (`NetMsgLayout::SeqNumAt`) and by the
# reflection tables, both made from spec/wire. What reads or writes its bytes by hand looks so:
WIRE_BY_HAND = [
    (re.compile(r"\b(?:load|store)_(?:u8|[bl]e(?:16|32))\("), "a number of the wire by hand"),
    (re.compile(r"\b0x(?:88[046][01]|c[cf][04][0f])\b|\b0x[46]1\b.*\b0x88\b", re.I),
     "a frame control field of 802.15.4"),
    (re.compile(r"[=(,{] ?0x3f\b", re.I), "the network byte of an I-frame"),
    (re.compile(r"\bconstexpr [\w:]+ k\w*(?:Offset|At|HeaderBytes|HeadBytes) ?= ?[1-9]"),
     "an offset or the size of a header"),
    (re.compile(r"(?<!char )(?<!uint8_t )\b(?:payload|packet|body|bytes|frame)_?(?:\(\))?"
                r"(?:(?:\.data\(\))?\[\d+\]|\.(?:data|begin)\(\) \+ [1-9])"),
     "a byte of a frame by its number"),
    (re.compile(r"\] ?<< ?(?:8|16|24)\b"), "a number of the wire by hand"),
    (re.compile(r"\b(?:rubicon|tinyos)::(?!\w+(?:View|Layout|Builder)\b)[A-Z]\w+(?: \w+)?"
                r"\{\s*[^}\s]|Layout::store\(\{"), "the fields of a structure by their order"),
]
# What people read is printed by text::print(), which makes it harmless for terminals. These print
# for programs, or draw over a line of their own; node and adapters share nothing with the tools.
PRINTED = re.compile(r"\bfmt::print\((?!f)|\bstd::c(?:err|out)\b|\bf?puts\(.*\bstd(?:err|out)\b")
PRINTERS = ("codec/text/text.cc", "tools/cli/progress.cc", "tools/commands/completion.cc",
            "tools/commands/explore.cc", "tools/commands/main.cc",
            "tools/commands/run/json_application.cc", "tools/wireshark/extcap/main.cc")
PRINTING = ("tools/cli", "tools/commands", "tools/encode", "tools/format", "tools/wireshark",
            "codec/lines", "conformance/check", "conformance/test")
# Where bytes are read by hand for a reason, besides tests, which state what they expect.
HAND_MADE = {
    "codec/runtime/": "the loads and stores themselves, and the framing of serial lines",
    "codec/containers/": "framing: capture files, check sums, records",
    "codec/reflect/decode.cc": "loads what the tables say",
    "codec/reflect/evaluate.cc": "loads what the tables say",
    "codec/reflect/encode_number.cc": "stores what the tables say",
    "codec/bench/": "compares views with hand-written code",
    "codec/tests/": "tests",
    "conformance/selftest/lawful_traffic/": "independent of what it tests, see its README",
    "conformance/adapters/firmware/bench/": "records between a board and its bench, not frames",
    "conformance/adapters/firmware/host/bridge.cc": "the same records",
    "conformance/adapters/firmware/host/words.cc": "the same records",
    "codec/lines/forwarder.cc": "framing: packets of a serial forwarder",
    "conformance/selftest/scripts/bytes.": "scripts as the fuzzers' bytes",
    "conformance/selftest/scripts/walk.": "walks as the fuzzers' bytes",
    "fuzz/support/": "what fuzz targets compare the codec with",
    "fuzz/targets/": "what fuzz targets compare the codec with",
    "spec/compiler/": "writes the code that loads",
}
INCLUDE = re.compile(r'#include "([^"]+)"')
# A quotation of a rule beside the code that keeps it: `//= J4-SEQ: the sentence`, perhaps going on
# in the next `//=` line.
QUOTE = re.compile(r"\s*//= (.*)")
# Code names a rule.
NAMED_RULE = re.compile(r'"([\w-]+)"_rule')
QUOTE_START = re.compile(r"([A-Z][A-Z0-9-]*[A-Z0-9]): (.*)")


def catalogue(root):
    """The sentence of each rule."""
    text = (root / "spec/requirements.yaml").read_text(encoding="utf-8")
    pairs = re.findall(r'^- id: (\S+)\n(?:  .*\n)*?  sentence: "(.*)"$', text, re.M)
    return dict(pairs)


def quotes(lines):
    """Each quotation with the number of its first line."""
    found = []
    going_on = False
    for number, line in enumerate(lines, 1):
        quote = QUOTE.match(line)
        start = quote and QUOTE_START.match(quote[1])
        if start:
            found.append([number, start[1], start[2]])
        elif quote and going_on:
            found[-1][2] += " " + quote[1]
        elif quote:
            found.append([number, quote[1], ""])
        going_on = quote is not None
    return found


def quote_breaches(path, lines, sentences):
    for number, rule, text in quotes(lines):
        if rule not in sentences:
            yield f"{path}:{number}: the catalogue has no rule {rule}"
        elif text != sentences[rule]:
            yield f"{path}:{number}: {rule} says: {sentences[rule]}"


def name_breaches(path, lines, sentences):
    """Names of rules that the catalogue does not have; their numbers would be nobody's."""
    for number, line in enumerate(lines, 1):
        for name in NAMED_RULE.findall(line):
            if name not in sentences:
                yield f"{path}:{number}: the catalogue has no rule {name}"


def tracked(root):
    out = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=root, check=True,
                         capture_output=True, text=True).stdout
    return [pathlib.PurePath(line) for line in out.splitlines() if (root / line).is_file()]


def include_breaches(path, lines):
    area = next((a for a in ALLOWED if f"{path}/".startswith(a + "/")), None)
    if area is None or path.stem.endswith(("_test", "_bench")) or "/tests/" in str(path) \
            or "/bench/" in str(path):
        return
    for number, line in enumerate(lines, 1):
        if COMMAND_LINE.match(line) and path.parent != pathlib.PurePath("tools/cli"):
            yield f"{path}:{number}: tools/cli alone includes the command line library"
        found = INCLUDE.match(line)
        if found and not any(found[1] == a or found[1].startswith(a + "/") for a in ALLOWED[area]):
            yield f"{path}:{number}: {area} may not include {found[1]}"


def wire_breaches(path, lines):
    """Lines of C++ that know where a structure of the wire has its fields."""
    name = str(path)
    test = path.stem.endswith(("_test", "_bench", "_fixture")) or path.stem == "testing"
    if path.suffix not in {".cc", ".h"} or test or "generated" in path.parts \
            or name.startswith(tuple(HAND_MADE)):
        return
    for number, line in enumerate(lines, 1):
        code = line.split("//")[0]
        for pattern, what in WIRE_BY_HAND:
            if pattern.search(code):
                yield f"{path}:{number}: {what}; spec/wire and what is generated from it say that"


def print_breaches(path, lines):
    """Lines that print for people without making it harmless."""
    name = str(path)
    test = "test" in path.stem or "bench" in path.stem or "tests" in path.parts
    if path.suffix not in {".cc", ".h"} or test or name in PRINTERS \
            or not name.startswith(PRINTING):
        return
    for number, line in enumerate(lines, 1):
        if PRINTED.search(line.split("//")[0]):
            yield f"{path}:{number}: prints what may not be harmless; text::print() does"


def folder_breaches(files):
    sources = {}
    for path in files:
        if path.suffix in COUNTED and "generated" not in path.parts:
            sources[path.parent] = sources.get(path.parent, 0) + 1
    for folder, count in sources.items():
        if count > MAX_FILES:
            yield f"{folder}: {count} sources and headers, at most {MAX_FILES}"
    tools = {path.parts[1] for path in files if path.parts[0] == "tools"}
    if len(tools) > MAX_TOOLS:
        yield f"tools: {len(tools)} entries, at most {MAX_TOOLS}"


def bug_breaches(root, files):
    """A bug that a long test plants has its place in the source, also after that has changed."""
    for path in (path for path in files if path.name == "bugs.json"):
        for bug in json.loads((root / path).read_text("utf-8")):
            trees = (root / path.parent, root / "conformance")  # Firmware is made of both.
            source = next((tree / bug["file"] for tree in trees
                           if (tree / bug["file"]).is_file()), None)
            if source is None or source.read_text("utf-8").count(bug["old"]) != 1:
                yield f"{path}: {bug['name']}: {bug['file']} does not have its old text once"


def breaches(root, path, sentences):
    generated = "generated" in path.parts or "captures" in path.parts or "vectors" in path.parts
    code = path.suffix in CODE or path.name == "CMakeLists.txt"
    if not code and path.suffix not in SOURCES:
        return
    lines = (root / path).read_text(encoding="utf-8", errors="replace").splitlines()
    yield from include_breaches(path, lines)
    yield from wire_breaches(path, lines)
    yield from print_breaches(path, lines)
    quoting = path.suffix in {".cc", ".h", ".java"}
    yield from quote_breaches(path, lines if quoting else [], sentences)
    yield from name_breaches(path, lines if quoting else [], sentences)
    for number, line in enumerate(lines, 1):
        # Prose in data files and tables in documents may run long.
        if code and not (generated and path.suffix != ".h") and len(line) > MAX_COLUMNS:
            yield f"{path}:{number}: {len(line)} columns, at most {MAX_COLUMNS}"
        if code and line != line.rstrip():
            yield f"{path}:{number}: blanks at the end of the line"
    if code and not generated and len(lines) > MAX_LINES:
        yield f"{path}: {len(lines)} lines, at most {MAX_LINES}"
    if path.suffix == ".h" and "#pragma once" not in lines:
        yield f"{path}: no #pragma once"


# What people wrote before there was one reader, and the lines that took its place.
PLANTED = [
    "  out = {load_be16(p), load_be16(p + 2), load_be32(p + 4), load_be16(p + 8)};",
    "  store_le16(bytes.data() + 3, kPanId);",
    "constexpr std::uint16_t kFcfData = 0x8841;  // Short addresses in one PAN.",
    "constexpr std::uint16_t kFcfAddressing = 0xCC00;",
    "constexpr std::uint8_t kNetworkLowpan = 0x3F;",
    "constexpr std::size_t kMacHeaderBytes = 9;",
    "constexpr std::size_t kReplySeqOffset = 8;",
    "  const std::uint8_t trans_id = payload[0];",
    "  std::copy_n(frame.payload.begin() + 4, 4, ack.payload.begin());",
    "  out.type = packet.data()[7];",
    "  const rubicon::JoinReply reply{island, dest, clock_ms(node), seq_num};",
    "  rubicon::JoinRequestLayout::store({seq_num, wire_of(what)}, place.payload);",
    "  const int value = bytes[i] << 8 | bytes[i + 1];",
]
SOUND = [
    "  out.seq_num = NetMsgLayout::SeqNumAt::load(p);",
    "constexpr std::size_t kMacHeaderBytes = tinyos::MacHeaderView::kMaxSizeBytes;",
    "  const auto reply = rubicon::JoinReplyView::parse(frame.payload);",
    "  std::uint8_t bytes[4096];",
    "  rubicon::JoinReply reply{};",
    "std::optional<rubicon::NetMsgView> read(Bytes bytes) {",
    "  return payload.data();  // Not load_be16(p): the view does.",
]


def self_test():
    """Each planted line is found in each place where it may not be, and nothing else is."""
    reader = pathlib.PurePath("conformance/check/input/read_packet.cc")
    lawful = pathlib.PurePath("conformance/selftest/lawful_traffic/air.cc")
    for line in PLANTED:
        assert list(wire_breaches(reader, [line])), f"not found: {line}"
        assert not list(wire_breaches(lawful, [line])), line
    assert not list(wire_breaches(reader, SOUND)), list(wire_breaches(reader, SOUND))


def main():
    self_test()
    root = pathlib.Path(sys.argv[1])
    files = tracked(root)
    sentences = catalogue(root)
    found = [b for path in files for b in breaches(root, path, sentences)]
    found += folder_breaches(files)
    found += bug_breaches(root, files)
    for breach in found:
        print(breach)
    print(f"{len(files)} files, {len(found)} mistakes")
    return 1 if found or not files else 0


if __name__ == "__main__":
    sys.exit(main())
