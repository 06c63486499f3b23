// SPDX-License-Identifier: Apache-2.0
#include "runtime/bind.h"
#include "support/runtime_enums.h"

namespace ibr::python {

void bindEnums(pybind11::module_& module) {
  defineEnum<ErrorCode>(module, "Kind of an Error.");
  defineEnum<DeviceKind>(module, "Kind of processor behind a Vulkan device. Presets depend on it.");
  defineEnum<AssetKind>(module, "Kind of a folder or file: asset_kind().");
  defineEnum<CameraModel>(module, "Projection of a camera.");
  defineEnum<Composition>(module,
                          "Source of a pixel's depth and colour. CELLS: morphing cells; GATHERED: photographs vote for "
                          "the depth of each pixel; HYBRID: cells, and a gather where they leave pixels open.");
  defineEnum<BlendMode>(
      module,
      "How the members' colours are combined. BLEND: weighted sum; DITHER: one member a pixel; MIXED: "
      "the mean of both.");
  defineEnum<Morph>(module,
                    "Direction of a vertex from the virtual camera. OURS: exact for static points; PAPER: eq. 4.");
  defineEnum<DrawOrder>(module, "Draw order of cells. OURS: main cell first, with a depth test; PAPER: back to front.");
  defineEnum<ColourMapping>(module, "How the cells' colours adapt to those of the main cell.");
  defineEnum<Exposure>(module,
                       "Brightness and white balance of photographs with known exposure. OFF: unchanged; SCENE: the "
                       "scene's mean; ADAPTED: the mean of the photographs that the main cell shows.");
  defineEnum<ColourTable>(module, "How a colour table continues beyond the levels that two cells share.");
  defineEnum<AlphaContent>(module,
                           "Alpha of a picture. OPAQUE: 255; TIER: 255 - 64 * tier where something is drawn, else 0.");
  defineEnum<Overlay>(module, "Diagnostic image over the picture, or in its place.");
  defineEnum<Preset>(module, "Named settings, from the fastest to the most accurate: preset().");
  defineEnum<TextureFilter>(module,
                            "Filter of photographs. AUTOMATIC: trilinear, bilinear on software devices; BICUBIC: "
                            "sharper where photographs are magnified.");
  defineEnum<BlockTextureMode>(
      module,
      "Block-compressed textures. AUTOMATIC: decoded on software devices where that is faster; "
      "KEEP: stay compressed; DECODE: decoded to RGBA8.");
  defineEnum<TextureFormat>(module, "Format of stored textures: 4 (RGBA8), 0.5 (BC1) or 1 (BC7) bytes a pixel.");
  defineEnum<HtmMethod>(module,
                        "Colours of a harmonised model. HARMONISED: displaced photographs; BLENDED: not displaced; "
                        "VERTEX_COLOURS: one colour per vertex.");
  defineEnum<HtmDirection>(module,
                           "Directions that a camera's weight compares. MIDDLE: towards the middle of the mesh; AXIS: "
                           "viewing axes.");
  defineEnum<AlignmentMethod>(
      module,
      "Search of the optimiser. RASTER, COMPUTE: random candidates on a device; CPU: the same on "
      "the processor; GRADIENT: computed steps, on the processor.");
  defineEnum<EccDefinition>(
      module,
      "Enhanced correlation coefficient. CHANNELS: one mean per channel and target; CONCATENATED: "
      "one mean over all, as in the paper.");
  defineEnum<AdviceKind>(module, "Fault of a capture: advise_capture().");
  defineEnum<Severity>(module, "Effect of a capture's fault: HINT, WARNING, SERIOUS.");
}

}  // namespace ibr::python
