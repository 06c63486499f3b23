// SPDX-License-Identifier: Apache-2.0
#include "viewer/viewer_session.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "viewer/control/controls.h"

namespace ibr::app {
namespace {

constexpr std::uint32_t kScopes = 64;
constexpr double kLongestStep = 0.1;  // s: limits the motion after a pause in drawing

Device makeDevice(const SessionOptions& options, Viewer& viewer) {
  return Device::create(
      {.device = options.device,
       .validation = options.validation,
       .instanceExtensions = Window::instanceExtensions(),
       .deviceExtensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME},
       .log = [&viewer](LogLevel level, std::string_view text) { viewer.say(level, std::string(text)); },
       .pipelineCache = options.pipelineCache});
}

// The previous frame may still be copying from the image.
constexpr ImageUse kCopiedBefore{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_NONE};

void copyPicture(VkCommandBuffer commands, VkImage from, VkExtent2D fromExtent, VkImage to, VkExtent2D toExtent) {
  const auto corner = [](VkExtent2D e) { return VkOffset3D{std::int32_t(e.width), std::int32_t(e.height), 1}; };
  const VkImageSubresourceLayers layers{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  const VkImageBlit region{layers, {{0, 0, 0}, corner(fromExtent)}, layers, {{0, 0, 0}, corner(toExtent)}};
  vkCmdBlitImage(commands, from, use::kTransferSource.layout, to, use::kTransferDestination.layout, 1, &region,
                 VK_FILTER_NEAREST);
}

}  // namespace

Session::Session(Window& window, Interface& interface, Viewer& viewer, const SessionOptions& options)
    : window_(window),
      interface_(interface),
      viewer_(viewer),
      options_(options),
      device_(makeDevice(options, viewer)),
      memory_(device_),
      swapchain_(device_, window, {.onlySrgb = options.onlySrgb}),
      last_(std::chrono::steady_clock::now()) {
  if (!options.shaders.empty()) shaders_.emplace(device_, ShaderReloadOptions{.folder = options.shaders});
  for (auto& timer : timers_) timer = std::make_unique<ScopeTimer>(device_, kScopes);
}

Session::~Session() {
  vkDeviceWaitIdle(device_.handle());
}

double Session::pause() const {
  if (redraws_ > 0 || pictureWanted_) return 0;
  const auto now = std::chrono::steady_clock::now();
  // Wake up to remove a message and to take results of loading and jobs.
  return shaders_ || viewer_.messageUntil > now || !viewer_.opening.empty() || !viewer_.jobs.empty() ? 0.1 : 3600;
}

void Session::run() {
  int shown = 0;
  while (!window_.closing() && !viewer_.wantsClose) {
    const double rest = pause();
    rested_ |= rest > 0;
    if (window_.handleEvents(rest)) redraws_ = 3;
    for (const std::filesystem::path& path : window_.takeDropped()) viewer_.open(path);
    if (viewer_.takeOpened()) {
      redraws_ = 3;
      pictureWanted_ = true;
    }
    if (!viewer_.opening.empty() || !viewer_.jobs.empty() || !viewer_.message.empty()) redraws_ = std::max(redraws_, 1);
    if (interface_.keysWait()) redraws_ = 3;
    if (shaders_) reloadShaders();
    if (redraws_ == 0 && !pictureWanted_) continue;
    if (!draw()) {
      window_.handleEvents(0.1);
      continue;
    }
    redraws_ = std::max(0, redraws_ - 1);
    forgetClosed();
    const bool ready = viewer_.opening.empty() && viewer_.jobs.empty();
    if (options_.frames > 0 && ready && ++shown >= options_.frames) break;
  }
  if (!options_.screenshot.empty()) takeScreenshot(options_.screenshot);
}

PlaceOnDevice* Session::drawnPlace() {
  OpenItem* place = viewer_.place();
  if (!place) return nullptr;
  std::unique_ptr<PlaceOnDevice>& drawn = drawn_[place->number];
  if (!drawn) {
    GpuSceneOptions options = options_.gpuScene;
    options.log = [this](LogLevel level, std::string_view text) { viewer_.say(level, std::string(text)); };
    drawn = putOnDevice(device_, *place, options);
  }
  return drawn.get();
}

void Session::reloadShaders() {
  const ShaderReloader::Result result = shaders_->poll();
  if (result.replaced.empty() && result.failed.empty() && viewer_.shaderFaults.size() == shaders_->failing().size())
    return;
  redraws_ = 3;
  viewer_.shaderFaults.clear();
  for (const ShaderReloader::Failure& fault : shaders_->failing())
    viewer_.shaderFaults.emplace_back(fault.file, fault.text);
  for (const ShaderReloader::Failure& fault : result.failed)
    viewer_.say(LogLevel::warning, fmt::format("{}: {}", fault.file, fault.text));
  if (result.replaced.empty()) return;
  const auto remake = [&] {
    for (auto& [number, drawn] : drawn_) drawn->remakePipelines();
  };
  try {
    remake();
    viewer_.show(fmt::format("{} loaded", fmt::join(result.replaced, ", ")));
  } catch (const Error& e) {
    if (e.code() == ErrorCode::deviceLost) throw;
    shaders_->takeBack();
    remake();
    viewer_.say(LogLevel::warning, fmt::format("{}: {}", fmt::join(result.replaced, ", "), e.what()));
  }
  pictureWanted_ = true;
}

void Session::forgetClosed() {
  std::erase_if(drawn_, [&](const auto& entry) {
    const bool closed =
        std::ranges::none_of(viewer_.places, [&](const auto& place) { return place->number == entry.first; });
    if (closed) vkDeviceWaitIdle(device_.handle());
    return closed;
  });
  viewer_.onDevice = drawn_.size();
}

void Session::recordPicture(const Swapchain::Frame& frame, double seconds) {
  if (!picture_ || picture_->target().extent.width != frame.extent.width ||
      picture_->target().extent.height != frame.extent.height) {
    vkDeviceWaitIdle(device_.handle());
    picture_ = std::make_unique<Offscreen>(device_, frame.extent);
    pictureWanted_ = true;
  }
  PlaceOnDevice* drawn = drawnPlace();
  if (drawn && pictureWanted_) {
    Target target = picture_->target();
    target.initialUse = kCopiedBefore;
    const std::uint64_t completed = frame_ > kFramesInFlight ? frame_ - kFramesInFlight : 0;
    drawn->record({frame.commands, frame_, completed, seconds}, target, timers_[frame.slot].get());
    pictureWanted_ = drawn->restless();
  }
  transition(frame.commands, frame.image, Swapchain::kBefore, use::kTransferDestination);
  if (drawn) {
    copyPicture(frame.commands, picture_->target().image, picture_->target().extent, frame.image, frame.extent);
  } else {
    pictureWanted_ = false;
    const VkClearColorValue grey{.float32 = {0.11f, 0.12f, 0.13f, 1}};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(frame.commands, frame.image, use::kTransferDestination.layout, &grey, 1, &all);
  }
}

// The monitor's scale may change when the window moves to another monitor.
void Session::fitInterface() {
  const double scale = options_.interfaceScale > 0 ? options_.interfaceScale : double(window_.scale());
  const bool isNew = interface_.setScale(float(scale) * viewer_.interfaceScale);
  if (drawer_ && !isNew) return;
  vkDeviceWaitIdle(device_.handle());
  drawer_.reset();  // ImGui supports one Vulkan backend at a time
  drawer_.emplace(device_, swapchain_.format(), kFramesInFlight);
  viewer_.layOut |= isNew;
  redraws_ = 3;
}

void Session::showPanels() {
  drawer_->beginFrame();
  interface_.beginFrame();
  PanelInput input{viewer_, window_, device_.name(), device_.kind()};
  input.sceneBudget = options_.gpuScene.budgetBytes;
  input.budget = memory_.read();
  if (OpenItem* place = viewer_.place())
    if (const auto found = drawn_.find(place->number); found != drawn_.end()) {
      input.plan = found->second->plan();
      input.memory = found->second->memory();
      input.streamed = found->second->streamed();
    }
  try {
    showAll(input);
  } catch (const Error& e) {
    ImGui::ErrorCheckEndFrameRecover(nullptr);  // ends windows that are still open
    viewer_.say(LogLevel::error, e.what());
  }
  ImGui::Render();
}

void Session::obeyHands(double seconds) try {
  press(viewer_, window_.takeKeys());
  if (OpenItem* place = viewer_.place())
    if (control(viewer_, *place, seconds)) pictureWanted_ = true;
} catch (const Error& e) {
  viewer_.say(LogLevel::error, e.what());  // the request is invalid; the scene stays as it is
}

bool Session::draw() {
  fitInterface();
  const std::optional<Swapchain::Frame> frame = swapchain_.begin();
  if (!frame) return false;
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - last_).count();
  last_ = now;
  ++frame_;
  ++viewer_.frames;
  try {
    check(viewer_.frames != options_.loseAtFrame, ErrorCode::deviceLost, "--lose-device");
    if (viewer_.frames == options_.loseSurfaceAtFrame) swapchain_.loseSurface();
    if (auto times = timers_[frame->slot]->read(); !times.empty()) {
      viewer_.history.addDevice(timed_[frame->slot], times);
      viewer_.deviceTimes = std::move(times);
    }
    timers_[frame->slot]->reset(frame->commands);
    timed_[frame->slot] = viewer_.frames;
    viewer_.history.add(viewer_.frames, std::exchange(rested_, false) ? std::nanf("") : float(1e3 * seconds));
    const std::size_t before = viewer_.current, places = viewer_.places.size();
    showPanels();
    obeyHands(std::min(seconds, kLongestStep));
    if (viewer_.current != before || viewer_.places.size() != places) pictureWanted_ = true;
    if (pictureWanted_) redraws_ = std::max(redraws_, 1);
    recordPicture(*frame, std::min(seconds, kLongestStep));
    drawer_->record(frame->commands, {frame->view, frame->extent, swapchain_.generation()});
  } catch (const Error& e) {
    swapchain_.abandon(*frame);
    --frame_;
    if (e.code() == ErrorCode::deviceLost || !viewer_.place()) throw;
    // Close a scene that cannot be drawn; the others stay open.
    viewer_.say(LogLevel::error, fmt::format("{}: {}", viewer_.place()->name, e.what()));
    vkDeviceWaitIdle(device_.handle());
    viewer_.closeCurrent();
    redraws_ = 3;
    pictureWanted_ = true;
    return true;
  }
  if (!swapchain_.end(*frame)) redraws_ = std::max(redraws_, 1);
  const OpenItem* shown = viewer_.place();
  if (shown && !viewer_.firstPicture) {
    vkDeviceWaitIdle(device_.handle());
    viewer_.firstPicture = std::chrono::duration<double>(std::chrono::steady_clock::now() - options_.begun).count();
  }
  window_.setTitle(shown ? shown->name + " - ibr" : "ibr");
  grantWishes();
  return true;
}

}  // namespace ibr::app
