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

constexpr double kFloorSpacing = 0.5;                                       // m
constexpr VkClearColorValue kDusk{.float32 = {0.012f, 0.014f, 0.018f, 1}};  // linear; behind the grid

LogCallback logOf(const Context& context) {
  return context.log();
}

HeadsetOptions headsetOptions(const Visit& visit) {
  return {.validation = visit.options.validation,
          .instanceExtensions = {},
          .deviceExtensions = {},
          .log = logOf(visit.context)};
}

}  // namespace

Show::Show(Visit& visit)
    : visit_(visit),
      headset_(headsetOptions(visit)),
      device_(headset_.device(logOf(visit.context))),
      session_(headset_, visit.options.space, visit.eyeHeight),
      images_(headset_, device_, session_, logOf(visit.context)),
      hands_(headset_, session_),
      ring_(device_),
      shapesPass_(device_, images_.format(), images_.depthFormat(), FrameRing::kSlots),
      capture_(device_) {
  visit_.headset = headset_.name();
  visit_.eyes = images_.description();
  say(LogLevel::info, session_.spaceKind() == SpaceKind::stage
                          ? "STAGE space: the floor is the room's"
                          : fmt::format("LOCAL space: the eyes begin {:.2f} m above the floor", visit.eyeHeight));
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
    const bool done = options().frames > 0 && visit_.shown >= options().frames;
    if ((done || interrupted()) && !leaving_) {
      leaving_ = true;
      if (!session_.running()) return;
      session_.requestExit();
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

// ---- Places

std::vector<RenderSettings> Show::levels() const {
  const Scene& scene = visit_.files[visit_.current]->scene;
  return options().governed ? ladder(options().settings, scene.cells.size(), scene.backdrops.size())
                            : std::vector{options().settings};
}

EyeFormat Show::eyeFormat() const {
  return {images_.extent(), images_.format(), {session_.hiddenArea(0), session_.hiddenArea(1)}};
}

void Show::beginLoading() {
  loadingSeconds_ = 0;
  // All that the thread uses is made here; what it reads of the visit nobody changes meanwhile.
  loading_ = std::async(std::launch::async, [this, eyes = eyeFormat()]() mutable {
    std::shared_ptr<const PlaceFiles>& files = visit_.files[visit_.current];
    if (!files)
      files = std::make_shared<PlaceFiles>(readPlace(options().places[visit_.current], options().unitsPerMetre));
    checkCells(options().settings, files->scene);
    GpuSceneOptions gpuScene = options().gpuScene;
    gpuScene.log = logOf(visit_.context);
    return std::make_unique<StereoPlace>(headset_.device(nullptr), files, levels(), options().floor, eyes, gpuScene);
  });
}

void Show::takeLoaded() {
  if (!loading_.valid() || loading_.wait_for(0s) != std::future_status::ready) return;
  place_ = loading_.get();
  const PlaceFiles& files = place_->files();
  if (!files.level)
    say(LogLevel::warning,
        fmt::format("{}: the photographs were held in too many ways to tell where up is", files.path.string()));
  governor_ = startGovernor(levels());
  if (!visit_.walk) visit_.walk = startWalk(files.walk, visit_.walking, 0);
}

void Show::giveFloor(RenderSettings& settings) {
  floor_.reset();
  const PlaceFiles& files = place_->files();
  if (!options().floor || !files.level) return;
  glm::dvec3 middle(0);
  for (const Node& node : files.scene.nodes) middle += node.camera.pose.position / double(files.scene.nodes.size());
  const double metre = walked_.tracking.unitsPerMetre;
  floor_ = FloorWish{glm::dot(files.walk.up, middle - walked_.tracking.origin), kFloorSpacing * metre};
  settings.floor = floorBelow(files.scene, *floor_);
}

// ---- A frame

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
  const Layers layers = draws ? layersOf() : Layers();
  session_.endFrame(moment, layers);
  if (draws && place_) account(moment, seconds, 1e3 * watch.seconds());
}

void Show::walk(double seconds) {
  walked_ = {};
  if (!place_) {
    loadingSeconds_ += seconds;
    return;
  }
  const bool tracked = eyes_.oriented && eyes_.positioned;
  const WalkInput input{
      .seconds = seconds, .head = tracked ? head_ : std::nullopt, .hands = input_, .black = nextPlace_.has_value()};
  walked_ = step(*visit_.walk, place_->files().walk, visit_.walking, input);
  for (const Hand hand : {kLeft, kRight})
    if (walked_.jumped && input_[hand].active) hands_.buzz(session_, hand);
  if (!nextPlace_ || walked_.fade < 1) return;
  ring_.wait();
  place_.reset();
  visit_.walk.reset();
  visit_.current = *std::exchange(nextPlace_, std::nullopt);
  beginLoading();
}

Shapes Show::shapes() {
  Shapes shapes;
  const Pose head = head_.value_or(Pose{{0, 1.6, 0}, {1, 0, 0, 0}});
  for (const HandInput& hand : input_)
    if (hand.active) addHand(shapes, hand.aim);
  if (!place_) {
    addFloorGrid(shapes, head);
    addProgressRing(shapes, head, std::nullopt, loadingSeconds_);
    return shapes;
  }
  const WalkPlace& place = place_->files().walk;
  const double height = visit_.walking.photographHeightMetres;
  std::optional<std::size_t> pointed;
  for (std::size_t i = 0; i < 2; ++i) {
    const HandOutput& hand = walked_.hands[i];
    if (!hand.aiming) continue;
    if (hand.pointed) pointed = hand.pointed;
    const double length =
        hand.pointed ? rayLength(place.spots[*hand.pointed], walked_.tracking, input_[i].aim, height) : 10;
    addRay(shapes, head, input_[i].aim, length, hand.pointed.has_value());
  }
  if (walked_.showMarks) addMarks(shapes, place.spots, walked_.tracking, head, height, pointed);
  addVignette(shapes, walked_.vignette);
  addFade(shapes, walked_.fade);
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
  if (place_)
    recordPlace(frame, seconds, cameras, targets);
  else
    recordEmptiness(frame.commands, targets);
  const bool captures = place_ && wantsPicture();
  if (captures) capture_.record(frame.commands, images_);
  shapesPass_.setShapes(frame.slot, shapes());
  for (std::size_t eye = 0; eye < 2; ++eye)
    shapesPass_.record(frame.commands, frame.slot, inSpace[eye], targets[eye], EyeImages::kNearPlane,
                       EyeImages::kFarPlane);
  images_.finish(frame.commands);
  ring_.submit(frame);
  images_.release();
  if (captures) writePictures(cameras);
}

void Show::recordPlace(const FrameRing::Frame& frame, double seconds, const std::vector<Camera>& eyes,
                       std::span<const Target> targets) {
  RenderSettings settings = governor_.levels[governor_.level];
  giveFloor(settings);
  const GpuScope scope(frame.commands, frame.timer, "frame");
  place_->record(frame, seconds, eyes, settings, targets);
  drawnWith_ = settings;
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

Show::Layers Show::layersOf() {
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
  return {reinterpret_cast<const XrCompositionLayerBaseHeader*>(&projection_)};
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
  if (!options().governed) return;
  const Decision decision = govern(
      governor_, {.workMs = std::max(processorMs, ring_.deviceMs()), .periodMs = moment.periodMs, .missed = missed});
  if (decision.reason.empty()) return;
  visit_.log.add(frame, decision.reason);
  say(LogLevel::info, decision.reason);
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
