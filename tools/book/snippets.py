"""Fenced blocks of Markdown that are run as they are shown. Each text is run in a copy of the
project of its own, from top to bottom:

    ```console              each `$ ` line is run by bash; what it prints must be what follows it
    ```cpp file=a.cc        is written to a.cc and compiled to a program a, with all warnings;
                            an ```output block after it is what a prints
    ```cpp file=a.cc with=copy  the same, with the headers of the copy, which may be generated anew
    ```cpp file=a.cc build=cmake    is written only: the text builds it itself
    ```cpp file=a.cc for=mote   is compiled for an ATmega128, a Cortex-M3 and this computer
    ```LANGUAGE file=PATH   is written to PATH
    ```diff                 is applied by `patch -p0`
    ```sh                   is not run: each `rubric` in it must have the options that are named

All other blocks are only read. In the copy, `rubric` and `rubricc` are those of the build folder,
`../share` from them, `find_package(rubric)` and pkg-config are what was installed from it, and
`cmake --build --preset release` is shadow_build.py.
"""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

FENCED = re.compile(r"^```([^\n`]*)\n(.*?)^```$", re.M | re.S)
FOLDERS = ("codec", "conformance", "fuzz", "spec", "tools")
LEFT_OUT = shutil.ignore_patterns("node_modules", "__pycache__", "build", "*.class", "corpora")
STRICT = ["-Wall", "-Wextra", "-Wshadow", "-Wconversion", "-Werror"]
MOTES = (["avr-g++", "-mmcu=atmega128", "-std=c++14", "-Os"],
         ["arm-none-eabi-g++", "-mcpu=cortex-m3", "-mthumb", "-std=c++14", "-Os"],
         ["c++", "-std=c++14", "-O2"])
FIRMWARE = ["-ffreestanding", "-fno-exceptions", "-fno-rtti", "-Wall", "-Wextra", "-Wshadow",
            "-Werror"]
SECONDS_MAX = 300


class Wrong(Exception):
    """A text shows something else than what happens."""


class Block:
    """A fenced block: its language, its key=value words, its text and its line."""

    def __init__(self, match, text):
        words = match[1].split()
        self.language = words[0] if words and "=" not in words[0] else ""
        self.words = dict(word.split("=", 1) for word in words if "=" in word)
        self.text = match[2]
        self.span = match.span(2)
        self.line = text.count("\n", 0, match.start()) + 1
        if not self.language and self.text.startswith("$ "):
            self.language = "console"


def blocks(text):
    return [Block(match, text) for match in FENCED.finditer(text)]


def commands(text):
    """The `$ ` lines of a console block, each with what is shown below it. A line that ends with a
    backslash goes on in the next one."""
    found = []
    going_on = False
    for line in text.splitlines(keepends=True):
        if going_on:
            found[-1][0] += line
        elif line.startswith("$ "):
            found.append([line[2:], ""])
        elif found:
            found[-1][1] += line
        else:
            raise Wrong("a console block begins with a `$ ` line")
        going_on = line.endswith("\\\n") and (going_on or line.startswith("$ "))
    return found


class Place:
    """A copy of the project in which one text is run."""

    def __init__(self, folder, root, build, prefix=None):
        self.folder = pathlib.Path(folder)
        for name in FOLDERS:
            shutil.copytree(root / name, self.folder / name, ignore=LEFT_OUT, symlinks=True)
        tools = self.folder / ".bin"
        for place in (tools, self.folder / "build/release", self.folder / ".home"):
            place.mkdir(parents=True)
        for program in ("rubric", "rubricc"):
            for place in (tools, self.folder / "build/release"):
                (place / program).symlink_to(build / program)
        (tools / "cmake").write_text(
            "#!/bin/sh\n[ \"$1 $2 $3\" = '--build --preset release' ] || "
            f"exec {shlex.quote(shutil.which('cmake'))} \"$@\"\n"
            f"exec {shlex.quote(sys.executable)} "
            f"{shlex.quote(str(root))}/tools/book/shadow_build.py"
            f" {shlex.quote(str(build))} {shlex.quote(str(self.folder))} \"$5\"\n",
            encoding="utf-8")
        (tools / "cmake").chmod(0o755)
        self.surround(tools, prefix)
        self.include = prefix / "include/rubric" if prefix else root

    def surround(self, tools, prefix):
        """The environment in which programs run."""
        drop = ("MOTECOM", "GITHUB_ACTIONS", "COLUMNS", "NO_COLOR", "MAKEFLAGS")
        self.environment = {key: value for key, value in os.environ.items() if key not in drop}
        self.environment |= {"PATH": f"{tools}:{os.environ['PATH']}", "LC_ALL": "C.UTF-8",
                             "TZ": "UTC", "HOME": str(self.folder / ".home")}
        if prefix:
            (self.folder / "share").symlink_to(prefix / "share")
            found = [str(path) for path in prefix.glob("**/pkgconfig")]
            self.environment |= {"CMAKE_PREFIX_PATH": str(prefix),
                                 "PKG_CONFIG_PATH": ":".join(found)}

    def run(self, words):
        done = subprocess.run(words, cwd=self.folder, env=self.environment, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=SECONDS_MAX, check=False)
        return done.returncode, done.stdout

    def must(self, words):
        status, printed = self.run([str(word) for word in words])
        if status:
            raise Wrong(f"{shlex.join(str(word) for word in words)}\nends with {status}\n{printed}")
        return printed

    def console(self, text):
        """The block as it would have to be shown."""
        out = ""
        for command, _ in commands(text):
            status, printed = self.run(["bash", "-c", command])
            if status < 0 or status > 128:  # Of bash, or of what it ran.
                raise Wrong(f"{command}ends with {status}, as what a signal ends does\n{printed}")
            if printed and not printed.endswith("\n"):
                printed += "\n"
            out += "$ " + command + printed
        return out

    def compile(self, block):
        source = block.words["file"]
        if block.words.get("for") == "mote":
            for compiler in MOTES:
                self.must([*compiler, *FIRMWARE, "-I", self.include, "-c", source,
                           "-o", ".mote.o"])
            return
        include = self.folder if block.words.get("with") == "copy" else self.include
        self.must(["c++", "-std=c++17", *STRICT, "-I", include, source,
                   "-o", source.removesuffix(".cc")])

    def options(self, text):
        """Each `rubric COMMAND` must have the options that are written after it."""
        joined = text.replace("\\\n", " ")
        for call in re.findall(r"\brubric ([a-z][a-z-]+)([^|;#\n]*)", joined):
            status, described = self.run(["rubric", call[0], "--help"])
            if status:
                raise Wrong(f"there is no `rubric {call[0]}`")
            for option in re.findall(r"(?<!\S)(--?[a-zA-Z][\w-]*)", call[1]):
                if not re.search(rf"(?<![\w-]){option}(?![\w-])", described):
                    raise Wrong(f"`rubric {call[0]}` has no option {option}")

    def work(self, block, before):
        """Returns the required text of the block; `before` is the block before it."""
        if block.language == "output":
            if before is None or before.language != "cpp" or "file" not in before.words:
                raise Wrong("an output block follows a cpp block with file=")
            return self.must(["./" + before.words["file"].removesuffix(".cc")])
        if block.language == "console":
            return self.console(block.text)
        if block.language == "sh":
            self.options(block.text)
        elif block.language == "diff":
            (self.folder / ".patch").write_text(block.text, encoding="utf-8")
            self.must(["patch", "-p0", "--forward", "-i", ".patch"])
        elif "file" in block.words:
            path = self.folder / block.words["file"]
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text, encoding="utf-8")
            if block.language == "cpp" and "build" not in block.words:
                self.compile(block)
        return block.text


class Installed(Place):
    """A folder with what an installation has in share/rubric, and the installed programs."""

    def __init__(self, folder, prefix):  # pylint: disable=super-init-not-called
        self.folder = pathlib.Path(folder)
        shutil.copytree(prefix / "share/rubric", self.folder)
        (self.folder / ".home").mkdir()
        self.surround(prefix / "bin", prefix)
        self.include = prefix / "include/rubric"


def renewed(text, place):
    """The text with what its blocks really print, and the mistakes: pairs of line and words."""
    out, at, wrong, before = "", 0, [], None
    for block in blocks(text):
        try:
            now = place.work(block, before)
        except (Wrong, OSError, subprocess.TimeoutExpired) as mistake:
            wrong.append((block.line, str(mistake)))
            now = block.text
        if now != block.text:
            wrong.append((block.line, f"it shows\n{block.text}but it should show\n{now}"))
        out += text[at:block.span[0]] + now
        at = block.span[1]
        before = block
    return out + text[at:], wrong
