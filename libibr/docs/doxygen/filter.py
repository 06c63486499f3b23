#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Doxygen's input filter for the public headers: turns comments for readers of a header into comments for Doxygen.

Rules for a header, which clang-format has formatted:

* The comment below the SPDX line describes the file.
* A `///` comment describes the declaration below it. It also describes functions and macros directly below that have
  no comment of their own: functions of the same name or that the comment names ("unlock()"), and any macro.
* A `//` comment behind a declaration, with the lines that continue it in the same column, describes the declaration.
* A `//` comment above a declaration that has no other comment describes the declaration.
* A comment on several variables in one declaration describes each of them. Labels assign its parts:
  `// seconds: elapsed time; cpuSeconds: processor time`. Text before the first label describes all.
* Moves, deleted copies and defaulted comparisons without a comment get a standard text.
* Indented lines and tables in a comment keep their layout.

Each declaration stays on its line, so that Doxygen's warnings name the right line.

Usage: filter.py HEADER
"""
import re
import sys

MOVED = "Moves; the source must only be destroyed or assigned to afterwards."
COMPARED = "Compares all members."
DELETED = "Deleted: objects cannot be copied."

LINE_BREAK = "@linebreak "  # alias of Doxyfile.in: a line break inside a comment that stays in one line
ABBREVIATION = re.compile(r"\b(e\.g|i\.e|et al|cf|eqs?|figs?|Algs?|Rec)\. ")  # its full stop ends no sentence
LITERAL = r'"(?:\\.|[^"\\])*"|(?<!\w)\'(?:\\.|[^\'\\])+\''
CLOSING = {"(": ")", "[": "]", "{": "}", "<": ">"}


class Line:
    """A line of a header: its code, and the comment behind the code or alone."""

    def __init__(self, text):
        self.text, self.code, self.column, self.doxygen, self.comment = text, text.rstrip(), None, False, ""
        for match in re.finditer(LITERAL + "|//", text):
            if match[0] == "//":
                self.code, self.column = text[:match.start()].rstrip(), match.start()
                self.doxygen = text.startswith("///", self.column)
                self.comment = re.sub(r"^///? ?", "", text[self.column:]).rstrip()
                return

    @property
    def is_comment(self):
        return self.column is not None and not self.code


class Item:
    """A declaration, an enumerator, a macro, or the head of a scope, from (first, column) to (last, end)."""

    def __init__(self, line, column, scope):
        self.first = self.last = line
        self.column = self.end = column
        self.scope = scope  # kind of the scope around it: namespace, record or enum
        self.opens = None  # kind of the scope that it opens
        self.code = ""
        self.texts = []  # description, by line

    @property
    def kind(self):
        code = without_template(self.code)
        if code.startswith("#"):
            return "macro"
        if code.startswith("}"):
            return "closing"  # the end of a type, with a variable of the type
        if self.opens or re.match(r"(struct|class|enum|union|namespace)\b", code):
            return "type"
        if re.match(r"(using|typedef)\b", code):
            return "alias"
        if re.match(r"(friend|static_assert)\b|(public|private|protected):", code):
            return "other"
        if self.scope == "enum":
            return "enumerator"
        head = outside_brackets(re.split(r"[={;]", code)[0], "<")
        return "function" if "(" in head or "operator" in head else "variable"

    @property
    def name(self):
        """Name of a function."""
        return re.search(r"(operator\W+?|~?\w+)\(", outside_brackets(without_template(self.code), "<"))[1]


def without_template(code):
    return re.sub(r"^template <[^{;]*?> (?=\w)", "", " ".join(code.split()))


def outside_brackets(text, brackets):
    """The text without the contents of brackets and their closing brackets."""
    result, stack = "", []
    for c in text:
        if not stack:
            result += c
        if stack and c == stack[-1]:
            stack.pop()
        elif c in brackets:
            stack.append(CLOSING[c])
    return result


def scope_of(code):
    """Kind of the scope that a brace opens after this code; None: a function's body or an initialiser."""
    code = without_template(code)
    if re.match(r"(inline )?namespace\b", code):
        return "namespace"
    if re.match(r"enum\b", code):
        return "enum"
    if re.match(r"(struct|class|union)\b", code) and not re.search(r"[(=]", outside_brackets(code, "<")):
        return "record"
    return None


def parse(lines):
    """Items of a header in the order of their starts."""
    items, scopes, item, depth, directive = [], ["namespace"], None, 0, False
    for number, line in enumerate(lines):
        if directive or line.code.startswith("#"):
            if not directive and line.code.startswith("#define"):
                items.append(Item(number, 0, scopes[-1]))
                items[-1].code, items[-1].end = line.code, len(line.code)
            directive = line.code.endswith("\\")
            continue
        if item:
            item.code += " "
        code = re.sub(LITERAL, lambda match: "_" * len(match[0]), line.code)
        for column, c in enumerate(code):
            if c.isspace():
                if item:
                    item.code += c
                continue
            if c == "}" and item and depth == 0:  # the last enumerator ends with its enumeration
                item = None
            if not item:
                if c == ";":
                    continue
                if c == "}":
                    scopes.pop()
                    if code[column + 1:].strip() in ("", ";"):
                        continue
                item, depth = Item(number, column, scopes[-1]), 0
                items.append(item)
            item.code += line.code[column]
            item.last, item.end = number, column + 1
            if c == "{" and depth == 0 and scope_of(item.code[:-1]):
                item.opens = scope_of(item.code[:-1])
                scopes.append(item.opens)
                item = None
            elif c in "([{":
                depth += 1
            elif c in ")]" or (c == "}" and depth > 0):
                depth -= 1
                if c == "}" and depth == 0 and not code[column + 1:].strip() and item.kind == "function":
                    item = None  # the end of a body
            elif depth == 0 and (c == ";" or (c == "," and item.scope == "enum") or
                                 (c == ":" and re.match(r"(public|private|protected):$", item.code))):
                item = None
    return items


def declarators(code):
    """(type, declarators) of a declaration of variables"""
    parts, depth = [""], 0
    for c in " ".join(code.split()).rstrip(";"):
        depth += (c in "([{<") - (c in ")]}>")
        if c == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    name = list(re.finditer(r"\w+", re.split(r"[={]", parts[0])[0]))[-1]
    return parts[0][:name.start()], [parts[0][name.start():]] + [part.strip() for part in parts[1:]]


def variable_names(item):
    """Names that a declaration of variables declares; none for other items."""
    if item.kind != "variable":
        return []
    return [re.match(r"\w+", declarator)[0] for declarator in declarators(item.code)[1]]


def by_name(text, names):
    """Text of each name: the text before the first label, and the part with its label ("a: text; b, c: text")."""
    name = "(?:" + "|".join(map(re.escape, names)) + ")"
    pieces = re.split(rf"(?:^|(?<=; )|(?<=\. ))({name}(?:, {name})*): ", text)
    if len(pieces) == 1:
        return dict.fromkeys(names, text)
    shared = pieces[0].rstrip(" .;")
    result = dict.fromkeys(names, shared)
    for label, part in zip(pieces[1::2], pieces[2::2]):
        for name in label.split(", "):
            result[name] = ": ".join(filter(None, [shared, part.rstrip(" ;")]))
    return result


def escaped(text):
    """Text without characters that Doxygen takes for markup, and without ends of sentences at abbreviations."""
    if re.match(r"@\w+", text):  # a Doxygen command
        return text
    parts = re.split(r"(`[^`]*`)", text)
    for i in range(0, len(parts), 2):
        parts[i] = re.sub(r"[@\\<>#&]|\*(?=\w)|(?<!\w)_(?=\w)", r"\\\g<0>", parts[i])
        parts[i] = ABBREVIATION.sub(r"\1.\\ ", parts[i])
    return "".join(parts)


def is_laid_out(texts):
    """For each line of a comment: True if its layout counts: indented lines, and paragraphs that start with columns."""
    fixed = [text.startswith("  ") for text in texts]
    in_table = False
    for i, text in enumerate(texts):
        starts = i == 0 or not texts[i - 1]
        in_table = bool(text) and (in_table or (starts and bool(re.search(r"\w {2,}\S", text))))
        fixed[i] = fixed[i] or in_table
    for i in range(1, len(texts) - 1):
        fixed[i] = fixed[i] or (not texts[i] and fixed[i - 1] and fixed[i + 1])
    return fixed


def described(texts):
    """Lines of a comment for Doxygen, as many as texts."""
    fixed, result, i = is_laid_out(texts), [], 0
    while i < len(texts):
        if not fixed[i]:
            result.append(escaped(texts[i]))
            i += 1
            continue
        end = i
        while end < len(texts) and fixed[end]:
            end += 1
        block = texts[i:end]
        indent = min(len(text) - len(text.lstrip()) for text in block if text)
        block = [text[indent:] for text in block]
        kind = "code{.cpp}" if any(re.search(r";(\s*//.*)?$", text) for text in block) else "verbatim"
        if result:
            result[-1] = f"{result[-1]} @{kind}".strip()
        else:
            block[0] = f"@{kind} {block[0]}"
        block[-1] += " @end" + kind.split("{")[0]
        result += block
        i = end
    return result


def inside_comment(text):
    if "*/" in text:
        raise ValueError(f'"{text}" cannot stand in a comment of Doxygen: "*/" would end it')
    return text


def standard_text(code):
    """Text of a function that has the same text in every class, or ""."""
    code = " ".join(code.split())
    if code.endswith("= delete;"):
        return DELETED
    if re.search(r"operator(==|<=>)\(.*= default;$", code):
        return COMPARED
    if re.match(r"(\w+)\(\1&&\)|(\w+)& operator=\(\2&&\)", code):
        return MOVED
    return ""


class Filter:
    """One run over a header."""

    def __init__(self, text):
        self.lines = [Line(line) for line in text.split("\n")]
        self.output = [line.text for line in self.lines]
        self.items = parse(self.lines)
        self.insertions = []  # (line, column, text)

    def replace_comment(self, numbers, texts, opening=""):
        """Writes a Doxygen comment over comments alone in lines. In `///` comments, code would keep the slashes."""
        if not any(is_laid_out(self.comments(numbers))):
            for number, text in zip(numbers, texts):
                self.output[number] = f"{' ' * self.lines[number].column}/// {text}".rstrip()
            if opening:
                self.output[0] = f"/// {opening}"
            return
        for number, text in zip(numbers, texts):
            self.output[number] = inside_comment(text)
        first = 0 if opening else numbers[0]
        self.output[first] = f"/** {opening or texts[0]}"
        self.output[numbers[-1]] += " */"

    def head(self):
        """Describes the file. Returns the number of the line below."""
        if not self.lines[0].comment.startswith("SPDX"):
            return 0
        end = 1
        while end < len(self.lines) and self.lines[end].is_comment and not self.lines[end].doxygen:
            end += 1
        numbers = range(1, end)
        if numbers:
            self.replace_comment(numbers, described(self.comments(numbers)), "@file")
        return end

    def continues(self, number, line):
        """True if a line continues the comment behind another line: in its column, or deeper than any declaration."""
        comment, indent = self.lines[number], len(line.text) - len(line.text.lstrip())
        return comment.is_comment and not comment.doxygen and comment.column > indent + 2

    def comment_behind(self, item):
        """Lines of the comment behind an item."""
        line = self.lines[item.last]
        if line.column is None or line.comment.startswith("NOLINT") or line.code[item.end:].strip(" };"):
            return range(0)
        end = item.last + 1
        while end < len(self.lines) and self.continues(end, line):
            end += 1
        return range(item.last, end)

    def comment_above(self, item, top):
        """Lines of the comment above an item, without those that continue a comment behind code."""
        if self.lines[item.first].code[:item.column].strip():
            return range(0)
        start = item.first
        while start > top and self.lines[start - 1].is_comment:
            start -= 1
        before = self.lines[start - 1]
        while top < start < item.first and before.code and self.continues(start, before):
            start += 1
        return range(start, item.first)

    def comments(self, numbers):
        return [self.lines[number].comment for number in numbers]

    def joined(self, numbers):
        return " ".join(self.comments(numbers))

    def erase(self, numbers):
        """Removes the comments of lines."""
        for number in numbers:
            self.output[number] = self.lines[number].code

    def insert(self, item, text):
        self.insertions.append((item.first, item.column, f"/** {inside_comment(text)} */ "))

    def run(self):
        """Returns the text for Doxygen."""
        top = self.head()
        enums = {item.first for item in self.items if item.opens == "enum"}
        previous = None  # item before, if its description may count for the next one
        for item in self.items:
            if item.kind == "other":
                previous = None
            elif item.kind == "closing":
                self.describe_closing(item)
            else:
                behind = self.comment_behind(item)
                if item.kind == "enumerator" and item.first in enums:
                    behind = range(0)  # a comment behind a whole enumeration
                previous = self.describe(item, self.comment_above(item, top), behind, previous)
        for line, column, text in sorted(self.insertions, reverse=True):
            self.output[line] = self.output[line][:column] + text + self.output[line][column:]
        return "\n".join(self.output)

    def describe_closing(self, item):
        """Describes a variable behind the end of its type."""
        behind = self.comment_behind(item)
        if behind:
            self.erase(behind)
            self.output[item.last] += f" ///< {escaped(self.joined(behind))}"

    def describe(self, item, above, behind, previous):
        """Describes an item by its comments. Returns the item, or None if its description counts for no other item."""
        in_place = bool(above) and self.lines[above[-1]].doxygen  # a comment that stays above the item
        text = self.joined(behind)
        inserted = []
        self.erase(behind)
        if in_place:
            item.texts = described(self.comments(above))
            if text:
                self.erase(above)
                item.texts = inserted = item.texts + [escaped(text)]
            else:
                self.replace_comment(above, item.texts)
        elif text or above:
            if not text:
                text = self.joined(above)
                self.erase(above)
            item.texts = inserted = [escaped(text)]
        elif item.kind == "function" and standard_text(item.code):
            item.texts = [standard_text(item.code)]
            self.insert(item, item.texts[0])
            return None
        elif previous and self.shares(item, previous):
            item.texts = inserted = previous.texts
        names = variable_names(item)
        if len(names) > 1:
            self.split(item, names, "" if in_place else text, skip_first=in_place and not inserted)
        elif inserted and item.kind == "macro":
            self.output[item.last] += f" /**< {LINE_BREAK.join(inserted)} */"
        elif inserted:
            self.insert(item, LINE_BREAK.join(inserted))
        return item if item.texts else None

    @staticmethod
    def shares(item, previous):
        """True if the description of the item directly above counts for this item, too."""
        if previous.last + 1 != item.first or previous.kind != item.kind:
            return False
        if item.kind == "function":
            return item.name == previous.name or any(f"{item.name}()" in text for text in previous.texts)
        return item.kind == "macro"

    def split(self, item, names, labelled, skip_first):
        """Declares each variable on its own, in the declaration's first line. `labelled`: text that may have labels."""
        texts = dict.fromkeys(names, LINE_BREAK.join(item.texts))
        if labelled:
            texts = {name: escaped(text) for name, text in by_name(labelled, names).items()}
        prefix, parts = declarators(item.code)
        if skip_first:
            texts[names[0]] = ""
        declarations = [(f"/** {inside_comment(texts[name])} */ " if texts[name] else "") + f"{prefix}{part};"
                        for name, part in zip(names, parts)]
        self.output[item.first] = self.output[item.first][:item.column] + " ".join(declarations)
        for number in range(item.first + 1, item.last + 1):
            self.output[number] = ""


def main():
    with open(sys.argv[1], encoding="utf-8") as header:
        try:
            sys.stdout.write(Filter(header.read()).run())
        except Exception:  # Doxygen ignores the exit status of filters; an unknown command makes Doxygen warn
            sys.stdout.write("/** @file @filterfailed */\n")
            raise


if __name__ == "__main__":
    main()
