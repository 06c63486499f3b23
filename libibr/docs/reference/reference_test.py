#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the generated documentation: reference_test.py APPS. Man pages have no warnings, completion offers what the
programs accept, and faults of the pages are found."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import completion
import descriptions
import effects
import manual
import markdown
import pages

APPS = pathlib.Path(sys.argv.pop(1)).resolve()
PROGRAMS = descriptions.read(APPS)
SCHEMAS = sorted((pathlib.Path(__file__).resolve().parent.parent.parent / "schemas").glob("*.json"))


def command(line):
    return next(c for program in PROGRAMS for c in program.commands if c.line == line)


def completed(*words):
    """What bash offers for the last word."""
    script = 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _ibr; echo "${COMPREPLY[*]}"'
    with tempfile.NamedTemporaryFile("w", suffix=".bash") as file:
        file.write(completion.bash(PROGRAMS))
        file.flush()
        done = subprocess.run(["bash", "-c", script, "bash", file.name, *words], check=True, capture_output=True, text=True)
    return done.stdout.split()


class Descriptions(unittest.TestCase):
    def test_help_lists_every_described_option(self):
        for program in PROGRAMS:
            for each in program.commands:
                said = subprocess.run([APPS / descriptions.PROGRAMS[program.name], *each.words.split(),
                                       "--help-all" if each.words else "--help"],
                                      check=True, capture_output=True, text=True).stdout
                for option in each.options:
                    self.assertIn(option.names[-1], said, each.line)

    def test_descriptions_name_no_folder_of_this_machine(self):
        here = {str(pathlib.Path.cwd()), str(pathlib.Path.home()), str(APPS), "/tmp"}
        for program in PROGRAMS:
            for option in (option for each in program.commands for option in each.options):
                self.assertFalse(any(f"[{folder}" in option.description for folder in here), option.description)

    def test_every_option_and_command_has_a_description(self):
        for program in PROGRAMS:
            for each in program.commands:
                self.assertTrue(each.summary and each.examples, each.line)
                for option in each.options:
                    self.assertTrue(option.description, f"{each.line} {option.name}")


class ManPages(unittest.TestCase):
    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    def test_groff_warns_of_nothing(self):
        for name, text in manual.pages(PROGRAMS).items():
            done = subprocess.run(["groff", "-K", "utf8", "-man", "-Tutf8", "-ww", "-z"], input=text, capture_output=True, text=True)
            self.assertEqual(done.stderr, "", name)

    def test_each_command_has_a_page_that_names_its_options(self):
        files = manual.pages(PROGRAMS)
        self.assertIn("\\-\\-refine\\-poses", files["ibr-build.1"])
        for name in ("ibr.1", "ibr-htm-build.1", "ibr-viewer.1", "ibr-vr.1", "ibr-decode.1"):
            self.assertIn(name, files)


class Completion(unittest.TestCase):
    def test_commands_options_and_words(self):
        self.assertIn("build", completed("ibr", ""))
        self.assertEqual(completed("ibr", "vali"), ["validate"])
        self.assertEqual(completed("ibr", "htm", "se"), ["sequence"])
        self.assertEqual(completed("ibr", "build", "photographs", "--dep"), ["--depth"])
        self.assertEqual(completed("ibr", "build", "--depth", ""), command("ibr build").options[
            [o.name for o in command("ibr build").options].index("--depth")].choices)
        self.assertIn("--preset", completed("ibr-viewer", "--pre"))
        self.assertEqual(completed("ibr", "build", "pho"), [])


class Effects(unittest.TestCase):
    def test_every_setting_has_a_measured_effect(self):
        for each, texts in effects.effects_of(PROGRAMS):
            for name, text in texts.items():
                self.assertRegex(text, r"\d|\]\(", f"{each.line} {name}: neither a figure nor a link to one")

    def test_a_setting_without_an_effect_is_named(self):
        extra = descriptions.Option(["--new"], False, False, "X", "A new setting", "Options")
        command("ibr build").options.append(extra)
        try:
            with self.assertRaisesRegex(effects.Missing, "--new"):
                effects.effects_of(PROGRAMS)
        finally:
            command("ibr build").options.remove(extra)


class Pages(unittest.TestCase):
    def test_every_command_and_schema_has_a_page(self):
        made = pages.pages(PROGRAMS, SCHEMAS)
        for program in PROGRAMS:
            for each in program.commands:
                for option in each.options:
                    self.assertIn(f"`{option.name}`", made[f"reference-{each.page}.md"])
        self.assertEqual(sum(name.startswith("schema-") for name in made), len(SCHEMAS))

    def test_every_field_of_a_schema_has_a_description(self):
        for file in SCHEMAS:
            schema = json.loads(file.read_text())
            for part in [schema, *schema.get("$defs", {}).values()]:
                for path, field, _ in pages.fields_of(part):
                    # A definition has its own table.
                    self.assertTrue("description" in field or "$ref" in field, f"{file.name}: {path}")

    def test_links_and_headings(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "docs").mkdir()
            (root / "source.cpp").write_text("")
            site = markdown.Site(root)
            site.add("a", "docs/a.md", "# A\n\n[b](b.md#two-words) and [a\nsource](../source.cpp)\n\n```sh\n# [x](y)\n```\n")
            site.add("b", "docs/b.md", "# B\n\n## Two `words`\n")
            text = site.converted("a")
            self.assertIn("[b](@ref page_b__two_words)", text)
            self.assertIn("`source.cpp`", text)
            self.assertIn("# [x](y)", text)
            self.assertIn("## Two `words` {#page_b__two_words}", site.converted("b"))
            for link in ("b.md#three", "c.md"):
                site.add("a", "docs/a.md", f"# A\n\n[b]({link})\n")
                with self.assertRaises(markdown.BrokenLink):
                    site.converted("a")


if __name__ == "__main__":
    unittest.main()
