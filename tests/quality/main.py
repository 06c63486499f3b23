#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares rendered views of scenes with photographs that were left out of the scenes. Each set takes one `ibr build`
and one `ibr eval`. All sets share the same options; a set defines only its files and the photographs to leave out. The
folder OUT gets tables (quality.md), all figures (quality.json) and a contact sheet of the worst views (sheet.jpg). The
folders scenes, pictures, results and logs in OUT contain the files of each set. Cached results are reused.
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
from reference import FROZEN_FILE, SMALL_FILE, freeze, judge_small, previous_of_small
from sets import SETS, configuration_of, selected_sets
from sheet import write_sheet
from work import Work


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Failure(f"{message} (--help lists the options)", COMMAND_LINE)


def with_equals(arguments):
    """Joins --build "--seams" to --build=--seams, because argparse takes values that begin with - for options."""
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
  quality.md           tables of all sets that were run, with the values of an older program; also printed
  quality.json         all figures: means and worst views of each set, every view, and the configuration
  sheet.jpg            the views with the worst tiles, worst first: prediction, truth and difference (needs PIL)
  scenes/SET           scene of a set; SET.json has the cost of its build
  pictures/SET         images of `ibr eval`, or of `ibr render` if a set has no truth
  results/RUN/SET.json cached result of a set, by configuration and program
  logs/SET.log         output of the programs
  truth/SET…           cube faces of panoramas that are left out

examples:
  tests/quality.sh ~/datasets                                   all sets, to out/quality
  tests/quality.sh ~/datasets street path_lund_street -o /tmp/q two sets
  tests/quality.sh ~/datasets --build "--max-size 500"          other options for all sets
  IBR=/tmp/other/ibr tests/quality.sh ~/datasets --reuse-scenes the same scenes, rendered by another program
  tests/quality.sh --small                                      run by CI: fails if the bundled sets are worse
  tests/quality.sh --small --write                              accept the figures as the new reference

Ctrl-C leaves cached results intact; the same command resumes the run. exit codes: 0 ok, 1 command line, 2 files,
4 a program failed, 6 worse than the reference, 130 stopped by Ctrl-C""")
    parser.add_argument("names", metavar="DATASETS [SET…]", nargs="*",
                        help="folder of the sets, and names of sets to run [all]; with --small only SETs")
    parser.add_argument("-o", "--output", type=pathlib.Path, metavar="OUT",
                        help="folder for scenes and results [out/quality, out/quality-small]")
    parser.add_argument("--small", action="store_true",
                        help=f"lane and relief, reduced, compared with tests/data/{SMALL_FILE.name}")
    parser.add_argument("--write", action="store_true", help="with --small: write this file instead of comparing")
    parser.add_argument("--build", default="", metavar="OPTIONS", help="more options for every ibr build")
    parser.add_argument("--eval", default="", metavar="OPTIONS", help="more options for every ibr eval")
    parser.add_argument("--again", action="store_true",
                        help="build and evaluate again, without cached scenes and results")
    parser.add_argument("--reuse-scenes", action="store_true",
                        help="evaluate scenes in OUT that another program built with the same options")
    parser.add_argument("--freeze", type=pathlib.Path, metavar="FILE",
                        help="write figures in the format of tests/data/quality_2bdd944.json; sets that were not run "
                        "are not changed")
    options = parser.parse_args(with_equals(arguments))
    if options.write and not options.small:
        parser.error("--write needs --small")
    options.datasets = None
    if not options.small:
        if not options.names:
            parser.error("DATASETS is missing: the folder of the sets")
        options.datasets = pathlib.Path(options.names.pop(0)).absolute()
        if not options.datasets.is_dir():
            raise Failure(f"{options.datasets}: is not a folder")
    options.output = (options.output or ROOT / "out" / ("quality-small" if options.small else "quality")).absolute()
    return options


def run_sets(works, again):
    """Returns results by set, and messages of failed sets by set."""
    results, failed = {}, {}
    for work in works:
        name = work.photo_set.name
        if not work.has_photographs():
            say(f"{name}: skipped, its photographs are missing")
            continue
        try:
            if again:
                work.result.unlink(missing_ok=True)
                if work.stamp.exists() and not work.reuse_scenes:
                    shutil.rmtree(work.scene, ignore_errors=True)
                    work.stamp.unlink()
            results[name] = work.cached_result() or work.run()
        except (Failure, OSError, KeyError) as failure:
            failed[name] = str(failure)
            say(f"{name}: {failure}")
    return results, failed


def main(arguments):
    options = parse(arguments)
    configuration, program = configuration_of(options), Program(pathlib.Path(os.environ.get("IBR", "ibr")).absolute())
    works = [Work(each, configuration, program, options) for each in selected_sets(configuration, options.names)]
    results, failed = run_sets(works, options.again)
    about = {"program": {"path": str(program.path), "hash": program.hash, "describe": describe()},
             "configuration": configuration.hash(), "rules": configuration.rules(), "failed": failed}
    previous = read_json(SMALL_FILE if options.small else FROZEN_FILE) or {}
    if options.small and previous:
        previous = previous_of_small(previous)
    text = markdown(results, previous, about)
    write_text(options.output / "quality.md", text)
    write_json(options.output / "quality.json", {**about, "sets": {
        name: {"columns": {column: {key: figures[key] for key in ("mean", "worst")}
                           for column, figures in summary(result).items()}, **result}
        for name, result in results.items()}})
    print(text, end="")
    rendered = {work.photo_set.name: results[work.photo_set.name] for work in works
                if work.photo_set.name in results and work.has_pictures()}
    write_sheet(options.output / "sheet.jpg", rendered, options.output / "pictures")
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
        say("tests/quality.sh: stopped; the same command resumes the run")
        sys.exit(STOPPED)
