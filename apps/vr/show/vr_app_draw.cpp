// SPDX-License-Identifier: Apache-2.0
// VrApp: draws both eyes' images, the runtime's layers and the mirror.
#include "base/stopwatch.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/rendering.h"
#include "ibr/error.h"
#include "vr/show/vr_capture.h"

namespace ibr::app {
namespace {

constexpr double kMissRayMetres = 10;  // m, length of a ray that hits nothing
constexpr VkClearColorValue kLoadingBackground{
    .float32 = {0.012f, 0.014f, 0.018f, 1}};  // linear; background of the grid

}  // namespace

void VrApp::draw(double seconds) {
  if (maskChanged_ && scene_) {
    maskChanged_ = false;
    ring_.wait();
    scene_->setHiddenArea({session_.hiddenArea(0), session_.hiddenArea(1)});
    ignoreNextFrames(governor_);
  }
  std::array<Camera, 2> inSpace, cameras;
  for (std::size_t i = 0; i < eyes_.eyes.size(); ++i) {
    const EyeView& eye = eyes_.eyes[i];
    const VkExtent2D extent = images_.extent();
    const Intrinsics lens = intrinsicsOf(eye.fov, int(extent.width), int(extent.height));
    inSpace[i] = {lens, eye.pose};
    cameras[i] = {lens, inWorld(walkOutput_.tracking, eye.pose)};
  }
  Capture* const capture = scene_ ? dueCapture() : nullptr;
  const Stopwatch waiting;
  const std::array<Target, 2> targets = images_.acquire(walkOutput_.tracking.unitsPerMetre);
  const FrameRing::Frame frame = ring_.begin();
  excludedMs_ += 1e3 * waiting.seconds();
  slot_ = frame.slot;
  finishStatistics(slot_, ring_.deviceMs());
  writeCaptures(frame.completed);
  if (writer_.hasResults()) reportPictures(writer_.takeResults());
  if (scene_)
    recordScene(frame, seconds, cameras, targets, capture != nullptr);
  else
    recordBackground(frame.commands, targets);
  if (capture) capture->images.record(frame.commands, images_);
  shapesPass_.setShapes(frame.slot, updatedShapes());
  for (std::size_t eye = 0; eye < 2; ++eye)
    shapesPass_.record(frame.commands, frame.slot, inSpace[eye], targets[eye], EyeImages::kNearPlane,
                       EyeImages::kFarPlane);
  menuShown_ = menu_.isOpen();
  if (menuShown_) menu_.record(frame);
  images_.finish(frame.commands);
  ring_.submit(frame);
  if (capture) keepCapture(*capture, frame.number, cameras);
  if (window_) showInMirror();
  images_.release();
  if (menuShown_) menu_.release();
}

void VrApp::recordScene(const FrameRing::Frame& frame, double seconds, const std::array<Camera, 2>& eyes,
                        std::span<const Target> targets, bool captured) {
  drawnSettings_ = governor_.levels[state_.governorEnabled ? governor_.level : 0];
  drawnSettings_.skipHiddenArea = !captured;
  setFloor(drawnSettings_);
  const GpuScope scope(frame.commands, frame.timer, "frame");
  scene_->record(frame, seconds, eyes, drawnSettings_, targets);
}

void VrApp::recordBackground(VkCommandBuffer commands, std::span<const Target> targets) const {
  for (const Target& target : targets) {
    transitionTarget(commands, target, target.initialUse, use::kColourAttachment);
    transitionTarget(commands, *target.depth, target.depth->initialUse, use::kDepthAttachment,
                     VK_IMAGE_ASPECT_DEPTH_BIT);
    const VkRenderingAttachmentInfo colour =
        colourAttachment(target.view, VK_ATTACHMENT_LOAD_OP_CLEAR, kLoadingBackground);
    const VkRenderingAttachmentInfo depth =
        depthAttachment(target.depth->view, VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_STORE);
    beginRendering(commands, target.extent, {&colour, 1}, &depth);
    vkCmdEndRendering(commands);
  }
}

// Places the guiding grid at the height of the real floor, with lines every 0.5 m.
void VrApp::setFloor(RenderSettings& settings) {
  floor_.reset();
  const LoadedScene& files = scene_->files();
  if (!options().floor || !files.level) return;
  constexpr double kSpacing = 0.5;  // m
  const double below = glm::dot(files.walk.up, files.middle - walkOutput_.tracking.origin);
  floor_ = FloorOptions{below, kSpacing * walkOutput_.tracking.unitsPerMetre};
  settings.floor = floorBelow(files.middle, files.walk.up, *floor_);
}

void VrApp::addHands(Shapes& shapes) const {
  for (const Hand hand : {kLeft, kRight}) {
    if (!input_[hand].active) continue;
    addHand(shapes, input_[hand].aim);
    if (const auto metres = menu_.rayLength(hand)) addRay(shapes, head_, input_[hand].aim, *metres, true);
  }
  if (!scene_) return;
  const WalkScene& scene = scene_->files().walk;
  const double height = state_.walking.photographHeightMetres;
  std::optional<std::size_t> pointed;
  for (const Hand hand : {kLeft, kRight}) {
    const HandOutput& output = walkOutput_.hands[hand];
    if (!output.aiming) continue;
    if (output.pointed) pointed = output.pointed;
    const Pose& aim = input_[hand].aim;
    const double metres =
        output.pointed ? rayLength(scene.spots[*output.pointed], walkOutput_.tracking, aim, height) : kMissRayMetres;
    addRay(shapes, head_, aim, metres, output.pointed.has_value());
  }
  if (walkOutput_.showMarks) addMarks(shapes, scene.spots, walkOutput_.tracking, head_, height, pointed);
}

const Shapes& VrApp::updatedShapes() {
  shapes_.inSpace.clear();
  shapes_.onView.clear();
  addHands(shapes_);
  if (scene_) {
    addVignette(shapes_, walkOutput_.vignette);
    addFade(shapes_, walkOutput_.fade);
  } else {
    addFloorGrid(shapes_, head_);
    addProgressRing(shapes_, head_, std::nullopt, loadingSeconds_);
  }
  return shapes_;
}

std::span<const XrCompositionLayerBaseHeader* const> VrApp::updatedLayers() {
  for (std::uint32_t eye = 0; eye < 2; ++eye) {
    projectionViews_[eye] = {.type = XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW,
                             .next = nullptr,
                             .pose = xrPoseOf(eyes_.eyes[eye].pose),
                             .fov = eyes_.eyes[eye].fov,
                             .subImage = images_.colour(eye)};
    if (const auto depth = images_.depth(eye)) {
      depthInfos_[eye] = {.type = XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR,
                          .next = nullptr,
                          .subImage = *depth,
                          .minDepth = 0,
                          .maxDepth = 1,
                          .nearZ = float(EyeImages::kNearPlane),
                          .farZ = float(EyeImages::kFarPlane)};
      projectionViews_[eye].next = &depthInfos_[eye];
    }
  }
  projection_ = {.type = XR_TYPE_COMPOSITION_LAYER_PROJECTION,
                 .next = nullptr,
                 .layerFlags = 0,
                 .space = session_.space(),
                 .viewCount = 2,
                 .views = projectionViews_.data()};
  layers_[0] = reinterpret_cast<const XrCompositionLayerBaseHeader*>(&projection_);
  if (menuShown_) layers_[1] = menu_.layer(session_.space());
  return std::span(layers_).first(menuShown_ ? 2 : 1);
}

void VrApp::makeMirror() try {
  if (!state_.window || !headset_.hasDeviceExtensions()) return;
  window_.emplace(device_, *state_.window, SwapchainOptions{.pace = Pace::immediate});
  mirror_.emplace(device_, images_.format(), images_.extent());
} catch (const Error& e) {
  window_.reset();
  logMessage(LogLevel::warning, fmt::format("no mirror window: {}", e.what()));
}

// Errors of the mirror do not stop the headset. A lost device will be reported by the headset's own calls.
void VrApp::showInMirror() try {
  const std::optional<Swapchain::Frame> frame = window_->begin();
  if (!frame) return;
  const EyeImages::Picture left = images_.picture(0);
  mirror_->record(frame->commands, {.image = left.image, .layer = left.layer, .rect = {{0, 0}, images_.extent()}},
                  *frame);
  window_->end(*frame);
} catch (const Error& e) {
  window_.reset();
  logMessage(LogLevel::warning, fmt::format("the mirror window has stopped: {}", e.what()));
}

}  // namespace ibr::app
