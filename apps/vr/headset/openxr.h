// SPDX-License-Identifier: Apache-2.0
// OpenXR helpers: results as exceptions, owning handles, conversion of poses.
#pragma once

#include <vulkan/vulkan.h>

#define XR_USE_GRAPHICS_API_VULKAN
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <utility>

#include "ibr/camera.h"

namespace ibr::app {

/// Returns successes; throws Error, naming call and result, for failures. Code deviceLost: session or instance are lost
/// and may be created again. Other codes: outOfMemory, unsupported, else vulkan.
XrResult xr(XrResult result, const char* call);

/// Loads a function of an extension. Throws Error{unsupported} if the instance lacks the extension.
PFN_xrVoidFunction xrFunction(XrInstance instance, const char* name);
template <class Function>
Function xrFunction(XrInstance instance, const char* name) {
  return reinterpret_cast<Function>(xrFunction(instance, name));
}

/// Move-only owner. Holds XR_NULL_HANDLE after default construction or a move.
template <class T, auto Destroy>
class XrOwner {
 public:
  XrOwner() = default;
  explicit XrOwner(T handle) noexcept : handle_(handle) {}
  XrOwner(XrOwner&& other) noexcept : handle_(std::exchange(other.handle_, XR_NULL_HANDLE)) {}
  XrOwner& operator=(XrOwner&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~XrOwner() {
    if (handle_ != XR_NULL_HANDLE) Destroy(handle_);
  }
  T get() const noexcept { return handle_; }

 private:
  T handle_ = XR_NULL_HANDLE;
};

using XrInstanceOwner = XrOwner<XrInstance, xrDestroyInstance>;
using XrSessionOwner = XrOwner<XrSession, xrDestroySession>;
using XrSpaceOwner = XrOwner<XrSpace, xrDestroySpace>;
using XrSwapchainOwner = XrOwner<XrSwapchain, xrDestroySwapchain>;
using XrActionSetOwner = XrOwner<XrActionSet, xrDestroyActionSet>;

/// Creates a handle: xrMake<XrSpaceOwner>(xrCreateReferenceSpace, session, info, "xrCreateReferenceSpace").
template <class Owner, class Create, class Parent, class Info>
Owner xrMake(Create create, Parent parent, const Info& info, const char* call) {
  decltype(Owner().get()) handle = XR_NULL_HANDLE;
  xr(create(parent, &info, &handle), call);
  return Owner(handle);
}

inline constexpr XrPosef kXrIdentity{{0, 0, 0, 1}, {0, 0, 0}};

/// Positions in metres. Normalises rotations, which runtimes may round.
Pose poseOf(const XrPosef& pose);
XrPosef xrPoseOf(const Pose& pose);

/// Returns true if intrinsicsOf accepts the field of view.
bool isValidFov(const XrFovf& fov) noexcept;
/// Returns a pinhole of this size. Throws Error{invalidInput} for angles that no pinhole has.
Intrinsics intrinsicsOf(const XrFovf& fov, int width, int height);

}  // namespace ibr::app
