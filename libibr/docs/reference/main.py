#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes documentation from the programs' own tables:

  python3 libibr/docs/reference/main.py APPS --man DIR --completion DIR     man pages, shell completion
  python3 libibr/docs/reference/main.py APPS --html DIR                     all pages and the library's interface, as HTML

APPS is the folder of the built programs, such as build/release/apps. The HTML needs doxygen; warnings are errors.
"""
import argparse
import pathlib
import shutil
import subprocess
import sys

import completion
import descriptions
import manual
import pages
from effects import Missing
from markdown import BrokenLink, Site, identifier

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent.parent
DOCS = ROOT / "libibr/docs"

# Pages by purpose, in the order in which a newcomer needs them. Other pages of libibr/docs are missing here: an error.
CHAPTERS = {
    "Start": ["start", "photographing", "capture", "poses", "photographs", "troubleshooting", "limits"],
    "Programs": ["commands", "cluster", "reference", "settings", "exit-codes", "viewer", "vr"],
    "Library": ["install", "examples", "conventions", "python", "extending", "architecture"],
    "File formats": ["schema-ibr-image-graph", "schema-ibr-harmonised-texture", "schema-build-steps", "schema-tradeoff"],
    "Measurements": ["quality", "metrics", "tradeoff", "costs"],
    "Tests": ["promises", "numerics", "faults", "mutants", "xr"],
    "Project": ["readme", "contributing", "changelog"],
}
OTHER_PAGES = {"viewer": "apps/viewer/README.md", "vr": "apps/vr/README.md", "architecture": "libibr/ARCHITECTURE.md",
               "readme": "README.md", "xr": "tests/xr/README.md", "photographs": "examples/photographs/README.md"}


def site_of(programs):
    site = Site(ROOT)
    for file in sorted(DOCS.glob("*.md")):
        site.add(file.stem.lower(), file.relative_to(ROOT), file.read_text())
    for name, path in OTHER_PAGES.items():
        site.add(name, path, (ROOT / path).read_text())
    for name, text in pages.pages(programs, sorted((ROOT / "libibr/schemas").glob("*.json"))).items():
        site.add(name.removesuffix(".md"), f"libibr/docs/{name}", text)
    return site


def add_chapters(site):
    """Adds a page for each chapter and the first page. Throws Missing for a page that no chapter has."""
    listed = {name for names in CHAPTERS.values() for name in names}
    missing = [name for name in site.texts if name not in listed and not name.startswith("reference-")]
    if missing:
        raise Missing(f"pages without a chapter in main.py: {', '.join(missing)}")
    index = "# libibr\n\nWalk through a real place from photographs. [Five minutes](start.md) lead from photographs to a walk.\n\n"
    for chapter, names in CHAPTERS.items():
        text = f"# {chapter}\n\n" + "".join(f"* @subpage {identifier(name)}\n" for name in names)
        site.add(f"chapter-{chapter.lower().replace(' ', '-')}", f"libibr/docs/{chapter}.md", text)
        index += f"* @subpage {identifier('chapter-' + chapter.lower().replace(' ', '-'))} — " + ", ".join(
            f"@ref {identifier(name)}" for name in names) + "\n"
    index += "* <a href=\"annotated.html\">All classes</a> and <a href=\"files.html\">all headers</a> of the library's interface\n"
    site.add("index", "libibr/docs/index.md", index)


def write_pages(programs, folder):
    site = site_of(programs)
    add_chapters(site)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in site.texts:
        (folder / f"{name}.md").write_text(site.converted(name))
    for name, file in site.pictures.items():
        shutil.copy(file, folder / name)
    return site


def write_html(programs, out):
    site = write_pages(programs, out / "pages")
    values = {"IBR_SOURCE": ROOT, "IBR_DOCS_OUTPUT": out, "IBR_VERSION": programs[0].version, "IBR_PAGES": out / "pages"}
    configuration = (DOCS / "doxygen/Doxyfile.in").read_text()
    for name, value in values.items():
        configuration = configuration.replace(f"@{name}@", str(value))
    (out / "Doxyfile").write_text(configuration)
    shutil.rmtree(out / "html", ignore_errors=True)
    done = subprocess.run(["doxygen", out / "Doxyfile"], cwd=out, capture_output=True, text=True)
    if done.returncode or done.stderr:
        raise Missing(f"doxygen:\n{done.stderr[-8000:]}")
    broken = [page.name for page in (out / "html").glob("page_*.html") if "ilinebr" in page.read_text()]
    if broken:
        raise Missing(f"doxygen shows its own commands in {', '.join(sorted(broken))}: code there has unusual marks")
    for name, file in site.pictures.items():
        shutil.copy(file, out / "html" / name)
    generated = sum(name.startswith(("reference", "schema", "settings", "exit")) for name in site.texts)
    print(f"{len(site.texts)} pages, {generated} of them generated; {out / 'html/index.html'}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("apps", type=pathlib.Path)
    for name in ("man", "completion", "html"):
        parser.add_argument(f"--{name}", type=pathlib.Path)
    options = parser.parse_args()
    programs = descriptions.read(options.apps)
    installed = [program for program in programs if program.name in descriptions.INSTALLED]
    if options.man:
        options.man.mkdir(parents=True, exist_ok=True)
        for name, text in manual.pages(installed).items():
            (options.man / name).write_text(text)
    if options.completion:
        options.completion.mkdir(parents=True, exist_ok=True)
        (options.completion / "ibr.bash").write_text(completion.bash(installed))
        for program in installed:
            (options.completion / f"{program.name}.fish").write_text(completion.fish(program))
    if options.html:
        absent = [name for name in descriptions.PROGRAMS if name not in [program.name for program in programs]]
        if absent:
            raise Missing(f"{options.apps}: {', '.join(absent)} was not built")
        options.html.mkdir(parents=True, exist_ok=True)
        write_html(programs, options.html.resolve())


if __name__ == "__main__":
    try:
        main()
    except (Missing, BrokenLink) as fault:
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {fault}")
