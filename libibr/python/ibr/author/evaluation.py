# SPDX-License-Identifier: Apache-2.0
"""Rendered views compared with photographs, and the pictures of harmonised models."""

from __future__ import annotations

import dataclasses
import math
import pathlib
import typing

import ibr
from ibr.author._author import BuildOptions, PosedPhotographs, read_picture

if typing.TYPE_CHECKING:
    import collections.abc
    import os

    import numpy as np
    import numpy.typing as npt


@dataclasses.dataclass(frozen=True)
class ViewEvaluation:
    """Scores of a view; `name` is the photograph's."""

    name: str
    scores: ibr.ViewScores


@dataclasses.dataclass(frozen=True)
class Evaluation:
    """Result of evaluate()."""

    views: tuple[ViewEvaluation, ...]

    @property
    def mean(self) -> dict[str, float]:
        """Mean of each score over the views that have it; NaN if none has. Keys: fields of ibr.ViewScores."""
        means = {}
        for name in ibr.ViewScores.__match_args__:
            if name == "worst_tile":
                continue
            values = [getattr(view.scores, name) for view in self.views]
            finite = [value for value in values if math.isfinite(value)]
            means[name] = sum(finite) / len(finite) if finite else math.nan
        return means


def held_out(folder: str | os.PathLike[str], masks: str | os.PathLike[str] | None = None) -> PosedPhotographs:
    """Reads held-out photographs with their poses, for evaluate().

    `folder` holds images/ (or the images themselves) and a COLMAP model in sparse/, sparse/0 or beside the images. All
    photographs of the model must be there: `ibr eval --truth` leaves missing ones out.
    """
    folder = pathlib.Path(folder)
    images = folder / "images"
    for model in (folder / "sparse", folder / "sparse" / "0", folder):
        if (model / "cameras.txt").exists() or (model / "cameras.bin").exists():
            # Nothing is written to `output`.
            return PosedPhotographs(
                BuildOptions(
                    photographs=images if images.is_dir() else folder, model=model, masks=masks, output=folder
                )
            )
    raise FileNotFoundError(f"{folder}: no COLMAP model in this folder, in sparse or in sparse/0")


def evaluate(
    renderer: ibr.Renderer,
    photographs: PosedPhotographs,
    *,
    names: collections.abc.Collection[str] | None = None,
    fit_gain: bool = False,
    progress: collections.abc.Callable[[str, int, int], bool | None] | None = None,
) -> Evaluation:
    """Compares rendered views with photographs that the scene was built without. Scores are those of `ibr eval --truth`.

    Each view is planned alone, with the renderer's settings and the size of the photograph, which the renderer must
    allow. Pixels that the photograph's mask covers do not count. `names`: only these photographs. `fit_gain`: also
    scores after one gain for each channel.
    """
    known = [image.name for image in photographs.images]
    chosen = known if names is None else list(names)
    unknown = sorted(set(chosen) - set(known))
    if unknown:
        raise ValueError(f"names: no photograph is named {unknown[0]}")
    settings = renderer.settings.replace(alpha=ibr.AlphaContent.TIER, background=(0, 0, 0))
    views: list[ViewEvaluation] = []
    for index, image in enumerate(photographs.images):
        if image.name not in chosen:
            continue
        goes_on = None if progress is None else progress("evaluating", len(views), len(chosen))
        if goes_on is not None and not goes_on:
            error = ibr.Error("stopped")
            error.code = ibr.ErrorCode.CANCELLED
            raise error
        picture = renderer.render(renderer.plan(image.camera, settings))
        scores = ibr.score_view(
            picture, photographs.photograph(index), mask=photographs.mask(index), fit_gain=fit_gain
        )
        views.append(ViewEvaluation(image.name, scores))
    return Evaluation(tuple(views))


def read_htm_picture(
    model: ibr.HtmModel, camera: int
) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint8] | None]:
    """Reads a camera's photograph and visibility from the files of a harmonised model, for ibr.HtmRenderer."""
    if model.folder is None:
        raise ValueError("model: has no folder")
    files = model.cameras[camera]
    if files.image_file is None:
        raise ValueError(f"model: camera {files.name} has no picture")
    photograph = read_picture(model.folder / files.image_file)
    if files.visibility_file is None:
        return photograph, None
    return photograph, read_picture(model.folder / files.visibility_file)[:, :, 0]
