# SPDX-License-Identifier: Apache-2.0
# Cameras, scenes and advice.
import os
import pathlib
from collections.abc import Iterator, Sequence
from typing import ClassVar, Final, overload

import numpy as np
import numpy.typing as npt

from ibr._stubs.enums import AdviceKind, CameraModel, Severity

_StrPath = str | os.PathLike[str]
_Bytes = npt.NDArray[np.uint8]
_Float32s = npt.NDArray[np.float32]
_Float64s = npt.NDArray[np.float64]

class Intrinsics:
    __match_args__: ClassVar[tuple[str, ...]]
    model: Final[CameraModel]
    width: Final[int]
    height: Final[int]
    fx: Final[float]
    fy: Final[float]
    cx: Final[float]
    cy: Final[float]
    def __init__(
        self, model: CameraModel = ..., width: int = ..., height: int = ..., fx: float = ..., fy: float = ...,
        cx: float = ..., cy: float = ...
    ) -> None: ...
    def replace(
        self, *, model: CameraModel = ..., width: int = ..., height: int = ..., fx: float = ..., fy: float = ...,
        cx: float = ..., cy: float = ...
    ) -> Intrinsics: ...
    @staticmethod
    def from_fov(width: int, height: int, fov_y: float) -> Intrinsics: ...
    @staticmethod
    def from_tangents(
        width: int, height: int, left: float, right: float, up: float, down: float
    ) -> Intrinsics: ...
    def resized(self, width: int, height: int) -> Intrinsics: ...
    def unproject(self, pixels: npt.ArrayLike) -> _Float64s: ...
    def project(self, directions: npt.ArrayLike) -> _Float64s: ...

class Pose:
    __match_args__: ClassVar[tuple[str, ...]]
    position: Final[_Float64s]
    rotation: Final[_Float64s]
    def __init__(self, position: npt.ArrayLike = ..., rotation: npt.ArrayLike = ...) -> None: ...
    def replace(self, *, position: npt.ArrayLike = ..., rotation: npt.ArrayLike = ...) -> Pose: ...
    @property
    def matrix(self) -> _Float64s: ...
    @property
    def axis(self) -> _Float64s: ...
    @staticmethod
    def from_matrix(matrix: npt.ArrayLike) -> Pose: ...

class Camera:
    __match_args__: ClassVar[tuple[str, ...]]
    intrinsics: Final[Intrinsics]
    pose: Final[Pose]
    def __init__(self, intrinsics: Intrinsics = ..., pose: Pose = ...) -> None: ...
    def replace(self, *, intrinsics: Intrinsics = ..., pose: Pose = ...) -> Camera: ...

class MorphMesh:
    match: Final[tuple[_Float32s, ...]]
    ratio: Final[tuple[_Float32s, ...]]
    inverse_distance: Final[_Float32s]
    uncertainty: Final[_Float32s]
    confirmations: Final[_Bytes | None]
    consensus: Final[_Float32s | None]
    triangles: Final[npt.NDArray[np.uint32]]
    tier: Final[_Bytes]
    ecc: Final[_Float32s]
    planes: Final[npt.NDArray[np.uint16] | None]
    tier0_count: Final[int]

class CaptureMetadata:
    __match_args__: ClassVar[tuple[str, ...]]
    exposure_time: Final[float]
    f_number: Final[float]
    iso: Final[float]
    focal_length: Final[float]
    focal_length_35: Final[float]
    maker: Final[str]
    model: Final[str]
    lens: Final[str]

class Node:
    __match_args__: ClassVar[tuple[str, ...]]
    name: Final[str]
    camera: Final[Camera]
    image_file: Final[pathlib.Path | None]
    texture_file: Final[pathlib.Path | None]
    capture: Final[CaptureMetadata]
    gain: Final[_Float64s]
    mask_file: Final[pathlib.Path | None]
    depth_file: Final[pathlib.Path | None]
    depth_scale: Final[float]

class CellQuality:
    __match_args__: ClassVar[tuple[str, ...]]
    coverage: Final[float]
    ecc: Final[float]
    residual_px: Final[float]
    score: Final[float]

class Cell:
    __match_args__: ClassVar[tuple[str, ...]]
    members: Final[tuple[int, ...]]
    quality: Final[CellQuality]
    mesh: Final[MorphMesh]

class NodeSequence:
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Node]: ...
    @overload
    def __getitem__(self, index: int) -> Node: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Node, ...]: ...

class CellSequence:
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Cell]: ...
    @overload
    def __getitem__(self, index: int) -> Cell: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Cell, ...]: ...

class UnusedPhotograph:
    __match_args__: ClassVar[tuple[str, ...]]
    name: Final[str]
    reason: Final[str]

class Fault:
    __match_args__: ClassVar[tuple[str, ...]]
    field: Final[str]
    message: Final[str]

class GeographicOrigin:
    __match_args__: ClassVar[tuple[str, ...]]
    latitude_degrees: Final[float]
    longitude_degrees: Final[float]
    height_metres: Final[float]

class MemoryDemand:
    __match_args__: ClassVar[tuple[str, ...]]
    positions: Final[int]
    indices: Final[int]
    textures: Final[int]
    depth: Final[int]
    @property
    def sum(self) -> int: ...

class Scene:
    nodes: Final[NodeSequence]
    cells: Final[CellSequence]
    backdrops: Final[CellSequence]
    folder: Final[pathlib.Path | None]
    unused_photographs: Final[tuple[UnusedPhotograph, ...]]
    acquisition: Final[str]
    settings: Final[str]
    origin: Final[GeographicOrigin | None]
    def vertex_positions(self, cell: int) -> _Float64s: ...

class Advice:
    __match_args__: ClassVar[tuple[str, ...]]
    kind: Final[AdviceKind]
    severity: Final[Severity]
    problem: Final[str]
    remedy: Final[str]
    nodes: Final[tuple[int, ...]]
    value: Final[float]

class NextView:
    __match_args__: ClassVar[tuple[str, ...]]
    camera: Final[Camera]
    reference_nodes: Final[tuple[int, ...]]
    gain: Final[float]
    where: Final[str]

class CaptureAdvice:
    __match_args__: ClassVar[tuple[str, ...]]
    advice: Final[tuple[Advice, ...]]
    views: Final[tuple[NextView, ...]]
    coverage: Final[float]
    coverage_with_views: Final[float]
