// SPDX-License-Identifier: Apache-2.0
// Show: lifetime, and the steps of a frame before drawing.
#include "vr/show/show.h"

#include <chrono>
#include <cmath>
#include <thread>

#include "base/stopwatch.h"
#include "base/vulkan/submit.h"
#include "shared/cli/signals.h"

namespace ibr::app {
namespace {

HeadsetOptions headsetOptions(Visit& visit) {
  HeadsetOptions options{.validation = visit.options.validation,
                         .pipelineCache = visit.options.pipelineCache,
                         .log = visit.context.log(),
                         .messages = &visit.validationMessages};
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
      menu_(headset_, device_, session_, visit.context.log()),
      head_{{0, visit.eyeHeight, 0}, {1, 0, 0, 0}} {
  visit_.headset = headset_.name();
  visit_.eyes = images_.description();
  say(LogLevel::info, session_.spaceKind() == SpaceKind::stage
                          ? "STAGE space: floor of the room"
                          : fmt::format("LOCAL space: initial eye height {:.2f} m", visit.eyeHeight));
  makeMirror();
  beginLoading();
}

Show::~Show() {
  if (loading_.valid()) loading_.wait();
  waitIdle(device_);
}

void Show::say(LogLevel level, const std::string& text) const {
  visit_.context.say(level, "{}", text);
}

void Show::run() {
  while (!session_.ended()) {
    obey(session_.handleEvents());
    if (visit_.window) {
      visit_.window->handleEvents(0);
      visit_.leaving |= visit_.window->closing();
    }
    visit_.leaving |= interrupted() || (options().frames > 0 && visit_.shown >= options().frames);
    if (visit_.leaving && !exitAsked_) {
      if (!session_.running()) return;
      session_.requestExit();
      exitAsked_ = true;
    }
    if (session_.running()) {
      frame();
    } else {
      lastTime_ = 0;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
}

void Show::obey(const SessionEvents& events) {
  recentrings_.insert(recentrings_.end(), events.recentred.begin(), events.recentred.end());
  maskChanged_ |= events.maskChanged;
  if (events.handsChanged) {
    const auto [left, right] = hands_.profiles(headset_, session_);
    const auto named = [](const std::string& profile) { return profile.empty() ? std::string("none") : profile; };
    say(LogLevel::info, fmt::format("controllers: left {}, right {}", named(left), named(right)));
  }
}

void Show::frame() {
  const XrMoment moment = session_.beginFrame();
  const Stopwatch watch;
  const double seconds = lastTime_ > 0 ? 1e-9 * double(moment.time - lastTime_) : 0;
  lastTime_ = moment.time;
  notWorkMs_ = 0;
  changeSpace(moment.time);
  lookAround(moment.time);
  takeLoaded();
  if (place_)
    walk(seconds);
  else
    waitInPlace(seconds);
  const bool draws = moment.shown && eyes_.oriented;
  if (draws) draw(seconds);
  const double processorMs = 1e3 * watch.seconds() - notWorkMs_;
  session_.endFrame(moment, draws ? layers() : Layers());
  if (draws && place_ && !exitAsked_) account(moment, seconds, processorMs);
}

// Applies changes of the space's origin before any pose is located in the space.
void Show::changeSpace(XrTime time) {
  const auto moved = [&](const Pose& newInOld) {
    const glm::dquat back = glm::conjugate(newInOld.rotation);
    head_ = {back * (head_.position - newInOld.position), back * head_.rotation};
    menu_.recentred(newInOld);
  };
  while (!recentrings_.empty() && time >= recentrings_.front().time) {
    const std::optional<Pose> change = recentrings_.front().change;
    recentrings_.erase(recentrings_.begin());
    if (visit_.walk) recentred(*visit_.walk, change);
    if (change)
      moved(*change);
    else
      menu_.close();  // its pose in the new space is unknown
  }
  if (!eyeHeight_) return;
  moved({{0, visit_.eyeHeight - *eyeHeight_, 0}, {1, 0, 0, 0}});
  session_.setEyeHeight(visit_.eyeHeight = *std::exchange(eyeHeight_, std::nullopt));
}

void Show::lookAround(XrTime time) {
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

void Show::walk(double seconds) {
  menu_.point(input_);
  const WalkInput input{.seconds = seconds,
                        .head = eyes_.oriented ? std::optional(head_) : std::nullopt,
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

void Show::waitInPlace(double seconds) {
  waitedSeconds_ += seconds;
  walked_ = {};
  menu_.point(input_);
  obeyWaitingMenu(seconds);
}

}  // namespace ibr::app
