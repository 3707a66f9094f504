"""Mutants of C++ sources, found in clang's syntax tree."""

import json
import pathlib
import re
import shutil
import subprocess

from sites import Edit, Mutant, unique

CLANG = shutil.which("clang++-14") or "clang++"
RELATIONS = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"),
             "==": ("!=",), "!=": ("==",)}
ARITHMETIC = {"+": "-", "-": "+", "*": "+", "/": "*", "%": "*", "&": "|", "|": "&", "^": "|",
              "<<": ">>", ">>": "<<"}
INTEGER = re.compile(r"(const )?((std::)?u?int(8|16|32|64)_t|(std::)?size_t|unsigned( \w+)*|int|"
                     r"long|short|(machine::)?Ticks)$")
# Labels of what happened: no trace sees them. They are read by `rubric coverage`.
LABELS = re.compile(r"(\w+(\.|->))*(ignored|followed)\(|static_cast<void>")
NOT_ENTERED = {"ConstantExpr", "StaticAssertDecl", "TemplateArgument", "UserDefinedLiteral",
               "ClassTemplateSpecializationDecl", "ClassTemplatePartialSpecializationDecl",
               "FieldDecl", "EnumDecl", "CXXDefaultArgExpr", "CXXDefaultInitExpr",
               "ImplicitValueInitExpr", "UnaryExprOrTypeTraitExpr", "ParmVarDecl"}
FUNCTIONS = {"FunctionDecl", "CXXMethodDecl", "CXXConstructorDecl", "CXXConversionDecl",
             "CXXDestructorDecl"}


def documents(text):
    """The trees that clang printed one after the other."""
    decoder = json.JSONDecoder()
    at = 0
    while at < len(text):
        tree, at = decoder.raw_decode(text, at)
        yield tree
        while at < len(text) and text[at].isspace():
            at += 1


class Unit:
    """A translation unit: the mutants in those of its files that are asked for."""

    def __init__(self, command, scope, files):
        self.files = files      # Absolute path: (relative path, text).
        self.mutants = []
        self.place = None       # The file of the last location: clang leaves out what stays.
        dump = subprocess.run([*command, "-fsyntax-only", "-w", "-Xclang", "-ast-dump=json",
                               "-Xclang", f"-ast-dump-filter={scope}"],
                              capture_output=True, text=True, check=True).stdout
        for tree in documents(dump):
            self.place = None
            self.locate(tree)
            self.visit(tree, None, "")

    # Places.

    def location(self, place):
        if "spellingLoc" in place:
            self.location(place["spellingLoc"])
            self.location(place["expansionLoc"])
            return None     # From a macro.
        if "file" in place:
            self.place = place["file"]
        if "offset" not in place:
            return None
        return self.place, place["offset"], place["tokLen"]

    def locate(self, node):
        """Gives each node, in the order of the text, "at": its file, begin and end."""
        if isinstance(node.get("loc"), dict):
            self.location(node["loc"])
        at = None
        if "range" in node:
            begin = self.location(node["range"]["begin"])
            end = self.location(node["range"]["end"])
            if begin and end and begin[0] == end[0]:
                at = begin[0], begin[1], end[1] + end[2]
        node["at"] = at
        for child in node.get("inner", ()):
            self.locate(child)

    def known(self, node):
        return node.get("at") is not None and node["at"][0] in self.files

    def text(self, node):
        return self.files[node["at"][0]][1][node["at"][1]:node["at"][2]]

    def add(self, node, function, text, **kind):
        self.add_edits(node, function, [self.edit(node, text, **kind)])

    def edit(self, node, text, **kind):
        return Edit(node["at"][1], node["at"][2], text, **kind)

    def add_edits(self, node, function, edits):
        self.mutants.append(Mutant(self.files[node["at"][0]][0], function, tuple(edits)))

    # The walk.

    def visit(self, node, parent, function):
        kind = node.get("kind")
        if kind in NOT_ENTERED or node.get("isImplicit") and kind != "CXXMethodDecl":
            return
        if kind == "VarDecl" and node.get("constexpr"):
            return
        inner = [child for child in node.get("inner", ()) if child.get("kind")]
        if kind in FUNCTIONS:
            if node["name"] != "operator()":
                function = node["name"]
            elif not function:      # One of several; a lambda belongs to its function.
                function = node["type"]["qualType"].replace("void (", "operator()(")
            if function.startswith("operator") and node["name"] != "operator()":
                return
            if node.get("explicitlyDefaulted") or not self.known(node):
                return
        if kind == "FunctionTemplateDecl":      # The others are instances of the first.
            others = [child for child in inner if child["kind"] in FUNCTIONS][1:]
            inner = [child for child in inner if child not in others]
        if kind == "CXXForRangeStmt":           # Between them is what the compiler adds.
            inner = [inner[-1]]
        if kind == "LambdaExpr":                # Its body is there twice.
            inner = inner[:1] if inner and inner[0]["kind"] == "CXXRecordDecl" else inner
        whole = node
        if kind == "CXXRewrittenBinaryOperator":   # a != b as !(a == b): the call inside is enough.
            while node["kind"] != "CXXOperatorCallExpr" and inner:
                node = inner[0]
                kind = node["kind"]
                inner = [child for child in node.get("inner", ()) if child.get("kind")]
            node["_guard"] = whole.get("_guard")
        if function and self.known(node):
            mutate = getattr(self, "mutate_" + kind, None)
            if mutate:
                mutate(node, parent, inner, function)
            self.remove(whole, parent, inner, function)
            if node.get("_label"):
                return
        for child in inner:
            self.visit(child, node, function)

    # The kinds of mutants.

    def guard(self, node, function, true=True):
        node["_guard"] = True
        if not self.known(node) or not self.text(node) or node["kind"] == "CXXBoolLiteralExpr":
            return
        if node.get("kind") == "ConstantExpr":
            return
        if true:
            self.add(node, function, "true", condition=True)
        self.add(node, function, "false", condition=True)

    def mutate_IfStmt(self, node, parent, inner, function):
        if not node.get("hasVar") and not node.get("hasInit") and not node.get("isConstexpr"):
            self.guard(inner[0], function)

    def mutate_ConditionalOperator(self, node, parent, inner, function):
        if "ReqId" in node["type"]["qualType"]:
            node["_label"] = True
        else:
            self.guard(inner[0], function)

    def mutate_WhileStmt(self, node, parent, inner, function):
        if not node.get("hasVar"):
            self.guard(inner[0], function, true=False)

    def mutate_ForStmt(self, node, parent, inner, function):
        conditions = [child for child in node["inner"][2:3] if child.get("kind")]
        for condition in conditions:
            self.guard(condition, function, true=False)

    def mutate_VarDecl(self, node, parent, inner, function):
        if node["type"]["qualType"] in ("bool", "const bool") and inner and node.get("init") == "c":
            self.guard(inner[-1], function)

    @staticmethod
    def relations(node, operator):
        """What finds a guard that is always or never true finds the opposite one, too."""
        others = RELATIONS.get(operator, ())
        return () if node.get("_guard") and len(others) == 1 else others

    def mutate_BinaryOperator(self, node, parent, inner, function):
        operator = node["opcode"]
        left, right = inner
        if not self.known(left) or not self.known(right):
            return
        if operator in RELATIONS:
            for other in self.relations(node, operator):
                self.add(node, function, self.with_operator(node, operator, other), condition=True)
        elif operator in ("&&", "||"):
            a, b = self.text(left), self.text(right)
            other = f"({a}) && ({b})" if operator == "||" else f"{a} || {b}"
            for text in (other, a, b):
                self.add(node, function, text, condition=True)
        elif operator in ARITHMETIC and "*" not in left["type"]["qualType"]:
            self.add(node, function, self.with_operator(node, operator, ARITHMETIC[operator]))

    def mutate_CXXOperatorCallExpr(self, node, parent, inner, function):
        name = inner[0]
        if not self.known(name) or len(inner) != 3:
            return
        operator = self.text(name)
        for other in self.relations(node, operator):
            text = self.text(node)
            at = name["at"][1] - node["at"][1]
            self.add(node, function, text[:at] + other + text[at + len(operator):], condition=True)

    def mutate_CompoundAssignOperator(self, node, parent, inner, function):
        other = ARITHMETIC.get(node["opcode"][:-1])
        if other:
            self.add(node, function, self.with_operator(node, node["opcode"], other + "="))

    def mutate_UnaryOperator(self, node, parent, inner, function):
        operator = node["opcode"]
        if operator == "!" and self.known(inner[0]):
            self.add(node, function, self.text(inner[0]), condition=True)
        elif operator in ("++", "--") and (parent or {}).get("kind") != "ForStmt":
            other = "--" if operator == "++" else "++"
            text = self.text(node)
            post = node.get("isPostfix")
            self.add(node, function, text[:-2] + other if post else other + text[2:])
        elif operator == "-" and inner[0]["kind"] != "IntegerLiteral" and self.known(inner[0]):
            self.add(node, function, self.text(inner[0]))

    def with_operator(self, node, operator, other):
        text = self.text(node)
        left = next(child for child in node["inner"] if child.get("kind"))
        at = text.index(operator, left["at"][2] - node["at"][1])
        return text[:at] + other + text[at + len(operator):]

    def off_by_one(self, node, function):
        if not INTEGER.match(node["type"]["qualType"]):
            return
        text = self.text(node)
        for other in (f"({text} + 1)", f"({text} - 1)"):
            if other != "(0 - 1)":
                self.add(node, function, other)

    def mutate_IntegerLiteral(self, node, parent, inner, function):
        self.off_by_one(node, function)

    def mutate_DeclRefExpr(self, node, parent, inner, function):
        if re.search(r"(^|::)k[A-Z]\w*$", self.text(node)) and node["valueCategory"] == "lvalue":
            self.off_by_one(node, function)

    def mutate_CXXBoolLiteralExpr(self, node, parent, inner, function):
        self.add(node, function, "false" if node["value"] else "true")

    def mutate_ReturnStmt(self, node, parent, inner, function):
        if inner and inner[0].get("type", {}).get("qualType") == "bool":
            self.guard(inner[0], function)

    def swap(self, node, arguments, function):
        for a, b in zip(arguments, arguments[1:]):
            if not (self.known(a) and self.known(b)):
                continue
            first, second = self.text(a), self.text(b)
            same = all(a.get(key) == b.get(key) for key in ("type", "valueCategory"))
            # What a list leaves out has the place of its last brace.
            if same and first != second and not {"{", "}", ""} & {first[:1], second[:1]}:
                self.add_edits(node, function, [self.edit(a, second), self.edit(b, first)])

    def mutate_CallExpr(self, node, parent, inner, function):
        self.swap(node, inner[1:], function)

    mutate_CXXMemberCallExpr = mutate_CallExpr

    def mutate_CXXConstructExpr(self, node, parent, inner, function):
        self.swap(node, inner, function)

    mutate_InitListExpr = mutate_CXXConstructExpr
    mutate_CXXTemporaryObjectExpr = mutate_CXXConstructExpr

    # Removed statements.

    def is_statement(self, node, parent):
        if parent is None or node["kind"].endswith(("Decl", "DeclStmt")):
            return False
        kind = parent["kind"]
        inner = [child for child in parent["inner"] if child.get("kind")]
        if kind in ("CompoundStmt", "CaseStmt", "DefaultStmt"):
            return kind == "CompoundStmt" or inner[-1] is node and len(inner) > (kind == "CaseStmt")
        if kind == "IfStmt":
            return any(node is child for child in inner[-2 if parent.get("hasElse") else -1:])
        return kind in ("ForStmt", "WhileStmt", "CXXForRangeStmt") and inner[-1] is node

    def remove(self, node, parent, inner, function):
        kind = node["kind"]
        jump = kind in ("BreakStmt", "ContinueStmt")
        expression = "Expr" in kind or "Operator" in kind or kind == "ExprWithCleanups"
        if not (jump or expression or kind == "ReturnStmt"):
            return
        if not self.is_statement(node, parent):
            return
        only_then = parent["kind"] == "IfStmt" and not parent.get("hasElse")
        value = ""
        if kind == "ReturnStmt":
            if inner and inner[0].get("type", {}).get("qualType") != "void":
                return      # Without it there is no program.
            value = self.text(inner[0]) if inner and self.known(inner[0]) else ""
        if LABELS.match(value):
            inner[0]["_label"] = True
        elif value:
            self.add_statement(node, function, "return;")
        if expression and LABELS.match(self.text(node)):
            node["_label"] = True
        elif kind == "BreakStmt" and parent["kind"] in ("CaseStmt", "DefaultStmt"):
            pass        # It ends cases that do nothing; the next case is another mutant's.
        elif not only_then:     # Else it is the condition that is never true.
            self.add_statement(node, function, ";")

    def add_statement(self, node, function, text):
        file, begin, end = node["at"]
        end = self.files[file][1].index(";", end) + 1
        self.mutants.append(
            Mutant(self.files[file][0], function, (Edit(begin, end, text, statement=True),)))


def wrap(inner, alternatives):
    """All alternatives of one range, chosen by the switch."""
    if any(edit.statement for _, edit in alternatives):
        chosen = "".join(f"if (RUBRIC_MUTANT({number})) {{ {edit.text} }} else "
                         for number, edit in alternatives)
        return f"{{ {chosen}{{ {inner} }} }}"
    condition = any(edit.condition for _, edit in alternatives)

    def convert(text):
        return f"static_cast<bool>({text})" if condition else f"({text})"

    out = convert(inner)
    for number, edit in reversed(alternatives):
        text = convert(edit.text)
        if re.search(r"^\([\w:']+ [+-] 1\)$", edit.text):     # Keeps the type of the constant.
            text = f"static_cast<std::decay_t<decltype({edit.text[1:-5]})>>{text}"
        out = f"(RUBRIC_MUTANT({number}) ? {text} : {out})"
    return out


def mutants(subject, project, texts):
    """The mutants of each file, as the translation units show them."""
    command = [CLANG, "-x", "c++", "-std=c++20", f"-I{project}", *subject.flags]
    files = {str(project / file): (file, text) for file, text in texts.items()}
    by_file = {}
    for source in files:
        if pathlib.Path(source).name == subject.unit:
            unit = ["-include", source, "/dev/null"]
        elif source.endswith(".cc"):
            unit = [source]
        else:
            continue
        for mutant in Unit([*command, *unit], subject.scope, files).mutants:
            by_file.setdefault(mutant.file, []).append(mutant)
    return {file: unique(mutants) for file, mutants in by_file.items()}


# In front of each copy. The rest must keep its lines.
SWITCH = ('#include <type_traits>\nextern "C" int rubric_source_mutant;\n'
          "#define RUBRIC_MUTANT(n) (rubric_source_mutant == (n))\n")


def finish(text):
    """What was a constant expression is none with a switch in it."""
    return SWITCH + re.sub(r"^constexpr bool (\w+\()", r"inline bool \1", text, flags=re.M)
