// SPDX-License-Identifier: Apache-2.0
#include "vr/headset/openxr.h"

#include <openxr/openxr_reflection.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "base/check.h"

namespace ibr::app {
namespace {

const char* nameOf(XrResult result) noexcept {
  switch (result) {
#define IBR_XR_NAME(name, value) \
  case name:                     \
    return #name;
    XR_LIST_ENUM_XrResult(IBR_XR_NAME)
#undef IBR_XR_NAME
        default : return "an unknown XrResult";
  }
}

// Returns a hint for the user; "" if there is none.
const char* adviceFor(XrResult result) noexcept {
  switch (result) {
    case XR_ERROR_RUNTIME_UNAVAILABLE:
      return ": is an OpenXR runtime installed, active (XR_RUNTIME_JSON) and running?";
    case XR_ERROR_FORM_FACTOR_UNAVAILABLE:
      return ": is the headset connected and switched on?";
    case XR_ERROR_FORM_FACTOR_UNSUPPORTED:
      return ": the runtime does not support headsets";
    default:
      return "";
  }
}

ErrorCode codeOf(XrResult result) noexcept {
  switch (result) {
    case XR_ERROR_SESSION_LOST:
    case XR_ERROR_INSTANCE_LOST:
      return ErrorCode::deviceLost;
    case XR_ERROR_OUT_OF_MEMORY:
    case XR_ERROR_LIMIT_REACHED:
      return ErrorCode::outOfMemory;
    case XR_ERROR_RUNTIME_UNAVAILABLE:
    case XR_ERROR_RUNTIME_FAILURE:
    case XR_ERROR_FORM_FACTOR_UNAVAILABLE:
    case XR_ERROR_FORM_FACTOR_UNSUPPORTED:
    case XR_ERROR_API_VERSION_UNSUPPORTED:
    case XR_ERROR_FUNCTION_UNSUPPORTED:
    case XR_ERROR_EXTENSION_NOT_PRESENT:
      return ErrorCode::unsupported;
    default:
      return ErrorCode::vulkan;
  }
}

}  // namespace

XrResult xr(XrResult result, const char* call) {
  check(XR_SUCCEEDED(result), codeOf(result), "{}: {}{}", call, nameOf(result), adviceFor(result));
  return result;
}

PFN_xrVoidFunction xrFunction(XrInstance instance, const char* name) {
  PFN_xrVoidFunction function = nullptr;
  xr(xrGetInstanceProcAddr(instance, name, &function), name);
  return function;
}

Pose poseOf(const XrPosef& pose) {
  const glm::dquat rotation{double(pose.orientation.w), double(pose.orientation.x), double(pose.orientation.y),
                            double(pose.orientation.z)};
  const double length = glm::length(rotation);
  return {{double(pose.position.x), double(pose.position.y), double(pose.position.z)},
          length > 0 ? rotation / length : glm::dquat(1, 0, 0, 0)};
}

XrPosef xrPoseOf(const Pose& pose) {
  return {{float(pose.rotation.x), float(pose.rotation.y), float(pose.rotation.z), float(pose.rotation.w)},
          {float(pose.position.x), float(pose.position.y), float(pose.position.z)}};
}

bool isValidFov(const XrFovf& fov) noexcept {
  constexpr float kMaxHalfAngle = 1.569f;  // rad, 89.9°: bounds the tangents
  const auto spans = [](float low, float high) { return low >= -kMaxHalfAngle && low < high && high <= kMaxHalfAngle; };
  return spans(fov.angleLeft, fov.angleRight) && spans(fov.angleDown, fov.angleUp);
}

Intrinsics intrinsicsOf(const XrFovf& fov, int width, int height) {
  return pinholeFromTangents(width, height, std::tan(double(fov.angleLeft)), std::tan(double(fov.angleRight)),
                             std::tan(double(fov.angleUp)), std::tan(double(fov.angleDown)));
}

}  // namespace ibr::app
