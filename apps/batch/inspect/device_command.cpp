// SPDX-License-Identifier: Apache-2.0
#include "ibr/device.h"

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "batch/command.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

const char* typeName(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "processor";
    default:
      return "other";
  }
}

std::string versionText(std::uint32_t version) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                     VK_API_VERSION_PATCH(version));
}

ExitCode listDevices(const Context& context) {
  const auto devices = Device::list();
  const auto disabled = Device::disabledFeatures();
  Json report = Json::array();
  bool usable = false;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceDescription& device = devices[i];
    usable |= device.lacking.empty();
    context.print("{}  {}\n   {}, {}, Vulkan {}, {} of its own memory\n", i, device.name, typeName(device.type),
                  device.driver, versionText(device.apiVersion), bytesText(double(device.memoryBytes)));
    if (!device.features.empty()) context.print("   has {}\n", fmt::join(device.features, ", "));
    if (device.lacking.empty()) context.print("   can be used\n");
    for (const std::string& reason : device.lacking) context.print("   cannot be used: {}\n", reason);
    report.push_back({{"index", i},
                      {"name", device.name},
                      {"driver", device.driver},
                      {"type", typeName(device.type)},
                      {"apiVersion", versionText(device.apiVersion)},
                      {"memoryBytes", device.memoryBytes},
                      {"features", device.features},
                      {"lacking", device.lacking}});
  }
  if (devices.empty())
    context.print("no Vulkan device; on Debian, the package mesa-vulkan-drivers has one that needs no graphics card\n");
  if (!disabled.empty())
    context.print("disabled by --disable-feature or IBR_DISABLE_FEATURES: {}\n", fmt::join(disabled, ", "));
  context.report(
      Json{{"devices", report}, {"disabledFeatures", disabled}}.dump(2, ' ', false, Json::error_handler_t::replace));
  return usable ? kExitOk : kExitUnsupported;
}

}  // namespace

const Command kDeviceCommand{
    .name = "device",
    .summary = "Lists the Vulkan devices, and what each lacks",
    .examples = "ibr device\nibr device --json -",
    .details =
        "Exit code 5 where there is none that can be used. The number or a part of the name is what --device takes.",
    .afterInterrupt = "",
    .declare = [](CLI::App&) -> std::function<ExitCode(const Context&)> { return listDevices; }};

}  // namespace ibr::app
