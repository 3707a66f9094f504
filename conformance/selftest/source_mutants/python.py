"""Mutants of Python sources, found in Python's own syntax tree."""

import ast

from sites import Edit, Mutant, unique

RELATIONS = {ast.Lt: ("<=", ">="), ast.LtE: ("<", ">"), ast.Gt: (">=", "<="), ast.GtE: (">", "<"),
             ast.Eq: ("!=",), ast.NotEq: ("==",), ast.In: ("not in",), ast.NotIn: ("in",),
             ast.Is: ("is not",), ast.IsNot: ("is",)}
ARITHMETIC = {ast.Add: "-", ast.Sub: "+", ast.Mult: "+", ast.FloorDiv: "*", ast.Div: "*",
              ast.Mod: "*", ast.BitAnd: "|", ast.BitOr: "&", ast.BitXor: "|", ast.LShift: ">>",
              ast.RShift: "<<"}


class Walk(ast.NodeVisitor):
    def __init__(self, file, text):
        self.file = file
        self.text_of_file = text
        self.lines = [0]
        for line in text.splitlines(keepends=True):
            self.lines.append(self.lines[-1] + len(line))
        self.function = ""
        self.guards = set()
        self.mutants = []

    # Places.

    def at(self, node):
        return (self.lines[node.lineno - 1] + node.col_offset,
                self.lines[node.end_lineno - 1] + node.end_col_offset)

    def text(self, node):
        begin, end = self.at(node)
        return self.text_of_file[begin:end]

    def add(self, node, text, **kind):
        self.add_edits(Edit(*self.at(node), text, **kind))

    def add_edits(self, *edits):
        if self.function:
            self.mutants.append(Mutant(self.file, self.function, edits))

    # Expressions.

    def guard(self, node, true=True):
        self.guards.add(node)
        if true:
            self.add(node, "True")
        self.add(node, "False")

    def between(self, left, right, operators):
        """Replaces the operator between two expressions."""
        begin, end = self.at(left)[1], self.at(right)[0]
        return [self.text(left) + self.text_of_file[begin:end].replace(*pair, 1) + self.text(right)
                for pair in operators]

    def visit_Compare(self, node):
        if len(node.ops) == 1:
            others = RELATIONS[type(node.ops[0])]
            if not (node in self.guards and len(others) == 1):
                for other in others:
                    left, right = self.text(node.left), self.text(node.comparators[0])
                    self.add(node, f"{left} {other} {right}")
        self.generic_visit(node)

    def visit_BoolOp(self, node):
        word, other = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
        texts = [f"({self.text(value)})" for value in node.values]
        self.add(node, f" {other} ".join(texts))
        for i in range(len(texts)):
            rest = texts[:i] + texts[i + 1:]
            self.add(node, f" {word} ".join(rest))
        self.generic_visit(node)

    def visit_BinOp(self, node):
        other = ARITHMETIC.get(type(node.op))
        text = isinstance(node.left, (ast.JoinedStr, ast.List))
        if other and not text:
            self.add(node, f"({self.text(node.left)}) {other} ({self.text(node.right)})")
        self.generic_visit(node)

    def visit_UnaryOp(self, node):
        self.add(node, self.text(node.operand))
        self.generic_visit(node)

    def visit_Constant(self, node):
        if isinstance(node.value, bool):
            self.add(node, str(not node.value))
        elif isinstance(node.value, int):
            self.add(node, f"({self.text(node)} + 1)")
            if node.value != 0:
                self.add(node, f"({self.text(node)} - 1)")

    def visit_Name(self, node):
        if isinstance(node.ctx, ast.Load) and node.id.isupper() and node.id in self.numbers:
            self.add(node, f"({node.id} + 1)")
            self.add(node, f"({node.id} - 1)")

    def visit_IfExp(self, node):
        self.guard(node.test)
        self.generic_visit(node)

    def visit_Call(self, node):
        for a, b in zip(node.args, node.args[1:]):
            if isinstance(a, ast.Starred) or isinstance(b, ast.Starred):
                continue
            first, second = self.text(a), self.text(b)
            if first != second:
                self.add_edits(Edit(*self.at(a), second), Edit(*self.at(b), first))
        self.generic_visit(node)

    def visit_JoinedStr(self, node):
        pass    # The places inside are not those of the file.

    # Statements.

    def visit_If(self, node):
        self.guard(node.test)
        self.remove_alone(node)
        self.generic_visit(node)

    def visit_While(self, node):
        if not (isinstance(node.test, ast.Constant)):
            self.guard(node.test, true=False)
        self.generic_visit(node)

    def remove_alone(self, node):
        """What is left out as a statement that is the only one of an if is its guard's mutant."""
        if len(node.body) == 1 and not node.orelse:
            self.guards.add(node.body[0])

    def remove(self, node):
        begin = self.at(node)[0]
        line = self.text_of_file[self.lines[node.lineno - 1]:begin]
        if node not in self.guards and not line.strip():
            self.add(node, "pass", statement=True)
        self.generic_visit(node)

    def visit_Expr(self, node):
        if not isinstance(node.value, ast.Constant):    # Else it is a comment.
            self.remove(node)

    def visit_Return(self, node):
        if isinstance(node.value, (ast.Compare, ast.BoolOp)):
            self.guard(node.value)
        self.remove(node)

    visit_Continue = visit_Break = remove

    def visit_Assign(self, node):
        if isinstance(node.targets[0], (ast.Attribute, ast.Subscript)):
            self.remove(node)
        else:       # Without it the name is unknown.
            self.generic_visit(node)

    visit_AugAssign = remove

    def visit_FunctionDef(self, node):
        before, self.function = self.function, f"{self.function}.{node.name}".lstrip(".")
        for statement in node.body:
            self.visit(statement)
        self.function = before

    def visit_ClassDef(self, node):
        before, self.function = self.function, node.name
        for statement in node.body:
            if isinstance(statement, ast.FunctionDef):
                self.visit(statement)
        self.function = before


def mutants(subject, project, texts):
    out = {}
    for file, text in texts.items():
        tree = ast.parse(text)
        walk = Walk(file, text)
        walk.numbers = {target.id for one in tree.body if isinstance(one, ast.Assign)
                        and isinstance(one.value, ast.Constant) and isinstance(one.value.value, int)
                        for target in one.targets if isinstance(target, ast.Name)}
        walk.visit(tree)
        out[file] = unique(walk.mutants)
    return out


def wrap(inner, alternatives):
    if any(edit.statement for _, edit in alternatives):
        numbers = ", ".join(str(number) for number, _ in alternatives)
        return f"if RUBRIC_MUTANT not in ({numbers},): {inner}"
    for number, edit in reversed(alternatives):
        inner = f"(({edit.text}) if RUBRIC_MUTANT == {number} else ({inner}))"
    return inner


def finish(text):
    return ('import os as _os; RUBRIC_MUTANT = int(_os.environ.get("RUBRIC_SOURCE_MUTANT", 0))\n'
            + text)
