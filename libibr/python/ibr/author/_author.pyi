# SPDX-License-Identifier: Apache-2.0
# The author of libibr. Types of reports are in ibr.author._stubs.
import pathlib
from collections.abc import Callable, Sequence
from typing import ClassVar, Final

from ibr import AlignmentOptions, Camera, TextureFormat
from ibr._stubs.scene import _Bytes, _Float64s, _StrPath
from ibr.author._stubs import *

# Stage, done, total (0: unknown). False cancels.
_Progress = Callable[[str, int, int], bool | None]

class PosedImage:
    __match_args__: ClassVar[tuple[str, ...]]
    name: Final[str]
    camera: Final[Camera]
    def __init__(self, name: str = ..., camera: Camera = ...) -> None: ...
    def replace(self, *, name: str = ..., camera: Camera = ...) -> PosedImage: ...
    distorted: Final[bool]

class PosedModel:
    images: Final[tuple[PosedImage, ...]]
    track_positions: Final[_Float64s]
    def __init__(self, images: Sequence[PosedImage]) -> None: ...

class PosedPhotographs:
    images: Final[tuple[PosedImage, ...]]
    def __init__(self, options: BuildOptions) -> None: ...
    def photograph(self, image: int) -> _Bytes: ...
    def mask(self, image: int) -> _Bytes | None: ...

class BuildOptions:
    __match_args__: ClassVar[tuple[str, ...]]
    photographs: Final[pathlib.Path | None]
    output: Final[pathlib.Path | None]
    model: Final[pathlib.Path | None]
    colmap: Final[str]
    exclude: Final[tuple[str, ...]]
    skip_missing: Final[bool]
    orientation: Final[Orientation]
    tracks: Final[TrackSource]
    masks: Final[pathlib.Path | None]
    match_exposures: Final[bool]
    fit_vignetting: Final[bool]
    refine_poses: Final[RefinePoses]
    mask_moving_objects: Final[bool]
    strip_metadata: Final[bool]
    keep_border: Final[bool]
    dimension: Final[int]
    max_size: Final[int]
    texture: Final[TextureFormat]
    theta_degrees: Final[float]
    backdrops: Final[bool]
    depth: Final[DepthSearch]
    draft: Final[bool]
    backdrop_spacing: Final[int]
    cache_folder: Final[pathlib.Path | None]
    matcher: Final[MatchMethod]
    triangle_filter: Final[TriangleFilter]
    threads: Final[int]
    memory: Final[float]
    seed: Final[int]
    def __init__(
        self, photographs: _StrPath | None = ..., output: _StrPath | None = ..., model: _StrPath | None = ...,
        colmap: str = ...,
        exclude: Sequence[str] = ..., skip_missing: bool = ..., orientation: Orientation = ..., tracks: TrackSource = ...,
        masks: _StrPath | None = ..., match_exposures: bool = ..., fit_vignetting: bool = ..., refine_poses: RefinePoses = ...,
        mask_moving_objects: bool = ..., strip_metadata: bool = ..., keep_border: bool = ..., dimension: int = ..., max_size: int = ...,
        texture: TextureFormat = ..., theta_degrees: float = ..., backdrops: bool = ..., depth: DepthSearch = ...,
        draft: bool = ..., backdrop_spacing: int = ..., cache_folder: _StrPath | None = ..., matcher: MatchMethod = ...,
        triangle_filter: TriangleFilter = ..., threads: int = ..., memory: float = ..., seed: int = ...
    ) -> None: ...
    def replace(
        self, *, photographs: _StrPath | None = ..., output: _StrPath | None = ..., model: _StrPath | None = ...,
        colmap: str = ...,
        exclude: Sequence[str] = ..., skip_missing: bool = ..., orientation: Orientation = ..., tracks: TrackSource = ...,
        masks: _StrPath | None = ..., match_exposures: bool = ..., fit_vignetting: bool = ..., refine_poses: RefinePoses = ...,
        mask_moving_objects: bool = ..., strip_metadata: bool = ..., keep_border: bool = ..., dimension: int = ..., max_size: int = ...,
        texture: TextureFormat = ..., theta_degrees: float = ..., backdrops: bool = ..., depth: DepthSearch = ...,
        draft: bool = ..., backdrop_spacing: int = ..., cache_folder: _StrPath | None = ..., matcher: MatchMethod = ...,
        triangle_filter: TriangleFilter = ..., threads: int = ..., memory: float = ..., seed: int = ...
    ) -> BuildOptions: ...

class RefinedModel:
    __match_args__: ClassVar[tuple[str, ...]]
    model: Final[PosedModel]
    refinement: Final[PoseRefinement]

class HtmOptions:
    __match_args__: ClassVar[tuple[str, ...]]
    faces: Final[int]
    inconsistent_size: Final[float]
    inconsistent_difference: Final[float]
    inconsistent_share: Final[float]
    adjust_rounds: Final[int]
    adjust_smoothness: Final[float]
    reshape: Final[bool]
    shape_smoothness: Final[float]
    measure: Final[TemplateMeasure]
    radius: Final[float]
    later_radius: Final[float]
    min_texture: Final[float]
    smoothness: Final[float]
    complement_px: Final[float]
    outlier_px: Final[float]
    alpha: Final[float]
    gamma1: Final[float]
    rounds: Final[int]
    mean_difference: Final[float]
    face_difference: Final[float]
    self_occluded: Final[bool]
    min_face_px: Final[float]
    max_faces: Final[int]
    reject: Final[bool]
    reject_difference: Final[float]
    reject_correlation: Final[float]
    soft_px: Final[float]
    keep_source: Final[bool]
    threads: Final[int]
    def __init__(
        self, faces: int = ..., inconsistent_size: float = ..., inconsistent_difference: float = ...,
        inconsistent_share: float = ..., adjust_rounds: int = ..., adjust_smoothness: float = ..., reshape: bool = ...,
        shape_smoothness: float = ..., measure: TemplateMeasure = ..., radius: float = ..., later_radius: float = ...,
        min_texture: float = ..., smoothness: float = ..., complement_px: float = ..., outlier_px: float = ...,
        alpha: float = ..., gamma1: float = ..., rounds: int = ..., mean_difference: float = ...,
        face_difference: float = ..., self_occluded: bool = ..., min_face_px: float = ..., max_faces: int = ...,
        reject: bool = ..., reject_difference: float = ..., reject_correlation: float = ..., soft_px: float = ...,
        keep_source: bool = ..., threads: int = ...
    ) -> None: ...
    def replace(
        self, *, faces: int = ..., inconsistent_size: float = ..., inconsistent_difference: float = ...,
        inconsistent_share: float = ..., adjust_rounds: int = ..., adjust_smoothness: float = ..., reshape: bool = ...,
        shape_smoothness: float = ..., measure: TemplateMeasure = ..., radius: float = ..., later_radius: float = ...,
        min_texture: float = ..., smoothness: float = ..., complement_px: float = ..., outlier_px: float = ...,
        alpha: float = ..., gamma1: float = ..., rounds: int = ..., mean_difference: float = ...,
        face_difference: float = ..., self_occluded: bool = ..., min_face_px: float = ..., max_faces: int = ...,
        reject: bool = ..., reject_difference: float = ..., reject_correlation: float = ..., soft_px: float = ...,
        keep_source: bool = ..., threads: int = ...
    ) -> HtmOptions: ...

class HtmBuildOptions:
    __match_args__: ClassVar[tuple[str, ...]]
    mesh: Final[pathlib.Path | None]
    model: Final[pathlib.Path | None]
    images: Final[pathlib.Path | None]
    output: Final[pathlib.Path | None]
    masks: Final[pathlib.Path | None]
    exclude: Final[tuple[str, ...]]
    max_size: Final[int]
    optimise: Final[HtmOptions]
    def __init__(
        self, mesh: _StrPath | None = ..., model: _StrPath | None = ..., images: _StrPath | None = ...,
        output: _StrPath | None = ..., masks: _StrPath | None = ..., exclude: Sequence[str] = ..., max_size: int = ...,
        optimise: HtmOptions = ...
    ) -> None: ...
    def replace(
        self, *, mesh: _StrPath | None = ..., model: _StrPath | None = ..., images: _StrPath | None = ...,
        output: _StrPath | None = ..., masks: _StrPath | None = ..., exclude: Sequence[str] = ..., max_size: int = ...,
        optimise: HtmOptions = ...
    ) -> HtmBuildOptions: ...

class SplitOptions:
    __match_args__: ClassVar[tuple[str, ...]]
    input: Final[pathlib.Path | None]
    model: Final[pathlib.Path | None]
    output: Final[pathlib.Path | None]
    views: Final[int]
    poles: Final[bool]
    fov_degrees: Final[float]
    size: Final[int]
    format: Final[ImageFileFormat]
    threads: Final[int]
    def __init__(
        self, input: _StrPath | None = ..., model: _StrPath | None = ...,
        output: _StrPath | None = ..., views: int = ..., poles: bool = ..., fov_degrees: float = ..., size: int = ...,
        format: ImageFileFormat = ..., threads: int = ...
    ) -> None: ...
    def replace(
        self, *, input: _StrPath | None = ..., model: _StrPath | None = ...,
        output: _StrPath | None = ..., views: int = ..., poles: bool = ..., fov_degrees: float = ..., size: int = ...,
        format: ImageFileFormat = ..., threads: int = ...
    ) -> SplitOptions: ...

def build(
    options: BuildOptions, *, progress: _Progress | None = ...,
    on_prediction: Callable[[BuildPrediction], bool | None] | None = ...
) -> BuildReport: ...
def refine_model_poses(options: BuildOptions, *, progress: _Progress | None = ...) -> RefinedModel: ...
def read_poses(options: BuildOptions) -> PosedModel: ...
def read_pose_file(path: _StrPath, photographs: _StrPath | None = ...) -> PosedModel: ...
def read_colmap_model(folder: _StrPath) -> PosedModel: ...
def read_transforms(file: _StrPath, photographs: _StrPath | None = ...) -> PosedModel: ...
def read_panoramas(file: _StrPath) -> PosedModel: ...
def write_colmap_model(model: PosedModel, folder: _StrPath) -> None: ...
def optimise_scene(
    scene: _StrPath, output: _StrPath, alignment: AlignmentOptions = ..., *, cells: Sequence[int] = ...,
    threads: int = ..., device: str = ..., progress: _Progress | None = ...
) -> OptimiseSceneReport: ...
def build_htm(options: HtmBuildOptions, *, progress: _Progress | None = ...) -> HtmReport: ...
def split_panoramas(options: SplitOptions, *, progress: _Progress | None = ...) -> SplitReport: ...
def scan_photograph_folder(folder: _StrPath) -> PhotographFolder: ...
def read_picture(file: _StrPath) -> _Bytes: ...
