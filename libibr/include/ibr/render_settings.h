// SPDX-License-Identifier: Apache-2.0
// How a frame is drawn ([T] §2.5), and presets from the fastest to the most accurate. No Vulkan.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ibr/conventions.h"
#include "ibr/device_kind.h"
#include "ibr/export.h"
#include "ibr/scene.h"

namespace ibr {

/// Source of a pixel's depth and colour.
enum class Composition : std::uint8_t {
  cells,     // the morphing cells of [T], each in its own slice of the depth range; nothing behind them
  gathered,  // photographs vote for the depth of each pixel; its colour is gathered from those that see the surface
  hybrid,    // the cells; pixels that they leave open are gathered
};

/// How the members' colours are combined ([T] §2.5.1).
enum class BlendMode : std::uint8_t {
  blend,   // weighted sum, [T] eq. 6
  dither,  // one member a pixel, chosen by tileable blue noise, [T] eq. 7
  mixed,   // the mean of both
};

/// Direction of a vertex from the virtual camera at p (λ: barycentric coordinates of p, c_i: member centres).
enum class Morph : std::uint8_t {
  ours,   // Σ λ_i a_i r_i + ρ (Σ λ_i c_i − p), λ clamped to the simplex: exact for static points, everywhere
  paper,  // Σ λ_i r_i with unclamped λ, [T] eq. 4
};

/// The order in which cells are drawn. Both orders show the better cell where two overlap.
enum class DrawOrder : std::uint8_t {
  ours,   // main cell first; the depth test compares rank, then depth inside the cell: each pixel is shaded once
  paper,  // back to front, main cell last, no depth test ([T] §2.5.2)
};

/// How the cells' colours adapt to those of the main cell ([T] §2.5.3).
enum class ColourMapping : std::uint8_t {
  off,          // colours are not adapted
  ours,         // all tables at once, from a small proxy image of the cells; applied while the cells are drawn
  paper,        // the paper's sequence: front to back, cell by cell; a compute pass applies the tables to all pixels
  paperRedraw,  // the same sequence; drawing the mesh again applies the tables
};

/// The brightness and white balance that photographs of known exposure (Node::gain) are shown with. Photographs of
/// unknown exposure are shown unchanged. Applied before colour mapping.
enum class Exposure : std::uint8_t {
  off,      // each photograph unchanged
  scene,    // all with the scene's mean exposure
  adapted,  // all with the mean exposure of the photographs that the main cell shows; exposure adapts over time ([T]
            // §2.5.3). At a photograph's own pose the photograph is unchanged
};

/// How a colour table continues beyond the 8-bit levels that two cells share.
enum class ColourTable : std::uint8_t {
  naive,       // continued as [T] eq. 10
  strict,      // continued as [T] eq. 16
  preserving,  // continued as [T] eq. 18, which the paper recommends
};

/// The target's alpha channel.
enum class AlphaContent : std::uint8_t {
  opaque,  // 1 everywhere
  tier,    // (255 − 64·tier) / 255 where something is drawn, 0 elsewhere
};

/// Diagnostic image over the picture or in its place. Colours and limits: shaders/shared/overlay.h. Overlays use the
/// picture's draw order, depth, fades and composition. Holes are filled under the wireframe alone.
enum class Overlay : std::uint8_t {
  none,        // no overlay
  wireframe,   // triangle edges over the picture, in a heat colour of the cell's rank ([T] fig. 4)
  tiers,       // over the picture: confirmed depth (grey), completed depth, filled pixels, holes
  weights,     // over the picture: weights of a cell pixel's members, or of a gathered pixel's best four photographs
  confidence,  // relative uncertainty of the depth: σ of ρ over ρ
  depth,       // depth along the viewing axis, in units of FramePlan::nearDistance
  overlap,     // number of cells that show a pixel. Only cells are drawn; a caller's DepthTarget stays far
  agreement,   // mean correlation of the members around a pixel ([T] §3.5 eq. 1); grey where they have no contrast or
               // the pixel is gathered
};

/// Maximum number of cells of a frame.
inline constexpr std::uint32_t kMaxCellCount = 64;

// Limits of the gather.
inline constexpr std::uint32_t kMaxGatherCandidates = 16;  // maximum of RenderSettings::gatherCandidates
inline constexpr std::uint32_t kMaxGatherColours = 8;      // maximum of RenderSettings::gatherColours
inline constexpr std::uint32_t kMaxGatherLayers = 2;       // maximum of RenderSettings::gatherLayers

/// Grid on the ground, for guidance where no photograph shows anything ([T] §2.5.4). Drawn over the background and over
/// filled pixels, never over photographed ones; hides nothing of the caller's.
struct Floor {
  glm::dvec3 up{0, 1, 0};  // upward direction, unit, world axes
  double height = 0;       // height of the ground along `up` from the world's origin, world units
  double spacing = 1;      // distance of neighbouring lines, world units, > 0
  double fadeRadius = 8;   // distance from the point below the eye at which the grid has faded out, world units
  bool operator==(const Floor&) const = default;
};

/// Settings of a frame. Fields that count for each Composition:
///
///   field                                            cells    gathered                       hybrid
///   gatherCandidates, gatherColours, gatherLayers,
///   voteScale                                        no       yes                            yes
///   textureScale, renderScale, alpha, floor,
///   background, skipHiddenArea                       yes      yes                            yes
///   maxTier                                          0, 3     0 confirmed, 2 completed,      0 cells and confirmed,
///                                                    filled   3 filled                       as gathered
///   exposure, exposureSeconds                        yes      adapted: to the photographs    as cells
///                                                             by inverse squared distance
///   maxCells, extrapolationLimit, fadeShare,
///   switchSeconds, morph, blend, alignCells,
///   mutedCells, colour…, shareEyeColours             yes      no                             of its cells, 2 at most
///   soloCells                                        yes      the cells are drawn            the cells are drawn
///   overlay                                          yes      yes                            yes
///   order paper; colourMapping paper, paperRedraw    yes      refused                        refused
///
/// Refused: planFrame throws Error{invalidInput} that names the field. A scene whose photographs have no confirmed
/// depth (Requirements::gatherable 0) is drawn as with Composition::cells.
struct RenderSettings {
  Composition composition = Composition::cells;  // source of depth and colour
  std::uint32_t gatherCandidates = 12;           // K: photographs that vote, 1 to kMaxGatherCandidates
  std::uint32_t gatherColours = 4;               // N: photographs averaged for a pixel's colour, 1 to kMaxGatherColours
  std::uint32_t gatherLayers = 2;                // surfaces that a pixel shows, 1 or 2
  double voteScale = 0.5;                     // size of the vote, as a share of the drawn image's sides; > 0, at most 1
  BlendMode blend = BlendMode::blend;         // how members' colours are combined
  Morph morph = Morph::ours;                  // direction of a vertex from the virtual camera
  DrawOrder order = DrawOrder::ours;          // order in which cells are drawn
  AlphaContent alpha = AlphaContent::opaque;  // contents of the target's alpha
  std::uint32_t maxCells = 12;                // cells drawn at most: the set that covers the views best
  double extrapolationLimit = 2.0;            // distance beyond which cells are not drawn, in cell sizes (longest edge)
  double fadeShare = 0.25;                    // last share of the limit, over which a cell fades out
  double switchSeconds = 0.25;  // cross-fade of two draw orders after the main cell changes, and fade of a cell
                                // that changes its rank; 0: cuts
  double textureScale = 1.0;    // scale of the photographs' sides: 0.5 shows half their detail; > 0
  double renderScale = 1.0;     // scale of the target's sides for drawing; > 0, at most RendererOptions::maxRenderScale
  std::vector<std::uint32_t> mutedCells;  // indices into Scene::cells that are never drawn, in any order
  std::vector<std::uint32_t> soloCells;   // if there are any, no other cells are drawn. Both ignore indices beyond
                                          // Scene::cells
  /// Morph::ours: neighbouring cells agree on where shared photographs are seen (PlannedCell::correction). Helps where
  /// pose errors are large and random; may lose a little on good poses.
  bool alignCells = false;
  int maxTier = kTierCompleted;  // maximum tier that is drawn (Tier); kTierFilled fills holes from around, but not in
                                 // scenes with masks: masked areas are not invented
  bool skipHiddenArea = true;    // RendererOptions::hiddenArea is not drawn; false: all is drawn, for screenshots

  Exposure exposure = Exposure::adapted;  // brightness that photographs are shown with
  double exposureSeconds = 0.5;           // time constant of Exposure::adapted

  ColourMapping colourMapping = ColourMapping::off;   // how cells adapt to the main cell's colours
  ColourTable colourTable = ColourTable::preserving;  // how colour tables continue beyond shared levels
  double colourSamples = 1.0;           // share of an overlap's pixels that are counted, chosen by blue noise
  std::uint32_t colourMinSamples = 64;  // counted pixels of an overlap below which the table is the identity; from
                                        // twice as many on it counts in full
  int colourProxy = 8;   // ours: distance of the proxy image's pixels in x and y, at least 1; smaller where too few
                         // pixels would remain, larger where the cells' tiles would not fit into the canvas
  int colourPeriod = 8;  // ours: frames between two counts; a new cell is counted at once
  double colourFadeSeconds = 1.0;     // duration of a new main cell's fade from its table to the identity
  double colourSmoothSeconds = 0.15;  // ours: time constant with which tables follow the measured ones
  double colourMaxSpeed = 120;        // ours: largest change of a table, 8-bit levels per second
  bool shareEyeColours = true;        // ours: one table for both views; false: a table for each view, measured in every
                                      // frame, not smoothed

  std::optional<Floor> floor;       // grid on the ground; nullopt: none
  Overlay overlay = Overlay::none;  // diagnostic image; not with ColourMapping::paper, paperRedraw

  glm::vec3 background{0.0f};  // colour where nothing is drawn: R, G, B, display-encoded

  bool operator==(const RenderSettings&) const = default;
};

/// Named settings, from the fastest to the most accurate. They differ by the kind of device. The programs' default is
/// `balanced`.
enum class Preset : std::uint8_t {
  fast,      // few cells, few photographs per pixel and a coarse vote
  balanced,  // RenderSettings' defaults with Composition::hybrid; a coarse vote on software devices
  accurate,  // more cells, and a vote of full size on hardware devices
  reference  // as many cells and voting photographs as the limits allow, and a vote of full size
};
/// Returns the settings of a preset on a kind of device.
IBR_API RenderSettings preset(Preset preset, DeviceKind kind);

}  // namespace ibr
