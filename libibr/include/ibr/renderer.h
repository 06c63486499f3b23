// SPDX-License-Identifier: Apache-2.0
// Rendering an image graph ([T] §2.5): plan on the CPU, record into the caller's command buffer.
//
//   Device device = Device::create();
//   Scene scene = loadScene("place");
//   GpuScene gpuScene(device, scene);
//   Renderer renderer(device, gpuScene, {1920, 1080});
//   FramePlan plan = planFrame(scene, bounds, input, state);
//   renderer.record(commandBuffer, plan, target);           // then the caller submits
//
// Threading: planFrame is pure and may run on any thread. One thread at a time uses a Renderer.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "ibr/camera.h"
#include "ibr/device.h"
#include "ibr/image.h"
#include "ibr/scene.h"
#include "ibr/target.h"

namespace ibr {

/// How the members' colours become one ([T] §2.5.1).
enum class BlendMode : std::uint8_t {
  blend,   // weighted sum, [T] eq. 6
  dither,  // one member a pixel, chosen by tileable blue noise, [T] eq. 7
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

/// What the target's alpha channel holds.
enum class AlphaContent : std::uint8_t {
  opaque,  // 1 everywhere
  tier,    // (255 − 64·tier) / 255 where something was drawn, 0 where nothing was
};

/// More cells than this are never drawn in one frame.
inline constexpr std::uint32_t kLargestCellCount = 64;

struct RenderSettings {
  BlendMode blend = BlendMode::blend;
  Morph morph = Morph::ours;
  DrawOrder order = DrawOrder::ours;
  AlphaContent alpha = AlphaContent::opaque;
  std::uint32_t maxCells = 12;      // at most this many cells are drawn, best first; kLargestCellCount in any case
  double extrapolationLimit = 2.0;  // in cell sizes (longest edge); a cell further off is not drawn
  int lowestTier = kTierRejected;   // kTierAgrees: what the filters rejected is not drawn
  glm::vec3 background{0.0f};       // display-encoded, shown where nothing is drawn
};

/// What planning needs to know of a cell's mesh, computed once.
struct CellBounds {
  struct Member {
    glm::vec3 low{0.0f}, high{0.0f};          // box of the vertices' a_i r_i in the member's camera axes
    glm::vec3 unitLow{0.0f}, unitHigh{0.0f};  // the same of r_i, for Morph::paper
  };
  std::vector<Member> members;       // as Cell::members
  float largestInverseDistance = 0;  // of all vertices, ρ
  double size = 0;                   // longest edge of the simplex, world units
};
std::vector<CellBounds> cellBounds(const Scene& scene);

struct FrameInput {
  Camera view;  // pinhole; principal point anywhere; any aspect
  RenderSettings settings;
};

/// What a plan remembers of the frames before. Start from {}.
struct PlanState {
  std::int64_t mainCell = -1;  // index of the last main cell, −1 if none
};

struct PlannedCell {
  std::uint32_t cell = 0;            // index into Scene::cells
  std::uint32_t rank = 0;            // 0 = main cell
  double extrapolationDistance = 0;  // world units; 0 inside ([T] §2.5.2)
  double rotationalDistance = 0;     // radians
  std::array<double, 4> position{};  // λ of the morph: clamped (ours) or not (paper); 0 beyond the members
  std::array<double, 4> blend{};     // λ̂ clamped and smoothstepped, sums to 1
  std::uint32_t best = 0;            // member with the greatest λ̂, which tier 1 is drawn from
};

/// One frame, decided. Plain data: it may be kept, compared, sent elsewhere.
struct FramePlan {
  Camera view;
  RenderSettings settings;
  std::vector<PlannedCell> cells;     // by rank, best first
  double nearDistance = 0;            // world units; nearer surfaces are drawn at this depth
  std::uint32_t culledByFrustum = 0;  // cells not drawn, and why
  std::uint32_t culledByDistance = 0;
  std::uint32_t culledByCount = 0;
  PlanState next;  // to be handed to the next call
};

/// Pure. Preconditions: validate(scene) is empty; the view is a pinhole with finite, positive focal lengths and a unit
/// rotation, else Error{invalidInput}. Cell order is total and does not depend on the order of cells in the scene.
FramePlan planFrame(const Scene& scene, std::span<const CellBounds> bounds, const FrameInput& input,
                    const PlanState& state = {});

/// A photograph's texture for the GPU: level 0 has the size of the node's intrinsics, RGBA8, each level half the last,
/// down to 1×1. Called once a node, from the thread that makes the GpuScene.
using TextureSource = std::function<std::vector<Image8>(const Scene& scene, std::size_t node)>;

/// The device's copy of a scene: photographs as layers of array images, meshes in arena buffers, descriptor sets.
/// Submits uploads on the device's queue and waits for them. Throws Error (io, outOfMemory, …).
class GpuScene {
 public:
  /// Without a source, textures are read from the nodes' textureFile.
  GpuScene(Device& device, const Scene& scene, const TextureSource& source = {});
  GpuScene(GpuScene&&) noexcept;
  GpuScene& operator=(GpuScene&&) noexcept;
  ~GpuScene();

  struct Memory {
    std::uint64_t positions = 0, indices = 0, textures = 0;  // bytes allocated
  };
  Memory memory() const noexcept;

  struct State;
  const State& state() const noexcept { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

/// Records frames. The scene must outlive it; commands recorded by it must have finished before it is destroyed.
class Renderer {
 public:
  /// Allocates the canvas (RGBA8 + D32F) and builds pipelines for pictures of at most `largest` pixels.
  Renderer(Device& device, const GpuScene& scene, VkExtent2D largest);
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// Records one frame: canvas pass, then composition into the target. Must be called outside a render pass; the view's
  /// picture is target.extent, at most `largest`. Bound pipelines, descriptor sets, viewport and scissor are lost.
  /// The target goes from target.before to target.after. Nothing is submitted, waited for or allocated; a command
  /// buffer that is never submitted does no harm. Frames are submitted in order on the device's queue.
  void record(VkCommandBuffer commandBuffer, const FramePlan& plan, const Target& target) const noexcept;

  /// Formats that a target may have.
  static bool supports(VkFormat format) noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
