# SPDX-License-Identifier: Apache-2.0
"""Descriptions of the programs' command lines, as `PROGRAM --describe` prints them."""
import dataclasses
import json
import os
import pathlib
import re
import subprocess
import tempfile

PROGRAMS = {"ibr": "batch/ibr", "ibr-lab": "lab/ibr-lab", "ibr-viewer": "viewer/ibr-viewer", "ibr-vr": "vr/ibr-vr"}
INSTALLED = ("ibr", "ibr-viewer", "ibr-vr")
COMMON = ("--help", "--version", "--help-all", "--json", "--device", "--disable-feature", "--seed", "--threads", "--quiet",
          "--verbose")


@dataclasses.dataclass
class Option:
    names: list
    argument: bool
    flag: bool
    type: str
    description: str
    heading: str
    required: bool = False
    repeated: bool = False
    needs: list = dataclasses.field(default_factory=list)
    excludes: list = dataclasses.field(default_factory=list)

    @property
    def name(self):
        """The long name, such as --output, or the argument's word."""
        return next((name for name in self.names if name.startswith("--")), self.names[0])

    @property
    def choices(self):
        """The words that the option takes, if it takes only some."""
        words = self.type.split("|")
        return words if len(words) > 1 and not any(word.isupper() for word in words) else []

    @property
    def text(self):
        """The description, with what it needs and excludes."""
        parts = [re.sub(r"(?<!:)\s*\n\s*", "; ", self.description).replace("\n", " ")]
        if self.required:
            parts.append("required")
        if self.needs:
            parts.append("needs " + ", ".join(self.needs))
        if self.excludes:
            parts.append("not with " + ", ".join(self.excludes))
        return "; ".join(parts)


@dataclasses.dataclass
class Command:
    program: str
    words: str  # "htm build"; "" for a program without commands
    summary: str
    examples: list
    details: str
    after_interrupt: str
    options: list

    @property
    def line(self):
        return f"{self.program} {self.words}".strip()

    @property
    def page(self):
        return self.line.replace(" ", "-")

    @property
    def arguments(self):
        return [option for option in self.options if option.argument]


@dataclasses.dataclass
class Program:
    name: str
    version: str
    summary: str
    commands: list
    exit_codes: list


def options_of(listed):
    return [Option(**option) for option in listed]


def split_help(text):
    """Divides a help text of the form "Examples:\\n  LINE…\\n\\nSENTENCES" into the lines and the sentences."""
    examples, _, rest = text.removeprefix("Examples:\n").partition("\n\n")
    return [line.strip() for line in examples.splitlines()], " ".join(rest.split())


def described(program):
    """Returns what `PROGRAM --describe` prints, without a folder of this machine: in an empty home, the folder for
    pictures is the current one."""
    with tempfile.TemporaryDirectory() as home:
        here = os.path.realpath(home)
        environment = {name: value for name, value in os.environ.items() if name != "XDG_CONFIG_HOME"} | {"HOME": here}
        text = subprocess.run([program.resolve(), "--describe"], check=True, capture_output=True, text=True, cwd=here,
                              env=environment).stdout
    return json.loads(text.replace(f"[{here}]", "[ibr in the user's folder for pictures; without it the current one]"))


def read(apps, names=tuple(PROGRAMS)):
    """Returns the programs in the folder `apps` of a build; those that were not built are left out."""
    programs = []
    for name in names:
        file = pathlib.Path(apps) / PROGRAMS[name]
        if not file.exists():
            continue
        said = described(file)
        examples, summary = split_help(said["help"])
        if "commands" in said:
            commands = [Command(name, c["command"], c["summary"], c["examples"].split("\n"), c["details"],
                                c["afterInterrupt"], options_of(c["options"])) for c in said["commands"]]
        else:
            commands = [Command(name, "", summary, examples, "", "", options_of(said["options"]))]
        programs.append(Program(name, said["version"], summary, commands, said["exitCodes"]))
    return programs
