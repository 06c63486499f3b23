// SPDX-License-Identifier: Apache-2.0
// How a loader of OpenXR and a runtime meet, from the loader's specification ("Runtime Interface Negotiation"):
// Debian's package of the headers leaves it out.
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
