# SPDX-License-Identifier: Apache-2.0
"""Turns the repository's Markdown into Markdown that Doxygen 1.9 links: headings get identifiers, links between pages refer
to these, links to other files of the repository become their paths, and pictures get unique names."""
import pathlib
import re

HEADING = re.compile(r"^(#{1,5}) (.*?)\s*#*$")
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
FENCE = re.compile(r"^\s*(```|~~~)")
CODE = re.compile(r"(`+)((?:(?!\n\s*\n).)+?)\1(?!`)", re.DOTALL)


class BrokenLink(Exception):
    pass


def slug(heading):
    """The anchor that GitHub gives a heading."""
    text = LINK.sub(lambda link: link[2], heading).replace("`", "").lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors_of(text):
    """Returns the anchors of a page's headings below its title."""
    found, fenced = [], False
    for line in text.splitlines():
        fenced ^= bool(FENCE.match(line))
        heading = HEADING.match(line)
        if heading and not fenced and len(heading[1]) > 1:
            found.append(slug(heading[2]))
    return found


def identifier(page, anchor=""):
    """Identifier of a page or of a heading in it."""
    return re.sub(r"\W+", "_", f"page_{page}" + (f"__{anchor}" if anchor else ""))


class Site:
    """Pages by their path in the repository. A page's name is unique; its links are relative to its path."""

    def __init__(self, root):
        self.root = pathlib.Path(root).resolve()
        self.texts, self.names, self.pictures = {}, {}, {}

    def add(self, name, path, text):
        self.names[pathlib.Path(path)] = name
        self.texts[name] = (pathlib.Path(path), text)

    def target_of(self, path, link):
        """The file that a link of the page at `path` refers to, relative to the root."""
        return pathlib.Path(*(part for part in (self.root / path.parent / link).resolve().relative_to(self.root).parts))

    def link(self, name, picture, words, to):
        path, _ = self.texts[name]
        if re.match(r"[a-z]+:", to):
            return f"[{words}]({to})"
        file, _, anchor = to.partition("#")
        target = self.target_of(path, file) if file else path
        if target in self.names:
            page = self.names[target]
            if anchor and anchor not in anchors_of(self.texts[page][1]):
                raise BrokenLink(f"{path}: {to}: the page has no such heading")
            if page.startswith(f"{name}-"):  # a part of this page
                return f'@subpage {identifier(page)} "{words}"'
            return f"[{words}](@ref {identifier(page, anchor)})"
        if not (self.root / target).exists():
            raise BrokenLink(f"{path}: {to}: no such file")
        if picture or target.suffix in (".svg", ".jpg", ".png"):
            unique = "-".join(target.parts)
            self.pictures[unique] = self.root / target
            return f"![{words}]({unique})" if picture else f"<a href=\"{unique}\">{words}</a>"
        return words if words.strip("`") == str(target) else f"{words} (`{target}`)"

    def converted(self, name):
        """Returns the page for Doxygen."""
        out, block = [], []

        def flush():
            """A link may be broken over lines."""
            text = LINK.sub(lambda m: self.link(name, m[1], m[2], m[3]), "\n".join(block))
            # To Doxygen, an apostrophe ends code that begins with one backtick.
            text = CODE.sub(lambda code: f"``{code[2]}``" if "'" in code[2] else code[0], text)
            out.append(text if block else None)
            block.clear()

        fenced = False
        for line in self.texts[name][1].splitlines():
            heading = HEADING.match(line)
            if FENCE.match(line):
                flush()
                fenced = not fenced
                out.append(re.sub(r"```(\w+)$", r"```{.\1}", line))
            elif fenced:
                out.append(line)
            elif heading:
                flush()
                anchor = "" if len(heading[1]) == 1 else slug(heading[2])
                words = LINK.sub(lambda link: link[2], heading[2])
                out.append(f"{heading[1]} {words} {{#{identifier(name, anchor)}}}")
            else:
                block.append(line)
        flush()
        return "\n".join(part for part in out if part is not None) + "\n"
