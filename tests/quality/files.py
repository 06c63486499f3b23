# SPDX-License-Identifier: Apache-2.0
"""Helpers for all modules: path of the source tree, exit codes, messages, and reading and writing of small files."""
import hashlib
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PICTURE_SUFFIXES = (".jpg", ".jpeg", ".png")
OK, COMMAND_LINE, FILES, RUN_TIME, UNSUPPORTED, COMPARISON, STOPPED = 0, 1, 2, 4, 5, 6, 130


class Failure(Exception):
    """Error that ends the script, or the run of one set; `code` is the exit code."""

    def __init__(self, text, code=FILES):
        super().__init__(text)
        self.code = code


def say(text):
    print(text, file=sys.stderr, flush=True)


def read_json(file):
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise Failure(f"{file}: {error}; remove it, or run with --again") from error


def write_text(file, text):
    """Replaces the file atomically, so that a stopped run leaves no partial file."""
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(file.name + ".part")
    part.write_text(text, encoding="utf-8")
    part.replace(file)


def write_json(file, value):
    write_text(file, json.dumps(value, indent=1, ensure_ascii=False) + "\n")


def digest(value):
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:12]


def names_in(folder):
    """Returns the sorted names of the photographs in a folder."""
    return sorted(f.name for f in folder.iterdir() if f.suffix.lower() in PICTURE_SUFFIXES)


def model_names(model):
    """Returns the image names of a COLMAP text model. Every second line that is not a comment has an image name."""
    lines = [line for line in (model / "images.txt").read_text().split("\n") if not line.startswith("#")]
    return [line.split(maxsplit=9)[9] for line in lines[::2] if line.strip()]
