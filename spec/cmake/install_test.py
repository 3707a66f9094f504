#!/usr/bin/env python3
"""Installs what was built, and the Debian packages made of it, and builds programs of somebody else
against them, by CMake and by pkg-config, after the folder was moved as well.

Usage: install_test.py BUILD_FOLDER [--lintian]: its packages alone, with Debian's own checks.
"""

import concurrent.futures
import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

BUILD = ""
LINTIAN = False
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/book"))
import snippets  # pylint: disable=wrong-import-position
# Lines and stations go on until somebody ends them, a large exploration for minutes.
GOES_ON = re.compile(r"@|mqtt:|zep:|sf-server:|--follow|explore --motes|"
                     r"rubric (run|forward|monitor|proxy)")
GOING_ON_SECONDS = 3
EXAMPLE_SECONDS = 60  # All others take seconds.
TOO_LONG = -1
ISLANDS = "islands:\n  - island: 11\n    radio: zep:0\n    motes:\n      - {id: 5, app: demo}\n"
CODEC = """
#include <cstdio>
#include "codec/generated/rubicon/join_reply.h"

int main() {
  uint8_t bytes[16];
  rubric::rubicon::JoinReply reply;
  reply.island_addr = 11;
  reply.mote_addr = 2;
  reply.seq_num = 7;
  const auto written = rubric::rubicon::write(reply, rubric::MutableBytes(bytes, sizeof bytes));
  if (!written) return 1;
  const auto view = rubric::rubicon::JoinReplyView::parse(written.value());
  std::printf("%zu bytes, island %u\\n", view->size_bytes(), unsigned{view->island_addr()});
  return view->island_addr() == 11 ? 0 : 1;
}
"""
CONFORMANCE = """
#include <cstdio>
#include "conformance/machine/step.h"
#include "conformance/test/suite/cases.h"

int main() {
  rubric::machine::Config config;
  const rubric::machine::State state = rubric::machine::start(config);
  std::printf("%zu files of cases, %zu timers\\n", rubric::suite::embedded_files().size(),
              std::size_t{rubric::machine::timers(state).size()});
  return rubric::suite::embedded_files().empty();
}
"""
PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(consumer LANGUAGES CXX)
find_package(rubric {wanted})
add_executable(consumer main.cc)
target_link_libraries(consumer PRIVATE rubric::{part})
target_compile_options(consumer PRIVATE -Werror)
"""


def examples_of(text):
    """The lines below Examples: of a command's help, whole and without comments."""
    found = re.search(r"^Examples:\n((?:  .*\n)+)", text, re.M)
    out = []
    for line in found[1].splitlines() if found else ():
        line = re.sub(r"\s{2,}#.*", "", line).strip()
        if out and out[-1].endswith("|"):
            out[-1] += " " + line
        else:
            out.append(line)
    return out


def run(*words, **more):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True,
                          check=False, **more)
    if done.returncode:
        raise AssertionError(f"{words}: {done.stdout}\n{done.stderr}")
    return done.stdout


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="rubric-install-")
        cls.base = pathlib.Path(cls.folder.name)
        run("cmake", "--install", BUILD, "--prefix", cls.base / "first")
        # Nothing installed may know where it was installed to.
        (cls.base / "first").rename(cls.base / "moved")
        cls.prefix = cls.base / "moved"

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def consumer(self, name, part, code, prefix, *arguments, wanted="REQUIRED"):
        folder = self.base / name
        folder.mkdir()
        (folder / "main.cc").write_text(code, encoding="utf-8")
        (folder / "CMakeLists.txt").write_text(PROJECT.format(part=part, wanted=wanted),
                                               encoding="utf-8")
        run("cmake", "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={prefix}",
            *arguments)
        run("cmake", "--build", folder / "build")
        return run(folder / "build/consumer")

    def examples(self, prefix):
        return next(prefix.glob("**/examples"))

    def flags(self, prefix, module):
        found = next(prefix.glob("**/pkgconfig"))
        return run("pkg-config", "--cflags", "--libs", module,
                   env={**os.environ, "PKG_CONFIG_PATH": str(found)}).split()

    def pkg_config(self, prefix, module, code, name):
        source = self.base / f"{name}.cc"
        source.write_text(code, encoding="utf-8")
        run("c++", "-std=c++20", source, "-o", self.base / name, *self.flags(prefix, module))
        return run(self.base / name)

    def test_the_codec_needs_nothing_else(self):
        said = self.consumer("codec", "codec", CODEC, self.prefix,
                             "-DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON",
                             "-DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON")
        self.assertEqual(said, "10 bytes, island 11\n")

    def test_the_node_on_a_pc(self):
        code = (self.examples(self.prefix) / "pc.cc").read_text(encoding="utf-8")
        said = self.consumer("node", "node", code, self.prefix,
                             "-DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON",
                             "-DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON",
                             wanted="REQUIRED COMPONENTS node")
        self.assertIn("sink: mote 5 is a member\n", said)
        self.assertRegex(said, r"mote: message \d+ acked\n$")

    def test_an_application_in_python(self):
        knock = {"event": "received", "src": "12:65533", "app_id": 10, "data": b"OPEN_DOOR".hex()}
        said = run(sys.executable, self.examples(self.prefix) / "door.py",
                   input=json.dumps(knock) + "\n")
        self.assertEqual([json.loads(line)["call"] for line in said.splitlines()],
                         ["join", "send"])

    def test_an_application_in_cpp(self):
        door = self.base / "door"
        run("c++", "-std=c++17", "-Wall", "-Wextra", "-Werror",
            self.examples(self.prefix) / "door.cc", "-o", door)
        knock = {"event": "received", "src": "12:65533", "app_id": 10, "data": b"OPEN_DOOR".hex()}
        said = run(door, input=json.dumps({"event": "joined", "own": "0:5", "success": False}) +
                   "\n" + json.dumps(knock) + "\n")
        self.assertEqual([json.loads(line) for line in said.splitlines()][2],
                         {"call": "send", "dest": "12:65533", "app_id": 10, "reliable": True,
                          "data": b"DOOR_IS_OPEN".hex()})

    def test_the_program_alone_has_the_applications_of_the_book(self):
        """What the Debian package rubric has."""
        prefix = self.base / "tool"
        run("cmake", "--install", BUILD, "--component", "tool", "--prefix", prefix)
        chapters = "".join((ROOT / "tools/book/chapters" / name).read_text(encoding="utf-8")
                           for name in ("34-run.md", "35-scenarios.md"))
        named = set(re.findall(r"app: python3 (\w+\.py)", chapters))
        self.assertEqual(named, {"door.py", "hospital.py", "robot.py"})
        for name in named:
            self.assertTrue((prefix / "share/doc/rubric/examples" / name).exists(), name)

    @unittest.skipUnless(shutil.which("avr-g++"), "there is no avr-g++")
    def test_the_node_on_a_mote(self):
        elf = self.base / "mote.elf"
        run("avr-g++", "-mmcu=atmega128", "-std=c++14", "-Os", "-Wall", "-Wextra", "-Werror",
            "-ffreestanding", "-fno-exceptions", "-fno-rtti",
            *self.flags(self.prefix, "rubric-node"), self.examples(self.prefix) / "mote.cc",
            "-o", elf)
        text, data, bss = map(int, run("avr-size", elf).splitlines()[1].split()[:3])
        self.assertLess(data + bss, 3300)
        self.assertLess(4000, text + data)
        self.assertLess(text + data, 20000)

    def test_the_conformance_library(self):
        said = self.consumer("conformance", "conformance", CONFORMANCE, self.prefix,
                             wanted="REQUIRED COMPONENTS conformance")
        self.assertRegex(said, r"^[1-9]\d* files of cases, 0 timers\n$")

    def test_a_missing_dependency_is_named(self):
        with self.assertRaisesRegex(AssertionError, "fmt"):
            self.consumer("missing", "conformance", CONFORMANCE, self.prefix,
                          "-DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON",
                          wanted="REQUIRED COMPONENTS conformance")

    def test_pkg_config(self):
        said = self.pkg_config(self.prefix, "rubric-codec", CODEC, "pc_codec")
        self.assertEqual(said, "10 bytes, island 11\n")
        said = self.pkg_config(self.prefix, "rubric-conformance", CONFORMANCE, "pc_conformance")
        self.assertIn("files of cases", said)

    def test_a_newer_version_that_is_asked_for_is_not_found(self):
        with self.assertRaisesRegex(AssertionError, "version"):
            self.consumer("newer", "codec", CODEC, self.prefix, wanted="9.0 REQUIRED")

    def test_the_program_and_what_belongs_to_it(self):
        rubric = self.prefix / "bin/rubric"
        self.assertRegex(run(rubric, "--version"), r"^\d+\.\d+\.\d+\n$")
        self.assertIn("join_reply", run(rubric, "messages", cwd="/"))
        self.assertIn("pass", run(rubric, "test", "--target", "machine", "--cases", "j1*", cwd="/"))
        share = self.prefix / "share"
        for path in ("bash-completion/completions/rubric", "zsh/site-functions/_rubric",
                     "fish/vendor_completions.d/rubric.fish", "rubric/wireshark/rubric.lua"):
            self.assertGreater((share / path).stat().st_size, 1000, path)
        self.wireshark(rubric)

    def commands(self):
        """Every command and its help."""
        rubric = self.prefix / "bin/rubric"
        listed = run(rubric, "--help").split("Subcommands:")[1].split("\n\n")[0]
        names = [row.split()[0] for row in listed.splitlines() if re.match(r"  \S", row)]
        return {name: run(rubric, name, "--help") for name in names}

    def test_every_file_that_is_named_is_installed(self):
        """In helps and in what commands lay down, under the paths of the project."""
        rubric = self.prefix / "bin/rubric"
        texts = {**self.commands(), "rubricc": run(self.prefix / "bin/rubricc", "--help")}
        laid = self.base / "laid"
        run(rubric, "new-adapter", "python", "--out", laid / "adapter")
        run(rubric, "new-protocol", "probes", "--out", laid)
        texts.update((path.name, path.read_text("utf-8")) for path in laid.glob("**/*.md"))
        named = {(source, path) for source, text in texts.items()
                 for path in re.findall(r"\b(?:spec|conformance|tools)/[\w./-]*\w", text)}
        self.assertIn(("new-adapter", "conformance/PORTING.md"), named)
        share = self.prefix / "share/rubric"
        self.assertEqual([one for one in sorted(named) if not (share / one[1]).exists()], [])
        vectors = len(list((ROOT / "spec/vectors").glob("**/*.yaml")))
        self.assertEqual(len(list((share / "spec/vectors").glob("**/*.yaml"))), vectors)

    def test_every_example_runs_in_an_empty_folder(self):
        """With the files that it names beside it, and nothing of the project."""
        found = [(command, example) for command, text in self.commands().items()
                 for example in examples_of(text)]
        self.assertGreater(len(found), 45)

        def attempt(one):
            with tempfile.TemporaryDirectory(dir=self.base) as folder:
                self.lay_down(one[1], pathlib.Path(folder), one[0])
                return self.attempt(one[1], folder)

        with concurrent.futures.ThreadPoolExecutor(4) as pool:  # Most of them wait for something.
            results = list(pool.map(attempt, found))
        for (_, example), (code, err) in zip(found, results):
            with self.subTest(example):
                # Mistakes of the command line, broken tools, output that is not written.
                self.assertNotIn(code, (2, 64, 74, 126, 127), err)
                if not re.search(r"@|mqtt:|zep:|sf-server:", example):
                    going_on = (TOO_LONG,) if GOES_ON.search(example) else ()
                    self.assertIn(code, (0, 1, 3, *going_on), err or "too long")

    def lay_down(self, example, folder, command):
        """The files that the example reads."""
        tools = folder / ".tools"
        tools.mkdir()
        (tools / "sudo").write_text("#!/bin/sh\nexit 0\n", encoding="utf-8")
        (tools / "sudo").chmod(0o755)
        for name in (".local/share/bash-completion/completions", ".zfunc",
                     ".config/fish/completions"):
            (folder / name).mkdir(parents=True)
        firmware = ROOT / "spec/captures/firmware"
        files = {"capture.pcapng": firmware / "b_reliable.pcapng",
                 "sniffer.pcapng": firmware / "b_reliable.pcapng",
                 "mote.serial.bin": firmware / "b_reliable.serial.bin",
                 "sink.serial.bin": firmware / "b_reliable.serial.bin",
                 "app.rtr": ROOT / "conformance/check/tests/testdata/b_reliable.app.rtr",
                 "j4.rtr": ROOT / "conformance/cases/j4.rtr",
                 "small.rtr": ROOT / "conformance/cases/j4.rtr",
                 "no_fail.rtr": ROOT / "conformance/cases/j4.rtr",
                 "captures/one.pcapng": firmware / "b_reliable.pcapng"}
        if "--protocol my_protocol" in example:
            run(self.prefix / "bin/rubric", "new-protocol", "my_protocol", cwd=folder)
            for name in ("old_node", "new_node"):
                (folder / name).write_text("#!/bin/sh\nexec python3 my_protocol/node.py\n",
                                           encoding="utf-8")
                (folder / name).chmod(0o755)
        for name, source in files.items():
            if name in example or name.startswith("captures/") and "captures/" in example:
                (folder / name).parent.mkdir(exist_ok=True)
                shutil.copy(source, folder / name)
        rubric = self.prefix / "bin/rubric"
        if "sniffer.pcap " in example:
            run(rubric, "convert", firmware / "b_reliable.pcapng", "--only", "radio", "-o",
                folder / "sniffer.pcap")
        if command == "send" and "run.pcapng" in example:
            shutil.copy(firmware / "b_reliable.pcapng", folder / "run.pcapng")
        (folder / "commands.jsonl").write_text('{"type":10,"value":12}\n', encoding="utf-8")
        if "islands.yaml" in example:
            (folder / "islands.yaml").write_text(ISLANDS, encoding="utf-8")
        if "my_traces.rtr" in example:
            text = (ROOT / "conformance/cases/j4.rtr").read_text(encoding="utf-8")
            (folder / "my_traces.rtr").write_text(text.replace("case j4.wrong_seq", "case mine"),
                                                  encoding="utf-8")
        for name in re.findall(r"crash-\w+", example):
            (folder / name).write_bytes(bytes(range(200)))
        if re.search(r"\./|mote\.py", example):
            run(rubric, "new-adapter", "python", "--out", folder)
            for name in ("my_adapter", "a", "b", "old_mote", "new_mote"):
                (folder / name).write_text("#!/bin/sh\nexec python3 adapter.py\n", encoding="utf-8")
                (folder / name).chmod(0o755)
            with open(folder / "mote.py", "a", encoding="utf-8") as file:
                file.write("\nif __name__ == '__main__':\n    import runpy\n"
                           "    runpy.run_path('adapter.py', run_name='__main__')\n")
        elif "known.yaml" in example:
            (folder / "known.yaml").write_text("[]\n", encoding="utf-8")

    def attempt(self, example, folder):
        environment = {"PATH": f"{folder}/.tools:{self.prefix}/bin:{os.environ['PATH']}",
                       "HOME": folder, "LC_ALL": "C.UTF-8"}
        process = subprocess.Popen(["bash", "-o", "pipefail", "-c", example], cwd=folder,
                                   env=environment, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                   start_new_session=True)
        try:
            most = GOING_ON_SECONDS if GOES_ON.search(example) else EXAMPLE_SECONDS
            err = process.communicate(timeout=most)[1]
            return process.returncode, err
        except subprocess.TimeoutExpired:
            return TOO_LONG, ""
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.communicate()

    def test_the_commands_of_the_book_run_in_an_empty_folder(self):
        """With what is installed in share/rubric, as README.md says. The others need the sources,
        or wait for a minute."""
        text = next(self.prefix.glob("**/doc/rubric/README.md")).read_text(encoding="utf-8")
        texts = {"README.md": text}
        for path in sorted((ROOT / "tools/book/chapters").glob("*.md")):
            if path.name not in ("34-run.md", "50-library.md", "51-extend.md"):
                texts[path.name] = path.read_text(encoding="utf-8")
        worked = 0
        for name, text in texts.items():
            worked += len(snippets.blocks(text))
            place = snippets.Installed(self.base / "book" / name, self.prefix)
            with self.subTest(name):
                self.assertEqual(snippets.renewed(text, place)[1], [])
        self.assertGreater(worked, 60)

    def test_programs_know_no_folder_of_the_project(self):
        for name in ("rubric", "rubricc", "rubric-extcap"):
            self.assertNotIn(os.fsencode(str(ROOT)), (self.prefix / "bin" / name).read_bytes())

    def test_the_compiler_of_specs(self):
        """It needs no file of the project: rules, profiles and imports are installed."""
        folder = self.base / "spec"
        folder.mkdir()
        text = (ROOT / "spec/wire/oscilloscope.ksy").read_text(encoding="utf-8")
        (folder / "mine.ksy").write_text(text.replace("id: oscilloscope\n", "id: mine\n"),
                                         encoding="utf-8")
        rubricc = self.prefix / "bin/rubricc"
        run(rubricc, "--check", "mine.ksy", cwd=folder)
        run(rubricc, "--emit", "cpp,tables,lua", "--out", "out", "mine.ksy", cwd=folder)
        header = folder / "out/codec/generated/mine/oscilloscope_msg.h"
        self.assertIn("OscilloscopeMsgView", header.read_text(encoding="utf-8"))
        with self.assertRaisesRegex(AssertionError, "cannot read spec/requirements.yaml"):
            run(rubricc, "--check", "--requirements", "spec/requirements.yaml", "mine.ksy",
                cwd=folder)  # What is named is not looked for elsewhere.

    def test_the_readme_has_no_dead_links(self):
        text = next(self.prefix.glob("**/doc/rubric/README.md")).read_text(encoding="utf-8")
        self.assertNotIn("](", text)
        self.assertIn("## Folders", text)

    def test_manual_pages(self):
        pages = self.prefix / "share/man/man1"
        commands = self.commands()
        self.assertGreater(len(commands), 10)
        programs = ["rubric", "rubricc", "rubric-extcap"]
        for name in programs + ["rubric-" + command for command in commands]:
            page = pages / f"{name}.1.gz"
            done = subprocess.run(["man", "--warnings", "-l", str(page)], capture_output=True,
                                  text=True, check=True, env={**os.environ, "MANPAGER": "cat"})
            self.assertEqual(done.stderr, "", name)
            self.assertIn("SYNOPSIS", done.stdout)

    def test_debian_packages(self):
        packages = self.base / "packages"
        broken = self.base / "broken"  # Debian's package `file` is not needed.
        broken.mkdir()
        (broken / "file").write_text("#!/bin/sh\nexit 1\n", encoding="utf-8")
        (broken / "file").chmod(0o755)
        run("cpack", "--config", f"{BUILD}/CPackConfig.cmake", "-B", packages, cwd=BUILD,
            env={**os.environ, "PATH": f"{broken}:{os.environ['PATH']}"})
        found = sorted(packages.glob("*.deb"))
        names = [run("dpkg-deb", "--field", path, "Package").strip() for path in found]
        self.assertEqual(names, ["librubric-dev", "rubric"])
        self.assertRegex(run("dpkg-deb", "--field", found[1], "Depends"), r"libfmt\d")
        self.assertNotIn(";", run("dpkg-deb", "--field", found[1], "Description"))
        if LINTIAN:
            done = subprocess.run(["lintian", "--fail-on", "error", *map(str, found)],
                                  capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stdout)
        root = self.base / "root"
        for path in found:
            run("dpkg-deb", "--extract", path, root)
        shutil.rmtree(packages)
        said = self.consumer("deb", "codec", CODEC, root / "usr")
        self.assertEqual(said, "10 bytes, island 11\n")
        said = self.pkg_config(root / "usr", "rubric-codec", CODEC, "deb_codec")
        self.assertEqual(said, "10 bytes, island 11\n")
        self.assertIn("join_reply", run(root / "usr/bin/rubric", "messages"))
        self.wireshark(root / "usr/bin/rubric")

    def wireshark(self, rubric):
        """It finds what it needs to teach Wireshark, in whatever folder it was installed."""
        home = tempfile.TemporaryDirectory(dir=self.base)
        self.addCleanup(home.cleanup)
        environment = {**os.environ, "HOME": home.name}
        run(rubric, "install-wireshark", env=environment)
        self.assertIn("rubric (RUBICON mote or sink", run("tshark", "-D", env=environment))


if __name__ == "__main__":
    BUILD = os.path.abspath(sys.argv.pop(1))
    LINTIAN = "--lintian" in sys.argv  # It takes 12 s of the processor.
    if LINTIAN:
        sys.argv[sys.argv.index("--lintian"):] = ["-k", "test_debian_packages"]
    unittest.main()
