// SPDX-License-Identifier: Apache-2.0
// Renders frame plans ([T] §2.5): records them into the caller's command buffer.
//
//   Device device = Device::create();
//   Scene scene = loadScene("scene");
//   GpuScene gpuScene(device, scene);
//   Renderer renderer(device, gpuScene, optionsFor(settings, {1920, 1080}));
//   FramePlan plan = planFrame(scene, sceneBounds(scene), {{view}, settings}, state);
//   renderer.record(commandBuffer, plan, target);  // then the caller submits
//
// Threading: one thread at a time uses a Renderer. No function reads files. "Allocates nothing" means neither host nor
// device memory.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ibr/conventions.h"
#include "ibr/device.h"
#include "ibr/export.h"
#include "ibr/frame_plan.h"
#include "ibr/gpu_scene.h"
#include "ibr/scene.h"
#include "ibr/scope_timer.h"
#include "ibr/target.h"
#include "ibr/uploads.h"

namespace ibr {

/// Ways of colour mapping that a renderer compiles. A scene of one cell costs nothing.
enum class ColourSupport : std::uint8_t {
  off,   // ColourMapping::off
  ours,  // ColourMapping::off and ours
  all,   // every ColourMapping
};

/// Everything that later plans and targets may use. Each item costs pipelines or memory. Renderer::supports tells
/// whether a plan stays within the options.
struct RendererOptions {
  VkExtent2D maxExtent{0, 0};   // maximum size of a view's image, px
  std::uint32_t maxViews = 1;   // maximum number of a plan's views, 1 or 2
  bool crossFadeOrders = true;  // a second canvas for FramePlan::previous; false: the draw order changes as a cut
  bool fill = true;             // fills holes (tier 3); false: holes show the background
  bool depth = false;           // supports targets with a DepthTarget
  ColourSupport colour = ColourSupport::off;  // ways of colour mapping
  /// Both views of a plan in one render pass, where they have one size and Renderer::probeMultiview() is true; the
  /// pixels are the same. With `uploads` the constructor does not run the probe: multiview then needs an earlier probe.
  bool multiview = true;
  std::vector<Overlay> overlays;            // overlays of all plans
  bool floor = false;                       // supports RenderSettings::floor
  const Scene* bufferScene = nullptr;       // the GpuScene's scene, for recordBuffers; read by the constructor alone
  const Scene* uncertaintyScene = nullptr;  // the same scene, for Overlay::confidence; read by the constructor alone
  /// Formats of targets.
  std::vector<TargetFormat> formats{VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_UNORM,
                                    VK_FORMAT_B8G8R8A8_SRGB};
  std::vector<DrawOrder> orders{DrawOrder::ours};             // draw orders of all plans
  std::vector<BlendMode> blends{BlendMode::blend};            // blend modes of all plans
  std::vector<Composition> compositions{Composition::cells};  // compositions of all plans
  std::uint32_t gatherCandidates = 12;                        // maximum RenderSettings::gatherCandidates
  std::uint32_t gatherColours = 4, gatherLayers = 2;          // exact values of each plan that gathers
  double voteScale = 0.5;                                     // largest RenderSettings::voteScale
  bool dissolve = true;       // supports opacities below 1; false only with fadeShare 0 and switchSeconds 0
  double maxRenderScale = 0;  // maximum RenderSettings::renderScale; 0: each plan is drawn at the target's size
  /// By view: triangles (three corners each, of any orientation) that cover pixels nobody sees, in tangents: x right, y
  /// up at z = −1 of the camera (OpenXR's XR_KHR_visibility_mask). Nothing is drawn or filled there: colour is the
  /// background, alpha is as in a hole, depth is far. Other pixels are unchanged, except that nothing is filled or
  /// interpolated from pixels inside. Ignored by DrawOrder::paper, ColourMapping::paper and paperRedraw, recordBuffers
  /// and the counting of colours. The constructor throws Error{invalidInput} for a number of corners that is not a
  /// multiple of three, and for corners that are not finite or beyond 10⁶.
  std::array<std::vector<glm::vec2>, 2> hiddenArea;
  Uploads* uploads = nullptr;  // collects the uploads of the constructor instead of submitting and waiting
};

/// Returns the options that plans with these settings need, and no more. Pure; allocates host memory.
IBR_API RendererOptions optionsFor(const RenderSettings& settings, VkExtent2D maxExtent,
                                   TargetFormat format = VK_FORMAT_R8G8B8A8_UNORM);

/// Records frames. The GpuScene must outlive the renderer. Commands that it recorded must have finished before it is
/// destroyed.
class IBR_API Renderer {
 public:
  /// Allocates working images, host and device memory, and builds pipelines. Submits uploads and layout transitions on
  /// the device's queue and waits for them; with RendererOptions::uploads, neither. Throws Error (invalidInput,
  /// unsupported, outOfMemory, deviceLost).
  Renderer(Device& device, const GpuScene& scene, const RendererOptions& options);
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();  // frees device memory; does not wait

  /// Records a frame: canvas pass, then composition into a target for each of the plan's views. Must be called outside
  /// a render pass. A view's image has its target's extent, at most RendererOptions::maxExtent. Targets go from
  /// `initialUse` to `finalUse`. Bound pipelines, descriptor sets, viewport and scissor are undefined afterwards.
  /// Submits, waits for and allocates nothing; the command buffer need not be submitted. Frames must be submitted in
  /// order on the device's queue. A plan that supports() rejects, or a target that the options do not declare, clears
  /// the targets to the background. `timer` gets a scope for each pass.
  void record(VkCommandBuffer commandBuffer, const FramePlan& plan, std::span<const Target> targets,
              ScopeTimer* timer = nullptr) const noexcept;
  /// Records a frame of one view, as the other overload, without a timer.
  void record(VkCommandBuffer commandBuffer, const FramePlan& plan, const Target& target) const noexcept {
    record(commandBuffer, plan, std::span(&target, 1));
  }

  /// Records one view of a plan into floating-point images, in the order of recording; `record` need not have been
  /// called for the plan. Otherwise as `record`.
  void recordBuffers(VkCommandBuffer commandBuffer, const FramePlan& plan, std::size_t view,
                     const BufferTargets& targets) const noexcept;

  /// Returns true if the renderer was made for such a plan. `why` gets the field of RendererOptions that the plan
  /// exceeds, for people; untouched where the plan is supported. Allocates only that text.
  bool supports(const FramePlan& plan, std::string* why = nullptr) const;

  /// Returns true if the options declare the target's format, encoding and depth. `why` as for a plan.
  bool supports(const Target& target, std::string* why = nullptr) const;

  /// Exact cost of a plan on a renderer.
  struct Counters {
    std::uint32_t pipelines = 0;                          // number of the renderer's pipelines
    std::uint64_t workingBytes = 0;                       // device memory of the renderer's images
    std::uint32_t passes = 0, draws = 0, dispatches = 0;  // number in the frame
    std::uint64_t triangles = 0;                          // number of triangles that the frame draws
    /// Bytes of the renderer's images and buffers as requested, without the device's alignment.
    struct Bytes {
      // canvases: images that cells are drawn into; fill: images for filling holes; colours: colour tables and their
      // images; parameters: parameters of draws; noise: blue noise; uncertainties: MorphMesh::uncertainty of all cells;
      // hiddenArea: triangles of RendererOptions::hiddenArea
      std::uint64_t canvases = 0, fill = 0, colours = 0, parameters = 0, noise = 0, uncertainties = 0, hiddenArea = 0;
      std::uint64_t gather = 0;  // images of the vote
      bool operator==(const Bytes&) const = default;
    } bytes;  // memory by purpose
  };
  /// Returns the cost of a plan. Neither waits nor allocates.
  Counters count(const FramePlan& plan) const noexcept;

  /// Tests if the device draws both views of a pass correctly, as some drivers do not. The first call for a Device
  /// allocates, submits and waits, and so does the first renderer that needs the answer; later ones use this answer.
  /// Throws Error.
  static bool probeMultiview(const Device& device);

  /// Returns true if RendererOptions::formats may name this combination. `why` gets the reason where it may not.
  static bool supports(TargetFormat format, std::string* why = nullptr);

 private:
  struct IBR_LOCAL State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
