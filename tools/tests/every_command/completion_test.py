#!/usr/bin/env python3
"""The output of `rubric completion` works in bash, zsh and fish themselves.

Usage: completion_test.py RUBRIC. Needs the three shells.
"""

import os
import subprocess
import unittest

from testing import Folder, run

def script(shell):
    return run("completion", shell, text=True, check=True).stdout


def bash(*words):
    """Candidates for the last of the words."""
    test = script("bash") + '\nCOMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _rubric 2>/dev/null\n' \
        'printf "%s\\n" "${COMPREPLY[@]}"'
    done = subprocess.run(["bash", "-c", test, "bash", *words], capture_output=True, text=True,
                          check=True)
    return done.stdout.split()


def fish(line, folder):
    path = folder / "rubric.fish"
    path.write_text(script("fish"), encoding="utf-8")
    done = subprocess.run(["fish", "--no-config", "-c", f"source {path}; complete -C '{line}'"],
                          capture_output=True, text=True, check=True,
                          env={**os.environ, "HOME": str(folder), "TERM": "dumb"})
    return [row.split("\t")[0] for row in done.stdout.splitlines()]


def zsh(line, folder):
    """Types the line and a tabulator into a zsh on a terminal of its own; what it then shows."""
    (folder / "_rubric").write_text(script("zsh"), encoding="utf-8")
    test = f"""
zmodload zsh/zpty
zpty -b shell zsh -f -i
zpty -w shell "PS1=; stty -echo; fpath=({folder} \\$fpath); autoload -Uz compinit; compinit -u -D"
zpty -w shell "zstyle ':completion:*' list-prompt ''; LISTMAX=9999; zmodload zsh/complist"
zpty -w shell "print READY"
zpty -r -m shell before '*READY*'
zpty -w -n shell "{line}"$'\\t'
integer tries=0
while ((tries++ < 50)); do
  zpty -r -t shell part && print -rn -- $part || sleep 0.05
done
zpty -d shell
"""
    return subprocess.run(["zsh", "-f", "-c", test], capture_output=True, text=True, timeout=60,
                          check=True, env={**os.environ, "TERM": "dumb", "COLUMNS": "200"}).stdout


class Completion(Folder):
    def test_bash_completes_commands_options_and_values(self):
        self.assertEqual(bash("rubric", "dec"), ["decode"])
        self.assertEqual(bash("rubric", "decode", "--inp"), ["--input-format"])
        self.assertEqual(bash("rubric", "decode", "--format", ""), ["text", "jsonl", "csv"])
        self.assertEqual(bash("rubric", "check", "--profile", "d"), ["deployed"])

    def test_names_of_the_protocol_and_the_kit(self):
        self.assertEqual(bash("rubric", "explain", "J4-SE"), ["J4-SEQ"])
        self.assertEqual(bash("rubric", "explain", "join_rep"), ["join_reply"])
        self.assertEqual(bash("rubric", "decode", "--spec", "blink"), ["blink_to_radio"])
        self.assertEqual(bash("rubric", "decode", "--as", "join_rep"), ["join_reply"])
        self.assertEqual(bash("rubric", "decode", "--fields", "frame.rs"), ["frame.rssi"])
        self.assertEqual(bash("rubric", "test", "--rule", "J4-SE"), ["J4-SEQ"])
        self.assertIn("j4.wrong_seq", bash("rubric", "test", "--cases", "j4.w"))
        self.assertEqual(fish("rubric explain J4-SE", self.folder), ["J4-SEQ"])
        self.assertIn("J4-SEQ", zsh("rubric explain J4-SE", self.folder))
        self.assertIn("blink_to_radio", zsh("rubric decode --spec bli", self.folder))

    def test_bash_completes_files(self):
        (self.folder / "run 1.pcapng").touch()
        before = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)
        self.assertEqual(bash("rubric", "decode", "run"), ["run", "1.pcapng"])

    def test_fish_completes_commands_options_and_values(self):
        self.assertEqual(fish("rubric dec", self.folder), ["decode"])
        self.assertEqual(fish("rubric decode --inp", self.folder), ["--input-format"])
        self.assertEqual(sorted(fish("rubric decode --format ", self.folder)),
                         ["csv", "jsonl", "text"])

    def test_zsh_completes_commands_options_and_values(self):
        self.assertIn("rubric decode", zsh("rubric dec", self.folder))
        self.assertIn("--input-format", zsh("rubric decode --inp", self.folder))
        shown = zsh("rubric decode --format ", self.folder)
        for value in ("text", "jsonl", "csv"):
            self.assertIn(value, shown)

    def test_every_command_and_option_of_the_help_is_known(self):
        help_text = run("--help", text=True, check=True).stdout
        listed = help_text.split("Subcommands:")[1].split("\n\n")[0].splitlines()
        commands = [row.split()[0] for row in listed if row.startswith("  ") and row[2:3].strip()]
        self.assertIn("decode", commands)
        known = bash("rubric", "")
        for command in commands:
            self.assertIn(command, known)
            text = run(command, "--help", text=True, check=True).stdout
            options = [word for row in text.splitlines() if row.startswith("  -")
                       for word in row.split()[0].split(",") if word.startswith("--")]
            known_options = bash("rubric", command, "--")
            for option in options:
                self.assertIn(option, known_options, command)


if __name__ == "__main__":
    unittest.main()
