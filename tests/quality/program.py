# SPDX-License-Identifier: Apache-2.0
"""The program `ibr` as a child process: what it can do, what a run costs, and what becomes of a run that failed or was
stopped."""
import dataclasses
import hashlib
import os
import shlex
import signal
import subprocess
import time

from files import ROOT, RUN_TIME, STOPPED, Failure


@dataclasses.dataclass
class Run:
    code: int
    seconds: float
    cpu_seconds: float  # user and system, of the program and its children


class Program:
    def __init__(self, path):
        self.path = path
        if not path.is_file() or not os.access(path, os.X_OK):
            raise Failure(f"{path}: is no program; build it, or set IBR")
        self.hash = hashlib.sha256(path.read_bytes()).hexdigest()[:12]
        self.eval_help = subprocess.run([path, "eval", "--help"], capture_output=True, text=True, check=False).stdout

    def run(self, words, log):
        """Runs `ibr WORDS`, with its output in a log. It gets SIGINT once, and time to leave whole files."""
        begin = time.monotonic()
        log.parent.mkdir(parents=True, exist_ok=True)
        with open(log, "a", encoding="utf-8") as out:
            out.write("\nibr " + shlex.join(words) + "\n")
            out.flush()
            child = subprocess.Popen([self.path, *words], stdin=subprocess.DEVNULL, stdout=out, stderr=out,
                                     start_new_session=True)
            stopped = False
            while True:
                try:
                    _, status, usage = os.wait4(child.pid, 0)
                    break
                except KeyboardInterrupt:
                    stopped = True
                    child.send_signal(signal.SIGINT)
        child.returncode = os.waitstatus_to_exitcode(status)
        code = STOPPED if stopped else child.returncode
        return Run(code, time.monotonic() - begin, usage.ru_utime + usage.ru_stime)

    def eval_words(self, options):
        """The options as far as this program has them: older ones know all baselines or none, and no others."""
        if "gathered" in self.eval_help or "--baselines" not in options:
            return list(options)
        return [*without([o for o in options if o != "--guessed"], "--baselines"), "--baselines"]


def without(options, option):
    """The options without this one and its values."""
    first = options.index(option)
    last = next((i for i in range(first + 1, len(options)) if options[i].startswith("-")), len(options))
    return [*options[:first], *options[last:]]


def check_run(run, what, log):
    if run.code == STOPPED:
        raise KeyboardInterrupt
    if run.code != 0:
        lines = log.read_text(encoding="utf-8", errors="replace").strip().split("\n")
        raise Failure(f"{what} failed with exit code {run.code}: {lines[-1]} (all of it: {log})", RUN_TIME)


def describe():
    """The commit of the source tree; the program may be of another, so its hash stands beside."""
    git = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"], capture_output=True, text=True,
                         check=False)
    return "source tree " + (git.stdout.strip() or "unknown")
