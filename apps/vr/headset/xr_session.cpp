// SPDX-License-Identifier: Apache-2.0
#include "vr/headset/xr_session.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "base/check.h"

namespace ibr::app {
namespace {

constexpr XrViewConfigurationType kStereo = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;

template <class T, class Enumerate>
std::vector<T> enumerated(const T& blank, const char* call, const Enumerate& enumerate) {
  std::uint32_t count = 0;
  xr(enumerate(0u, &count, static_cast<T*>(nullptr)), call);
  std::vector<T> all(count, blank);
  xr(enumerate(count, &count, all.data()), call);
  all.resize(count);
  return all;
}

bool isFinite(glm::dvec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool isFinite(const glm::dquat& q) {
  return std::isfinite(q.w) && isFinite(glm::dvec3(q.x, q.y, q.z));
}

}  // namespace

Pose EyeViews::head() const {
  const Pose &left = eyes[0].pose, &right = eyes[1].pose;
  return {0.5 * (left.position + right.position), glm::slerp(left.rotation, right.rotation, 0.5)};
}

Session::Session(Headset& headset, std::optional<SpaceKind> space, double eyeHeight) : headset_(headset) {
  const XrGraphicsBindingVulkan2KHR binding = headset.binding();
  const XrSessionCreateInfo info{
      .type = XR_TYPE_SESSION_CREATE_INFO, .next = &binding, .createFlags = 0, .systemId = headset.system()};
  {
    const std::lock_guard lock(headset.queueMutex());
    session_ = xrMake<XrSessionOwner>(xrCreateSession, headset.instance(), info, "xrCreateSession");
  }
  chooseView();
  const auto spaces = enumerated<XrReferenceSpaceType>({}, "xrEnumerateReferenceSpaces", [&](auto... arguments) {
    return xrEnumerateReferenceSpaces(get(), arguments...);
  });
  const bool hasStage = std::ranges::find(spaces, XR_REFERENCE_SPACE_TYPE_STAGE) != spaces.end();
  check(hasStage || space != SpaceKind::stage, ErrorCode::unsupported,
        "{} has no STAGE space: set up a room, or use --space local", headset.name());
  kind_ = space.value_or(hasStage ? SpaceKind::stage : SpaceKind::local);
  makeSpace(eyeHeight);
}

void Session::chooseView() {
  const auto views = enumerated<XrViewConfigurationView>(
      {.type = XR_TYPE_VIEW_CONFIGURATION_VIEW}, "xrEnumerateViewConfigurationViews", [&](auto... arguments) {
        return xrEnumerateViewConfigurationViews(headset_.instance(), headset_.system(), kStereo, arguments...);
      });
  check(views.size() == 2, ErrorCode::unsupported, "{} has {} views, not two", headset_.name(), views.size());
  eyeExtent_ = {std::max(views[0].recommendedImageRectWidth, views[1].recommendedImageRectWidth),
                std::max(views[0].recommendedImageRectHeight, views[1].recommendedImageRectHeight)};
  const auto modes = enumerated<XrEnvironmentBlendMode>({}, "xrEnumerateEnvironmentBlendModes", [&](auto... arguments) {
    return xrEnumerateEnvironmentBlendModes(headset_.instance(), headset_.system(), kStereo, arguments...);
  });
  // Also draws on see-through headsets: takes the runtime's first blend mode if opaque is not supported.
  if (std::ranges::find(modes, blendMode_) == modes.end() && !modes.empty()) blendMode_ = modes.front();
}

void Session::makeSpace(double eyeHeight) {
  XrReferenceSpaceCreateInfo info{.type = XR_TYPE_REFERENCE_SPACE_CREATE_INFO,
                                  .next = nullptr,
                                  .referenceSpaceType = XR_REFERENCE_SPACE_TYPE_STAGE,
                                  .poseInReferenceSpace = kXrIdentity};
  if (kind_ == SpaceKind::local) {
    info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
    info.poseInReferenceSpace.position.y = -float(eyeHeight);
  }
  space_ = xrMake<XrSpaceOwner>(xrCreateReferenceSpace, get(), info, "xrCreateReferenceSpace");
}

void Session::setEyeHeight(double metres) {
  if (kind_ == SpaceKind::local) makeSpace(metres);
}

void Session::enter(XrSessionState state) {
  state_ = state;
  switch (state) {
    case XR_SESSION_STATE_READY: {
      const XrSessionBeginInfo info{
          .type = XR_TYPE_SESSION_BEGIN_INFO, .next = nullptr, .primaryViewConfigurationType = kStereo};
      xr(xrBeginSession(get(), &info), "xrBeginSession");
      running_ = true;
      break;
    }
    case XR_SESSION_STATE_STOPPING:
      running_ = false;
      xr(xrEndSession(get()), "xrEndSession");
      break;
    case XR_SESSION_STATE_LOSS_PENDING:
      fail(ErrorCode::deviceLost, "the OpenXR runtime announces the loss of the session");
    case XR_SESSION_STATE_EXITING:
      ended_ = true;
      break;
    default:
      break;
  }
}

SessionEvents Session::handleEvents() {
  SessionEvents events;
  for (;;) {
    XrEventDataBuffer buffer{.type = XR_TYPE_EVENT_DATA_BUFFER, .next = nullptr, .varying = {}};
    if (xr(xrPollEvent(headset_.instance(), &buffer), "xrPollEvent") == XR_EVENT_UNAVAILABLE) return events;
    switch (buffer.type) {
      case XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED: {
        const auto& event = reinterpret_cast<const XrEventDataSessionStateChanged&>(buffer);
        if (event.session == get()) enter(event.state);
        break;
      }
      case XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING:
        fail(ErrorCode::deviceLost, "the OpenXR runtime announces its end");
      case XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING: {
        const auto& event = reinterpret_cast<const XrEventDataReferenceSpaceChangePending&>(buffer);
        const auto ours = kind_ == SpaceKind::stage ? XR_REFERENCE_SPACE_TYPE_STAGE : XR_REFERENCE_SPACE_TYPE_LOCAL;
        if (event.session != get() || event.referenceSpaceType != ours) break;
        events.recentred.push_back(
            {event.changeTime, event.poseValid ? std::optional(poseOf(event.poseInPreviousSpace)) : std::nullopt});
        break;
      }
      case XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR:
        events.maskChanged = true;
        break;
      case XR_TYPE_EVENT_DATA_INTERACTION_PROFILE_CHANGED:
        events.handsChanged = true;
        break;
      default:
        break;
    }
  }
}

void Session::requestExit() {
  if (running_) xr(xrRequestExitSession(get()), "xrRequestExitSession");
}

XrFrameTiming Session::beginFrame() {
  const XrFrameWaitInfo waitInfo{.type = XR_TYPE_FRAME_WAIT_INFO, .next = nullptr};
  XrFrameState state{.type = XR_TYPE_FRAME_STATE};
  xr(xrWaitFrame(get(), &waitInfo, &state), "xrWaitFrame");
  const XrFrameBeginInfo beginInfo{.type = XR_TYPE_FRAME_BEGIN_INFO, .next = nullptr};
  const std::lock_guard lock(headset_.queueMutex());
  xr(xrBeginFrame(get(), &beginInfo), "xrBeginFrame");  // XR_FRAME_DISCARDED is a success: previous frame dropped
  return {state.predictedDisplayTime, 1e-6 * double(state.predictedDisplayPeriod), state.shouldRender == XR_TRUE};
}

EyeViews Session::locate(XrTime time) const {
  const XrViewLocateInfo info{.type = XR_TYPE_VIEW_LOCATE_INFO,
                              .next = nullptr,
                              .viewConfigurationType = kStereo,
                              .displayTime = time,
                              .space = space()};
  XrViewState state{.type = XR_TYPE_VIEW_STATE};
  std::array<XrView, 2> views{XrView{.type = XR_TYPE_VIEW}, XrView{.type = XR_TYPE_VIEW}};
  std::uint32_t count = 0;
  xr(xrLocateViews(get(), &info, &state, 2, &count, views.data()), "xrLocateViews");
  EyeViews found;
  found.oriented = count == 2 && state.viewStateFlags & XR_VIEW_STATE_ORIENTATION_VALID_BIT;
  found.positioned = count == 2 && state.viewStateFlags & XR_VIEW_STATE_POSITION_VALID_BIT;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const XrView& view = views[eye];
    found.eyes[eye] = {poseOf(view.pose), view.fov};
    found.oriented &= isFinite(found.eyes[eye].pose.rotation) && isValidFov(view.fov);
    found.positioned &= found.oriented && isFinite(found.eyes[eye].pose.position);
  }
  return found;
}

std::optional<Pose> Session::locate(XrSpace what, XrTime time) const {
  constexpr XrSpaceLocationFlags kBoth = XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
  XrSpaceLocation location{.type = XR_TYPE_SPACE_LOCATION};
  xr(xrLocateSpace(what, space(), time, &location), "xrLocateSpace");
  if ((location.locationFlags & kBoth) != kBoth) return std::nullopt;
  return poseOf(location.pose);
}

void Session::endFrame(const XrFrameTiming& timing, std::span<const XrCompositionLayerBaseHeader* const> layers) {
  const XrFrameEndInfo info{.type = XR_TYPE_FRAME_END_INFO,
                            .next = nullptr,
                            .displayTime = timing.time,
                            .environmentBlendMode = blendMode_,
                            .layerCount = std::uint32_t(layers.size()),
                            .layers = layers.data()};
  const std::lock_guard lock(headset_.queueMutex());
  xr(xrEndFrame(get(), &info), "xrEndFrame");
}

std::vector<glm::vec2> Session::hiddenArea(std::uint32_t eye) const {
  if (!headset_.supportsVisibilityMask()) return {};
  const auto getMask = xrFunction<PFN_xrGetVisibilityMaskKHR>(headset_.instance(), "xrGetVisibilityMaskKHR");
  const auto ask = [&](XrVisibilityMaskKHR& mask) {
    return XR_SUCCEEDED(getMask(get(), kStereo, eye, XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR, &mask));
  };
  XrVisibilityMaskKHR mask{.type = XR_TYPE_VISIBILITY_MASK_KHR};
  if (!ask(mask) || mask.vertexCountOutput == 0 || mask.indexCountOutput == 0) return {};
  std::vector<XrVector2f> vertices(mask.vertexCountOutput);
  std::vector<std::uint32_t> indices(mask.indexCountOutput);
  mask.vertexCapacityInput = mask.vertexCountOutput;
  mask.vertices = vertices.data();
  mask.indexCapacityInput = mask.indexCountOutput;
  mask.indices = indices.data();
  if (!ask(mask)) return {};
  std::vector<glm::vec2> area;
  for (const std::uint32_t index : indices)
    if (index < vertices.size()) area.emplace_back(vertices[index].x, vertices[index].y);
  area.resize(area.size() / 3 * 3);
  return area;
}

}  // namespace ibr::app
