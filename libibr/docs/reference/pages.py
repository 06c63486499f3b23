# SPDX-License-Identifier: Apache-2.0
"""Pages that are made from the programs' own tables and from the schemas, as Markdown: commands, settings, exit codes and
file formats."""
import json
import re

from descriptions import COMMON
from effects import effects_of


def cell(text):
    """Text of a table's cell. Options are code: Markdown makes dashes of --."""
    parts = re.split(r"(`[^`]*`)", text.replace("|", "\\|").replace("\n", " "))
    return "".join(part if part.startswith("`") else re.sub(r"(?<![\w-])(--[a-z][\w-]*)", r"`\1`", part) for part in parts)


def code(text):
    """Code in a table's cell. Doxygen ends a cell at |, also in code: words are separated otherwise."""
    return " or ".join(f"`{word}`" for word in text.split("|"))


def usage(option):
    names = ", ".join(f"`{name}`" for name in option.names)
    return names if option.argument or not option.type else f"{names} {code(option.type)}"


def option_rows(options):
    return "".join(f"| {usage(option)} | {cell(option.text)} |\n" for option in options)


def options_of(command):
    """Tables of a command's options, one for each heading; the options of all commands come last."""
    own = [option for option in command.options if option.name not in COMMON]
    text = ""
    for heading in dict.fromkeys(option.heading for option in own):
        rows = option_rows([option for option in own if option.heading == heading])
        text += f"\n## {'Options' if heading.lower() == 'options' else heading}\n\n| option | effect |\n|---|---|\n{rows}"
    common = option_rows([option for option in command.options if option.name in COMMON])
    return text + f"\n## Options of all commands\n\n| option | effect |\n|---|---|\n{common}"


def command_page(command):
    text = f"# {command.line}\n\n{command.summary.rstrip('.')}.\n\n```sh\n" + "\n".join(command.examples) + "\n```\n"
    if command.details:
        text += f"\n```\n{command.details}\n```\n"
    if command.after_interrupt:
        text += f"\nAfter Ctrl-C: {command.after_interrupt}.\n"
    return text + options_of(command)


def command_list(programs):
    text = "# Command reference\n\nThis page and its links are made from the tables by which the programs read their " \
           "command lines. [Commands](commands.md) has examples for each purpose.\n"
    for program in programs:
        text += f"\n## {program.name}\n\n{program.summary}\n\n| command | purpose |\n|---|---|\n"
        for command in program.commands:
            text += f"| [{command.line}](reference-{command.page}.md) | {cell(command.summary)} |\n"
    return text


def exit_code_page(programs):
    rows = "".join(f"| {c['code']} | {cell(c['meaning'])} |\n" for c in programs[0].exit_codes)
    return f"""# Exit codes and error codes

All programs end with one of these codes:

| exit code | meaning |
|---|---|
{rows}
The library throws ibr::Error, whose ibr::ErrorCode says what went wrong. [Troubleshooting](troubleshooting.md) lists
messages and remedies.
"""


def setting_page(programs):
    """Settings of the commands in effects.json, each with its measured effect."""
    text = """# Settings and their measured effects

Each option that changes the result or the cost of a command, with its effect as measured. Inputs, outputs and the options
of all commands are left out: the [command reference](reference.md) lists them.

Settings of rendering were measured on five scenes ([trade-off](tradeoff.md)), the others by `libibr/docs/reference/measure.py`: on a
generated *court* of fine texture with exact truth, on the bundled *lane* with two photographs held out, and on the generated figure in
a *studio*. One setting at a time differs from the defaults; figures are differences from the defaults. Settings of cells and of the gather
differ from `--composition cells` or `gathered` instead, where their row says so.
"""
    for command, effects in effects_of(programs):
        text += f"\n## {command.line}\n\n| setting | meaning | measured effect |\n|---|---|---|\n"
        for option in command.options:
            if option.name in effects:
                text += f"| {usage(option)} | {cell(option.text)} | {cell(effects[option.name])} |\n"
    return text


def type_of(schema):
    if "const" in schema:
        return json.dumps(schema["const"])
    if "enum" in schema:
        return " or ".join(json.dumps(value) for value in schema["enum"])
    if "$ref" in schema:
        return schema["$ref"].rpartition("/")[2]
    if "allOf" in schema:
        return type_of(schema["allOf"][0])
    kind = schema.get("type", "any")
    kind = " or ".join(kind) if isinstance(kind, list) else kind
    if "items" in schema and isinstance(schema["items"], dict):
        kind += f" of {type_of(schema['items'])}"
    for name, words in (("minimum", "from"), ("exclusiveMinimum", "over"), ("maximum", "to"),
                        ("exclusiveMaximum", "below"), ("minItems", "with at least"), ("maxItems", "with at most")):
        if name in schema:
            kind += f" {words} {schema[name]}"
    return kind


def fields_of(schema, path=""):
    """Yields path, schema and whether it is required, for all fields below."""
    for variant in [schema, *schema.get("allOf", []), schema.get("then", {})]:
        required = variant.get("required", [])
        for name, field in variant.get("properties", {}).items():
            here = f"{path}.{name}" if path else name
            yield here, field, name in required
            yield from fields_of(field, here)
            if isinstance(field.get("items"), dict):
                yield from fields_of(field["items"], here + "[]")


def schema_page(file):
    schema = json.loads(file.read_text())
    text = f"# {schema.get('title', file.name)}\n\n{schema.get('description', '')}\n\nSchema: `libibr/schemas/{file.name}`\n"
    parts = [("Fields", schema), *((name, part) for key in ("definitions", "$defs")
                                   for name, part in schema.get(key, {}).items())]
    for name, part in parts:
        rows = "".join(f"| {code(path)} | {cell(type_of(field))}{'' if needed else ', optional'} | "
                       f"{cell(field.get('description', ''))} |\n" for path, field, needed in fields_of(part))
        if rows:
            about = "" if part is schema else part.get("description", "")
            text += f"\n## {name}\n\n{about}\n\n| field | type | meaning |\n|---|---|---|\n{rows}"
    return text


def pages(programs, schemas):
    """Returns the text of each page by its file name."""
    files = {"reference.md": command_list(programs), "exit-codes.md": exit_code_page(programs),
             "settings.md": setting_page(programs)}
    for program in programs:
        for command in program.commands:
            files[f"reference-{command.page}.md"] = command_page(command)
    for file in schemas:
        files[f"schema-{re.sub('[^a-z]+', '-', file.name.lower().removesuffix('.schema.json'))}.md"] = schema_page(file)
    return files
