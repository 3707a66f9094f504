#!/usr/bin/env python3
"""Installs what was built, and the Debian packages made of it, and builds programs of somebody else
against them, by CMake and by pkg-config, after the folder was moved as well.

Usage: install_test.py BUILD_FOLDER.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = ""
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

    def test_manual_pages(self):
        pages = self.prefix / "share/man/man1"
        commands = [row.split()[0] for row in run(self.prefix / "bin/rubric", "--help")
                    .split("Subcommands:")[1].split("\n\n")[0].splitlines()
                    if re.match(r"  \S", row)]
        self.assertGreater(len(commands), 10)
        programs = ["rubric", "rubricc", "rubric-extcap"]
        for name in programs + ["rubric-" + command for command in commands]:
            page = pages / f"{name}.1"
            done = subprocess.run(["man", "--warnings", "-l", str(page)], capture_output=True,
                                  text=True, check=True, env={**os.environ, "MANPAGER": "cat"})
            self.assertEqual(done.stderr, "", name)
            self.assertIn("SYNOPSIS", done.stdout)

    def test_debian_packages(self):
        packages = self.base / "packages"
        run("cpack", "--config", f"{BUILD}/CPackConfig.cmake", "-B", packages, cwd=BUILD)
        found = sorted(packages.glob("*.deb"))
        names = [run("dpkg-deb", "--field", path, "Package").strip() for path in found]
        self.assertEqual(names, ["librubric-dev", "rubric"])
        self.assertRegex(run("dpkg-deb", "--field", found[1], "Depends"), r"libfmt\d")
        self.assertNotIn(";", run("dpkg-deb", "--field", found[1], "Description"))
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
    unittest.main()
