# SPDX-License-Identifier: Apache-2.0
"""Measured effects of settings: of the renderer from tradeoff.md, of other commands from measured.json (measure.py), and
sentences of effects.json that name a page with figures. effects.json also lists the options that are inputs, outputs or
diagnostics and have no effect to measure."""
import json
import pathlib
import re

from descriptions import COMMON

HERE = pathlib.Path(__file__).resolve().parent
TRADE_OFF = "[trade-off](tradeoff.md#what-each-knob-costs-and-gives)"

CELLS, GATHERED = ("--composition cells", ("composition", "cells")), ("--composition gathered", ("composition", "gathered"))
COLOURS = ("--composition cells --colour ours", ("colour", "ours"))
# The options and the row that knobs of a composition were varied from (apps/batch/tradeoff/tradeoff_settings.cpp).
BASES = {"photographs": GATHERED, "colours": GATHERED, "layers": GATHERED, "voteScale": GATHERED,
         "cells": CELLS, "extrapolation": CELLS, "blend": CELLS, "morph": CELLS, "order": CELLS, "align": CELLS, "colour": CELLS,
         "colourTable": COLOURS, "colourSamples": COLOURS, "colourProxy": COLOURS, "colourPeriod": COLOURS}


class Missing(Exception):
    """A setting without a measured effect, or an effect without its setting."""


def knobs():
    """Returns the rows of each knob in tradeoff.md: value, time, FLIP, PSNR."""
    text = (HERE.parent / "tradeoff.md").read_text()
    found, knob = {}, None
    for line in text.partition("## What each knob")[2].partition("<!-- end -->")[0].splitlines():
        fields = [field.strip() for field in line.strip("|").split("|")]
        if len(fields) == 5 and re.fullmatch(r"[\d.]+", fields[2]):
            knob = fields[0].strip("`") or knob
            found.setdefault(knob, []).append((fields[1], *map(float, fields[2:])))
    return found


def varied_from(knob, of_knobs):
    """Returns the options and the row that a knob was varied from. Other knobs than those of BASES were varied from the
    default, which has no row: the page's figures are relative to it."""
    if knob not in BASES:
        return "", ("the default", 1, 1, 0)
    options, (other, value) = BASES[knob]
    first, base = of_knobs[knob][0], next(row for row in of_knobs[other] if row[0] == value)
    if first[1:] != base[1:]:
        raise Missing(f"tradeoff.md: the first value of {knob} is not that of {other} {value}, from which it was varied")
    return f" with `{options}`", first


def knob_text(knob, of_knobs):
    options, base = varied_from(knob, of_knobs)
    values = "; ".join(f"`{value}`: time × {time / base[1]:.2f}, FLIP × {flip / base[2]:.3f}, PSNR {psnr - base[3] + 0.0:+.2f} dB"
                       for value, time, flip, psnr in of_knobs[knob] if value != base[0])
    return f"against {base[0]}{options}: {values} ({TRADE_OFF})"


def measured_text(rows):
    parts = []
    for words, figures in rows.items():
        part = f"`{words}`: processor time × {figures['cpu']:.2f}"
        for name, label, form in (("psnr", "PSNR, dB,", "{:+.2f}"), ("flip", "FLIP", "{:+.3f}"), ("ecc", "ECC", "{:+.4f}"),
                                  ("ssim", "SSIM", "{:+.4f}")):
            if name in figures:
                part += f", {label} " + " and ".join(f"{form.format(value + 0.0)} ({scene})"  # + 0.0: no "-0.00"
                                                      for scene, value in figures[name].items())
        parts.append(part)
    return "; ".join(parts)


def camel(name):
    return re.sub("-(.)", lambda match: match[1].upper(), name.removeprefix("--"))


def effects_of(programs):
    """Returns pairs of a command and the effect of each of its settings by name. Throws Missing."""
    sentences, measured = json.loads((HERE / "effects.json").read_text()), json.loads((HERE / "measured.json").read_text())
    of_knobs = knobs()
    commands = {command.line: command for program in programs for command in program.commands}
    result = []
    for line, given in sentences.items():
        command, effects = commands[line], dict(given["effects"])
        for option in command.options:
            rows = measured.get(given.get("measured", line), {}).get(option.name)
            if option.name in effects or option.name in given["inputs"] or option.name in COMMON:
                continue
            if given.get("knobs") and camel(option.name) in of_knobs:
                effects[option.name] = knob_text(camel(option.name), of_knobs)
            elif rows:
                effects[option.name] = measured_text(rows)
            else:
                raise Missing(f"{line} {option.name} has no measured effect: measure it (measure.py, tradeoff.sh), or "
                              f"list it in {HERE.name}/effects.json")
        names = {option.name for option in command.options}
        unknown = [name for name in [*given["effects"], *given["inputs"]] if name not in names]
        if unknown:
            raise Missing(f"{HERE.name}/effects.json: {line} has no option {', '.join(unknown)}")
        result.append((command, effects))
    return result
