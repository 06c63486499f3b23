// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "support/gpu.h"

namespace ibr::test {

/// Handles of testDevice(), as an engine passes them, with all optional features that it has.
inline DeviceHandles testDeviceHandles() {
  const Device& device = testDevice();
  return {.instance = device.instance(),
          .physicalDevice = device.physicalDevice(),
          .device = device.handle(),
          .queue = device.queue(),
          .queueFamily = device.queueFamily(),
          .optionalFeatures = Device::featuresFor(device.physicalDevice()),
          .log = testLog()};
}

}  // namespace ibr::test
