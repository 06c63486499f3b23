// SPDX-License-Identifier: Apache-2.0
// Spaces and views, swapchains, frames.
#include <limits>

#include "fault_runtime.h"

namespace ibr::test {

// --- Spaces and views.

XrResult enumerateReferenceSpaces(XrSession session, std::uint32_t capacity, std::uint32_t* count,
                                  XrReferenceSpaceType* into) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  std::uint32_t all = 0;
  if (const XrResult r = behind.enumerateReferenceSpaces(session, 0, &all, nullptr); XR_FAILED(r)) return r;
  std::vector<XrReferenceSpaceType> list(all);
  if (const XrResult r = behind.enumerateReferenceSpaces(session, all, &all, list.data()); XR_FAILED(r)) return r;
  if (stands("no-stage")) std::erase(list, XR_REFERENCE_SPACE_TYPE_STAGE);
  return handOut(list, capacity, count, into);
}

XrResult createReferenceSpace(XrSession session, const XrReferenceSpaceCreateInfo* info, XrSpace* space) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  const XrReferenceSpaceType type = info->referenceSpaceType;
  if (type == XR_REFERENCE_SPACE_TYPE_STAGE && stands("no-stage")) return XR_ERROR_REFERENCE_SPACE_UNSUPPORTED;
  const XrResult result = behind.createReferenceSpace(session, info, space);
  const std::lock_guard lock(state->mutex);
  if (XR_SUCCEEDED(result))
    state->record.space(*space, session,
                        type == XR_REFERENCE_SPACE_TYPE_VIEW    ? "VIEW"
                        : type == XR_REFERENCE_SPACE_TYPE_LOCAL ? "LOCAL"
                        : type == XR_REFERENCE_SPACE_TYPE_STAGE ? "STAGE"
                                                                : std::to_string(type));
  return result;
}

XrResult createActionSpace(XrSession session, const XrActionSpaceCreateInfo* info, XrSpace* space) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  const XrResult result = behind.createActionSpace(session, info, space);
  const std::lock_guard lock(state->mutex);
  if (XR_SUCCEEDED(result)) state->record.space(*space, session, "action");
  return result;
}

XrResult locateSpace(XrSpace space, XrSpace base, XrTime time, XrSpaceLocation* location) {
  return ownerIsLost(space) ? XR_ERROR_SESSION_LOST : behind.locateSpace(space, base, time, location);
}

XrResult locateViews(XrSession session, const XrViewLocateInfo* info, XrViewState* flags, std::uint32_t capacity,
                     std::uint32_t* count, XrView* views) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  const XrResult result = behind.locateViews(session, info, flags, capacity, count, views);
  if (XR_FAILED(result) || capacity < *count) return result;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const bool nowhere = stands("no-view-pose"), half = stands("half-view-pose");
  if (nowhere) flags->viewStateFlags = 0;
  if (half) flags->viewStateFlags = XR_VIEW_STATE_ORIENTATION_VALID_BIT;
  for (std::uint32_t i = 0; i < *count; ++i) {
    if (nowhere) views[i].pose.orientation = {kNan, kNan, kNan, kNan};
    if (nowhere || half) views[i].pose.position = {kNan, kNan, kNan};
  }
  const std::lock_guard lock(state->mutex);
  state->record.located(*info, views, *count);
  return result;
}

XrResult syncActions(XrSession session, const XrActionsSyncInfo* info) {
  return isLost(session) ? XR_ERROR_SESSION_LOST : behind.syncActions(session, info);
}

XrResult getVisibilityMask(XrSession session, XrViewConfigurationType type, std::uint32_t view,
                           XrVisibilityMaskTypeKHR kind, XrVisibilityMaskKHR* mask) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  const bool half = stands("half-mask") && kind == XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR;
  if (!half && !stands("empty-mask")) return behind.getVisibilityMask(session, type, view, kind, mask);
  // Triangles on the plane z = −1 of a view, wider than any field of view in the tests.
  std::vector<XrVector2f> vertices{{-9, -9}, {0, -9}, {0, 9}, {-9, 9}};
  std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
  if (!half) vertices.clear(), indices.clear();
  const XrResult first = handOut(vertices, mask->vertexCapacityInput, &mask->vertexCountOutput, mask->vertices);
  const XrResult second = handOut(indices, mask->indexCapacityInput, &mask->indexCountOutput, mask->indices);
  return XR_FAILED(first) ? first : second;
}

// --- Swapchains.

XrResult enumerateSwapchainFormats(XrSession session, std::uint32_t capacity, std::uint32_t* count,
                                   std::int64_t* into) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  if (!stands("formats")) return behind.enumerateSwapchainFormats(session, capacity, count, into);
  std::vector<std::int64_t> formats;
  for (const std::string& word : split(valueOf("formats"), ':')) formats.push_back(std::stoll(word));
  return handOut(formats, capacity, count, into);
}

XrResult createSwapchain(XrSession session, const XrSwapchainCreateInfo* info, XrSwapchain* swapchain) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  if (stands("no-swapchain")) return XR_ERROR_RUNTIME_FAILURE;
  if (info->arraySize > 1 && stands("no-array")) return XR_ERROR_FEATURE_UNSUPPORTED;
  const std::vector<std::string> formats = split(valueOf("formats"), ':');
  if (!formats.empty() && std::ranges::find(formats, std::to_string(info->format)) == formats.end())
    return XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED;
  XrSwapchainCreateInfo readable = *info;
  if (state->pictures.active()) readable.usageFlags |= XR_SWAPCHAIN_USAGE_TRANSFER_SRC_BIT;
  const XrResult result = behind.createSwapchain(session, &readable, swapchain);
  if (XR_FAILED(result)) return result;
  const std::lock_guard lock(state->mutex);
  state->record.swapchain(*swapchain, session, *info);
  state->pictures.swapchain(*swapchain, behind.enumerateSwapchainImages);
  return result;
}

XrResult acquireSwapchainImage(XrSwapchain swapchain, const XrSwapchainImageAcquireInfo* info, std::uint32_t* index) {
  if (ownerIsLost(swapchain)) return XR_ERROR_SESSION_LOST;
  const XrResult result = behind.acquireSwapchainImage(swapchain, info, index);
  const std::lock_guard lock(state->mutex);
  if (XR_SUCCEEDED(result)) state->record.acquired(swapchain, *index);
  return result;
}

XrResult waitSwapchainImage(XrSwapchain swapchain, const XrSwapchainImageWaitInfo* info) {
  return ownerIsLost(swapchain) ? XR_ERROR_SESSION_LOST : behind.waitSwapchainImage(swapchain, info);
}

XrResult releaseSwapchainImage(XrSwapchain swapchain, const XrSwapchainImageReleaseInfo* info) {
  if (ownerIsLost(swapchain)) return XR_ERROR_SESSION_LOST;
  const XrResult result = behind.releaseSwapchainImage(swapchain, info);
  const std::lock_guard lock(state->mutex);
  if (XR_SUCCEEDED(result)) state->record.released(swapchain);
  return result;
}

// --- Frames.

XrResult waitFrame(XrSession session, const XrFrameWaitInfo* info, XrFrameState* frame) {
  {
    const std::lock_guard lock(state->mutex);
    state->faults.nextFrame();
  }
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  if (rests(session)) return XR_ERROR_SESSION_NOT_RUNNING;
  const XrResult result = behind.waitFrame(session, info, frame);
  if (XR_FAILED(result)) return result;
  if (stands("not-rendered")) frame->shouldRender = XR_FALSE;
  const std::lock_guard lock(state->mutex);
  state->record.waited(*frame);
  return result;
}

XrResult beginFrame(XrSession session, const XrFrameBeginInfo* info) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  if (rests(session)) return XR_ERROR_SESSION_NOT_RUNNING;
  const XrResult result = behind.beginFrame(session, info);
  const std::lock_guard lock(state->mutex);
  if (XR_SUCCEEDED(result)) state->record.begun();
  return result == XR_SUCCESS && state->faults.active("frame-discarded") ? XR_FRAME_DISCARDED : result;
}

XrResult endFrame(XrSession session, const XrFrameEndInfo* info) {
  if (isLost(session)) return XR_ERROR_SESSION_LOST;
  if (rests(session)) return XR_ERROR_SESSION_NOT_RUNNING;
  {
    const std::lock_guard lock(state->mutex);
    state->pictures.frame(*info, state->record);
  }
  const XrResult result = behind.endFrame(session, info);
  const std::lock_guard lock(state->mutex);
  state->record.ended(state->faults.frame(), *info, result);
  return result;
}

}  // namespace ibr::test
