// SPDX-License-Identifier: Apache-2.0
// Rendering an image graph ([T] §2.5): plan on the CPU, record into the caller's command buffer.
//
//   Device device = Device::create();
//   Scene scene = loadScene("place");
//   GpuScene gpuScene(device, scene);
//   Renderer renderer(device, gpuScene, {{1920, 1080}});
//   FramePlan plan = planFrame(scene, bounds, {{view}, settings}, state);
//   renderer.record(commandBuffer, plan, target);           // then the caller submits
//
// Threading: planFrame is pure and may run on any thread. One thread at a time uses a Renderer.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "ibr/camera.h"
#include "ibr/device.h"
#include "ibr/gpu_scene.h"
#include "ibr/image.h"
#include "ibr/scene.h"
#include "ibr/target.h"

namespace ibr {

/// Where a pixel's depth and colour come from.
enum class Composition : std::uint8_t {
  cells,     // the morphing cells of [T], each in its own slice of the depth range; nothing behind them
  gathered,  // photographs vote for the depth of each pixel; its colour is gathered from those that saw it
  hybrid,    // the cells; what they leave open is gathered
};

/// How the members' colours become one ([T] §2.5.1).
enum class BlendMode : std::uint8_t {
  blend,   // weighted sum, [T] eq. 6
  dither,  // one member a pixel, chosen by tileable blue noise, [T] eq. 7
  mixed,   // the mean of both
};

/// Where a vertex is seen from the virtual camera at p (λ: barycentric coordinates of p, c_i: member centres).
enum class Morph : std::uint8_t {
  ours,   // Σ λ_i a_i r_i + ρ (Σ λ_i c_i − p), λ clamped to the simplex: right for static points, everywhere
  paper,  // Σ λ_i r_i with unclamped λ, [T] eq. 4
};

/// In which order cells reach the canvas. Both show the better cell where two overlap.
enum class DrawOrder : std::uint8_t {
  ours,   // main cell first; rank and depth inside the cell decide in the depth buffer, so each pixel is shaded once
  paper,  // back to front, main cell last, no depth ([T] §2.5.2)
};

/// Whether and how the cells' colours adapt to the main cell's ([T] §2.5.3).
enum class ColourMapping : std::uint8_t {
  off,
  ours,         // all tables at once from a small proxy of the cells, applied while they are drawn
  paper,        // the paper's sequence: front to back, cell by cell; tables applied to all pixels by compute
  paperRedraw,  // the same sequence; tables applied by drawing the mesh again
};

/// As how bright and how white photographs are shown whose exposures are known (Node::gain); others are shown as they
/// are. Also where colours are mapped, which then has less to do.
enum class Exposure : std::uint8_t {
  off,      // each as it is
  scene,    // all as bright as they are in the mean
  adapted,  // all as bright as those that the main cell shows there ([T] §2.5.3's eye, which adapts): at a photograph's
            // own pose it is shown as it is
};

/// How a colour table goes on beyond the levels that two cells share.
enum class ColourTable : std::uint8_t {
  naive,       // [T] eq. 10
  strict,      // [T] eq. 16
  preserving,  // [T] eq. 18, which it recommends
};

/// What a renderer is prepared for; more costs pipelines and memory. A scene of one cell has nothing to adapt to and
/// costs nothing.
enum class ColourSupport : std::uint8_t {
  off,
  ours,  // ColourMapping::off and ours
  all,
};

/// What the target's alpha channel holds.
enum class AlphaContent : std::uint8_t {
  opaque,  // 1 everywhere
  tier,    // (255 − 64·tier) / 255 where something was drawn, 0 where nothing was
};

/// What is shown over a picture or in its place, to see how it comes about; colours and limits stand in
/// shaders/shared/overlay.h. Overlays go through the picture's order, depth, fades and composition; none but the
/// wireframe lets what nothing shows be filled.
enum class Overlay : std::uint8_t {
  none,
  wireframe,   // edges of triangles over the picture, in a heat colour of their cell's rank ([T] fig. 4)
  tiers,       // over the picture: photographs agree on its depth (grey), or it was completed, or filled; holes
  weights,     // over the picture: which members of a cell it comes from; of a gathered pixel, which of the best four
  confidence,  // how certain the depth is: its relative uncertainty, σ of ρ over ρ
  depth,       // along the viewing axis, in FramePlan::nearDistance
  overlap,    // how many cells show a pixel: the cells are drawn, nothing is gathered; a caller's DepthTarget stays far
  agreement,  // mean correlation of the members around a pixel ([T] §3.5 eq. 1); grey where they have no contrast, and
              // where a pixel is gathered
};

/// More than this is never drawn in one frame.
inline constexpr std::uint32_t kLargestCellCount = 64;
inline constexpr std::uint32_t kLargestLeavingCount = 16;  // cells besides, for a moment after the order changed
inline constexpr std::uint32_t kColourSlotCount =
    2 * (kLargestCellCount + kLargestLeavingCount);  // of a frame's cells and of those before it

/// A grid where the ground is, for guidance where no photograph shows anything ([T] §2.5.4): it lies over the
/// background and over what is filled, never over what was photographed, and hides nothing of the caller's.
struct Floor {
  glm::dvec3 up{0, 1, 0};  // unit, world
  double height = 0;       // along `up` from the world's origin, world units
  double spacing = 1;      // of the lines, world units, > 0
  double fadeRadius = 8;   // distance from below the eye at which the grid has vanished, world units
  bool operator==(const Floor&) const = default;
};

/// Limits of the gather.
inline constexpr std::uint32_t kMaxGatherCandidates = 16;
inline constexpr std::uint32_t kMaxGatherColours = 8;
inline constexpr std::uint32_t kMaxGatherLayers = 2;

/// How a frame is drawn. Which fields count for which Composition:
///
///   field                                            cells    gathered                       hybrid
///   gatherCandidates, gatherColours, gatherLayers,
///   voteScale                                        no       yes                            yes
///   textureScale, renderScale, alpha, floor,
///   background, leaveOutHidden                       yes      yes                            yes
///   lowestTier                                       0, 3     0 confirmed, 2 completed,      0 cells and confirmed,
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
/// Refused: planFrame throws Error{invalidInput} that names the field. A scene whose photographs have no evidence of
/// their depth (Requirements::gatherable 0) is drawn as with Composition::cells.
struct RenderSettings {
  Composition composition = Composition::cells;
  std::uint32_t gatherCandidates = 12;  // K: photographs that vote, 1 to kMaxGatherCandidates
  std::uint32_t gatherColours = 4;      // N: photographs that a pixel's colour is a mean of, 1 to kMaxGatherColours
  std::uint32_t gatherLayers = 2;       // surfaces that a pixel shows, 1 or 2
  double voteScale = 0.5;               // of the drawn image's sides: size of the vote; > 0, at most 1
  BlendMode blend = BlendMode::blend;
  Morph morph = Morph::ours;
  DrawOrder order = DrawOrder::ours;
  AlphaContent alpha = AlphaContent::opaque;
  std::uint32_t maxCells = 12;      // at most this many cells are drawn: those that together cover the views best
  double extrapolationLimit = 2.0;  // in cell sizes (longest edge); a cell further off is not drawn
  double fadeShare = 0.25;          // over this last share of the limit a cell dissolves into what lies behind it
  double switchSeconds = 0.25;      // after a switch of the main cell the order before it is mixed in for so long, and
                                    // cells that change their place fade for so long; 0: cuts
  double textureScale = 1.0;        // of the photographs' sides that are seen: 0.5 shows half their detail; > 0
  double renderScale = 1.0;         // of the target's sides: cells are drawn that much smaller or larger; > 0, at most
                                    // RendererOptions::largestScale
  std::vector<std::uint32_t> mutedCells, soloCells;  // Scene::cells that are never drawn; where there are any of the
                                                     // latter, nothing else is. In any order; indices beyond the
                                                     // scene's mean nothing
  bool alignCells = false;  // Morph::ours: neighbours agree on where their shared photographs are seen
                            // (PlannedCell::correction), though poses be wrong. Helps where errors of poses are large
                            // and of no pattern; on good poses it may lose a little
  int lowestTier = kTierCompleted;  // tiers beyond this are not drawn; kTierFilled fills from around what nothing
                                    // shows, but not in scenes with masks: what these leave out is not invented
  bool leaveOutHidden = true;       // RendererOptions::hiddenArea; false: all is drawn, as for a picture to be kept

  Exposure exposure = Exposure::adapted;
  double exposureSeconds = 0.5;  // time constant with which the eye adapts

  ColourMapping colourMapping = ColourMapping::off;
  ColourTable colourTable = ColourTable::preserving;
  double colourSamples = 1.0;             // share of the pixels of an overlap that are counted, chosen by blue noise
  std::uint32_t colourLeastSamples = 64;  // below it a table is the identity, from twice that on it counts in full
  int colourProxy = 8;   // ours: a proxy pixel every so many pixels in x and y, at least 1; fewer where too few pixels
                         // would remain, more where the cells' tiles would not fit into the canvas
  int colourPeriod = 8;  // ours: frames from one count to the next; a new cell is counted at once
  double colourFadeSeconds = 1.0;     // a new main cell's table takes so long to the identity
  double colourSmoothSeconds = 0.15;  // ours: time constant with which tables follow what is measured
  double colourLargestSpeed = 120;    // ours: levels per second that a table changes at most
  bool shareEyeColours = true;  // ours: one table for both views; else each view's own, in every frame, unsmoothed

  std::optional<Floor> floor;       // a guiding floor
  Overlay overlay = Overlay::none;  // not with the paper's ways of colour mapping

  glm::vec3 background{0.0f};  // display-encoded, shown where nothing is drawn

  bool operator==(const RenderSettings&) const = default;
};

/// Settings by name, from the fastest to the most accurate. What a device of the kind draws in little time differs, so
/// that the settings do. `balanced` is the default of the programs.
enum class Preset : std::uint8_t { fast, balanced, accurate, reference };
RenderSettings preset(Preset preset, DeviceKind kind);

/// What planning needs to know of a cell's mesh, computed once.
struct CellBounds {
  struct Member {
    glm::vec3 low{0.0f}, high{0.0f};          // box of the vertices' a_i r_i in the member's camera axes
    glm::vec3 unitLow{0.0f}, unitHigh{0.0f};  // the same of r_i, for Morph::paper
  };
  struct Corner {
    std::array<glm::vec3, 4> point{};  // a_i r_i in the member's camera axes
    float inverseDistance = 0;
  };
  struct Anchor {                  // a place of a photograph, as tier 0 shows it
    std::uint32_t photograph = 0;  // node
    std::uint32_t place = 0;       // on a grid over it (render/plan/anchors.h)
    Corner point;
  };
  std::vector<Member> members;       // as Cell::members
  std::vector<glm::vec4> surface;    // points of tier 0, (x, y, z) / w from the first member's place, world axes
  std::vector<Corner> corners;       // of the outline
  std::vector<glm::uvec2> outline;   // sum of tier 0's directed borders, edges between corners; empty: not to be used
  float largestInverseDistance = 0;  // of all vertices, ρ
  float farInverseDistance = 0;      // a tenth of the vertices lies farther away …
  float nearInverseDistance = 0;     // … and a tenth nearer than this
  double size = 0;                   // longest edge of the simplex, world units
};
class AnchorsOnDemand;  // render/plan/anchors.h
/// What the gather needs to know of a scene's photographs as a whole.
struct GatherBounds {
  double spacing = 1;             // b: median distance between neighbouring capture sites, world units
  double medianInverseDepth = 0;  // of what photographs confirm of each other, 1 / world unit
  double residualPx = 0;          // median reprojection residual of the cells, px of the photographs
  bool operator==(const GatherBounds&) const = default;
};
struct SceneBounds {
  std::vector<CellBounds> cells;  // as those of the scene
  GatherBounds gather;
  std::shared_ptr<AnchorsOnDemand> anchors;  // made by the first frame that is planned with RenderSettings::alignCells
};
SceneBounds sceneBounds(const Scene& scene);

struct FrameInput {
  // One, or two for stereo: pinholes; principal point anywhere; any aspect. Two share the order of cells, colour tables
  // (counted in the first) and noise: its pattern lies infinitely far ahead of both, so that it does not rival.
  std::vector<Camera> views;
  RenderSettings settings;
  double dtSeconds = 0;  // since the frame before; clamped to 0 … 0.1 (NUMERICS T18)
};

/// A rigid motion of a mesh while it is drawn: what it has at X is seen at pivot + rotation·(X − pivot + shift), what
/// it has in a direction far away in the turned one.
struct Correction {
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  // unit
  glm::dvec3 pivot{0.0}, shift{0.0};        // world
  bool operator==(const Correction&) const = default;
};

struct PlannedCell {
  struct View {
    std::array<double, 4> position{};  // λ of the morph: clamped (ours) or not (paper); 0 beyond the members
    std::array<double, 4> blend{};     // λ̂ clamped and smoothstepped, sums to 1
    bool operator==(const View&) const = default;
  };
  std::uint32_t cell = 0;            // index into Scene::cells
  double extrapolationDistance = 0;  // world units, from the middle of the views; 0 inside ([T] §2.5.2)
  double rotationalDistance = 0;     // radians, likewise
  double photographDistance = 0;     // of those that it shows, world units, likewise: RMS, as they are blended
  double opacity = 1;                // below 1 near the extrapolation limit, and while the order changes
  std::array<View, 2> view;          // weights by view
  Correction correction;             // aligns it with its neighbours (RenderSettings::alignCells)
  std::uint32_t colourSlot = kColourSlotCount;  // of the cell's colour table; kColourSlotCount: the identity
  bool colourFresh = true;                      // the slot remembers no frame before
  bool colourNeeded = true;                     // something that shows may go through its colour table
  bool hidden = false;                          // better cells cover it for certain
};

/// A photograph that votes and that colours are gathered from (Composition::gathered, hybrid).
struct PlannedPhotograph {
  std::uint32_t node = 0;      // index into Scene::nodes
  std::uint32_t backdrop = 0;  // index into Scene::backdrops: its mesh
  double weight = 1;           // 0 to 1, as a whole: 0 where it is about to be replaced by another
  double distance = 0;         // from the middle of the views, world units
  double share = 0;            // of the views' colours, by places and directions alone; they sum to 1
  bool operator==(const PlannedPhotograph&) const = default;
};

/// A cell as a frame shows it in its order.
struct ShownCell {
  std::uint32_t cell = 0;  // its index
  double opacity = 1;      // of a fade after the order changed
  bool leaving = false;    // it has another place by now, or none
  bool operator==(const ShownCell&) const = default;
};

/// What a plan remembers of the frames before. Start from {}.
struct PlanState {
  std::int64_t mainCell = -1;              // index of the last main cell, −1 if none
  std::vector<ShownCell> cells;            // in the last frame, best first
  std::vector<std::uint32_t> hiddenCells;  // that were in view and not chosen, ascending
  std::vector<ShownCell> former;           // cells before the last switch of the main cell, best first
  double secondsSinceSwitch = 0;           // of that switch
  std::vector<std::int64_t> colourSlots;   // cell of each slot, −1 if none
  std::optional<glm::dvec3> exposure;      // log of FramePlan::exposure
  double colourFade = 0;                   // seconds until the main cell's table is the identity
  int colourAge = 0;                       // frames since colours were counted
  bool operator==(const PlanState&) const = default;
};

/// A cell that is drawn besides, because it had this place a moment ago.
struct LeavingCell {
  PlannedCell planned;
  std::uint32_t before = 0;  // it is drawn before this one of FramePlan::cells, or after all of them
};

/// How tables move in this frame.
struct ColourPlan {
  bool counted = true;       // histograms are made; else tables go on to where they were going
  bool mainMapped = false;   // the main cell's table is not the identity yet
  double mainShare = 1;      // of its way to the identity that the main cell's table goes
  double share = 1;          // of their way that the others' go
  double largestStep = 255;  // levels, of the others
};

/// One frame, decided. Plain data: it may be kept, compared, sent elsewhere.
struct FramePlan {
  std::vector<Camera> views;
  RenderSettings settings;
  std::vector<PlannedCell> cells;              // best first; the first is the main cell
  std::vector<LeavingCell> leaving;            // what is drawn besides, by place
  std::vector<PlannedPhotograph> photographs;  // for the gather, best first; empty with Composition::cells
  GatherBounds gather;                         // of the scene
  std::vector<PlannedCell> former;  // while a switch is mixed: what is drawn in the order before it; else empty
  double formerWeight = 0;          // of the picture of `former` in the mixture, 0 … 1
  glm::dvec3 exposure{1.0};         // R, G, B: of linear light, times a photograph's gain, unless that is off
  ColourPlan colour;
  double nearDistance = 0;            // world units; nearer surfaces are drawn at this depth
  std::uint32_t culledByFrustum = 0;  // cells not drawn, and why
  std::uint32_t culledByDistance = 0;
  std::uint32_t culledByCount = 0;   // they were too many, or add nothing to those that are drawn
  std::uint32_t culledByChoice = 0;  // RenderSettings::mutedCells, soloCells
  PlanState next;                    // to be handed to the next call
};

/// Pure. Preconditions: validate(scene) is empty; one or two views, pinholes with finite, positive focal lengths and a
/// unit rotation, within 1e12 world units of the origin, scales positive, else Error{invalidInput}. The order is total,
/// does not depend on the order of cells in the scene, and is one for all views, from the pose in their middle ([T]
/// §2.5.4).
///
/// A switch of the main cell cannot be seen as a cut: for switchSeconds the former order is mixed in, and until then
/// the main cell is kept. Nor can its colours: the main cell's table begins as it was shown and fades. Nor can changes
/// of the order behind the main cell: what changes its place fades there, also what is muted or drawn alone.
FramePlan planFrame(const Scene& scene, const SceneBounds& bounds, const FrameInput& input,
                    const PlanState& state = {});

class ScopeTimer;

struct RendererOptions {
  VkExtent2D largest{0, 0};  // of a picture
  std::uint32_t views = 1;   // most of a plan
  bool switchMixing = true;  // a second canvas, for FramePlan::former; without, a switch is a cut
  bool fill = true;          // tier 3; without, the background shows where nothing is drawn
  bool depth = false;        // for targets with a depth
  ColourSupport colour =
      ColourSupport::ours;  // off: no plan's colours are mapped; ours: a plan's mapping is not the paper's
  bool multiview = true;  // both views of a plan in one pass, where they have one size and the device is seen to do it
                          // right; the pixels are the same without
  std::vector<Overlay> overlays;         // for RenderSettings::overlay
  bool floor = false;                    // for RenderSettings::floor
  const Scene* buffers = nullptr;        // the GpuScene's scene, read while the renderer is made: for recordBuffers
  const Scene* uncertainties = nullptr;  // likewise, for Overlay::confidence
  // What plans and targets will ask for: others are a programmer's error.
  std::vector<VkFormat> formats{VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_UNORM,
                                VK_FORMAT_B8G8R8A8_SRGB};
  std::vector<DrawOrder> orders{DrawOrder::ours, DrawOrder::paper};
  std::vector<BlendMode> blends{BlendMode::blend, BlendMode::dither, BlendMode::mixed};
  std::vector<Composition> compositions{Composition::cells};
  std::uint32_t gatherCandidates = 12, gatherColours = 4, gatherLayers = 2;  // most K; N and layers of all plans
  double voteScale = 0.5;                                                    // largest of RenderSettings::voteScale
  bool dissolve = true;     // opacities may be below 1: false only where fadeShare and switchSeconds are 0
  double largestScale = 0;  // of RenderSettings::renderScale; 0: all is drawn at the target's size
  /// By view: triangles (three corners each, of any orientation) in tangents, x right and y up at z = −1 of the camera,
  /// whose pixels nobody sees, as a headset's lenses leave them out (OpenXR's XR_KHR_visibility_mask). Nothing is drawn
  /// or filled there: the background shows, alpha is as where nothing is, and depth is far. Pixels outside are as
  /// without it, but that nothing is filled or interpolated from the pixels inside. Plans of DrawOrder::paper and of
  /// the paper's ways of colour mapping pay no heed, nor does recordBuffers, nor the count of colours. Throws
  /// Error{invalidInput} where corners are not in threes, or further out than 10⁶ or not finite.
  std::array<std::vector<glm::vec2>, 2> hiddenArea;
};

/// What these settings need, and nothing else.
RendererOptions optionsFor(const RenderSettings& settings, VkExtent2D largest,
                           VkFormat format = VK_FORMAT_R8G8B8A8_UNORM);

/// Records frames. The scene must outlive it; commands recorded by it must have finished before it is destroyed.
class Renderer {
 public:
  /// Allocates working images and builds the pipelines that this scene needs.
  Renderer(Device& device, const GpuScene& scene, const RendererOptions& options);
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// Records one frame, a target for each of the plan's views: canvas pass, then composition into the target. Must be
  /// called outside a render pass; a view's picture has its target's extent, at most `largest`. Bound pipelines,
  /// descriptor sets, viewport and scissor are lost. Targets go from `before` to `after`. Nothing is submitted, waited
  /// for or allocated; a command buffer that is never submitted does no harm. Frames are submitted in order on the
  /// device's queue.
  /// `timer` (gpu/draw/scope.h) gets a scope for each pass: labels in captures, and times.
  void record(VkCommandBuffer commandBuffer, const FramePlan& plan, std::span<const Target> targets,
              ScopeTimer* timer = nullptr) const noexcept;
  void record(VkCommandBuffer commandBuffer, const FramePlan& plan, const Target& target) const noexcept {
    record(commandBuffer, plan, std::span(&target, 1));
  }

  /// Records one view of a plan into floats; as `record` otherwise, which need not have been called. What both record
  /// comes in the order of recording.
  void recordBuffers(VkCommandBuffer commandBuffer, const FramePlan& plan, std::size_t view,
                     const BufferTargets& targets) const noexcept;

  /// What recording a plan amounts to. Exact; a scene pays only for what it declares (NUMERICS §4).
  struct Counters {
    std::uint32_t pipelines = 0;                          // alive in this renderer
    std::uint64_t workingBytes = 0;                       // of this renderer's images
    std::uint32_t passes = 0, draws = 0, dispatches = 0;  // of the frame
    std::uint64_t triangles = 0;                          // of its draws
    struct Bytes {                                        // asked for, without a device's alignment
      std::uint64_t canvases = 0, fill = 0, colours = 0, parameters = 0, noise = 0, uncertainties = 0, hiddenArea = 0;
      std::uint64_t gather = 0;
      bool operator==(const Bytes&) const = default;
    } bytes;
  };
  Counters count(const FramePlan& plan) const noexcept;

  /// Formats that a target may have.
  static bool supports(VkFormat format) noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
