# SPDX-License-Identifier: Apache-2.0
# Enumerations and reports of ibr.author._author. There is no such module at run time.
import enum
import pathlib
from typing import ClassVar, Final

from ibr import AlignmentSummary, CellQuality, UnusedPhotograph

class TrackSource(enum.Enum):
    AUTOMATIC = 0
    MODEL = 1
    OWN = 2

class RefinePoses(enum.Enum):
    AUTOMATIC = 0
    ON = 1
    OFF = 2

class MatchMethod(enum.Enum):
    AUTOMATIC = 0
    SWEEP = 1
    HOMOGRAPHIC = 2
    FLOW = 3

class DepthSearch(enum.Enum):
    FAST = 0
    SWEPT = 1
    REFINED = 2
    FINE = 3

class TriangleFilter(enum.Enum):
    CONSISTENCY = 0
    HOMOGENEOUS = 1

class Orientation(enum.Enum):
    AUTOMATIC = 0
    STORED = 1
    EXIF = 2

class ImageFileFormat(enum.Enum):
    AS_SOURCE = 0
    JPEG = 1
    PNG = 2

class TemplateMeasure(enum.Enum):
    ABSOLUTE_DIFFERENCES = 0
    CORRELATION = 1

class ReprojectionErrors:
    __match_args__: ClassVar[tuple[str, ...]]
    median_px: Final[float]
    p90_px: Final[float]

class PoseChange:
    __match_args__: ClassVar[tuple[str, ...]]
    photograph: Final[str]
    rotation_px: Final[float]
    shift: Final[float]
    focal_factor: Final[float]

class RefinementStep:
    __match_args__: ClassVar[tuple[str, ...]]
    description: Final[str]
    cells_gain_sigmas: Final[float]
    model_gain_sigmas: Final[float]
    accepted: Final[bool]

class PoseRefinement:
    __match_args__: ClassVar[tuple[str, ...]]
    cell_tracks: Final[int]
    model_tracks: Final[int]
    steps: Final[tuple[RefinementStep, ...]]
    initial_errors: Final[ReprojectionErrors]
    final_errors: Final[ReprojectionErrors]
    pose_changes: Final[tuple[PoseChange, ...]]

class BuildStage:
    __match_args__: ClassVar[tuple[str, ...]]
    name: Final[str]
    seconds: Final[float]
    cpu_seconds: Final[float]

class BuildPrediction:
    __match_args__: ClassVar[tuple[str, ...]]
    photographs: Final[int]
    cells: Final[int]
    backdrops: Final[int]
    poses_known: Final[bool]
    cell_count_known: Final[bool]
    megapixels: Final[float]
    threads: Final[int]
    stages: Final[tuple[BuildStage, ...]]
    seconds: Final[float]
    cpu_seconds: Final[float]
    memory: Final[float]
    memory_limit_bytes: Final[float]
    disk: Final[float]
    disk_free_bytes: Final[float]

class CellReport:
    __match_args__: ClassVar[tuple[str, ...]]
    members: Final[tuple[str, ...]]
    points: Final[int]
    triangles: Final[int]
    tier0: Final[int]
    quality: Final[CellQuality]
    seconds: Final[float]
    cpu_seconds: Final[float]
    cached: Final[bool]
    matcher: Final[MatchMethod]
    homogeneous: Final[float]

class BackdropReport:
    __match_args__: ClassVar[tuple[str, ...]]
    photograph: Final[str]
    points: Final[int]
    triangles: Final[int]
    matched_share: Final[float]
    seconds: Final[float]
    cached: Final[bool]

class RejectedCell:
    __match_args__: ClassVar[tuple[str, ...]]
    cell: Final[str]
    reason: Final[str]

class MaskReport:
    __match_args__: ClassVar[tuple[str, ...]]
    photograph: Final[str]
    given_share: Final[float]
    moving_share: Final[float]

class ExposureSummary:
    __match_args__: ClassVar[tuple[str, ...]]
    measured: Final[int]
    parts: Final[int]
    alike: Final[bool]
    text: Final[str]
    vignetting: Final[str]

class BuildReport:
    __match_args__: ClassVar[tuple[str, ...]]
    poses: Final[pathlib.Path | None]
    exposures: Final[ExposureSummary]
    refinement: Final[PoseRefinement]
    masks: Final[tuple[MaskReport, ...]]
    cells: Final[tuple[CellReport, ...]]
    backdrops: Final[tuple[BackdropReport, ...]]
    dropped: Final[tuple[RejectedCell, ...]]
    unused_photographs: Final[tuple[UnusedPhotograph, ...]]
    prediction: Final[BuildPrediction]
    seconds: Final[float]
    cpu_seconds: Final[float]
    memory: Final[float]

class HtmStage:
    __match_args__: ClassVar[tuple[str, ...]]
    name: Final[str]
    seconds: Final[float]

class HtmRound:
    __match_args__: ClassVar[tuple[str, ...]]
    vertices: Final[int]
    faces: Final[int]
    unharmonised_difference: Final[float]
    harmonised_difference: Final[float]
    matched_share: Final[float]
    divided: Final[int]
    divided_as_hidden: Final[int]

class HtmAdjustment:
    __match_args__: ClassVar[tuple[str, ...]]
    before_px: Final[float]
    after_px: Final[float]
    mean_displacement: Final[float]

class HtmReport:
    __match_args__: ClassVar[tuple[str, ...]]
    stages: Final[tuple[HtmStage, ...]]
    adjustments: Final[tuple[HtmAdjustment, ...]]
    source_faces: Final[int]
    reduced_faces: Final[int]
    collapses: Final[int]
    rounds: Final[tuple[HtmRound, ...]]
    cameras_per_vertex: Final[float]
    rejected: Final[float]
    complement_bytes: Final[int]

class OptimisedCell:
    __match_args__: ClassVar[tuple[str, ...]]
    cell: Final[int]
    members: Final[tuple[str, ...]]
    width: Final[int]
    height: Final[int]
    points: Final[int]
    evaluated: Final[int]
    fixed: Final[int]
    moved: Final[int]
    flipped: Final[int]
    inserted: Final[int]
    reverted: Final[int]
    summary: Final[AlignmentSummary]
    seconds: Final[float]
    cached: Final[bool]

class OptimiseSceneReport:
    __match_args__: ClassVar[tuple[str, ...]]
    cells: Final[tuple[OptimisedCell, ...]]
    seconds: Final[float]

class SplitReport:
    __match_args__: ClassVar[tuple[str, ...]]
    panoramas: Final[int]
    pictures: Final[int]
    observations: Final[int]
    skipped: Final[tuple[str, ...]]
    size: Final[int]
    seconds: Final[float]

class UnreadableFile:
    __match_args__: ClassVar[tuple[str, ...]]
    name: Final[str]
    reason: Final[str]

class PhotographFolder:
    __match_args__: ClassVar[tuple[str, ...]]
    pictures: Final[tuple[str, ...]]
    unreadable: Final[tuple[UnreadableFile, ...]]
    videos: Final[tuple[str, ...]]
    doubles: Final[int]
    others: Final[int]
