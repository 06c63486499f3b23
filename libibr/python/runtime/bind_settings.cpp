// SPDX-License-Identifier: Apache-2.0
#include "ibr/render_settings.h"

#include "runtime/bind.h"
#include "support/record.h"
#include "support/runtime_enums.h"

namespace py = pybind11;

namespace ibr::python {

void bindSettings(py::module_& module) {
  Record<Floor>(module, "Floor", "Grid on the ground, drawn where no photograph shows anything.")
      .field("up", &Floor::up, "Unit, world axes")
      .field("height", &Floor::height, "Along `up` from the world's origin, world units")
      .field("spacing", &Floor::spacing, "Of the lines, world units, > 0")
      .field("fade_radius", &Floor::fadeRadius, "Distance from below the eye at which the grid has faded out")
      .constructible();

  using S = RenderSettings;
  Record<S>(module, "RenderSettings",
            "How a frame is drawn. Immutable: replace() returns a changed copy. preset() gives settings by name.")
      .field("composition", &S::composition, "Composition")
      .field("gather_candidates", &S::gatherCandidates, "Photographs that vote, 1 to 16")
      .field("gather_colours", &S::gatherColours, "Photographs averaged for a pixel's colour, 1 to 8")
      .field("gather_layers", &S::gatherLayers, "Surfaces that a pixel shows, 1 or 2")
      .field("vote_scale", &S::voteScale, "Size of the vote, share of the drawn image's sides; > 0, at most 1")
      .field("blend", &S::blend, "BlendMode")
      .field("morph", &S::morph, "Morph")
      .field("order", &S::order, "DrawOrder")
      .field("alpha", &S::alpha, "AlphaContent")
      .field("max_cells", &S::maxCells, "Cells drawn at most")
      .field("extrapolation_limit", &S::extrapolationLimit, "In cell sizes; cells farther away are not drawn")
      .field("fade_share", &S::fadeShare, "Last share of the limit, over which a cell fades out")
      .field("switch_seconds", &S::switchSeconds, "Cross-fade after the main cell changes, s; 0: cuts")
      .field("texture_scale", &S::textureScale, "Share of the photographs' detail; > 0")
      .field("render_scale", &S::renderScale, "Share of the picture's sides, for drawing; > 0")
      .field("muted_cells", &S::mutedCells, "Indices of cells that are never drawn")
      .field("solo_cells", &S::soloCells, "If there are any, no other cells are drawn")
      .field("align_cells", &S::alignCells, "Neighbouring cells are shifted to agree, for inaccurate poses")
      .field("max_tier", &S::maxTier, "Tiers above it are not drawn: 0 confirmed, 2 completed, 3 filled")
      .field("skip_hidden_area", &S::skipHiddenArea, "Pixels that a headset never shows are left out")
      .field("exposure", &S::exposure, "Exposure")
      .field("exposure_seconds", &S::exposureSeconds, "Time constant of the adaptation, s")
      .field("colour_mapping", &S::colourMapping, "ColourMapping")
      .field("colour_table", &S::colourTable, "ColourTable")
      .field("colour_samples", &S::colourSamples, "Share of an overlap's pixels that are counted")
      .field("colour_min_samples", &S::colourMinSamples, "Fewer: the table is the identity")
      .field("colour_proxy", &S::colourProxy, "Distance of the proxy image's pixels, px")
      .field("colour_period", &S::colourPeriod, "Frames between two counts")
      .field("colour_fade_seconds", &S::colourFadeSeconds, "Fade of a new main cell's table to the identity, s")
      .field("colour_smooth_seconds", &S::colourSmoothSeconds, "Time constant of the tables, s")
      .field("colour_max_speed", &S::colourMaxSpeed, "Largest change of a table, 8-bit levels per second")
      .field("share_eye_colours", &S::shareEyeColours, "One colour table for both views")
      .field("floor", &S::floor, "Floor or None")
      .field("overlay", &S::overlay, "Overlay")
      .field("background", &S::background, "Display-encoded red, green, blue, 0 to 1, where nothing is drawn")
      .constructible();

  module.def("preset", &preset, py::arg("preset"), py::arg("kind"),
             "RenderSettings of a Preset for a DeviceKind: Device.kind.");
}

}  // namespace ibr::python
