// SPDX-License-Identifier: Apache-2.0
// probe FRAMES: submits the given number of frames and prints the state of each frame as JSON lines. Recreates its
// session and its instance if these are lost. Exit code 0 after the last frame, 1 after a failed call, 2 if the runtime
// ends the program.
#include "probe.h"

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>

namespace ibr::test {
namespace {

using nlohmann::json;

struct ExitWanted {};
struct InstanceLost {};

json asJson(const XrVector3f& v) {
  return {v.x, v.y, v.z};
}

class Probe {
 public:
  void run(int frames) {
    openInstance(p_);
    openSession(p_);
    while (frames_ < frames) try {
        pollEvents();
        if (running_) frame();
      } catch (const ProbeFailure& failure) {
        if (failure.result != XR_ERROR_SESSION_LOST) throw;
        print({{"failed", failure.call}, {"result", failure.result}});
        renewSession();
      } catch (const InstanceLost&) {
        closeInstance(p_);
        openInstance(p_);
        renewSession();
      }
    closeInstance(p_);
  }

 private:
  void renewSession() {
    running_ = false;
    closeSession(p_);
    openSession(p_);
  }

  void pollEvents() {
    for (XrEventDataBuffer event{XR_TYPE_EVENT_DATA_BUFFER}; xrPollEvent(p_.instance, &event) == XR_SUCCESS;
         event = {XR_TYPE_EVENT_DATA_BUFFER}) {
      print({{"event", event.type}});
      if (event.type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING) throw InstanceLost();
      if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED)
        enter(reinterpret_cast<const XrEventDataSessionStateChanged&>(event).state);
    }
  }

  void enter(XrSessionState state) {
    XrSessionBeginInfo begin{XR_TYPE_SESSION_BEGIN_INFO};
    begin.primaryViewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
    if (state == XR_SESSION_STATE_READY) checkXr("xrBeginSession", xrBeginSession(p_.session, &begin));
    if (state == XR_SESSION_STATE_READY) running_ = true;
    if (state == XR_SESSION_STATE_STOPPING) running_ = false;
    if (state == XR_SESSION_STATE_STOPPING) checkXr("xrEndSession", xrEndSession(p_.session));
    if (state == XR_SESSION_STATE_LOSS_PENDING) renewSession();
    if (state == XR_SESSION_STATE_EXITING) throw ExitWanted();
  }

  void frame() {
    XrFrameState state{XR_TYPE_FRAME_STATE};
    checkXr("xrWaitFrame", xrWaitFrame(p_.session, nullptr, &state));
    const XrResult begun = xrBeginFrame(p_.session, nullptr);
    checkXr("xrBeginFrame", begun);
    json line{{"frame", ++frames_},
              {"discarded", begun == XR_FRAME_DISCARDED},
              {"shouldRender", state.shouldRender == XR_TRUE}};
    std::array<XrView, 2> views = locate(state.predictedDisplayTime, line);
    readActions(state.predictedDisplayTime, line);
    const XrViewStateFlags known = line["flags"];
    if (!(known & XR_VIEW_STATE_POSITION_VALID_BIT))
      for (XrView& view : views) view.pose.position = {};
    submit(state, views, state.shouldRender && (known & XR_VIEW_STATE_ORIENTATION_VALID_BIT));
    print(line);
  }

  std::array<XrView, 2> locate(XrTime time, json& line) {
    XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO};
    info.viewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
    info.displayTime = time;
    info.space = p_.space;
    XrViewState state{XR_TYPE_VIEW_STATE};
    std::array<XrView, 2> views{};
    for (XrView& view : views) view.type = XR_TYPE_VIEW;
    std::uint32_t count = 2;
    checkXr("xrLocateViews", xrLocateViews(p_.session, &info, &state, count, &count, views.data()));
    line["flags"] = state.viewStateFlags;
    for (const XrView& view : views) {
      line["eyes"].push_back(asJson(view.pose.position));
      line["fov"].push_back({view.fov.angleLeft, view.fov.angleRight, view.fov.angleUp, view.fov.angleDown});
    }
    return views;
  }

  void readActions(XrTime time, json& line) {
    const XrActiveActionSet active{p_.actions, XR_NULL_PATH};
    XrActionsSyncInfo sync{XR_TYPE_ACTIONS_SYNC_INFO};
    sync.countActiveActionSets = 1;
    sync.activeActionSets = &active;
    checkXr("xrSyncActions", xrSyncActions(p_.session, &sync));
    XrActionStateGetInfo get{XR_TYPE_ACTION_STATE_GET_INFO};
    XrActionStateBoolean select{XR_TYPE_ACTION_STATE_BOOLEAN};
    XrActionStateVector2f stick{XR_TYPE_ACTION_STATE_VECTOR2F};
    get.action = p_.select;
    checkXr("xrGetActionStateBoolean", xrGetActionStateBoolean(p_.session, &get, &select));
    get.action = p_.stick;
    checkXr("xrGetActionStateVector2f", xrGetActionStateVector2f(p_.session, &get, &stick));
    XrSpaceLocation hand{XR_TYPE_SPACE_LOCATION};
    checkXr("xrLocateSpace", xrLocateSpace(p_.handSpace, p_.space, time, &hand));
    line["select"] = select.currentState == XR_TRUE;
    line["stick"] = {stick.currentState.x, stick.currentState.y};
    line["hand"] = asJson(hand.pose.position);
  }

  void submit(const XrFrameState& state, const std::array<XrView, 2>& views, bool shown) {
    std::uint32_t index = 0;
    XrSwapchainImageWaitInfo wait{XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO};
    wait.timeout = XR_INFINITE_DURATION;
    checkXr("xrAcquireSwapchainImage", xrAcquireSwapchainImage(p_.colour, nullptr, &index));
    checkXr("xrWaitSwapchainImage", xrWaitSwapchainImage(p_.colour, &wait));
    checkXr("xrReleaseSwapchainImage", xrReleaseSwapchainImage(p_.colour, nullptr));
    std::array<XrCompositionLayerProjectionView, 2> projected{};
    for (std::size_t i = 0; i < 2; ++i) {
      projected[i].type = XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW;
      projected[i].pose = views[i].pose;
      projected[i].fov = views[i].fov;
      projected[i].subImage.swapchain = p_.colour;
      projected[i].subImage.imageRect.extent = {int(p_.width), int(p_.height)};
    }
    XrCompositionLayerProjection layer{XR_TYPE_COMPOSITION_LAYER_PROJECTION};
    layer.space = p_.space;
    layer.viewCount = 2;
    layer.views = projected.data();
    const std::array layers{reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer)};
    XrFrameEndInfo end{XR_TYPE_FRAME_END_INFO};
    end.displayTime = state.predictedDisplayTime;
    end.environmentBlendMode = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
    end.layerCount = shown ? 1 : 0;
    end.layers = layers.data();
    checkXr("xrEndFrame", xrEndFrame(p_.session, &end));
  }

  ProbeSession p_;
  bool running_ = false;
  int frames_ = 0;
};

}  // namespace
}  // namespace ibr::test

int main(int argc, char** argv) {
  using namespace ibr::test;
  try {
    Probe().run(argc > 1 ? std::atoi(argv[1]) : 10);
    return 0;
  } catch (const ProbeFailure& failure) {
    print({{"failed", failure.call}, {"result", failure.result}});
    return 1;
  } catch (const ExitWanted&) {
    return 2;
  }
}
