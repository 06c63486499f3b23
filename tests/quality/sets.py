# SPDX-License-Identifier: Apache-2.0
"""Sets of photographs: their folders, photographs that are left out, and options of builds and evaluations. All of
these are the configuration. Figures may be compared only if the hashes of their configurations are equal."""
import dataclasses
import shlex

from files import COMMAND_LINE, Failure, digest

# Version of the rules. Increment it when a change of this file, of program.py or of work.py changes figures.
RULES_VERSION = 1
BUILD_OPTIONS = ()
SMALL_BUILD_OPTIONS = ("--max-size", "640")
EVAL_OPTIONS = ("--fit-gain", "--guessed", "--baselines", "lumigraph", "gathered")
PANORAMA_BASELINES = ("gathered",)  # the lumigraph supports pinhole cameras only
SPLIT_OPTIONS = ("--fov", "90", "--format", "png")
RENDER_OPTIONS = ("--path", "auto:9")

# Functions that select the photographs left out of a build from a set's sorted photograph names.
LEFT_OUT = {
    "none": lambda names: [],
    "every sixth from the fourth on": lambda names: names[3::6],
    "the fourth": lambda names: names[3:4],
}


@dataclasses.dataclass(frozen=True)
class Set:
    """Files of a set, and photographs that are left out. Folders are relative to DATASETS, or to examples/photographs
    for a bundled set. Field names and values are part of the configuration's hash."""
    name: str
    photographs: str
    poses: tuple  # option of `ibr build`, and its file or folder
    left_out: str = "none"
    truth: str = ""  # folder of the truth views: photographs that are left out, or other views
    depth_unit: float = 0  # metres per step of the truth's depth images; 0: depth is not evaluated
    judged: str = "views"  # "views", "faces" of the panoramas that are left out, or "pictures": images without truth
    bundled: bool = False


def photographs(name, **more):
    """Returns a set with every sixth of its own photographs as truth."""
    return Set(name, f"{name}/images", ("--model", f"{name}/sparse"), "every sixth from the fourth on", name, **more)


def bundled(name):
    return Set(name, name, ("--model", f"{name}/sparse"), "every sixth from the fourth on", name, bundled=True)


SMALL_SETS = (bundled("lane"), bundled("relief"))
SETS = (
    photographs("path_lund_street"),
    photographs("object_vespasian"),
    photographs("drone_brighton"),
    photographs("wall_nineveh_panel"),
    *SMALL_SETS,
    Set("street", "street/images", ("--model", "street/sparse"), truth="street/gt", depth_unit=0.01),
    Set("street-exposure", "street-exposure/images", ("--model", "street/sparse"), truth="street/gt"),
    Set("hall-pano", "hall-pano", ("--panoramas", "hall-pano/panoramas.json"), truth="hall-pano/gt"),
    Set("pano360_flat", "pano360_flat/images", ("--model", "pano360_flat/sparse"), "the fourth", judged="faces"),
    Set("studio", "studio/images", ("--model", "studio/sparse"), truth="studio/gt"),
    Set("outdoor_berlin_cathedral3", "outdoor_berlin_cathedral3/images",
        ("--model", "outdoor_berlin_cathedral3/sparse"), judged="pictures"),
)


@dataclasses.dataclass(frozen=True)
class Configuration:
    sets: tuple
    build: tuple
    evaluation: tuple

    def rules(self):
        return {"version": RULES_VERSION, "build": self.build, "eval": self.evaluation, "split": SPLIT_OPTIONS,
                "render": RENDER_OPTIONS, "sets": [dataclasses.asdict(each) for each in self.sets]}

    def hash(self):
        """Returns one hash for all sets, independent of the sets that are run."""
        return digest(self.rules())


def configuration_of(options):
    build = (*BUILD_OPTIONS, *(SMALL_BUILD_OPTIONS if options.small else ()), *shlex.split(options.build))
    return Configuration(SMALL_SETS if options.small else SETS, build, (*EVAL_OPTIONS, *shlex.split(options.eval)))


def selected_sets(configuration, names):
    known = [each.name for each in configuration.sets]
    for name in names:
        if name not in known:
            raise Failure(f"{name}: unknown set; choose from {', '.join(known)}", COMMAND_LINE)
    return [each for each in configuration.sets if not names or each.name in names]
