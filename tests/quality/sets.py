# SPDX-License-Identifier: Apache-2.0
"""The sets of photographs: where they are, which photographs are left out, and the options that all of them are built
and judged with. The configuration is all of this, and its hash says which figures may be compared."""
import dataclasses
import shlex

from files import COMMAND_LINE, Failure, digest

# Version of the rules. Raise it where a change of this file, of program.py or of work.py changes figures.
RULES_VERSION = 1
BUILD_OPTIONS = ()
SMALL_BUILD_OPTIONS = ("--max-size", "640")
EVAL_OPTIONS = ("--fit-gain", "--guessed", "--baselines", "lumigraph", "gathered")
PANORAMA_BASELINES = ("gathered",)  # the lumigraph is of pinholes alone
SPLIT_OPTIONS = ("--fov", "90", "--format", "png")
RENDER_OPTIONS = ("--path", "auto:9")

# Names that are left out of a build, from the sorted names of a set's photographs.
LEFT_OUT = {
    "none": lambda names: [],
    "every sixth from the fourth on": lambda names: names[3::6],
    "the fourth": lambda names: names[3:4],
}


@dataclasses.dataclass(frozen=True)
class Set:
    """Where the files of a set are, and which photographs are left out. Folders are below DATASETS; those of a bundled
    set below examples/photographs."""
    name: str
    photographs: str
    poses: tuple  # option of `ibr build`, and its file or folder
    left_out: str = "none"
    truth: str = ""  # folder of the truth views: of those left out, or of others
    depth_unit: float = 0  # metres a step of the truth's depth pictures; 0: their depth is not judged
    judged: str = "views"  # "views", "faces" of the panoramas that are left out, or "pictures" alone, without truth
    bundled: bool = False


def photographs(name, **more):
    """A set whose truth is every sixth of its own photographs."""
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
        """One for the whole table, whichever sets are run."""
        return digest(self.rules())


def configuration_of(options):
    build = (*BUILD_OPTIONS, *(SMALL_BUILD_OPTIONS if options.small else ()), *shlex.split(options.build))
    return Configuration(SMALL_SETS if options.small else SETS, build, (*EVAL_OPTIONS, *shlex.split(options.eval)))


def chosen(configuration, names):
    known = [each.name for each in configuration.sets]
    for name in names:
        if name not in known:
            raise Failure(f"{name}: is no set; there are {', '.join(known)}", COMMAND_LINE)
    return [each for each in configuration.sets if not names or each.name in names]
