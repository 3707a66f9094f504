#!/usr/bin/env python3
"""The book: the same bytes each time, every link leads somewhere, nothing of the protocol is
missing, and every mistake in a chapter is told with its place.

Usage: book_test.py RUBRIC RUBRICC [TEST...]
"""

import base64
import hashlib
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser

RUBRIC, RUBRICC = (str(pathlib.Path(one).absolute()) for one in sys.argv[1:3])
HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
MAX_BYTES = 4 << 20


def make(out, *options):
    return subprocess.run([sys.executable, HERE / "make_book.py", "--rubric", RUBRIC,
                           "--rubricc", RUBRICC, "--out", out, *options],
                          capture_output=True, text=True, check=False)


class Page(HTMLParser):
    """Collects the parts of the finished page, independently of the generator's own check."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.links, self.attributes, self.tags, self.policy = [], [], set(), set(), ""
        self.sources = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        for name, value in attrs:
            self.attributes.add(name)
            if name == "id":
                self.ids.append(value)
            if name == "href":
                self.links.append(value)
            if name == "src":
                self.sources.append(value)
        if ("http-equiv", "Content-Security-Policy") in attrs:
            self.policy = dict(attrs)["content"]


class Book(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()  # pylint: disable=consider-using-with
        cls.addClassCleanup(cls.folder.cleanup)
        cls.out = pathlib.Path(cls.folder.name) / "doc/rubric.html"
        cls.chapters = pathlib.Path(cls.folder.name) / "chapters"
        shutil.copytree(HERE / "chapters", cls.chapters)
        cls.made = make(cls.out, "--chapters", cls.chapters)
        if cls.made.returncode != 0:
            raise AssertionError(cls.made.stderr)
        cls.text = cls.out.read_text(encoding="utf-8")
        cls.page = Page(cls.text)

    def section(self, anchor):
        """The text from an anchor to the end of its section."""
        return re.search(rf'id="{re.escape(anchor)}".*?</section>', self.text, re.S)[0]

    def test_the_same_bytes_each_time(self):
        again = self.out.with_name("again.html")
        self.assertEqual(make(again, "--chapters", self.chapters).returncode, 0)
        self.assertEqual(again.read_bytes(), self.out.read_bytes())

    def test_is_of_a_sensible_size_and_of_no_machine(self):
        self.assertLess(len(self.text.encode()), MAX_BYTES)
        self.assertGreater(len(self.text.encode()), 500_000)
        for path in {str(ROOT), self.folder.name, str(pathlib.Path(RUBRIC).parent)}:
            self.assertNotIn(path, self.text)
        self.assertNotRegex(self.text, r"\{\{\w|\bblock-\d+-of-this-chapter|@[A-Z_]+@")

    def test_every_link_leads_somewhere(self):
        self.assertEqual(len(self.page.ids), len(set(self.page.ids)))
        ids = set(self.page.ids)
        inner = [one for one in self.page.links if one.startswith("#")]
        self.assertGreater(len(inner), 2000)
        self.assertEqual([one for one in inner if one[1:] not in ids], [])
        outer = {one for one in self.page.links if not one.startswith("#")} - {"data:,"}
        self.assertEqual([one for one in outer if not re.fullmatch(r"https?://\S+", one)], [])
        for one in outer:  # Listed for whoever has a network to try them.
            self.assertIn(one, self.made.stdout)

    def test_nothing_of_the_protocol_is_missing(self):
        ids = set(self.page.ids)
        rules = re.findall(r"^- id: (\S+)$", (ROOT / "spec/requirements.yaml").read_text("utf-8"),
                           re.M)
        self.assertGreater(len(rules), 180)
        self.assertEqual([one for one in rules if one not in ids], [])
        listed = json.loads(subprocess.run(
            [RUBRIC, "messages", "--format", "json"], capture_output=True, check=True).stdout)
        messages = [one["id"] for one in listed["messages"]]
        self.assertGreater(len(messages), 25)
        self.assertEqual([one for one in messages if one not in ids], [])
        cases = [name for path in (ROOT / "conformance/cases").rglob("*.rtr")
                 for name in re.findall(r"^case (\S+)", path.read_text("utf-8"), re.M)]
        self.assertGreater(len(cases), 250)
        self.assertEqual([one for one in cases if one not in ids], [])
        for path in (ROOT / "spec/decisions").glob("[0-9]*.md"):
            self.assertIn(f"decision-{int(path.name[:4])}", ids)
        for enum in ("am_type", "pid", "mote_type", "transducer_mask"):
            self.assertIn(enum, ids)

    def test_a_rule_says_what_is_known_of_it(self):
        text = self.section("J4-SEQ")
        for part in ("MUST", "A mote ignores a join_reply whose sequence number is not that of its "
                     "outstanding request.", "Release 1.0", "paper: Component Management",
                     'href="#j4.wrong_seq"', "tempts it", 'href="#decision-117"', "mutants"):
            self.assertIn(part, text)
        self.assertIn("Accepted (deployed)", self.section("J3-TIME"))
        self.assertIn("files of bytes that break it", self.section("WIRE-NET-RELIABLE"))

    def test_a_message_has_its_picture_and_its_fields(self):
        text = self.section("join_reply")
        for part in ("10 bytes", "15 (0x0f)", "AM type 15 on radio", 'class="bytes"',
                     "<code>cur_time</code>", 'href="#WIRE-JOIN-REPLY"',
                     "island_addr 2, mote_addr 2, cur_time 4, seq_num 2"):
            self.assertIn(part, text)
        row = re.search(r"<code>seq_num</code></th><td>(\d+)</td><td>(\d+)</td>", text)
        self.assertEqual(row.groups(), ("8", "2"))

    def test_a_trace_is_shown_unchanged(self):
        found = re.search(r'<details class="case" id="j4.wrong_seq".*?</details>', self.text, re.S)
        self.assertIn("%profile paper", found[0])
        self.assertIn("b+2..99            m5 !&gt; rA  ack_join(*)", found[0])

    def test_the_page_lets_nothing_else_in(self):
        for tag, kind in (("style", "style-src"), ("script", "script-src")):
            (inner,) = re.findall(rf"<{tag}>(.*?)</{tag}>", self.text, re.S)
            digest = base64.b64encode(hashlib.sha256(inner.encode()).digest()).decode()
            self.assertIn(f"{kind} 'sha256-{digest}'", self.page.policy)
        self.assertTrue(self.page.policy.startswith("default-src 'none'"))
        self.assertNotIn("unsafe", self.page.policy)
        self.assertEqual(self.page.attributes & {"style", "srcset", "action"}, set())
        self.assertEqual([one for one in self.page.sources
                          if not one.startswith("data:image/png;base64,")], [])
        self.assertEqual([one for one in self.page.attributes if re.fullmatch("on[a-z]+", one)], [])
        self.assertEqual(self.page.tags & {"iframe", "object", "embed", "form"}, set())

    def test_exit_codes(self):
        self.assertEqual(make("/dev/null/nowhere").returncode, 3)
        no_program = subprocess.run(
            [sys.executable, HERE / "make_book.py", "--rubric", "/nowhere/rubric", "--rubricc",
             RUBRICC, "--out", self.out.with_name("no.html")], capture_output=True, check=False)
        self.assertEqual(no_program.returncode, 3)
        usage = subprocess.run([sys.executable, HERE / "make_book.py"], capture_output=True,
                               check=False)
        self.assertEqual(usage.returncode, 2)


class Mistakes(unittest.TestCase):
    def chapter(self, text, references=True, **more):
        """The mistakes in a book of one chapter, 10-a.md, and of those in `more`. Without
        `references`, which take two seconds, it can show nothing of the protocol."""
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "10-a.md").write_text(text, encoding="utf-8")
            for name, inner in more.items():
                (folder / f"20-{name}.md").write_text(inner, encoding="utf-8")
            # The references, so that links of generated parts have their targets.
            parts = ("all_layouts", "all_enums", "all_rules", "all_cases", "decisions")
            (folder / "90-z.md").write_text(
                "# Z\n\n" + "".join(f"{{{{{one}}}}}\n\n" for one in parts if references),
                encoding="utf-8")
            done = make(folder / "out.html", "--chapters", folder)
            self.assertEqual((folder / "out.html").exists(), done.returncode == 0)
            self.assertEqual(done.returncode, 1 if done.stderr else 0)
            return done.stderr.splitlines()

    def only(self, text, expected, **more):
        found = self.chapter(text, **more)
        self.assertEqual(len(found), 1, found)
        self.assertRegex(found[0], expected)

    def test_none(self):
        self.assertEqual(self.chapter("# A\n\nText with `a < b`, J4-SEQ and decision 105.\n"), [])

    def test_directives(self):
        found = self.chapter(
            "# A\n\n{{layuot join_reply}}\n\n{{layout join_replay}}\n\n{{enum mote}}\n\n"
            "{{rules J44}}\n\n{{case j4.lisetd}}\n\n{{chart j4.nothing}}\n\n{{states nothing}}\n\n"
            "{{help nothing}}\n\n{{include spec/nothing}}\n\n{{dispatch smoke}}\n\n{{layout}}\n\n"
            "{{coverage J4}}\n\n{{include ../../etc/passwd}}\n")
        wanted = ["no directive is called 'layuot'; expected layout$",
                  "no message is called 'join_replay'; expected join_reply$",
                  "no enum is called 'mote'; expected",
                  "no rule or group is called 'J44'; expected J4",
                  "no golden trace is called 'j4.lisetd'",
                  "no golden trace is called 'j4.nothing'; expected",
                  "no state diagram is called 'nothing'; expected .*join, listing",
                  "no command of rubric is called 'nothing'", "no file of the project is called",
                  "no carrier is called 'smoke'; expected radio_ack, radio_i",
                  r"expected '\{\{layout NAME\}\}'", r"expected '\{\{coverage\}\}'",
                  "no file of the project is called"]
        self.assertEqual(len(found), len(wanted), found)
        for number, (line, text) in enumerate(zip(found, wanted)):
            self.assertRegex(line, rf"10-a\.md:{2 * number + 3}: .*{text}")

    def test_a_thing_is_shown_once(self):
        self.only("# A\n\n{{rules J4}}\n", r"20-b\.md:3: J4-SEQ is shown at 10-a\.md:3 already",
                  b="# B\n\n{{rules J4-SEQ}}\n")
        self.only("# A\n\n{{layout net_msg}}\n\n{{layout rubicon::net_msg}}\n",
                  r"10-a\.md:5: rubicon::net_msg is shown at 10-a\.md:3 already")

    def each(self, *wanted):
        """As only() of each text with what is expected of it, but all as chapters of one book."""
        book = {f"{i}-{i}": text for i, (text, _) in enumerate(wanted)}
        found = self.chapter("# First\n", references=False, **book)
        self.assertEqual(len(found), len(wanted), found)
        for i, (_, expected) in enumerate(wanted):
            place = rf"20-{i}-{i}\.md"
            self.assertRegex("\n".join(found), f"(?m){place}{expected}")

    def test_links(self):
        self.each(("# A\n\nSee\n[here](#nowhere).\n", ":4: #nowhere leads nowhere"),
                  ("# B\n\n[x](../README.md)\n", r":3: '\.\./README\.md' leads to a file"),
                  ("# C\n\n[x](https://nodots/a)\n", ":3: .* is not an address"),
                  ("# D\n\n## Text {#find}\n", ":3: #find exists already, in the page"))
        self.only("# A\n\n## Same\n\n[b](#b)\n", r"20-b\.md:3: #same exists already, in 10-a\.md",
                  references=False, b="# B\n\n## Same\n")

    def test_text(self):
        self.each(("No title.\n", ":1: expected '# Title'"),
                  ("# B\n\n```text\nx\n", ":3: expected a line that closes this fence"),
                  ("# C\n\nSee {{rules J4}} here.\n", ":3: expected a directive alone"),
                  ("# D\n\n#### Deep\n", ":3: expected a heading of level 2 at most"),
                  ("# E\n\n# F\n", ":3: expected one heading of level 1"),
                  ("# G\n\n<b>bold</b>\n", ":3: expected no HTML"))

    def test_text_is_never_markup(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "10-a.md").write_text(
                "# A\n\n`<script>alert(1)</script>`\n\n```text\n</pre><b>{{x}}@SCRIPT@\n```\n",
                encoding="utf-8")
            (folder / "90-z.md").write_text("# Z\n", encoding="utf-8")
            done = make(folder / "out.html", "--chapters", folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            text = (folder / "out.html").read_text(encoding="utf-8")
            self.assertEqual(text.count("<script>"), 1)
            self.assertIn("&lt;/pre&gt;&lt;b&gt;{{x}}@SCRIPT@", text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
