// SPDX-License-Identifier: Apache-2.0
// Interface between an OpenXR loader and a runtime, from the loader's specification ("Runtime Interface Negotiation").
// Debian's header package does not include the interface.
#pragma once

#include <openxr/openxr.h>

#include <cstddef>
#include <cstdint>

namespace ibr::test {

struct XrNegotiateLoaderInfo;

struct XrNegotiateRuntimeRequest {
  std::uint32_t structType;  // 3
  std::uint32_t structVersion;
  std::size_t structSize;
  std::uint32_t runtimeInterfaceVersion;
  XrVersion runtimeApiVersion;
  PFN_xrGetInstanceProcAddr getInstanceProcAddr;
};
static_assert(sizeof(XrNegotiateRuntimeRequest) == 40 &&
              offsetof(XrNegotiateRuntimeRequest, getInstanceProcAddr) == 32);

using NegotiateRuntime = XrResult (*)(const XrNegotiateLoaderInfo* loader, XrNegotiateRuntimeRequest* request);

}  // namespace ibr::test
