// SPDX-License-Identifier: Apache-2.0
// Plans a frame on the CPU ([T] §2.5.1 to §2.5.3): which cells it draws, in which order, with which weights and
// colours, and which photographs it gathers from. No Vulkan: a frame can be planned where there is no device.
//
//   SceneBounds bounds = sceneBounds(scene);  // once
//   FramePlan plan = planFrame(scene, bounds, {{view}, settings, dtSeconds}, state);
//   state = plan.next;
//
// Threading: all functions may run on any thread, also at the same time with the same scene and bounds. The result
// depends on the arguments alone. The overload of planFrame that writes over a plan changes that plan: two threads must
// not share it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "ibr/camera.h"
#include "ibr/conventions.h"
#include "ibr/export.h"
#include "ibr/render_settings.h"
#include "ibr/scene.h"

namespace ibr {

/// Maximum number of cells that fade out after a change of the draw order, in addition to the frame's own.
inline constexpr std::uint32_t kMaxFadingOutCount = 16;
/// Number of colour tables: of a frame's cells and of those of the previous draw order.
inline constexpr std::uint32_t kColourSlotCount = 2 * (kMaxCellCount + kMaxFadingOutCount);

/// Bounds of a cell's mesh, computed once. a_i, r_i, ρ: as in MorphMesh.
struct CellBounds {
  /// Boxes of the vertices in one member's camera axes.
  struct Member {
    glm::vec3 low{0.0f}, high{0.0f};          // lowest and highest coordinates of the vertices' a_i r_i
    glm::vec3 unitLow{0.0f}, unitHigh{0.0f};  // the same of r_i, for Morph::paper
  };
  /// A point of the mesh.
  struct Corner {
    std::array<glm::vec3, 4> point{};  // a_i r_i by member, in the member's camera axes
    float inverseDistance = 0;         // ρ, 1 / world unit
  };
  struct Anchor {                  // point of tier 0 at a grid point of a photograph
    std::uint32_t photograph = 0;  // index into Scene::nodes
    std::uint32_t gridCell = 0;    // index of the grid point, by rows from the top
    Corner point;                  // the mesh's point there that is nearest to the photograph
  };
  struct OutlineEdge {                   // an edge of the outline, or the chord of a chain of its edges
    std::uint32_t from = 0, to = 0;      // indices into `corners`
    std::array<float, 4> deviation{};    // maximum distance of the chain from the chord, of a_i r_i and r_i, by member
    float inverseDistanceDeviation = 0;  // the same of ρ, 1 / world unit
  };
  std::array<Member, 4> members;     // by member, as Cell::members
  std::vector<glm::vec4> surface;    // points of tier 0: (x, y, z) / w from the first member's position, world axes
  std::vector<Corner> corners;       // ends of the outline's edges
  std::vector<OutlineEdge> outline;  // sum of tier 0's directed borders, of limited length; empty: not usable
  float maxInverseDistance = 0;      // largest ρ of all vertices, 1 / world unit
  double size = 0;                   // longest edge of the simplex, world units
};
/// Statistics of a scene's photographs, for the gather.
struct GatherStatistics {
  double spacing = 1;             // b: median distance between neighbouring capture sites, world units
  double medianInverseDepth = 0;  // median of confirmed depth, 1 / world unit
  double residualPx = 0;          // median reprojection residual of the cells, px of the photographs
  bool operator==(const GatherStatistics&) const = default;
};
/// Bounds of a scene for planFrame(). Made by sceneBounds() alone, which sets both pointers.
struct SceneBounds {
  std::vector<CellBounds> cells;  // in the order of Scene::cells
  GatherStatistics gather;        // statistics of the scene's photographs
  struct Index;
  std::shared_ptr<const Index> index;  // finds the cells and photographs near a view
  struct Anchors;
  std::shared_ptr<Anchors> anchors;  // for RenderSettings::alignCells; thread-safe
};
/// Computes the bounds of a scene. Time is linear in the number of vertices, and n log n in those of cells and
/// photographs. `alignCells`: computes the anchors that RenderSettings::alignCells needs, too, at most 256 points in
/// memory for each photograph of each cell; otherwise the first aligned frame, or misalignmentsPx, computes those of
/// the whole scene. A requested stop throws Error{cancelled} before the next cell or photograph. Preconditions:
/// validate(scene) is empty; the scene does not change while the bounds are used.
IBR_API SceneBounds sceneBounds(const Scene& scene, bool alignCells = false, const std::stop_token& stop = {});

/// Views and settings of a frame to plan.
struct FrameInput {
  /// One view, or two for stereo: pinholes with any principal point and aspect. Two views share the draw order, the
  /// colour tables (counted in the first view) and the noise, whose pattern lies at infinity of both.
  std::vector<Camera> views;
  RenderSettings settings;  // how the frame is drawn
  double dtSeconds = 0;     // time since the previous frame, s; clamped to 0 … 0.1
};

/// A rigid motion of a mesh while it is drawn: a point X is seen at pivot + rotation·(X − pivot + shift), a direction
/// at infinity in the rotated one.
struct Correction {
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  // unit, in world axes
  glm::dvec3 pivot{0.0}, shift{0.0};        // pivot: centre of the rotation, world; shift: world units
  bool operator==(const Correction&) const = default;
};

/// A cell that the frame draws. Distances are from the midpoint of the views.
struct PlannedCell {
  /// Weights of the cell's members in a view, in the order of Cell::members.
  struct View {
    std::array<double, 4> position{};  // λ of the morph: clamped (ours) or not (paper); 0 beyond the members
    std::array<double, 4> blend{};     // λ̂, weights of the colours: clamped and smoothstepped, sums to 1
    bool operator==(const View&) const = default;
  };
  std::uint32_t cell = 0;            // index into Scene::cells
  double extrapolationDistance = 0;  // distance of the views from the cell, world units; 0 inside ([T] §2.5.2)
  double rotationalDistance = 0;     // angle between the views' axis and the cell's, radians; 0 for panoramas
  double photographDistance = 0;     // RMS distance of the cell's photographs as they are blended, world units
  double opacity = 1;                // 0 to 1; below 1 near the extrapolation limit, and while the draw order changes
  std::array<View, 2> view;          // weights by view, as FrameInput::views
  Correction correction;             // aligns the cell with its neighbours (RenderSettings::alignCells)
  std::uint32_t colourSlot = kColourSlotCount;  // slot of the cell's colour table; kColourSlotCount: the identity
  bool colourTableIsNew = true;                 // the slot has no table of a previous frame
  bool colourTableNeeded = true;                // a visible pixel may use the colour table
  bool hidden = false;                          // better cells certainly cover the cell
  bool operator==(const PlannedCell&) const = default;
};

/// A photograph that votes and that colours are gathered from (Composition::gathered, hybrid).
struct PlannedPhotograph {
  std::uint32_t node = 0;      // index into Scene::nodes
  std::uint32_t backdrop = 0;  // index into Scene::backdrops: its mesh
  double weight = 1;    // factor of its vote and colours, 0 to 1; 0 where another photograph is about to take its rank
  double distance = 0;  // distance from the midpoint of the views, world units
  double share = 0;     // share of the views' colours, by positions and directions alone; the shares sum to 1
  bool operator==(const PlannedPhotograph&) const = default;
};

/// A cell of a draw order.
struct DrawOrderEntry {
  std::uint32_t cell = 0;  // index into Scene::cells
  double opacity = 1;      // opacity of a fade after the order changed, 0 to 1
  bool fadingOut = false;  // the cell has another rank now, or none
  bool operator==(const DrawOrderEntry&) const = default;
};

/// State from frame to frame. The first frame starts from {}.
struct PlanState {
  std::int64_t mainCell = -1;              // index of the last main cell into Scene::cells, −1: none
  std::vector<DrawOrderEntry> cells;       // draw order of the last frame, best first
  std::vector<std::uint32_t> hiddenCells;  // cells in view that were not chosen, indices into Scene::cells, ascending
  std::vector<DrawOrderEntry> previous;    // draw order before the last switch of the main cell, best first
  double secondsSinceSwitch = 0;           // time since the last switch of the main cell
  std::vector<std::int64_t> colourSlots;   // cell of each colour slot, −1: none
  std::optional<glm::dvec3> exposure;      // log of FramePlan::exposure
  double colourFadeSecondsLeft = 0;        // seconds until the main cell's table is the identity
  int framesSinceColourCount = 0;          // frames since colours were counted
  bool operator==(const PlanState&) const = default;
};

/// A cell that is drawn at the rank that it had before the draw order changed.
struct FadingOutCell {
  PlannedCell planned;  // the cell as it is drawn
  /// Index in FramePlan::cells of the cell that this one is drawn before; the number of cells: drawn last.
  std::uint32_t drawnBefore = 0;
  bool operator==(const FadingOutCell&) const = default;
};

/// How colour tables move in a frame.
struct ColourPlan {
  bool countHistograms = true;   // histograms are counted; else tables move on towards the last target
  bool mainTableFading = false;  // the main cell's table is not the identity yet
  double mainShare = 1;          // share of its way to the identity that the main cell's table moves
  double share = 1;              // share of their way that the other tables move
  double maxStep = 255;          // maximum step of the other tables, 8-bit levels
  bool operator==(const ColourPlan&) const = default;
};

/// One frame, decided. Plain data: a plan may be stored, compared, sent elsewhere.
struct FramePlan {
  std::vector<Camera> views;                   // as FrameInput::views, with unit rotations
  RenderSettings settings;                     // as FrameInput::settings; maxTier and composition as the scene allows
  std::vector<PlannedCell> cells;              // cells to draw, best first; the first is the main cell
  std::vector<FadingOutCell> fadingOut;        // further cells, by rank
  std::vector<PlannedPhotograph> photographs;  // photographs for the gather, best first; empty with Composition::cells
  GatherStatistics gather;                     // statistics of the scene; set if there are `photographs`
  std::vector<PlannedCell> previous;           // cells of the previous draw order while two orders are cross-faded
  double previousWeight = 0;                   // weight of the previous order's image in the cross-fade, 0 to 1
  glm::dvec3 exposure{1.0};                    // R, G, B factors of linear light, beside each photograph's gain
  ColourPlan colour;                           // how colour tables move
  double nearDistance = 0;                     // depth at which nearer surfaces are drawn, world units
  std::uint32_t culledByFrustum = 0;           // number of cells out of view
  std::uint32_t culledByDistance = 0;          // number of cells beyond RenderSettings::extrapolationLimit
  std::uint32_t culledByCount = 0;   // number of cells beyond RenderSettings::maxCells, or without a gain in coverage
  std::uint32_t culledByMuting = 0;  // number of cells that RenderSettings::mutedCells or soloCells exclude
  PlanState next;                    // state for planning the next frame
  bool operator==(const FramePlan&) const = default;
};

/// Plans a frame. Time depends on the number of cells that are within RenderSettings::extrapolationLimit and in view,
/// and hardly on the scene's other cells, its photographs and vertices. With an infinite limit all cells are within it.
/// With RenderSettings::alignCells or Morph::paper, cells within the limit count even if they are out of view. The
/// first aligned frame may compute anchors (sceneBounds). Preconditions: validate(scene) is empty; `bounds` are of this
/// scene. Throws Error{invalidInput} for bounds of another number of cells or that sceneBounds did not make, and unless
/// there are one or two views, pinholes with finite, positive focal lengths and unit rotations, within 1e12 world units
/// of the origin, and positive scales. The draw order is total and does not depend on the order of cells in the scene.
/// All views share the order, which is computed at the pose midway between them ([T] §2.5.4).
///
/// When the main cell changes, the previous draw order is cross-faded over switchSeconds, colours included; until then
/// the main cell stays. Cells that change their rank behind the main cell fade one by one, also cells that are muted or
/// drawn alone.
IBR_API FramePlan planFrame(const Scene& scene, const SceneBounds& bounds, const FrameInput& input,
                            const PlanState& state = {});

/// Plans as the other overload, into a plan that may hold a previous frame, whose memory is used again: a frame like
/// those before allocates no heap memory. `state` may be `plan.next`. The plan is unchanged if the input is refused.
/// Each thread that plans keeps working memory, usually below 1 MiB, until it ends.
///
///   planFrame(scene, bounds, input, plan.next, plan);  // each frame
IBR_API void planFrame(const Scene& scene, const SceneBounds& bounds, const FrameInput& input, const PlanState& state,
                       FramePlan& plan);

/// Distances in pixels of a view between common anchors of the plan's cells. One value for each pair of cells and each
/// common anchor that both show inside the image. `corrected`: with the plan's corrections, otherwise without. Points
/// that other cells hide count too.
IBR_API std::vector<double> misalignmentsPx(const Scene& scene, const SceneBounds& bounds, const FramePlan& plan,
                                            std::size_t view, bool corrected);

}  // namespace ibr
