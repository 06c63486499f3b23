// SPDX-License-Identifier: Apache-2.0
// OpenXR as the program uses it: results as exceptions, owners of handles, poses in our types.
#pragma once

#include <vulkan/vulkan.h>

#define XR_USE_GRAPHICS_API_VULKAN
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <utility>

#include "ibr/camera.h"

namespace ibr::app {

/// Throws Error that names call and result where it is a failure: deviceLost where session, instance or runtime are
/// gone, so that making them anew may go on; outOfMemory, unsupported, else vulkan. Gives successes back.
XrResult xr(XrResult result, const char* call);

/// What an instance without the extension does not have. Throws Error{unsupported}.
PFN_xrVoidFunction xrFunction(XrInstance instance, const char* name);
template <class Function>
Function xrFunction(XrInstance instance, const char* name) {
  return reinterpret_cast<Function>(xrFunction(instance, name));
}

/// Move-only. A default-made or moved-from one holds XR_NULL_HANDLE.
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

/// xrMake<XrSpaceOwner>(xrCreateReferenceSpace, session, info, "xrCreateReferenceSpace"). Throws as xr().
template <class Owner, class Create, class Parent, class Info>
Owner xrMake(Create create, Parent parent, const Info& info, const char* call) {
  decltype(Owner().get()) handle = XR_NULL_HANDLE;
  xr(create(parent, &info, &handle), call);
  return Owner(handle);
}

inline constexpr XrPosef kXrIdentity{{0, 0, 0, 1}, {0, 0, 0}};

/// Metres. Rotations that runtimes round are of unit length again.
Pose poseOf(const XrPosef& pose);
XrPosef xrPoseOf(const Pose& pose);

/// Whether intrinsicsOf has an answer.
bool makesPicture(const XrFovf& fov) noexcept;
/// A pinhole of that size. Throws Error{invalidInput} where the angles make no picture.
Intrinsics intrinsicsOf(const XrFovf& fov, int width, int height);

}  // namespace ibr::app
