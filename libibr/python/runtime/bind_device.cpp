// SPDX-License-Identifier: Apache-2.0
#include "ibr/device.h"

#include "runtime/bind.h"
#include "runtime/shared_device.h"
#include "support/calls.h"
#include "support/record.h"
#include "support/runtime_enums.h"

namespace fs = std::filesystem;
namespace py = pybind11;

namespace ibr::python {

std::shared_ptr<SharedDevice> deviceOf(const DeviceChoice& choice) {
  if (const auto* device = std::get_if<std::shared_ptr<SharedDevice>>(&choice)) {
    if (!*device) throw Error(ErrorCode::invalidInput, "device: must not be None");
    return *device;
  }
  return std::make_shared<SharedDevice>(DeviceOptions{.device = std::get<std::string>(choice), .log = logToPython()});
}

namespace {

std::shared_ptr<SharedDevice> makeDevice(const std::string& device, bool validation,
                                         const std::optional<fs::path>& pipelineCache,
                                         const std::string& disabledFeatures) {
  DeviceOptions options{.device = device, .validation = validation, .log = logToPython()};
  options.pipelineCache = pipelineCache.value_or(fs::path());
  options.disabledFeatures = disabledFeatures;
  return unlocked([&] { return std::make_shared<SharedDevice>(options); });
}

py::tuple versionOf(const DeviceDescription& device) {
  return py::make_tuple(VK_API_VERSION_MAJOR(device.apiVersion), VK_API_VERSION_MINOR(device.apiVersion),
                        VK_API_VERSION_PATCH(device.apiVersion));
}

}  // namespace

void bindDevice(py::module_& module) {
  using D = DeviceDescription;
  Record<D> description(module, "DeviceDescription", "A Vulkan device of this machine: list_devices().");
  description.field("name", &D::name, "Name")
      .field("driver", &D::driver, "Driver and its version")
      .field("memory_bytes", &D::memoryBytes, "Device-local memory")
      .field("features", &D::features, "Tuple of its optional features")
      .field("missing", &D::missing, "Tuple of missing requirements; empty: libibr can use the device");
  description.type()
      .def_property_readonly("api_version", &versionOf, "Vulkan version (major, minor, patch)")
      .def_property_readonly(
          "kind", [](const D& self) { return deviceKindOf(self.type); }, "DeviceKind");

  py::class_<SharedDevice, std::shared_ptr<SharedDevice>>(
      module, "Device",
      "A Vulkan device. `device`: index or part of the name; '' takes IBR_DEVICE, else a discrete, an integrated or a "
      "software device. Several objects and threads may share one; their calls then wait for each other. Messages go "
      "to "
      "the logger 'ibr'.")
      .def(py::init(&makeDevice), py::arg("device") = "", py::kw_only(), py::arg("validation") = false,
           py::arg("pipeline_cache") = py::none(), py::arg("disabled_features") = "")
      .def_property_readonly(
          "name", [](const SharedDevice& self) { return self.device.name(); }, "Device and driver version")
      .def_property_readonly(
          "kind", [](const SharedDevice& self) { return self.device.kind(); }, "DeviceKind")
      .def_property_readonly(
          "is_lost", [](const SharedDevice& self) { return self.device.isLost(); },
          "True after a call has found the device lost: make it and its objects again")
      .def_property_readonly(
          "validation_messages", [](const SharedDevice& self) { return self.device.validationMessages(); },
          "Number of messages from the validation layer")
      .def("__repr__", [](const SharedDevice& self) { return "<Device " + self.device.name() + ">"; });

  module.def(
      "list_devices", [] { return toPython(unlocked([] { return Device::list(); })); },
      "Tuple of DeviceDescription; empty where no driver is installed.");
  module.def(
      "preferred_device", [](const std::string& device) { return Device::preferred(device); }, py::arg("device") = "",
      py::call_guard<py::gil_scoped_release>(),
      "DeviceDescription of the device that Device(device) takes; None where that would fail.");
}

}  // namespace ibr::python
