// SPDX-License-Identifier: Apache-2.0
#include "vr/show.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "base/check.h"
#include "base/stopwatch.h"
#include "gpu/barrier.h"
#include "gpu/rendering.h"
#include "shared/settings.h"
#include "shared/signals.h"
#include "shared/up.h"
#include "vr/eye_pictures.h"

namespace ibr::app {
namespace {

using namespace std::chrono_literals;

constexpr double kFreeRay = 10;                                             // m, of a ray that meets nothing
constexpr double kFloorSpacing = 0.5;                                       // m
constexpr VkClearColorValue kDusk{.float32 = {0.012f, 0.014f, 0.018f, 1}};  // linear; behind the grid

HeadsetOptions headsetOptions(const Visit& visit) {
  HeadsetOptions options{
      .validation = visit.options.validation, .pipelineCache = visit.options.pipelineCache, .log = visit.context.log()};
  if (!visit.window) return options;
  options.instanceExtensions = Window::instanceExtensions();
  options.deviceExtensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
  return options;
}

}  // namespace

Show::Show(Visit& visit)
    : visit_(visit),
      headset_(headsetOptions(visit)),
      device_(headset_.device(visit.context.log())),
      session_(headset_, visit.options.space, visit.eyeHeight),
      images_(headset_, device_, session_, visit.context.log()),
      hands_(headset_, session_),
      ring_(device_),
      shapesPass_(device_, images_.format(), images_.depthFormat(), FrameRing::kSlots),
      capture_(device_),
      menu_(headset_, device_, session_, visit.context.log()) {
  visit_.headset = headset_.name();
  visit_.eyes = images_.description();
  say(LogLevel::info, session_.spaceKind() == SpaceKind::stage
                          ? "STAGE space: the floor is the room's"
                          : fmt::format("LOCAL space: the eyes begin {:.2f} m above the floor", visit.eyeHeight));
  makeMirror();
  beginLoading();
}

Show::~Show() {
  if (loading_.valid()) loading_.wait();
  const std::lock_guard lock(headset_.queueMutex());
  vkDeviceWaitIdle(device_.handle());
}

void Show::say(LogLevel level, const std::string& text) const {
  visit_.context.say(level, "{}", text);
}

void Show::run() {
  while (!session_.ended()) {
    obey(session_.handleEvents());
    if (visit_.window) {
      visit_.window->handleEvents(0);
      leaving_ |= visit_.window->closing();
    }
    leaving_ |= interrupted() || (options().frames > 0 && visit_.shown >= options().frames);
    if (leaving_ && !exitAsked_) {
      if (!session_.running()) return;
      session_.requestExit();
      exitAsked_ = true;
    }
    if (session_.running())
      frame();
    else
      std::this_thread::sleep_for(20ms);
  }
}

void Show::obey(const SessionEvents& events) {
  if (events.recentred) recentring_ = events.recentred;
  maskChanged_ |= events.maskChanged;
  if (events.handsChanged) {
    const auto [left, right] = hands_.profiles(headset_, session_);
    const auto named = [](const std::string& profile) { return profile.empty() ? std::string("none") : profile; };
    say(LogLevel::info, fmt::format("Controllers: left {}, right {}", named(left), named(right)));
  }
}

void Show::frame() {
  const XrMoment moment = session_.beginFrame();
  const Stopwatch watch;
  const double seconds = lastTime_ > 0 ? 1e-9 * double(moment.time - lastTime_) : 0;
  lastTime_ = moment.time;
  if (recentring_ && moment.time >= recentring_->time) {
    if (visit_.walk) recentred(*visit_.walk, recentring_->change);
    recentring_.reset();
  }
  eyes_ = session_.locate(moment.time);
  if (eyes_.oriented && eyes_.positioned) head_ = eyes_.head();
  input_ = hands_.read(session_, moment.time);
  takeLoaded();
  walk(seconds);
  const bool draws = moment.shown && eyes_.oriented;
  if (draws) draw(seconds);
  const Layers layers = draws ? layersOf(menuShown_) : Layers();
  session_.endFrame(moment, layers);
  if (draws && place_) account(moment, seconds, 1e3 * watch.seconds());
}

void Show::walk(double seconds) {
  walked_ = {};
  if (!place_) {
    loadingSeconds_ += seconds;
    return;
  }
  menu_.point(input_);
  const WalkInput input{.seconds = seconds,
                        .head = eyes_.oriented && eyes_.positioned ? head_ : std::nullopt,
                        .hands = input_,
                        .goTo = std::exchange(goTo_, std::nullopt),
                        .scale = std::exchange(scale_, 1.0),
                        .black = nextPlace_.has_value()};
  walked_ = step(*visit_.walk, place_->files().walk, visit_.walking, input);
  for (const Hand hand : {kLeft, kRight})
    if (walked_.jumped && input_[hand].active) hands_.buzz(session_, hand);
  if (walked_.jumped) place_->forgetFrames();
  obeyMenu(seconds);
  if (nextPlace_ && walked_.fade >= 1) leavePlace();
}

void Show::addHands(Shapes& shapes, const Pose& head) const {
  const WalkPlace& place = place_->files().walk;
  const double height = visit_.walking.photographHeightMetres;
  std::optional<std::size_t> pointed;
  for (const Hand hand : {kLeft, kRight}) {
    const HandOutput& does = walked_.hands[hand];
    const Pose& aim = input_[hand].aim;
    if (const auto metres = menu_.rayLength(hand)) addRay(shapes, head, aim, *metres, true);
    if (!does.aiming) continue;
    if (does.pointed) pointed = does.pointed;
    const double metres =
        does.pointed ? rayLength(place.spots[*does.pointed], walked_.tracking, aim, height) : kFreeRay;
    addRay(shapes, head, aim, metres, does.pointed.has_value());
  }
  if (walked_.showMarks) addMarks(shapes, place.spots, walked_.tracking, head, height, pointed);
}

Shapes Show::shapes() const {
  Shapes shapes;
  const Pose head = head_.value_or(Pose{{0, 1.6, 0}, {1, 0, 0, 0}});
  for (const HandInput& hand : input_)
    if (hand.active) addHand(shapes, hand.aim);
  if (place_) {
    addHands(shapes, head);
    addVignette(shapes, walked_.vignette);
    addFade(shapes, walked_.fade);
  } else {
    addFloorGrid(shapes, head);
    addProgressRing(shapes, head, std::nullopt, loadingSeconds_);
  }
  return shapes;
}

void Show::draw(double seconds) {
  if (std::exchange(maskChanged_, false) && place_) {
    ring_.wait();
    place_->setHiddenArea({session_.hiddenArea(0), session_.hiddenArea(1)});
  }
  // Where the head's place is not known it is where it was.
  if (!eyes_.positioned && head_) {
    const glm::dvec3 away = head_->position - eyes_.head().position;
    for (EyeView& eye : eyes_.eyes) eye.pose.position += away;
  }
  std::vector<Camera> inSpace, cameras;
  for (const EyeView& eye : eyes_.eyes) {
    const VkExtent2D extent = images_.extent();
    const Intrinsics lens = intrinsicsOf(eye.fov, int(extent.width), int(extent.height));
    inSpace.push_back({lens, eye.pose});
    cameras.push_back({lens, inWorld(walked_.tracking, eye.pose)});
  }
  const std::array<Target, 2> targets = images_.acquire(walked_.tracking.unitsPerMetre);
  const FrameRing::Frame frame = ring_.begin();
  const bool captures = place_ && wantsPicture();
  if (place_)
    recordPlace(frame, seconds, cameras, targets, captures);
  else
    recordEmptiness(frame.commands, targets);
  if (captures) capture_.record(frame.commands, images_);
  shapesPass_.setShapes(frame.slot, shapes());
  for (std::size_t eye = 0; eye < 2; ++eye)
    shapesPass_.record(frame.commands, frame.slot, inSpace[eye], targets[eye], EyeImages::kNearPlane,
                       EyeImages::kFarPlane);
  menuShown_ = place_ && menu_.isOpen();
  if (menuShown_) menu_.record(frame);
  images_.finish(frame.commands);
  ring_.submit(frame);
  if (window_) showInMirror();
  images_.release();
  if (menuShown_) menu_.release();
  if (captures) writePictures(cameras);
}

void Show::recordEmptiness(VkCommandBuffer commands, std::span<const Target> targets) const {
  for (const Target& target : targets) {
    transitionTarget(commands, target, target.before, use::kColourAttachment);
    transitionTarget(commands, *target.depth, target.depth->before, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
    const VkRenderingAttachmentInfo colour = colourAttachment(target.view, VK_ATTACHMENT_LOAD_OP_CLEAR, kDusk);
    const VkRenderingAttachmentInfo depth =
        depthAttachment(target.depth->view, VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_STORE);
    beginRendering(commands, target.extent, {&colour, 1}, &depth);
    vkCmdEndRendering(commands);
  }
}

Show::Layers Show::layersOf(bool menu) {
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
  Layers layers{reinterpret_cast<const XrCompositionLayerBaseHeader*>(&projection_)};
  if (menu) layers.push_back(menu_.layer(session_.space()));
  return layers;
}

void Show::account(const XrMoment& moment, double seconds, double processorMs) {
  const bool missed = seconds > 1.5e-3 * moment.periodMs && moment.periodMs > 0;
  const std::uint64_t frame = ++visit_.shown;
  visit_.log.add({.frame = frame,
                  .intervalMs = 1e3 * seconds,
                  .processorMs = processorMs,
                  .deviceMs = ring_.deviceMs(),
                  .level = governor_.level,
                  .cells = place_->plan().cells.size(),
                  .missed = missed});
  tellPace(seconds, std::max(processorMs, ring_.deviceMs()), moment.periodMs);
  if (!visit_.governed) return;
  const Decision decision = govern(
      governor_, {.workMs = std::max(processorMs, ring_.deviceMs()), .periodMs = moment.periodMs, .missed = missed});
  if (decision.reason.empty()) return;
  visit_.log.add(frame, decision.reason);
  say(LogLevel::info, decision.reason);
}

// So seldom that it can be read.
void Show::tellPace(double seconds, double workMs, double periodMs) {
  constexpr double kSeconds = 0.5;
  paceSeconds_ += seconds;
  if (paceSeconds_ < kSeconds) return;
  paceSeconds_ = 0;
  pace_ = fmt::format("{:.1f} ms of {:.1f} ms a frame, {} cells", workMs, periodMs, place_->plan().cells.size());
  if (governor_.level > 0 && visit_.governed)
    pace_ += fmt::format(", {} of {} steps down", governor_.level, governor_.levels.size() - 1);
}

// ---- The window beside the headset

void Show::makeMirror() try {
  if (!visit_.window || !headset_.hasDeviceExtensions()) return;
  window_.emplace(device_, *visit_.window, SwapchainOptions{.pace = Pace::whenever});
  mirror_.emplace(device_, images_.format(), images_.extent());
} catch (const Error& e) {
  if (e.code() == ErrorCode::deviceLost) throw;
  window_.reset();
  say(LogLevel::warning, fmt::format("there is no mirror: {}", e.what()));
}

void Show::showInMirror() {
  const std::optional<Swapchain::Frame> frame = window_->begin();
  if (!frame) return;
  const EyeImages::Picture left = images_.picture(0);
  mirror_->record(frame->commands, {.image = left.image, .layer = left.layer, .rect = {{0, 0}, images_.extent()}},
                  *frame);
  window_->end(*frame);
}

// ---- Pictures

bool Show::wantsPicture() const {
  const std::uint64_t number = visit_.shown + 1;
  const bool last = number == options().frames && !options().screenshot.empty();
  return last || pictureAsked_ || (options().screenshotEvery > 0 && number % options().screenshotEvery == 0);
}

void Show::writePictures(const std::vector<Camera>& eyes) {
  ring_.wait();
  const bool last = visit_.shown + 1 == options().frames && !options().screenshot.empty();
  const std::filesystem::path file = last ? options().screenshot : freePicture(options().screenshots);
  pictureAsked_ = false;
  writeEyes(file, capture_.read(), eyes, pictureSettingsJson(drawnWith_, options().gpuScene, floor_));
  visit_.pictures.push_back(file);
  say(LogLevel::info, fmt::format("{}: both eyes' pictures are written", file.string()));
}

}  // namespace ibr::app
