// SPDX-License-Identifier: Apache-2.0
// An OpenXR runtime in front of another runtime. Passes all calls on, except for the requested faults,
// and records the frames that a program submits. An API layer would not suffice: the loader asks the runtime itself
// for the extensions.
//
// Environment variables: IBR_XR_RUNTIME_BEHIND, the file of the other runtime's library; IBR_XR_FAULTS (faults.h);
// IBR_XR_RECORD, a file (frame_record.h); IBR_XR_PICTURES, a folder (submitted_pictures.h). Calls may come from several
// threads.
#pragma once

#include <openxr/openxr.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "faults.h"
#include "frame_record.h"
#include "submitted_pictures.h"

namespace ibr::test {

/// Functions of the runtime behind, filled in when the loader requests each function.
struct Behind {
  PFN_xrGetInstanceProcAddr getInstanceProcAddr = nullptr;
  PFN_xrEnumerateInstanceExtensionProperties enumerateInstanceExtensionProperties = nullptr;
  PFN_xrCreateInstance createInstance = nullptr;
  PFN_xrGetSystem getSystem = nullptr;
  PFN_xrEnumerateViewConfigurationViews enumerateViewConfigurationViews = nullptr;
  PFN_xrCreateSession createSession = nullptr;
  PFN_xrDestroySession destroySession = nullptr;
  PFN_xrBeginSession beginSession = nullptr;
  PFN_xrEndSession endSession = nullptr;
  PFN_xrRequestExitSession requestExitSession = nullptr;
  PFN_xrPollEvent pollEvent = nullptr;
  PFN_xrEnumerateReferenceSpaces enumerateReferenceSpaces = nullptr;
  PFN_xrCreateReferenceSpace createReferenceSpace = nullptr;
  PFN_xrCreateActionSpace createActionSpace = nullptr;
  PFN_xrLocateSpace locateSpace = nullptr;
  PFN_xrLocateViews locateViews = nullptr;
  PFN_xrSyncActions syncActions = nullptr;
  PFN_xrEnumerateSwapchainFormats enumerateSwapchainFormats = nullptr;
  PFN_xrCreateSwapchain createSwapchain = nullptr;
  PFN_xrEnumerateSwapchainImages enumerateSwapchainImages = nullptr;
  PFN_xrAcquireSwapchainImage acquireSwapchainImage = nullptr;
  PFN_xrWaitSwapchainImage waitSwapchainImage = nullptr;
  PFN_xrReleaseSwapchainImage releaseSwapchainImage = nullptr;
  PFN_xrGetVisibilityMaskKHR getVisibilityMask = nullptr;
  PFN_xrWaitFrame waitFrame = nullptr;
  PFN_xrBeginFrame beginFrame = nullptr;
  PFN_xrEndFrame endFrame = nullptr;
};
extern Behind behind;

/// Progress of a session that was stopped temporarily by the fault "stopping".
enum class Pause { none, requested, ended };

struct State {
  std::mutex mutex;  // guards all members
  Faults faults;
  FrameRecord record;
  SubmittedPictures pictures;
  std::deque<XrEventDataBuffer> events;  // generated events, delivered before the runtime's own
  std::set<XrSession> lost;
  XrSession session = XR_NULL_HANDLE;  // the most recently created session
  bool running = false;
  int lookedFor = 0;  // number of times a missing headset was looked for
  Pause pause = Pause::none;

  State(const char* words, const char* file, const char* folder) : faults(words), record(file), pictures(folder) {}
};
/// Frames are counted across instances. The library must therefore stay loaded after the loader unloads it; the library
/// is linked to be permanent.
extern State* state;

/// Returns whether a fault is active at this frame; valueOf returns its value, or an empty string.
bool stands(const char* name);
std::string valueOf(const char* name);
std::vector<std::string> split(const std::string& value, char by);

/// Returns whether the session is lost, including a loss that is due at this frame.
bool isLost(XrSession session);
template <class Handle>
bool ownerIsLost(Handle handle) {
  XrSession owner;
  {
    const std::lock_guard lock(state->mutex);
    owner = state->record.ownerOf(handle);
  }
  return isLost(owner);
}

/// Returns whether the session was stopped and has ended, so that frames are errors of the program.
bool rests(XrSession session);

/// Returns a list with OpenXR's two-call idiom.
template <class T>
XrResult handOut(const std::vector<T>& list, std::uint32_t capacity, std::uint32_t* count, T* into) {
  *count = std::uint32_t(list.size());
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < list.size()) return XR_ERROR_SIZE_INSUFFICIENT;
  std::ranges::copy(list, into);
  return XR_SUCCESS;
}

// Replacements of the runtime's functions.

XrResult enumerateInstanceExtensionProperties(const char* layer, std::uint32_t capacity, std::uint32_t* count,
                                              XrExtensionProperties* into);
XrResult createInstance(const XrInstanceCreateInfo* info, XrInstance* instance);
XrResult getSystem(XrInstance instance, const XrSystemGetInfo* info, XrSystemId* system);
XrResult enumerateViewConfigurationViews(XrInstance instance, XrSystemId system, XrViewConfigurationType type,
                                         std::uint32_t capacity, std::uint32_t* count, XrViewConfigurationView* views);
XrResult createSession(XrInstance instance, const XrSessionCreateInfo* info, XrSession* session);
XrResult destroySession(XrSession session);
XrResult beginSession(XrSession session, const XrSessionBeginInfo* info);
XrResult endSession(XrSession session);
XrResult requestExitSession(XrSession session);
XrResult pollEvent(XrInstance instance, XrEventDataBuffer* event);
XrResult enumerateReferenceSpaces(XrSession session, std::uint32_t capacity, std::uint32_t* count,
                                  XrReferenceSpaceType* into);
XrResult createReferenceSpace(XrSession session, const XrReferenceSpaceCreateInfo* info, XrSpace* space);
XrResult createActionSpace(XrSession session, const XrActionSpaceCreateInfo* info, XrSpace* space);
XrResult locateSpace(XrSpace space, XrSpace base, XrTime time, XrSpaceLocation* location);
XrResult locateViews(XrSession session, const XrViewLocateInfo* info, XrViewState* flags, std::uint32_t capacity,
                     std::uint32_t* count, XrView* views);
XrResult syncActions(XrSession session, const XrActionsSyncInfo* info);
XrResult getVisibilityMask(XrSession session, XrViewConfigurationType type, std::uint32_t view,
                           XrVisibilityMaskTypeKHR kind, XrVisibilityMaskKHR* mask);
XrResult enumerateSwapchainFormats(XrSession session, std::uint32_t capacity, std::uint32_t* count, std::int64_t* into);
XrResult createSwapchain(XrSession session, const XrSwapchainCreateInfo* info, XrSwapchain* swapchain);
XrResult acquireSwapchainImage(XrSwapchain swapchain, const XrSwapchainImageAcquireInfo* info, std::uint32_t* index);
XrResult waitSwapchainImage(XrSwapchain swapchain, const XrSwapchainImageWaitInfo* info);
XrResult releaseSwapchainImage(XrSwapchain swapchain, const XrSwapchainImageReleaseInfo* info);
XrResult waitFrame(XrSession session, const XrFrameWaitInfo* info, XrFrameState* frame);
XrResult beginFrame(XrSession session, const XrFrameBeginInfo* info);
XrResult endFrame(XrSession session, const XrFrameEndInfo* info);

}  // namespace ibr::test
