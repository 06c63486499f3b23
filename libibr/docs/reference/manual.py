# SPDX-License-Identifier: Apache-2.0
"""Man pages: one for each program and each command of `ibr` (man 7 man-pages, man 7 groff_man)."""
import re

DECODER = """.TH IBR\\-DECODE 1 "" "ibr VERSION" "User Commands"
.SH NAME
ibr\\-decode \\- decodes a photograph for libibr
.SH SYNOPSIS
.B ibr\\-decode
.BR probe | picture
.I PIXELS
<
.I FILE
>
.I DECODED
.SH DESCRIPTION
libibr runs this program to read HEIC, AVIF, WebP and raw photographs, which it decodes with limits of memory and
processor time. It is not meant to be run by hand. libibr finds it by the environment variable
.BR IBR_DECODER ,
beside its own program, or in
.BR PATH .
.SH SEE ALSO
.BR ibr (1)
"""


def escaped(text):
    text = text.replace("\\", "\\\\").replace("-", "\\-").replace("'", "\\(aq")
    return re.sub(r"^\.", "\\\\&.", text, flags=re.MULTILINE)


def title(page, program):
    return f'.TH {escaped(page.upper())} 1 "" "{escaped(program.name)} {program.version}" "User Commands"\n'


def examples_of(lines):
    return ".SH EXAMPLES\n.nf\n" + "\n".join(escaped(line) for line in lines) + "\n.fi\n"


def exit_codes_of(program):
    rows = "".join(f".TP\n.B {code['code']}\n{escaped(code['meaning'])}\n" for code in program.exit_codes)
    return ".SH EXIT STATUS\n" + rows


def paragraphs_of(text):
    """Lines that are indented, such as lists, keep their breaks."""
    out = []
    for paragraph in text.split("\n\n"):
        lines = paragraph.split("\n")
        listed = any(line.startswith(" ") for line in lines)
        out.append((".PP\n.nf\n{}\n.fi\n" if listed else ".PP\n{}\n").format("\n".join(escaped(line) for line in lines)))
    return "".join(out)


def command_page(program, command, others):
    arguments = " ".join((f"{o.names[0]}..." if o.repeated else o.names[0]) for o in command.arguments)
    page = title(command.page, program)
    page += f".SH NAME\n{escaped(command.page)} \\- {escaped(command.summary[0].lower() + command.summary[1:].rstrip('.'))}\n"
    page += f".SH SYNOPSIS\n.B {escaped(command.line)}\n.RI [ OPTIONS ]\n"
    page += f".I {escaped(arguments)}\n" if arguments else ""
    page += f".SH DESCRIPTION\n{escaped(command.summary.rstrip('.'))}.\n"
    page += paragraphs_of(command.details) if command.details else ""
    page += ".SH OPTIONS\n"
    heading = None
    for option in command.options:
        if option.heading != heading and option.heading not in ("Options", "OPTIONS"):
            page += f".SS {escaped(option.heading)}\n"
        heading = option.heading
        names = ", ".join(f"\\fB{escaped(name)}\\fR" for name in option.names)
        page += f".TP\n{names}" + (f" \\fI{escaped(option.type)}\\fR" if option.type and not option.argument else "")
        page += f"\n{escaped(option.text)}\n"
    page += examples_of(command.examples)
    page += exit_codes_of(program)
    if command.after_interrupt:
        page += f".SH NOTES\nAfter Ctrl\\-C: {escaped(command.after_interrupt)}.\n"
    page += ".SH SEE ALSO\n" + ",\n".join(f".BR {escaped(other)} (1)" for other in others if other != command.page) + "\n"
    return page


def program_page(program):
    page = title(program.name, program)
    page += f".SH NAME\n{escaped(program.name)} \\- {escaped(program.summary.partition('. ')[0].rstrip('.'))}\n"
    page += f".SH SYNOPSIS\n.B {escaped(program.name)}\n.I COMMAND\n.RI [ OPTIONS ]\n"
    page += f".SH DESCRIPTION\n{escaped(program.summary)}\n.SH COMMANDS\n"
    for command in program.commands:
        page += f".TP\n.BR {escaped(command.page)} (1)\n{escaped(command.summary)}\n"
    page += exit_codes_of(program)
    page += ".SH ENVIRONMENT\n"
    for name, text in (("IBR_DECODER", "path of the program ibr-decode"),
                       ("IBR_DISABLE_FEATURES", "as the option --disable-feature")):
        page += f".TP\n.B {name}\n{escaped(text)}\n"
    return page


def pages(programs):
    """Returns the text of each man page by its file name."""
    files = {}
    names = [program.name for program in programs]
    for program in programs:
        others = [c.page for c in program.commands if c.words] + names
        if program.commands[0].words:
            files[f"{program.name}.1"] = program_page(program)
        for command in program.commands:
            files[f"{command.page}.1"] = command_page(program, command, others)
    files["ibr-decode.1"] = DECODER.replace("VERSION", programs[0].version)
    return files
