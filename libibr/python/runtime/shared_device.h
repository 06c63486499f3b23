// SPDX-License-Identifier: Apache-2.0
// A device that several Python objects share. One thread at a time uses a Device, so all calls lock it.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <variant>

#include "ibr/device.h"

namespace ibr::python {

struct SharedDevice {
  explicit SharedDevice(const DeviceOptions& options) : device(Device::create(options)) {}

  Device device;
  std::recursive_mutex mutex;  // recursive: a callback may destroy or use another object of the device
};

/// A device, or the selector of one (DeviceOptions::device).
using DeviceChoice = std::variant<std::shared_ptr<SharedDevice>, std::string>;

/// Returns the device, or creates it. Messages go to Python's logger "ibr". Call it without the interpreter's lock.
std::shared_ptr<SharedDevice> deviceOf(const DeviceChoice& choice);

/// Locks a device for a call, without the interpreter's lock: the thread that has the device may wait for that.
class DeviceUse {
 public:
  explicit DeviceUse(SharedDevice& device) : locked_(device.mutex) {}

 private:
  pybind11::gil_scoped_release unlocked_;  // released before the mutex is locked, taken again after it is unlocked
  std::lock_guard<std::recursive_mutex> locked_;
};

}  // namespace ibr::python
