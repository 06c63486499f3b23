# SPDX-License-Identifier: Apache-2.0
# Settings and plans of frames.
from collections.abc import Sequence
from typing import ClassVar, Final

import numpy.typing as npt

from ibr._stubs.enums import (
    AlphaContent, BlendMode, ColourMapping, ColourTable, Composition, DrawOrder, Exposure, Morph, Overlay
)
from ibr._stubs.scene import Camera, _Float32s, _Float64s, Scene

class Floor:
    __match_args__: ClassVar[tuple[str, ...]]
    up: Final[_Float64s]
    height: Final[float]
    spacing: Final[float]
    fade_radius: Final[float]
    def __init__(
        self, up: npt.ArrayLike = ..., height: float = ..., spacing: float = ..., fade_radius: float = ...
    ) -> None: ...
    def replace(
        self, *, up: npt.ArrayLike = ..., height: float = ..., spacing: float = ..., fade_radius: float = ...
    ) -> Floor: ...

class RenderSettings:
    __match_args__: ClassVar[tuple[str, ...]]
    composition: Final[Composition]
    gather_candidates: Final[int]
    gather_colours: Final[int]
    gather_layers: Final[int]
    vote_scale: Final[float]
    blend: Final[BlendMode]
    morph: Final[Morph]
    order: Final[DrawOrder]
    alpha: Final[AlphaContent]
    max_cells: Final[int]
    extrapolation_limit: Final[float]
    fade_share: Final[float]
    switch_seconds: Final[float]
    texture_scale: Final[float]
    render_scale: Final[float]
    muted_cells: Final[tuple[int, ...]]
    solo_cells: Final[tuple[int, ...]]
    align_cells: Final[bool]
    max_tier: Final[int]
    skip_hidden_area: Final[bool]
    exposure: Final[Exposure]
    exposure_seconds: Final[float]
    colour_mapping: Final[ColourMapping]
    colour_table: Final[ColourTable]
    colour_samples: Final[float]
    colour_min_samples: Final[int]
    colour_proxy: Final[int]
    colour_period: Final[int]
    colour_fade_seconds: Final[float]
    colour_smooth_seconds: Final[float]
    colour_max_speed: Final[float]
    share_eye_colours: Final[bool]
    floor: Final[Floor | None]
    overlay: Final[Overlay]
    background: Final[_Float32s]
    def __init__(
        self, composition: Composition = ..., gather_candidates: int = ..., gather_colours: int = ...,
        gather_layers: int = ..., vote_scale: float = ..., blend: BlendMode = ..., morph: Morph = ...,
        order: DrawOrder = ..., alpha: AlphaContent = ..., max_cells: int = ..., extrapolation_limit: float = ...,
        fade_share: float = ..., switch_seconds: float = ..., texture_scale: float = ..., render_scale: float = ...,
        muted_cells: Sequence[int] = ..., solo_cells: Sequence[int] = ..., align_cells: bool = ..., max_tier: int = ...,
        skip_hidden_area: bool = ..., exposure: Exposure = ..., exposure_seconds: float = ...,
        colour_mapping: ColourMapping = ..., colour_table: ColourTable = ..., colour_samples: float = ...,
        colour_min_samples: int = ..., colour_proxy: int = ..., colour_period: int = ...,
        colour_fade_seconds: float = ..., colour_smooth_seconds: float = ..., colour_max_speed: float = ...,
        share_eye_colours: bool = ..., floor: Floor | None = ..., overlay: Overlay = ...,
        background: npt.ArrayLike = ...
    ) -> None: ...
    def replace(
        self, *, composition: Composition = ..., gather_candidates: int = ..., gather_colours: int = ...,
        gather_layers: int = ..., vote_scale: float = ..., blend: BlendMode = ..., morph: Morph = ...,
        order: DrawOrder = ..., alpha: AlphaContent = ..., max_cells: int = ..., extrapolation_limit: float = ...,
        fade_share: float = ..., switch_seconds: float = ..., texture_scale: float = ..., render_scale: float = ...,
        muted_cells: Sequence[int] = ..., solo_cells: Sequence[int] = ..., align_cells: bool = ..., max_tier: int = ...,
        skip_hidden_area: bool = ..., exposure: Exposure = ..., exposure_seconds: float = ...,
        colour_mapping: ColourMapping = ..., colour_table: ColourTable = ..., colour_samples: float = ...,
        colour_min_samples: int = ..., colour_proxy: int = ..., colour_period: int = ...,
        colour_fade_seconds: float = ..., colour_smooth_seconds: float = ..., colour_max_speed: float = ...,
        share_eye_colours: bool = ..., floor: Floor | None = ..., overlay: Overlay = ...,
        background: npt.ArrayLike = ...
    ) -> RenderSettings: ...

class PlannedCell:
    __match_args__: ClassVar[tuple[str, ...]]
    cell: Final[int]
    extrapolation_distance: Final[float]
    rotational_distance: Final[float]
    photograph_distance: Final[float]
    opacity: Final[float]
    hidden: Final[bool]
    def blend(self, view: int = ...) -> _Float64s: ...

class PlannedPhotograph:
    __match_args__: ClassVar[tuple[str, ...]]
    node: Final[int]
    backdrop: Final[int]
    weight: Final[float]
    distance: Final[float]
    share: Final[float]

class FramePlan:
    views: Final[tuple[Camera, ...]]
    settings: Final[RenderSettings]
    cells: Final[tuple[PlannedCell, ...]]
    photographs: Final[tuple[PlannedPhotograph, ...]]
    exposure: Final[_Float64s]
    near_distance: Final[float]
    culled_by_frustum: Final[int]
    culled_by_distance: Final[int]
    culled_by_count: Final[int]
    culled_by_muting: Final[int]

class Planner:
    def __init__(self, scene: Scene) -> None: ...
    def plan(
        self, views: Camera | Sequence[Camera], settings: RenderSettings, *, dt_seconds: float = ...,
        previous: FramePlan | None = ...
    ) -> FramePlan: ...

class FrameBuffers:
    surface: Final[_Float32s]
    weights: Final[_Float32s]
    confidence: Final[_Float32s]
    depth: Final[_Float32s]
    tier: Final[_Float32s]
    rank: Final[_Float32s]
    extrapolation: Final[_Float32s]
    spread: Final[_Float32s]
    uncertainty: Final[_Float32s]
