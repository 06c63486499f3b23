// SPDX-License-Identifier: Apache-2.0
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "base/child_process.h"
#include "base/file.h"
#include "base/usage.h"
#include "batch/doctor/findings.h"
#include "ibr/device.h"
#include "shared/json/json_text.h"
#include "shared/report/table.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr double kGiB = 1024.0 * 1024 * 1024;
constexpr double kMinFreeMemory = 2 * kGiB;  // free memory, bytes, enough for photographs of 24 megapixels
constexpr double kLowDiskBytes = 5 * kGiB, kMinDiskBytes = 0.2 * kGiB;
constexpr auto kVersionTimeout = std::chrono::seconds(5);  // time limit for a program to print its version
constexpr std::size_t kMaxVersionBytes = 200;              // of the printed line, bytes

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

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

std::string describe(std::size_t index, const DeviceDescription& device) {
  return fmt::format("Vulkan device {}: {} ({}), driver {}, Vulkan {}, {} of device memory{}{}", index, device.name,
                     typeName(device.type), device.driver, versionText(device.apiVersion),
                     bytesText(double(device.memoryBytes)),
                     device.features.empty() ? "" : ", features: ", fmt::join(device.features, ", "));
}

std::string reasonForNoDevice() {
  try {
    Device::create();
  } catch (const Error& e) {
    return e.what();
  }
  return "none is listed";
}

void examineDevices(Findings& findings) {
  constexpr const char* kRemedy =
      "Install the driver of the graphics card. On Debian, the package mesa-vulkan-drivers has drivers for AMD and "
      "Intel, and a software driver.";
  std::vector<DeviceDescription> devices;
  try {
    devices = Device::list();
  } catch (const Error& e) {
    findings.add({"device", Severity::serious, fmt::format("Vulkan cannot be initialised: {}.", e.what()), kRemedy,
                  kExitUnsupported});
    return;
  }
  bool usable = false, graphicsCard = false;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceDescription& device = devices[i];
    findings.device({{"index", i},
                     {"name", device.name},
                     {"driver", device.driver},
                     {"type", typeName(device.type)},
                     {"apiVersion", versionText(device.apiVersion)},
                     {"memoryBytes", device.memoryBytes},
                     {"features", device.features},
                     {"missing", device.missing}});
    std::string why;
    for (const std::string& reason : device.missing) why += (why.empty() ? "" : ", ") + reason;
    if (!why.empty()) {
      findings.add({"device", Severity::hint,
                    fmt::format("Vulkan device {}, {}, cannot be used: {}.", i, device.name, why),
                    "A newer driver may help.", kExitUnsupported});
      continue;
    }
    usable = true;
    graphicsCard |= deviceKindOf(device.type) == DeviceKind::hardware;
    findings.fact(describe(i, device));
  }
  if (const auto disabled = Device::disabledFeatures(); !disabled.empty())
    findings.add({"device", Severity::hint,
                  fmt::format("Disabled features of the Vulkan device: {}.", fmt::join(disabled, ", ")),
                  "Unset IBR_DISABLE_FEATURES, or omit --disable-feature."});
  if (!usable)
    findings.add({"device", Severity::serious,
                  devices.empty() ? fmt::format("There is no Vulkan device: {}.", reasonForNoDevice())
                                  : "No Vulkan device can be used.",
                  kRemedy, kExitUnsupported});
  else if (!graphicsCard)
    findings.add(
        {"device", Severity::warning,
         "Images are rendered on the CPU: correct, but an image of one megapixel takes tenths of a second, too slow "
         "for a headset.",
         "If this machine has a graphics card, install its driver."});
}

struct Program {
  bool there = false;
  std::string version;  // first line with the expected beginning; empty if `trouble` says why there is none
  std::string trouble;
};

Program look(const std::vector<std::string>& command, std::string_view begins) {
  Program program;
  std::string first;
  const auto end = std::chrono::steady_clock::now() + kVersionTimeout;
  try {
    const ChildResult result = runChild(
        command, {},
        [&](std::string_view line) {
          if (first.empty()) first = line.substr(0, kMaxVersionBytes);
          if (program.version.empty() && line.starts_with(begins)) program.version = line.substr(0, kMaxVersionBytes);
        },
        [&] { return std::chrono::steady_clock::now() < end; });
    program.there = true;
    if (result.stopped)
      program.trouble = fmt::format("the program did not end within {} seconds", kVersionTimeout.count());
    else if (result.status != 0)
      program.trouble = fmt::format("exit code {}{}{}", result.status, first.empty() ? "" : ": ", first);
    else if (program.version.empty())
      program.trouble = first.empty() ? "the program prints nothing" : "the program prints: " + first;
  } catch (const Error&) {  // not installed, or cannot be started
  }
  return program;
}

std::string brokenText(const char* name, const Program& program) {
  return fmt::format("The program {} is installed but does not print its version: {}.", name, program.trouble);
}

void examineColmap(Findings& findings) {
  const Program colmap = look({"colmap", "help"}, "COLMAP ");
  if (!colmap.there)
    findings.add({"colmap", Severity::warning,
                  "The program COLMAP is not installed: photographs without poses cannot be built.",
                  "Install COLMAP (Debian: apt-get install colmap), or give poses (--model)."});
  else if (!colmap.trouble.empty())
    findings.add(
        {"colmap", Severity::warning, brokenText("COLMAP", colmap), "Reinstall COLMAP, or give poses (--model)."});
  else
    findings.fact(fmt::format("poses: {}", colmap.version));
  int major = 0, minor = 0;
  if (std::sscanf(colmap.version.c_str(), "COLMAP %d.%d", &major, &minor) == 2 &&
      (major < 3 || (major == 3 && minor < 8)))
    findings.add({"colmap", Severity::warning, fmt::format("COLMAP {}.{} is too old.", major, minor),
                  "Install COLMAP 3.8 or later."});
}

void examineFfmpeg(Findings& findings) {
  const Program ffmpeg = look({"ffmpeg", "-version"}, "ffmpeg version ");
  if (!ffmpeg.there)
    findings.add({"ffmpeg", Severity::hint,
                  "The program ffmpeg is not installed: images of a walk cannot be encoded as a video.",
                  "Install ffmpeg (Debian: apt-get install ffmpeg)."});
  else if (!ffmpeg.trouble.empty())
    findings.add({"ffmpeg", Severity::hint, brokenText("ffmpeg", ffmpeg),
                  "Reinstall ffmpeg to encode images of a walk as a video."});
  else
    findings.fact("videos: " + ffmpeg.version.substr(0, ffmpeg.version.find(" Copyright")));
}

void examineMemory(Findings& findings) {
  std::ifstream file("/proc/meminfo");
  double available = -1, total = -1;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string key;
    double kibibytes = 0;
    if (!(words >> key >> kibibytes)) continue;
    if (key == "MemTotal:") total = 1024 * kibibytes;
    if (key == "MemAvailable:") available = 1024 * kibibytes;
  }
  if (total < 0 || available < 0) return;
  const double limit = memoryLimit();
  const bool limited = limit < available;  // by a container or ulimit rather than by other programs' memory
  available = std::min(available, limit);
  findings.fact(fmt::format("{} processor cores, {} of {} of memory free", std::thread::hardware_concurrency(),
                            bytesText(available), bytesText(std::min(total, limit))));
  if (available < kMinFreeMemory)
    findings.add({"memory", Severity::warning,
                  limited ? fmt::format("Memory is limited to {} for this process.", bytesText(available))
                          : fmt::format("Only {} of memory is free.", bytesText(available)),
                  limited
                      ? "Raise the limit of the container or of the shell (ulimit -v), or build smaller photographs "
                        "(--max-size 1600)."
                      : "Close other programs, or build smaller photographs (--max-size 1600)."});
}

void examineDisk(Findings& findings) {
  std::error_code error;
  const fs::path here = fs::current_path(error);
  const fs::space_info space = fs::space(here, error);
  if (error) return;
  const auto left = double(space.available);
  if (left < kLowDiskBytes)
    findings.add(
        {"disk", left < kMinDiskBytes ? Severity::serious : Severity::warning,
         fmt::format("Only {} of disk space is left in {}.", bytesText(left), here.string()),
         "A scene needs up to six bytes per pixel of its photographs: free disk space, or build with --texture "
         "bc7.",
         kExitIo});
  else
    findings.fact(fmt::format("{} of disk space left in {}", bytesText(left), here.string()));
}

void examineDisplay(Findings& findings) {
  if (!environment("DISPLAY").empty()) return;
  const bool wayland = !environment("WAYLAND_DISPLAY").empty();
  findings.add({"display", Severity::hint,
                wayland ? "There is a Wayland display and no X11 display: ibr-viewer may not open its window."
                        : "There is no display: ibr-viewer cannot open a window.",
                wayland ? "Install Xwayland." : "ibr render and ibr eval need no display."});
}

// Paths that the OpenXR loader searches (OpenXR loader specification, "Runtime Enumeration").
std::vector<fs::path> runtimeFiles() {
  if (const std::string given = environment("XR_RUNTIME_JSON"); !given.empty()) return {given};
  std::vector<fs::path> folders;
  const std::string config = environment("XDG_CONFIG_HOME"), home = environment("HOME");
  if (!config.empty() || !home.empty())
    folders.push_back(config.empty() ? fs::path(home) / ".config" : fs::path(config));
  std::string shared = environment("XDG_CONFIG_DIRS");
  std::istringstream list(shared.empty() ? "/etc/xdg" : shared);
  for (std::string folder; std::getline(list, folder, ':');)
    if (!folder.empty()) folders.emplace_back(folder);
  folders.insert(folders.end(), {"/usr/local/etc", "/etc"});
  std::vector<fs::path> files;
  for (const fs::path& folder : folders)
    for (const char* name : {"active_runtime.x86_64.json", "active_runtime.aarch64.json", "active_runtime.json"})
      files.push_back(folder / "openxr/1" / name);
  return files;
}

void examineHeadset(Findings& findings) {
  std::error_code ignored;
  for (const fs::path& file : runtimeFiles()) {
    if (!fs::exists(file, ignored)) continue;
    try {
      const nlohmann::ordered_json json = jsonOrDiscarded(readTextFile(file));
      fs::path library = json.at("runtime").at("library_path").get<std::string>();
      const bool pathGiven = library.has_parent_path();
      if (pathGiven && library.is_relative()) library = fs::canonical(file).parent_path() / library;
      if (pathGiven && !fs::exists(library, ignored))
        findings.add({"headset", Severity::warning,
                      fmt::format("The OpenXR runtime named in {} is missing: {}.", file.string(), library.string()),
                      "Reinstall the runtime, or make another runtime the active one."});
      else
        findings.fact(fmt::format("headsets: {}", json.at("runtime").value("name", library.string())));
    } catch (const std::exception&) {
      findings.add({"headset", Severity::warning, fmt::format("{} does not name an OpenXR runtime.", file.string()),
                    "Reinstall the runtime of the headset."});
    }
    return;
  }
  findings.add({"headset", Severity::hint, "There is no OpenXR runtime: ibr-vr finds no headset.",
                "Install Monado, SteamVR or WiVRn as the active runtime."});
}

}  // namespace

void examineMachine(Findings& findings, const Context&) {
  examineDevices(findings);
  examineMemory(findings);
  examineDisk(findings);
  examineColmap(findings);
  examineFfmpeg(findings);
  examineDisplay(findings);
  examineHeadset(findings);
}

}  // namespace ibr::app
