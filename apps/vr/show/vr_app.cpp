// SPDX-License-Identifier: Apache-2.0
// VrApp: lifetime, and the steps of a frame before drawing.
#include "vr/show/vr_app.h"

#include <chrono>
#include <cmath>
#include <thread>

#include "base/stopwatch.h"
#include "base/vulkan/submit.h"
#include "ibr/error.h"
#include "shared/cli/folders.h"
#include "shared/cli/signals.h"
#include "vr/show/vr_capture.h"

namespace ibr::app {
namespace {

HeadsetOptions headsetOptions(VrState& state) {
  HeadsetOptions options{.validation = state.options.validation,
                         .pipelineCache = state.options.pipelineCache,
                         .log = state.context.log(),
                         .messages = &state.validationMessages};
  if (!state.window) return options;
  options.instanceExtensions = Window::instanceExtensions();
  options.deviceExtensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
  return options;
}

}  // namespace

VrApp::VrApp(VrState& state)
    : state_(state),
      headset_(headsetOptions(state)),
      device_(headset_.device(state.context.log())),
      session_(headset_, state.options.space, state.eyeHeight),
      images_(headset_, device_, session_, state.context.log()),
      hands_(headset_, session_),
      ring_(device_),
      shapesPass_(device_, images_.format(), images_.depthFormat(), FrameRing::kSlots),
      menu_(headset_, device_, session_, state.context.log()),
      head_{{0, state.eyeHeight, 0}, {1, 0, 0, 0}} {
  state_.headset = headset_.name();
  state_.eyes = images_.description();
  logMessage(LogLevel::info, session_.spaceKind() == SpaceKind::stage
                                 ? "STAGE space: floor of the room"
                                 : fmt::format("LOCAL space: initial eye height {:.2f} m", state.eyeHeight));
  for (auto& capture : captures_) capture = std::make_unique<Capture>(device_);
  for (const std::filesystem::path& scene : options().places) menuModel_.scenes.push_back(folderName(scene));
  makeMirror();
  beginLoading();
}

VrApp::~VrApp() {
  uploading_ = {};
  waitIdle(device_);
  const auto reportErrors = [this](const auto& work) {
    try {
      work();
    } catch (const Error& e) {
      logMessage(LogLevel::error, fmt::format("screenshots: {}", e.what()));
    }
  };
  reportErrors([this] { finishPictures(); });
  reportErrors([this] { reportPictures(writer_.finish()); });  // after a lost device: the copies that the writer has
}

void VrApp::logMessage(LogLevel level, const std::string& text) const {
  state_.context.logMessage(level, "{}", text);
}

void VrApp::run() {
  showFrames();
  finishPictures();
}

void VrApp::showFrames() {
  while (!session_.ended()) {
    handleSessionEvents(session_.handleEvents());
    if (state_.window) {
      state_.window->handleEvents(0);
      state_.leaving |= state_.window->closing();
    }
    state_.leaving |= interrupted() || (options().frames > 0 && state_.shown >= options().frames);
    if (state_.leaving && !exitRequested_) {
      if (!session_.running()) return;
      session_.requestExit();
      exitRequested_ = true;
    }
    if (session_.running()) {
      frame();
    } else {
      lastTime_ = 0;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
}

void VrApp::handleSessionEvents(const SessionEvents& events) {
  recentrings_.insert(recentrings_.end(), events.recentred.begin(), events.recentred.end());
  maskChanged_ |= events.maskChanged;
  if (events.handsChanged) {
    const auto [left, right] = hands_.profiles(headset_, session_);
    const auto named = [](const std::string& profile) { return profile.empty() ? std::string("none") : profile; };
    logMessage(LogLevel::info, fmt::format("controllers: left {}, right {}", named(left), named(right)));
  }
}

void VrApp::frame() {
  const XrFrameTiming timing = session_.beginFrame();
  const Stopwatch watch;
  const double seconds = lastTime_ > 0 ? 1e-9 * double(timing.time - lastTime_) : 0;
  lastTime_ = timing.time;
  excludedMs_ = 0;
  applySpaceChanges(timing.time);
  locateHeadAndHands(timing.time);
  collectLoadedScene();
  if (scene_)
    walk(seconds);
  else
    updateWhileLoading(seconds);
  const bool draws = timing.shown && eyes_.oriented;
  if (draws) draw(seconds);
  const double processorMs = 1e3 * watch.seconds() - excludedMs_;
  session_.endFrame(timing, draws ? updatedLayers() : std::span<const XrCompositionLayerBaseHeader* const>());
  if (draws && scene_ && !exitRequested_) recordStatistics(timing, seconds, processorMs);
}

// Applies changes of the space's origin before any pose is located in the space.
void VrApp::applySpaceChanges(XrTime time) {
  const auto moved = [&](const Pose& newInOld) {
    const glm::dquat back = glm::conjugate(newInOld.rotation);
    head_ = {back * (head_.position - newInOld.position), back * head_.rotation};
    menu_.recentred(newInOld);
  };
  while (!recentrings_.empty() && time >= recentrings_.front().time) {
    const std::optional<Pose> change = recentrings_.front().change;
    recentrings_.erase(recentrings_.begin());
    if (state_.walk) recentred(*state_.walk, change);
    if (change)
      moved(*change);
    else
      menu_.close();  // its pose in the new space is unknown
  }
  if (!eyeHeight_) return;
  moved({{0, state_.eyeHeight - *eyeHeight_, 0}, {1, 0, 0, 0}});
  session_.setEyeHeight(state_.eyeHeight = *std::exchange(eyeHeight_, std::nullopt));
}

void VrApp::locateHeadAndHands(XrTime time) {
  eyes_ = session_.locate(time);
  input_ = hands_.read(session_, time);
  if (!eyes_.oriented) return;
  const Pose seen = eyes_.head();
  head_.rotation = seen.rotation;
  if (eyes_.positioned) head_.position = seen.position;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    glm::dvec3& position = eyes_.eyes[eye].pose.position;
    if (eyes_.positioned)
      eyeOffsets_[eye] = glm::conjugate(seen.rotation) * (position - seen.position);
    else
      position = head_.position + head_.rotation * eyeOffsets_[eye];
  }
}

void VrApp::walk(double seconds) {
  menu_.point(input_);
  const WalkInput input{.seconds = seconds,
                        .head = eyes_.oriented ? std::optional(head_) : std::nullopt,
                        .hands = input_,
                        .teleportTo = std::exchange(teleportSpot_, std::nullopt),
                        .scale = std::exchange(scale_, 1.0),
                        .black = nextScene_.has_value()};
  walkOutput_ = step(*state_.walk, scene_->files().walk, state_.walking, input);
  for (const Hand hand : {kLeft, kRight})
    if (walkOutput_.jumped && input_[hand].active) hands_.buzz(session_, hand);
  if (walkOutput_.jumped) scene_->forgetFrames();
  applyMenuRequests(seconds);
  if (nextScene_ && walkOutput_.fade >= 1) leaveScene();
}

void VrApp::updateWhileLoading(double seconds) {
  loadingSeconds_ += seconds;
  walkOutput_ = {};
  menu_.point(input_);
  applyLoadingMenu(seconds);
}

}  // namespace ibr::app
