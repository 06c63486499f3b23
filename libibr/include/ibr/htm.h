// SPDX-License-Identifier: Apache-2.0
// Pictures of a harmonised model from new viewpoints ([H] §3.2, Algorithms 8 and 9).
//
//   GpuHtmModel gpuModel(device, model, pictures);
//   HtmRenderer renderer(device, gpuModel, {.largest = {1024, 768}});
//   const HtmFramePlan plan = planHtmFrame(model, bounds, {view, settings, dt}, state);   // eq. 5, pure CPU
//   renderer.record(commandBuffer, plan, target);                                         // eq. 6, then eq. 7
//   state = plan.next;
//
// Where a camera looks as the virtual one does, its photograph comes back and the others are bent to agree with it.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "ibr/device.h"
#include "ibr/htm_model.h"
#include "ibr/image.h"
#include "ibr/target.h"

namespace ibr {

/// How colours come from photographs; the last two are what [H] §4.2 compares with.
enum class HtmMethod : std::uint8_t {
  harmonised,    // [H]
  blended,       // VDTBM: photographs blended, not bent; complements are taken as 0
  vertexColours  // VDVBM: a colour a vertex, interpolated over triangles
};

/// Which directions eq. 5 compares.
enum class HtmDirection : std::uint8_t {
  middle,  // towards the middle of the mesh: turning a camera about its centre changes no colour
  axis,    // viewing axes, as [H] has it; the same where cameras look at the middle
};

struct HtmSettings {
  double gamma = 50;  // γ₂ of eq. 5, 1 to 1000
  HtmMethod method = HtmMethod::harmonised;
  HtmDirection direction = HtmDirection::middle;
  double weightCut = 1.0 / 512;  // of a pixel's or vertex's sum of weights: cameras that are left and together weigh no
                                 // more are not looked at; 0 <= cut < 1
  double depthTolerance = 0.005;  // of the mesh's radius, > 0, to which a pixel's width is added: so far behind what a
                                  // camera sees a point counts in full; at twice that it is hidden
  double smoothSeconds = 0;       // time constant with which log weights follow the view; 0: at once, infinity: never
  CameraSet exclude = 0;          // cameras that are not used at all
  glm::vec3 background{0.0f};     // display-encoded, finite, where nothing is drawn
};

/// What planning needs to know of the mesh, computed once.
struct HtmBounds {
  glm::dvec3 middle{0.0};  // of the box of all corners of triangles, world
  double radius = 1;       // of the ball around it that holds them, > 0
};
HtmBounds htmBounds(const HtmModel& model);

struct HtmInput {
  Camera view;  // a pinhole
  HtmSettings settings;
  double dtSeconds = 0;  // since the frame before, for smoothSeconds; finite, below 0 counts as 0
};

/// What a plan remembers of the frame before. Start from {}.
struct HtmState {
  std::vector<double> logWeights;  // by camera, of the largest 0
};

/// The state of a walk whose last frame was drawn of `before`, for its next one, of `model`: as 3D video goes on, or is
/// replaced by something else. Cameras are the same where their names are; one that was not there comes from the least
/// weight that was. {} where no camera is the same.
HtmState htmStateFor(const HtmModel& model, const HtmModel& before, const HtmState& state);

struct PlannedHtmCamera {
  std::uint32_t camera = 0;  // index into HtmModel::cameras
  double logWeight = 0;      // natural logarithm of w over the best camera's: <= 0, finite
  double logRest = 0;        // the same of the sum of all weights after it; −infinity for the last
};

/// One frame, decided. Plain data.
struct HtmFramePlan {
  Camera view;
  HtmSettings settings;
  HtmBounds bounds;
  std::vector<PlannedHtmCamera> cameras;  // best first, ties by index; all that are not excluded: a pixel that no near
                                          // camera sees still finds a far one
  HtmState next;                          // to be handed to the next call
};

/// Eq. 5. Pure. Preconditions: validate(model) is empty. Throws Error{invalidInput} that names the field for a view
/// that is no valid pinhole, settings out of range, a time, bounds or weights of the state that are not finite: what a
/// plan hands on is finite, whatever came in. A state of another number of cameras counts as {}.
HtmFramePlan planHtmFrame(const HtmModel& model, const HtmBounds& bounds, const HtmInput& input,
                          const HtmState& state = {});

/// What GpuHtmModel makes of a camera's picture before it is uploaded, for another thread to do ahead of time: its mip
/// levels, a third more memory. Throws Error{invalidInput} for a picture that does not fit its camera.
HtmPicture preparedHtmPicture(const HtmModel& model, std::size_t camera, HtmPicture picture);

struct GpuHtmModelOptions {
  std::optional<bool> trilinear;  // between mip levels; default: on GPUs, not on software devices
};

/// The model on a device: photographs with visibility as alpha, the mesh's depth as each camera sees it, mesh and
/// complements. Making one calls the source for each camera in turn, submits on the device's queue and waits. The
/// device must outlive it, the model need not. Throws what the source throws, Error{invalidInput} for a model that
/// validate() finds fault with or a picture that does not fit its camera, Error{unsupported} where complements (8 bytes
/// times cameras² times vertices) exceed the device's maxStorageBufferRange, Error{outOfMemory}.
class GpuHtmModel {
 public:
  GpuHtmModel(Device& device, const HtmModel& model, const HtmPictureSource& source,
              const GpuHtmModelOptions& options = {});
  GpuHtmModel(GpuHtmModel&&) noexcept;
  GpuHtmModel& operator=(GpuHtmModel&&) noexcept;
  ~GpuHtmModel();

  /// Puts another model in this one's place, as 3D video goes on: pipelines stay, and images and buffers that it fits
  /// into, so that little but uploads is left to do; nothing is held twice. Commands that read the model before must
  /// have finished, and each renderer of it is told by HtmRenderer::show before it records again. Throws what the
  /// constructor throws; then nothing but replace() or destruction may follow.
  void replace(const HtmModel& model, const HtmPictureSource& source);

  struct Memory {
    std::uint64_t mesh = 0, complements = 0, photographs = 0, depths = 0;  // bytes allocated on the device
    std::uint64_t sum() const noexcept { return mesh + complements + photographs + depths; }
  };
  Memory memory() const noexcept;

  struct State;
  const State& state() const noexcept { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

class ScopeTimer;

struct HtmRendererOptions {
  VkExtent2D largest{0, 0};  // of a picture
  // Of targets: 8-bit RGBA or BGRA, UNORM or SRGB; others are Error{unsupported}.
  std::vector<VkFormat> formats{VK_FORMAT_R8G8B8A8_UNORM};
};

/// Records frames. Model and device must outlive it; commands recorded by it must have finished before it is destroyed.
class HtmRenderer {
 public:
  /// Throws Error{unsupported} for formats that it cannot write and for models of more vertices than shaders can reach
  /// (16 bytes each within maxStorageBufferRange), Error{outOfMemory}.
  HtmRenderer(Device& device, const GpuHtmModel& model, const HtmRendererOptions& options);
  HtmRenderer(HtmRenderer&&) noexcept;
  HtmRenderer& operator=(HtmRenderer&&) noexcept;
  ~HtmRenderer();

  /// Frames from now on are of `model`, which is another one or the same after GpuHtmModel::replace. Pipelines stay.
  /// Commands recorded before must have finished. Throws what the constructor throws; then nothing but show() or
  /// destruction may follow.
  void show(const GpuHtmModel& model);

  /// Records one frame of a plan of the same model, outside a render pass; plan.view has the target's extent, at most
  /// `largest`, and the target no depth. Its whole extent is written: alpha is 1 where the mesh is drawn and some
  /// camera shows it, else 0 with the background's colour. Bound pipelines, sets, push constants, viewport and scissor
  /// are lost. The target goes from `before` to `after`. Nothing is submitted, waited for or allocated; a command
  /// buffer that is never submitted does no harm. Frames are submitted in order on the device's queue. `timer`
  /// (gpu/draw/scope.h) gets the scopes "coordinates" (eq. 6; of vertexColours: the colours) and "rasterisation".
  void record(VkCommandBuffer commandBuffer, const HtmFramePlan& plan, const Target& target,
              ScopeTimer* timer = nullptr) const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The model whose surface is `source`, the mesh before it was optimised, with the cameras as they were given, without
/// complements: what [H]'s comparison draws. A model without a source keeps its surface.
HtmModel baselineModel(const HtmModel& model);

}  // namespace ibr
