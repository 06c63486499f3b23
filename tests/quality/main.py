#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Judges whole views of scenes against photographs that no scene was built from. Each set is built by one `ibr build`
and judged by one `ibr eval`. All sets take the same options; a set only says where its files are and which photographs
are left out. The folder OUT gets the tables (quality.md), all figures (quality.json) and a contact sheet of the worst
views (sheet.jpg), and below scenes, pictures, results and logs what each set left. A set that is finished is not run
again.
"""
import argparse
import os
import pathlib
import shutil
import signal
import sys

from figures import summary
from files import COMMAND_LINE, OK, ROOT, RUN_TIME, STOPPED, Failure, read_json, say, write_json, write_text
from page import markdown
from program import Program, describe
from reference import FROZEN_FILE, SMALL_FILE, former_of_small, freeze, judge_small
from sets import SETS, chosen, configuration_of
from sheet import write_sheet
from work import Work


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Failure(f"{message} (--help lists the options)", COMMAND_LINE)


def with_equals(arguments):
    """--build "--seams" as --build=--seams: argparse would take the value for an option."""
    joined = []
    for word in arguments:
        if joined and joined[-1] in ("--build", "--eval"):
            joined[-1] += "=" + word
        else:
            joined.append(word)
    return joined


def parse(arguments):
    parser = Parser(
        prog="tests/quality.sh", formatter_class=argparse.RawDescriptionHelpFormatter, description=__doc__,
        epilog="sets: " + ", ".join(each.name for each in SETS) + """

files in OUT:
  quality.md           tables of all sets that were run, beside those of an older program: read this first; printed too
  quality.json         all figures: means and worst views of each set, every view, and the configuration
  sheet.jpg            the views with the worst tiles, worst first: prediction, truth and difference (needs PIL)
  scenes/SET           the scene of a set, and in SET.json what its build took
  pictures/SET         pictures of `ibr eval`, or of `ibr render` where a set has no truth
  results/RUN/SET.json the kept result of a set, by configuration and program
  logs/SET.log         what the programs printed
  truth/SET…           faces of panoramas that are left out

examples:
  tests/quality.sh ~/datasets                                   all sets, to out/quality
  tests/quality.sh ~/datasets street path_lund_street -o /tmp/q two of them
  tests/quality.sh ~/datasets --build "--max-size 500"          with other options for all sets
  IBR=/tmp/other/ibr tests/quality.sh ~/datasets --reuse-scenes judge how another program draws the same scenes
  tests/quality.sh --small                                      what CI runs: fails where the bundled sets got worse
  tests/quality.sh --small --write                              accept its figures as the new reference

Ctrl-C keeps what is finished; the same command goes on. exit codes: 0 ok, 1 command line, 2 files, 4 a program failed,
6 worse than the reference, 130 stopped by Ctrl-C""")
    parser.add_argument("names", metavar="DATASETS [SET…]", nargs="*",
                        help="folder of the sets, and which ones; with --small only SETs")
    parser.add_argument("-o", "--output", type=pathlib.Path, metavar="OUT",
                        help="folder for scenes and results [out/quality, out/quality-small]")
    parser.add_argument("--small", action="store_true",
                        help=f"lane and relief, reduced, compared with tests/data/{SMALL_FILE.name}")
    parser.add_argument("--write", action="store_true", help="with --small: write that file instead")
    parser.add_argument("--build", default="", metavar="OPTIONS", help="more options for every ibr build")
    parser.add_argument("--eval", default="", metavar="OPTIONS", help="more options for every ibr eval")
    parser.add_argument("--again", action="store_true", help="build and judge again what is finished")
    parser.add_argument("--reuse-scenes", action="store_true",
                        help="judge scenes in OUT that another program built with the same options")
    parser.add_argument("--freeze", type=pathlib.Path, metavar="FILE",
                        help="write figures as tests/data/quality_2bdd944.json has them; sets that were not run stay")
    options = parser.parse_args(with_equals(arguments))
    if options.write and not options.small:
        parser.error("--write is of --small")
    options.datasets = None
    if not options.small:
        if not options.names:
            parser.error("DATASETS is missing: the folder of the sets")
        options.datasets = pathlib.Path(options.names.pop(0)).absolute()
        if not options.datasets.is_dir():
            raise Failure(f"{options.datasets}: is no folder")
    options.output = (options.output or ROOT / "out" / ("quality-small" if options.small else "quality")).absolute()
    return options


def run_sets(works, again):
    """Results by set; and why sets failed."""
    results, failed = {}, {}
    for work in works:
        name = work.of.name
        if not work.is_there():
            say(f"{name}: skipped, its photographs are not there")
            continue
        try:
            if again:
                work.result.unlink(missing_ok=True)
                if work.stamp.exists() and not work.reuse_scenes:
                    shutil.rmtree(work.scene, ignore_errors=True)
                    work.stamp.unlink()
            results[name] = work.finished() or work.do()
        except (Failure, OSError, KeyError) as failure:
            failed[name] = str(failure)
            say(f"{name}: {failure}")
    return results, failed


def main(arguments):
    options = parse(arguments)
    configuration, program = configuration_of(options), Program(pathlib.Path(os.environ.get("IBR", "ibr")).absolute())
    works = [Work(each, configuration, program, options) for each in chosen(configuration, options.names)]
    results, failed = run_sets(works, options.again)
    about = {"program": {"path": str(program.path), "hash": program.hash, "describe": describe()},
             "configuration": configuration.hash(), "rules": configuration.rules(), "failed": failed}
    former = read_json(SMALL_FILE if options.small else FROZEN_FILE) or {}
    if options.small and former:
        former = former_of_small(former)
    text = markdown(results, former, about)
    write_text(options.output / "quality.md", text)
    write_json(options.output / "quality.json", {**about, "sets": {
        name: {"columns": {column: {key: of[key] for key in ("mean", "worst")}
                           for column, of in summary(result).items()}, **result}
        for name, result in results.items()}})
    print(text, end="")
    drawn = {work.of.name: results[work.of.name] for work in works if work.of.name in results and work.has_pictures()}
    write_sheet(options.output / "sheet.jpg", drawn, options.output / "pictures")
    if options.freeze:
        freeze(options.freeze, results, configuration.hash())
    if failed:
        return RUN_TIME
    return judge_small(options, results, configuration.hash()) if options.small else OK


def stop(*_):
    raise KeyboardInterrupt


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, stop)
    try:
        sys.exit(main(sys.argv[1:]))
    except Failure as failure:
        say(f"tests/quality.sh: {failure}")
        sys.exit(failure.code)
    except KeyboardInterrupt:
        say("tests/quality.sh: stopped; the same command goes on")
        sys.exit(STOPPED)
