// SPDX-License-Identifier: Apache-2.0
// Faults of the instance, the system, and the session's life cycle.
#include <cstring>

#include "fault_runtime.h"

namespace ibr::test {
namespace {

template <class T>
void tell(const T& event) {
  XrEventDataBuffer buffer{};
  static_assert(sizeof(T) <= sizeof(buffer));
  std::memcpy(static_cast<void*>(&buffer), &event, sizeof event);
  state->events.push_back(buffer);
}

void tellState(XrSessionState to) {
  XrEventDataSessionStateChanged event{XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED};
  event.session = state->session;
  event.state = to;
  tell(event);
}

}  // namespace

bool isLost(XrSession session) {
  const std::lock_guard lock(state->mutex);
  if (session == state->session && state->faults.due("session-loss")) state->lost.insert(session);
  return state->lost.contains(session);
}

// --- The instance and the system.

XrResult enumerateInstanceExtensionProperties(const char* layer, std::uint32_t capacity, std::uint32_t* count,
                                              XrExtensionProperties* into) {
  std::uint32_t all = 0;
  if (const XrResult r = behind.enumerateInstanceExtensionProperties(layer, 0, &all, nullptr); XR_FAILED(r)) return r;
  std::vector<XrExtensionProperties> list(all, {XR_TYPE_EXTENSION_PROPERTIES});
  if (const XrResult r = behind.enumerateInstanceExtensionProperties(layer, all, &all, list.data()); XR_FAILED(r))
    return r;
  const std::vector<std::string> hidden = split(valueOf("hide"), ':');
  std::erase_if(list, [&](const auto& one) { return std::ranges::find(hidden, one.extensionName) != hidden.end(); });
  return handOut(list, capacity, count, into);
}

XrResult createInstance(const XrInstanceCreateInfo* info, XrInstance* instance) {
  const std::vector<std::string> hidden = split(valueOf("hide"), ':');
  for (std::uint32_t i = 0; i < info->enabledExtensionCount; ++i)
    if (std::ranges::find(hidden, info->enabledExtensionNames[i]) != hidden.end())
      return XR_ERROR_EXTENSION_NOT_PRESENT;
  return behind.createInstance(info, instance);
}

namespace {
bool headsetIsAway() {
  const std::lock_guard lock(state->mutex);
  const std::optional<std::string> times = state->faults.active("no-headset");
  return times && (times->empty() || ++state->lookedFor <= std::stoi(*times));
}
}  // namespace

XrResult getSystem(XrInstance instance, const XrSystemGetInfo* info, XrSystemId* system) {
  return headsetIsAway() ? XR_ERROR_FORM_FACTOR_UNAVAILABLE : behind.getSystem(instance, info, system);
}

XrResult enumerateViewConfigurationViews(XrInstance instance, XrSystemId system, XrViewConfigurationType type,
                                         std::uint32_t capacity, std::uint32_t* count, XrViewConfigurationView* views) {
  const XrResult result = behind.enumerateViewConfigurationViews(instance, system, type, capacity, count, views);
  const std::vector<std::string> size = split(valueOf("odd-size"), 'x');
  for (std::uint32_t i = 0; size.size() == 2 && XR_SUCCEEDED(result) && i < std::min(capacity, *count); ++i) {
    views[i].recommendedImageRectWidth = std::uint32_t(std::stoul(size[0]));
    views[i].recommendedImageRectHeight = std::uint32_t(std::stoul(size[1]));
  }
  return result;
}

// --- The session's life.

XrResult createSession(XrInstance instance, const XrSessionCreateInfo* info, XrSession* session) {
  const XrResult result = behind.createSession(instance, info, session);
  if (XR_FAILED(result)) return result;
  const std::lock_guard lock(state->mutex);
  state->lost.erase(*session);  // handles are reused
  state->session = *session;
  state->events.clear();
  state->pause = Pause::none;
  state->running = false;
  state->record.session(*session);
  state->pictures.session(*info);
  return result;
}

XrResult destroySession(XrSession session) {
  {
    const std::lock_guard lock(state->mutex);
    if (session == state->session) state->running = false;
  }
  return behind.destroySession(session);
}

XrResult beginSession(XrSession session, const XrSessionBeginInfo* info) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  {
    const std::lock_guard lock(state->mutex);
    if (state->pause == Pause::ended) {
      state->pause = Pause::none;
      for (const auto to : {XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_VISIBLE, XR_SESSION_STATE_FOCUSED})
        tellState(to);
      return XR_SUCCESS;
    }
  }
  const XrResult result = behind.beginSession(session, info);
  if (XR_SUCCEEDED(result)) state->running = true;
  return result;
}

XrResult endSession(XrSession session) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  {
    const std::lock_guard lock(state->mutex);
    if (state->pause == Pause::requested) {
      state->pause = Pause::ended;
      for (const auto to : {XR_SESSION_STATE_IDLE, XR_SESSION_STATE_READY}) tellState(to);
      return XR_SUCCESS;
    }
  }
  return behind.endSession(session);
}

XrResult requestExitSession(XrSession session) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  if (!stands("loss-at-exit")) return behind.requestExitSession(session);
  const std::lock_guard lock(state->mutex);
  state->lost.insert(session);
  return XR_SUCCESS;
}

bool rests(XrSession session) {
  const std::lock_guard lock(state->mutex);
  return session == state->session && state->pause == Pause::ended;
}

void tellWhatIsDue() {
  Faults& faults = state->faults;
  if (faults.due("loss-pending")) tellState(XR_SESSION_STATE_LOSS_PENDING);
  if (faults.due("instance-loss")) tell(XrEventDataInstanceLossPending{XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING});
  if (faults.due("stopping")) {
    for (const auto to : {XR_SESSION_STATE_VISIBLE, XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_STOPPING})
      tellState(to);
    state->pause = Pause::requested;
  }
  if (const auto space = faults.due("recentre")) {
    XrEventDataReferenceSpaceChangePending event{XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING};
    event.session = state->session;
    event.referenceSpaceType = *space == "stage" ? XR_REFERENCE_SPACE_TYPE_STAGE : XR_REFERENCE_SPACE_TYPE_LOCAL;
    event.poseInPreviousSpace.orientation.w = 1;
    tell(event);
  }
  if (faults.due("mask-changed")) {
    XrEventDataVisibilityMaskChangedKHR event{XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR};
    event.session = state->session;
    event.viewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
    tell(event);
  }
}

XrResult pollEvent(XrInstance instance, XrEventDataBuffer* event) {
  bool exit = false;
  {
    const std::lock_guard lock(state->mutex);
    if (state->running) {
      tellWhatIsDue();
      exit = state->faults.due("exit").has_value();
    }
    if (!state->events.empty()) {
      *event = state->events.front();
      state->events.pop_front();
      state->record.event(*event);
      return XR_SUCCESS;
    }
  }
  if (exit) behind.requestExitSession(state->session);  // the runtime behind sends the whole sequence of states
  const XrResult result = behind.pollEvent(instance, event);
  const std::lock_guard lock(state->mutex);
  if (result == XR_SUCCESS) state->record.event(*event);
  return result;
}

}  // namespace ibr::test
