# SPDX-License-Identifier: Apache-2.0
"""The program `ibr` as a child process: its supported options, cost of a run, and handling of failed or stopped
runs."""
import dataclasses
import hashlib
import os
import shlex
import shutil
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
            raise Failure(f"{path}: is not an executable; build it, or set IBR")
        self.hash = hashlib.sha256(path.read_bytes()).hexdigest()[:12]
        self.eval_help = subprocess.run([path, "eval", "--help"], capture_output=True, text=True, check=False).stdout

    def run(self, words, log):
        """Runs `ibr WORDS` and appends its output to a log. On Ctrl-C, the program gets SIGINT and can finish its
        files."""
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
        """Returns the options that this program supports. Older programs compute all baselines or none, and lack
        --guessed."""
        if "gathered" in self.eval_help or "--baselines" not in options:
            return list(options)
        return [*without([o for o in options if o != "--guessed"], "--baselines"), "--baselines"]


def without(options, option):
    """Returns the options without `option` and its values."""
    first = options.index(option)
    last = next((i for i in range(first + 1, len(options)) if options[i].startswith("-")), len(options))
    return [*options[:first], *options[last:]]


def check_run(run, what, log):
    if run.code == STOPPED:
        raise KeyboardInterrupt
    if run.code != 0:
        lines = log.read_text(encoding="utf-8", errors="replace").strip().split("\n")
        raise Failure(f"{what} failed with exit code {run.code}: {lines[-1]} (full log: {log})", RUN_TIME)


def describe():
    """Returns the commit of the source tree. The program may be from another commit, so pages also show its hash."""
    if not shutil.which("git"):
        return "source tree unknown"
    git = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"], capture_output=True, text=True,
                         check=False)
    return "source tree " + (git.stdout.strip() or "unknown")
