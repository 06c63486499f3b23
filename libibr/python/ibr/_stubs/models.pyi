# SPDX-License-Identifier: Apache-2.0
# Harmonised models, the optimiser, and metrics.
import pathlib
from collections.abc import Iterator
from typing import ClassVar, Final, overload

import numpy as np
import numpy.typing as npt

from ibr._stubs.enums import AlignmentMethod, EccDefinition, HtmDirection, HtmMethod
from ibr._stubs.scene import Camera, _Float32s, _Float64s

class HtmCamera:
    __match_args__: ClassVar[tuple[str, ...]]
    name: Final[str]
    camera: Final[Camera]
    image_file: Final[pathlib.Path | None]
    visibility_file: Final[pathlib.Path | None]
    given: Final[Camera | None]

class HtmCameraSequence:
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[HtmCamera]: ...
    @overload
    def __getitem__(self, index: int) -> HtmCamera: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[HtmCamera, ...]: ...

class TriangleMesh:
    positions: Final[_Float64s]
    triangles: Final[npt.NDArray[np.uint32]]

class HtmModel:
    folder: Final[pathlib.Path | None]
    cameras: Final[HtmCameraSequence]
    mesh: Final[TriangleMesh]
    members: Final[npt.NDArray[np.uint64]]
    complements: Final[_Float32s | None]
    source_mesh: Final[TriangleMesh | None]
    settings: Final[str]

class HtmSequenceIndex:
    __match_args__: ClassVar[tuple[str, ...]]
    fps: Final[float]
    frames: Final[tuple[pathlib.Path, ...]]

class HtmSettings:
    __match_args__: ClassVar[tuple[str, ...]]
    gamma: Final[float]
    method: Final[HtmMethod]
    direction: Final[HtmDirection]
    weight_cut: Final[float]
    depth_tolerance: Final[float]
    smoothing_seconds: Final[float]
    exclude: Final[int]
    background: Final[_Float32s]
    def __init__(
        self, gamma: float = ..., method: HtmMethod = ..., direction: HtmDirection = ..., weight_cut: float = ...,
        depth_tolerance: float = ..., smoothing_seconds: float = ..., exclude: int = ...,
        background: npt.ArrayLike = ...
    ) -> None: ...
    def replace(
        self, *, gamma: float = ..., method: HtmMethod = ..., direction: HtmDirection = ..., weight_cut: float = ...,
        depth_tolerance: float = ..., smoothing_seconds: float = ..., exclude: int = ...,
        background: npt.ArrayLike = ...
    ) -> HtmSettings: ...

class PlannedHtmCamera:
    __match_args__: ClassVar[tuple[str, ...]]
    camera: Final[int]
    log_weight: Final[float]
    log_remaining_weight: Final[float]

class HtmFramePlan:
    view: Final[Camera]
    settings: Final[HtmSettings]
    cameras: Final[tuple[PlannedHtmCamera, ...]]

class AlignmentOptions:
    __match_args__: ClassVar[tuple[str, ...]]
    method: Final[AlignmentMethod]
    definition: Final[EccDefinition]
    instances: Final[int]
    radius_px: Final[float]
    decay: Final[float]
    threshold: Final[float]
    max_cycles: Final[int]
    variance_floor: Final[float]
    rigidity: Final[float]
    prune: Final[bool]
    scaled_instances: Final[bool]
    levels: Final[int]
    escape: Final[int]
    epipolar_weight: Final[float]
    flip_edges: Final[bool]
    flip_gain: Final[float]
    insert_points: Final[bool]
    insert_below: Final[float]
    insert_gain: Final[float]
    insert_share: Final[float]
    seed: Final[int]
    threads: Final[int]
    def __init__(
        self, method: AlignmentMethod = ..., definition: EccDefinition = ..., instances: int = ...,
        radius_px: float = ..., decay: float = ..., threshold: float = ..., max_cycles: int = ...,
        variance_floor: float = ..., rigidity: float = ..., prune: bool = ..., scaled_instances: bool = ...,
        levels: int = ..., escape: int = ..., epipolar_weight: float = ..., flip_edges: bool = ...,
        flip_gain: float = ..., insert_points: bool = ..., insert_below: float = ..., insert_gain: float = ...,
        insert_share: float = ..., seed: int = ..., threads: int = ...
    ) -> None: ...
    def replace(
        self, *, method: AlignmentMethod = ..., definition: EccDefinition = ..., instances: int = ...,
        radius_px: float = ..., decay: float = ..., threshold: float = ..., max_cycles: int = ...,
        variance_floor: float = ..., rigidity: float = ..., prune: bool = ..., scaled_instances: bool = ...,
        levels: int = ..., escape: int = ..., epipolar_weight: float = ..., flip_edges: bool = ...,
        flip_gain: float = ..., insert_points: bool = ..., insert_below: float = ..., insert_gain: float = ...,
        insert_share: float = ..., seed: int = ..., threads: int = ...
    ) -> AlignmentOptions: ...

class AlignmentCycle:
    __match_args__: ClassVar[tuple[str, ...]]
    radius_px: Final[float]
    ecc: Final[float]
    mutations: Final[int]
    pixels: Final[int]
    moved: Final[int]
    refused: Final[int]
    seconds: Final[float]
    flipped: Final[int]
    inserted: Final[int]

class AlignmentSummary:
    __match_args__: ClassVar[tuple[str, ...]]
    initial_ecc: Final[float]
    final_ecc: Final[float]
    initial_ecc_paper: Final[float]
    final_ecc_paper: Final[float]
    initial_star_ecc: Final[_Float32s]
    final_star_ecc: Final[_Float32s]
    cycles: Final[tuple[AlignmentCycle, ...]]
    best_cycle: Final[int]
    flips: Final[int]
    insertions: Final[int]
    seconds: Final[float]

class AlignedMesh:
    positions: Final[tuple[npt.NDArray[np.int32], ...]]
    triangles: Final[npt.NDArray[np.uint32]]
    summary: Final[AlignmentSummary]

class Detail:
    __match_args__: ClassVar[tuple[str, ...]]
    energy: Final[float]
    correlation: Final[float]

class WorstTile:
    __match_args__: ClassVar[tuple[str, ...]]
    x: Final[int]
    y: Final[int]
    mean_squared: Final[float]

class Difference:
    __match_args__: ClassVar[tuple[str, ...]]
    largest: Final[int]
    mean_absolute: Final[float]
    share_above: Final[float]

class ViewScores:
    __match_args__: ClassVar[tuple[str, ...]]
    psnr: Final[float]
    ssim: Final[float]
    flip: Final[float]
    coverage: Final[float]
    coverage_tier0: Final[float]
    coverage_tier2: Final[float]
    psnr_covered: Final[float]
    ssim_covered: Final[float]
    psnr_gain: Final[float]
    psnr_covered_gain: Final[float]
    ms_ssim: Final[float]
    detail_energy: Final[float]
    detail_correlation: Final[float]
    torn_tiles: Final[float]
    worst_tile: Final[WorstTile]
