// SPDX-License-Identifier: Apache-2.0
// Renders a harmonised model from new viewpoints ([H] §3.2, Algorithms 8 and 9).
//
//   GpuHtmModel gpuModel(device, model, pictures);
//   HtmRenderer renderer(device, gpuModel, {.maxExtent = {1024, 768}});
//   const HtmFramePlan plan = planHtmFrame(model, bounds, {view, settings, dt}, state);   // eq. 5, pure CPU
//   renderer.record(commandBuffer, plan, target);                                         // eq. 6, then eq. 7
//   state = plan.next;
//
// At a camera's own pose the frame shows its photograph; the other photographs are displaced to agree with it.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "ibr/device.h"
#include "ibr/export.h"
#include "ibr/htm_model.h"
#include "ibr/image.h"
#include "ibr/scope_timer.h"
#include "ibr/target.h"
#include "ibr/uploads.h"

namespace ibr {

/// How colours are computed from photographs. The last two are the methods that [H] §4.2 compares with.
enum class HtmMethod : std::uint8_t {
  harmonised,    // photographs displaced by complements and blended, as in [H]
  blended,       // VDTBM: photographs blended, not displaced: complements count as 0
  vertexColours  // VDVBM: one colour per vertex, interpolated over triangles
};

/// Directions that eq. 5 compares.
enum class HtmDirection : std::uint8_t {
  middle,  // towards the middle of the mesh: rotating a camera about its centre changes no colour
  axis,    // viewing axes, as in [H]; the same as `middle` where cameras look at the middle
};

/// Settings of a frame of a harmonised model.
struct HtmSettings {
  double gamma = 50;  // γ₂ of eq. 5, 1 to 1000: larger values favour the cameras with the nearest direction
  HtmMethod method = HtmMethod::harmonised;       // how colours are computed
  HtmDirection direction = HtmDirection::middle;  // directions that eq. 5 compares
  double weightCut = 1.0 / 512;   // share of a pixel's or vertex's sum of weights: the remaining cameras are skipped
                                  // once their weights sum to at most this share; 0 <= cut < 1
  double depthTolerance = 0.005;  // share of the mesh's radius, > 0; a pixel's width is added. A point at most so far
                                  // behind the surface that a camera sees counts in full; at twice that it is hidden
  double smoothingSeconds = 0;    // time constant with which log weights follow the view; 0: at once, infinity: never
  CameraSet exclude = 0;          // cameras that are not used
  glm::vec3 background{0.0f};     // colour where nothing is drawn: R, G, B, display-encoded, finite
};

/// Bounds of the mesh, for planning; computed once.
struct HtmBounds {
  glm::dvec3 middle{0.0};  // centre of the bounding box of all triangles, world
  double radius = 1;       // radius of the sphere around `middle` that contains all triangles, world units, > 0
};
/// Computes the bounds of a model's surface. Pure.
IBR_API HtmBounds htmBounds(const HtmModel& model);

/// View and settings of a frame to plan.
struct HtmPlanInput {
  Camera view;           // virtual camera, a pinhole
  HtmSettings settings;  // how the frame is drawn
  double dtSeconds = 0;  // time since the previous frame, s, for smoothingSeconds; finite; negative counts as 0
};

/// State from frame to frame. The first frame starts from {}.
struct HtmPlanState {
  std::vector<double> logWeights;  // natural logarithms of the weights, by camera; <= 0, and the largest is 0
};

/// Carries a state from one model to the next: the last frame showed `before`, the next one shows `model`, as in 3D
/// video. Cameras correspond by name; a new camera starts from the smallest weight. Returns {} if no name occurs in
/// both, or if `state` has another number of cameras than `before`. Pure.
IBR_API HtmPlanState transferHtmState(const HtmModel& model, const HtmModel& before, const HtmPlanState& state);

/// A camera's weight in a frame.
struct PlannedHtmCamera {
  std::uint32_t camera = 0;       // index into HtmModel::cameras
  double logWeight = 0;           // natural logarithm of w relative to the best camera's: <= 0, finite
  double logRemainingWeight = 0;  // the same of the sum of all later cameras' weights; −infinity for the last camera
};

/// Plan of one frame. Plain data.
struct HtmFramePlan {
  Camera view;                            // as HtmPlanInput::view
  HtmSettings settings;                   // as HtmPlanInput::settings
  HtmBounds bounds;                       // bounds of the model
  std::vector<PlannedHtmCamera> cameras;  // cameras, best first, ties by index; all that are not excluded, so that a
                                          // pixel that no near camera sees may use a far one
  HtmPlanState next;                      // state for planning the next frame
};

/// Plans a frame by eq. 5. Pure; allocates host memory. Precondition: validate(model) is empty. Throws
/// Error{invalidInput} that names the field: the view is no valid pinhole, a setting is out of range, or time, bounds
/// or weights of the state are not finite. `next` is always finite. A state of another number of cameras counts as {}.
IBR_API HtmFramePlan planHtmFrame(const HtmModel& model, const HtmBounds& bounds, const HtmPlanInput& input,
                                  const HtmPlanState& state = {});

/// Plans as the other overload, into a plan that may hold a previous frame, whose memory is used again: later frames
/// allocate no heap memory. `state` may be `plan.next`. The plan is unchanged if the input is refused.
IBR_API void planHtmFrame(const HtmModel& model, const HtmBounds& bounds, const HtmPlanInput& input,
                          const HtmPlanState& state, HtmFramePlan& plan);

/// Prepares a camera's picture for upload to GpuHtmModel: builds its mip levels, which take a third more memory. Pure,
/// so another thread can do it ahead of time. Throws Error{invalidInput} for a picture that does not fit its camera.
IBR_API HtmImage prepareHtmImage(const HtmModel& model, std::size_t camera, HtmImage picture);

/// Options of a GpuHtmModel.
struct GpuHtmModelOptions {
  std::optional<bool> trilinear;  // interpolates between mip levels; default: on GPUs, not on software devices
  Uploads* uploads = nullptr;     // collects the uploads of the constructor instead of submitting and waiting
};

/// The model on a device: photographs with visibility as alpha, a depth map of the mesh for each camera, the mesh and
/// complements. The device must outlive it; the model need not.
class IBR_API GpuHtmModel {
 public:
  /// Calls the source for each camera in turn, allocates host and device memory, submits on the device's queue and
  /// waits; with GpuHtmModelOptions::uploads, neither submits nor waits. Reads no files, unless the source does. Throws
  /// what the source throws; Error{invalidInput} if validate() finds a fault or a picture does not fit its camera;
  /// Error{unsupported} if complements (8 bytes × cameras² × vertices) exceed the device's maxStorageBufferRange;
  /// Error{outOfMemory}.
  GpuHtmModel(Device& device, const HtmModel& model, const HtmImageSource& source,
              const GpuHtmModelOptions& options = {});
  GpuHtmModel(GpuHtmModel&&) noexcept;
  GpuHtmModel& operator=(GpuHtmModel&&) noexcept;
  ~GpuHtmModel();  // frees device memory; does not wait

  /// Replaces the model by another one, as for the next frame of 3D video. Keeps pipelines, and images and buffers that
  /// are large enough, so that mostly uploads remain; frees smaller ones before it allocates. Commands that use the
  /// previous model, its recorded uploads included, must have finished. Calls the source on the calling thread. Each
  /// renderer of it needs HtmRenderer::setModel before it records again. Submits and waits, unless `uploads` collect
  /// the uploads; uploads of the previous model must not be recorded afterwards. Throws what the constructor throws;
  /// afterwards only replace() and destruction are allowed.
  void replace(const HtmModel& model, const HtmImageSource& source, Uploads* uploads = nullptr);

  /// Bytes allocated on the device.
  struct Memory {
    // mesh: the surface; complements: offsets of all pairs of cameras; photographs: with visibility; depths: depth maps
    std::uint64_t mesh = 0, complements = 0, photographs = 0, depths = 0;
    std::uint64_t sum() const noexcept { return mesh + complements + photographs + depths; }  // all bytes
  };
  Memory memory() const noexcept;  // memory at this moment; neither waits nor allocates

  struct IBR_LOCAL State;

 private:
  friend const State& stateOf(const GpuHtmModel& model) noexcept;
  std::unique_ptr<State> state_;
};

/// Options of an HtmRenderer.
struct HtmRendererOptions {
  VkExtent2D maxExtent{0, 0};                                   // maximum size of an image, px
  std::vector<TargetFormat> formats{VK_FORMAT_R8G8B8A8_UNORM};  // formats of targets
};

/// Records frames. Model and device must outlive it. Commands that it recorded must have finished before it is
/// destroyed.
class IBR_API HtmRenderer {
 public:
  /// Allocates host and device memory, and builds pipelines. Submits nothing, waits for nothing and reads no files.
  /// Throws Error{unsupported} for formats that are no combination of TargetFormat, and for models
  /// with too many vertices (16 bytes each must fit into maxStorageBufferRange); Error{outOfMemory}.
  HtmRenderer(Device& device, const GpuHtmModel& model, const HtmRendererOptions& options);
  HtmRenderer(HtmRenderer&&) noexcept;
  HtmRenderer& operator=(HtmRenderer&&) noexcept;
  ~HtmRenderer();  // frees device memory; does not wait

  /// Selects the model of later frames: another one, or the same after GpuHtmModel::replace. Keeps pipelines; allocates
  /// host and device memory, without waiting. Commands
  /// recorded before must have finished. Throws what the constructor throws; afterwards only setModel() and destruction
  /// are allowed.
  void setModel(const GpuHtmModel& model);

  /// Records one frame outside a render pass. Preconditions: the plan is of the same model; plan.view has the target's
  /// extent, at most `maxExtent`; the target has no depth. Writes the whole target: alpha is 1 where the mesh is drawn
  /// and some camera shows it, else 0 with the background's colour. The target goes from `initialUse` to `finalUse`.
  /// Bound pipelines, descriptor sets, push constants, viewport and scissor are undefined afterwards. Submits, waits
  /// for and reads nothing, and allocates neither host nor device memory; the command buffer need not be submitted.
  /// Frames must be submitted in order on the
  /// device's queue. `timer` gets the scopes "coordinates" (eq. 6; for vertexColours: the colours) and "rasterisation".
  void record(VkCommandBuffer commandBuffer, const HtmFramePlan& plan, const Target& target,
              ScopeTimer* timer = nullptr) const noexcept;

 private:
  struct IBR_LOCAL State;
  std::unique_ptr<State> state_;
};

/// The model before optimisation, for [H]'s comparison: `source` as its surface, the cameras as given, no complements.
/// A model without a source keeps its surface. Pure.
IBR_API HtmModel unoptimisedModel(const HtmModel& model);

}  // namespace ibr
