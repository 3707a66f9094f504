"""The book's source: the project's own data, as its programs print it."""

import json
import pathlib
import re
import subprocess
import tempfile

import yaml

_DECISION = re.compile(r"(\d{4})-[a-z0-9-]+\.md")


def group_of(rule_id):
    """'J4' of 'J4-SEQ'."""
    return rule_id.split("-")[0]


class Project:
    """Read once. Names of types and enums are full ones: 'rubicon::net_msg'."""

    def __init__(self, root, rubric, rubricc):
        self.root = pathlib.Path(root)
        self.rubric = str(pathlib.Path(rubric).absolute())
        self.rubricc = str(pathlib.Path(rubricc).absolute())
        model = self._model()
        # The protocol comes first, then the one below it, then the other one over the same frames.
        order = ["rubicon", "tinyos"]
        self.specs = sorted(model["specs"], key=lambda spec: (
            order.index(spec["id"]) if spec["id"] in order else len(order), spec["id"]))
        self.types = {f"{spec['id']}::{one['id']}": one
                      for spec in self.specs for one in spec["types"]}
        self.enums = {f"{spec['id']}::{one['id']}": one
                      for spec in self.specs for one in spec["enums"]}
        self.rules = {one["id"]: one for one in model["requirements"]}
        self.profiles = model["profiles"]
        self.case_uses = model["case_uses"]
        self.cases = {one["name"]: one for one in self._json("test", "--list")["cases"]}
        self.coverage = {one["id"]: one for one in self._json("coverage")["rules"]}
        self.reached = self._reached()
        self.decisions = self._decisions()
        self.vectors = self._vectors()

    def run(self, *words):
        """Returns the output of `rubric`, which does not depend on the terminal's width."""
        done = subprocess.run([self.rubric, *words], cwd=self.root, capture_output=True,
                              text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"rubric {' '.join(words)}: exit {done.returncode}: {done.stderr}")
        return done.stdout

    def commands(self):
        """The subcommands of rubric."""
        _, _, text = self.run("--help").partition("Subcommands:")
        return re.findall(r"^  (\w[\w-]*)  ", text, re.M)

    def read(self, path):
        return (self.root / path).read_text(encoding="utf-8")

    def _json(self, *words):
        return json.loads(self.run(*words, "--format", "json"))

    def _model(self):
        files = sorted(str(one.relative_to(self.root))
                       for one in (self.root / "spec/wire").glob("*.ksy"))
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([self.rubricc, "--emit", "json", "--out", folder, *files],
                           cwd=self.root, check=True)
            text = (pathlib.Path(folder) / "doc/wire.json").read_text(encoding="utf-8")
        return json.loads(text)

    def _reached(self):
        """Returns the routes to each type, as in `rubric messages`."""
        out = {}
        for spec in self.specs:
            if not any(one["am_types"] for one in spec["types"]):
                continue
            for one in self._json("messages", "--spec", spec["id"])["messages"]:
                out[f"{spec['id']}::{one['id']}"] = one["reached"]
        return out

    def _decisions(self):
        """Number to (file, title, text without its heading)."""
        out = {}
        for path in sorted((self.root / "spec/decisions").iterdir()):
            if not _DECISION.fullmatch(path.name):
                continue
            head, _, text = path.read_text(encoding="utf-8").partition("\n")
            number = int(path.name[:4])
            title = re.sub(r"^#\s*(\d+\.)?\s*", "", head)
            out[number] = (str(path.relative_to(self.root)), title, text.strip())
        return out

    def _vectors(self):
        """Rule to the number of files that show how bytes break it; type to how many are right."""
        out = {}
        for path in sorted((self.root / "spec/vectors").rglob("*.yaml")):
            one = yaml.load(path.read_text(encoding="utf-8"), Loader=yaml.CBaseLoader)
            fault = one.get("fault")
            key = fault["requirement"] if fault else one["message"].replace(".", "::")
            out[key] = out.get(key, 0) + 1
        return out
