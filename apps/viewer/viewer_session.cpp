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
#include "base/vulkan/functions.h"
#include "base/vulkan/submit.h"
#include "viewer/control/controls.h"

namespace ibr::app {
namespace {

constexpr std::uint32_t kScopes = 64;
constexpr double kMaxStepSeconds = 0.1;  // s: limits the motion after a pause in drawing

Device makeDevice(const SessionOptions& options, Viewer& viewer) {
  return Device::create({.device = options.device,
                         .validation = options.validation,
                         .instanceExtensions = Window::instanceExtensions(),
                         .deviceExtensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME},
                         .log = [&viewer](LogLevel level, std::string_view text) { viewer.post(level, text); },
                         .pipelineCache = options.pipelineCache});
}

// The previous frame may still be copying from the image.
constexpr ImageUse kImageInitialUse{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_NONE};

void blitImage(VkCommandBuffer commands, VkImage from, VkExtent2D fromExtent, VkImage to, VkExtent2D toExtent) {
  const auto corner = [](VkExtent2D e) { return VkOffset3D{std::int32_t(e.width), std::int32_t(e.height), 1}; };
  const VkImageSubresourceLayers layers{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  const VkImageBlit region{layers, {{0, 0, 0}, corner(fromExtent)}, layers, {{0, 0, 0}, corner(toExtent)}};
  vkCmdBlitImage(commands, from, use::kTransferSource.layout, to, use::kTransferDestination.layout, 1, &region,
                 VK_FILTER_NEAREST);
}

}  // namespace

ViewerSession::ViewerSession(Window& window, Interface& interface, Viewer& viewer, const SessionOptions& options)
    : window_(window),
      interface_(interface),
      viewer_(viewer),
      options_(options),
      owner_(makeDevice(options, viewer)),
      device_(sharedDevice()),
      memory_(device_),
      swapchain_(device_, window, {.onlySrgb = options.onlySrgb}),
      last_(std::chrono::steady_clock::now()) {
  if (!options.shaders.empty()) shaders_.emplace(device_, ShaderReloadOptions{.folder = options.shaders});
  for (auto& timer : timers_) timer = std::make_unique<ScopeTimer>(device_, kScopes);
}

ViewerSession::~ViewerSession() {
  for (auto& [number, upload] : uploads_) upload.requestStop();
  for (auto& upload : stoppedUploads_) upload.requestStop();
  uploads_.clear();
  stoppedUploads_.clear();
  waitIdle(device_);
  try {
    reportPictures(writer_.finish());
  } catch (const Error& e) {
    viewer_.logMessage(LogLevel::error, e.what());
  }
}

double ViewerSession::pause() const {
  if (redraws_ > 0 || imageOutdated_ || viewer_.hasPosted()) return 0;
  const auto now = std::chrono::steady_clock::now();
  // Wake up to remove a message and to take results of loading and jobs.
  const bool waits = !viewer_.opening.empty() || !viewer_.jobs.empty() || !uploads_.empty() || !stoppedUploads_.empty();
  return shaders_ || viewer_.messageUntil > now || waits ? 0.1 : 3600;
}

void ViewerSession::run() {
  int shown = 0;
  while (!window_.closing() && !viewer_.closeRequested) {
    const double rest = pause();
    drawingPaused_ |= rest > 0;
    if (window_.handleEvents(rest)) redraws_ = 3;
    for (const std::filesystem::path& path : window_.takeDropped()) viewer_.open(path);
    if (viewer_.collectOpenedItems()) {
      redraws_ = 3;
      imageOutdated_ = true;
    }
    if (!viewer_.opening.empty() || !viewer_.jobs.empty() || !viewer_.message.empty() || isUploading())
      redraws_ = std::max(redraws_, 1);
    if (writer_.hasResults()) reportPictures(writer_.takeResults());
    if (interface_.hasPendingKeys()) redraws_ = 3;
    if (shaders_) reloadShaders();
    if (redraws_ == 0 && !imageOutdated_) continue;
    if (!draw()) {
      window_.handleEvents(0.1);
      continue;
    }
    redraws_ = std::max(0, redraws_ - 1);
    releaseClosedItems();
    const bool ready = viewer_.opening.empty() && viewer_.jobs.empty() && !isUploading();
    if (options_.frames > 0 && ready && ++shown >= options_.frames) break;
  }
  if (!options_.screenshot.empty()) takeScreenshot(options_.screenshot);
  reportPictures(writer_.finish());
}

Device ViewerSession::sharedDevice() {
  return Device::adopt({.instance = owner_.instance(),
                        .physicalDevice = owner_.physicalDevice(),
                        .device = owner_.handle(),
                        .queue = owner_.queue(),
                        .queueFamily = owner_.queueFamily(),
                        .optionalFeatures = Device::featuresFor(owner_.physicalDevice()),
                        .log =
                            [this](LogLevel level, std::string_view text) {
                              if (level != LogLevel::info) viewer_.post(level, text);  // owner_ has told the device
                            },
                        .pipelineCache = owner_.pipelineCache(),
                        .queueMutex = &queueMutex_});
}

ItemOnDevice* ViewerSession::currentItemOnDevice() {
  const OpenItem* item = viewer_.item();
  const auto found = item ? itemsOnDevice_.find(item->number) : itemsOnDevice_.end();
  return found == itemsOnDevice_.end() ? nullptr : found->second.get();
}

Background<UploadedScene> ViewerSession::startUpload(std::shared_ptr<const OpenItem> item) {
  const auto device = std::make_shared<Device>(sharedDevice());
  return Background<UploadedScene>([this, item = std::move(item), device](const std::stop_token& stop) {
    struct Wake {
      ~Wake() { wakeWindow(); }
    } wake;
    GpuSceneOptions options = options_.gpuScene;
    options.log = [this](LogLevel level, std::string_view text) { viewer_.post(level, text); };
    options.stop = stop;
    return uploadScene(std::move(*device), *item->scene, options);
  });
}

ItemOnDevice* ViewerSession::uploadCurrentItem() {
  OpenItem* item = viewer_.item();
  if (!item) return nullptr;
  if (ItemOnDevice* drawn = currentItemOnDevice()) return drawn;
  std::unique_ptr<ItemOnDevice> drawn;
  if (item->scene) {
    const auto [upload, isNew] = uploads_.try_emplace(item->number);
    if (isNew) upload->second = startUpload(viewer_.items[viewer_.current]);
    if (!upload->second.isReady()) return nullptr;
    Background<UploadedScene> done = std::move(upload->second);
    uploads_.erase(upload);
    drawn = sceneOnDevice(device_, viewer_.items[viewer_.current], done.take());
  } else {
    drawn = modelOnDevice(device_, viewer_.items[viewer_.current]);
  }
  imageOutdated_ = true;
  redraws_ = 3;
  return (itemsOnDevice_[item->number] = std::move(drawn)).get();
}

void ViewerSession::reloadShaders() {
  const ShaderReloader::Result result = shaders_->poll();
  if (result.replaced.empty() && result.failed.empty() && viewer_.shaderErrors.size() == shaders_->failures().size())
    return;
  redraws_ = 3;
  viewer_.shaderErrors.clear();
  for (const ShaderReloader::Failure& fault : shaders_->failures())
    viewer_.shaderErrors.emplace_back(fault.file, fault.text);
  for (const ShaderReloader::Failure& fault : result.failed)
    viewer_.logMessage(LogLevel::warning, fmt::format("{}: {}", fault.file, fault.text));
  if (result.replaced.empty()) return;
  const auto rebuildAll = [&] {
    for (auto& [number, drawn] : itemsOnDevice_) drawn->rebuildPipelines();
  };
  try {
    rebuildAll();
    viewer_.show(fmt::format("{} loaded", fmt::join(result.replaced, ", ")));
  } catch (const Error& e) {
    if (e.code() == ErrorCode::deviceLost) throw;
    shaders_->revert();
    rebuildAll();
    viewer_.logMessage(LogLevel::warning, fmt::format("{}: {}", fmt::join(result.replaced, ", "), e.what()));
  }
  imageOutdated_ = true;
}

void ViewerSession::releaseClosedItems() {
  const auto isClosed = [&](const auto& entry) {
    return std::ranges::none_of(viewer_.items, [&](const auto& item) { return item->number == entry.first; });
  };
  for (auto entry = uploads_.begin(); entry != uploads_.end();) {
    if (!isClosed(*entry)) {
      ++entry;
      continue;
    }
    entry->second.requestStop();
    stoppedUploads_.push_back(std::move(entry->second));
    entry = uploads_.erase(entry);
  }
  std::erase_if(stoppedUploads_, [](const auto& upload) { return upload.isReady(); });
  std::erase_if(itemsOnDevice_, [&](const auto& entry) {
    const bool closed = isClosed(entry);
    if (closed) waitIdle(device_);
    return closed;
  });
  viewer_.onDevice = itemsOnDevice_.size();
}

void ViewerSession::recordImage(const Swapchain::Frame& frame, double seconds) {
  if (!sceneImage_ || sceneImage_->target().extent.width != frame.extent.width ||
      sceneImage_->target().extent.height != frame.extent.height) {
    waitIdle(device_);
    sceneImage_ = std::make_unique<Offscreen>(device_, frame.extent);
    imageOutdated_ = true;
  }
  ItemOnDevice* drawn = uploadCurrentItem();
  if (drawn && imageOutdated_) {
    Target target = sceneImage_->target();
    target.initialUse = kImageInitialUse;
    const std::uint64_t completed = frame_ > kFramesInFlight ? frame_ - kFramesInFlight : 0;
    drawn->record({frame.commands, frame_, completed, seconds}, target, timers_[frame.slot].get());
    imageOutdated_ = drawn->needsRedraw();
  }
  transition(frame.commands, frame.image, Swapchain::kInitialUse, use::kTransferDestination);
  if (drawn) {
    blitImage(frame.commands, sceneImage_->target().image, sceneImage_->target().extent, frame.image, frame.extent);
  } else {
    imageOutdated_ = false;
    const VkClearColorValue grey{.float32 = {0.11f, 0.12f, 0.13f, 1}};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(frame.commands, frame.image, use::kTransferDestination.layout, &grey, 1, &all);
  }
}

// The monitor's scale may change when the window moves to another monitor.
void ViewerSession::updateInterfaceScale() {
  const double scale = options_.interfaceScale > 0 ? options_.interfaceScale : double(window_.scale());
  const bool isNew = interface_.setScale(float(scale) * viewer_.interfaceScale);
  if (drawer_ && !isNew) return;
  waitIdle(device_);
  drawer_.reset();  // ImGui supports one Vulkan backend at a time
  drawer_.emplace(device_, swapchain_.format(), kFramesInFlight);
  viewer_.resetLayout |= isNew;
  redraws_ = 3;
}

void ViewerSession::showPanels() {
  drawer_->beginFrame();
  interface_.beginFrame();
  PanelInput input{viewer_, window_, device_.name(), device_.kind()};
  input.sceneBudget = options_.gpuScene.budgetBytes;
  input.budget = memory_.read();
  input.uploading = isUploading();
  if (OpenItem* item = viewer_.item())
    if (const auto found = itemsOnDevice_.find(item->number); found != itemsOnDevice_.end()) {
      input.plan = found->second->plan();
      input.memory = found->second->memory();
      input.streamed = found->second->streamed();
    }
  try {
    showAll(input);
  } catch (const Error& e) {
    ImGui::ErrorCheckEndFrameRecover(nullptr);  // ends windows that are still open
    viewer_.logMessage(LogLevel::error, e.what());
  }
  ImGui::Render();
}

void ViewerSession::handleInput(double seconds) try {
  press(viewer_, window_.takeKeys(), interface_.keys());
  if (OpenItem* item = viewer_.item())
    if (control(viewer_, *item, interface_.keys(), seconds)) imageOutdated_ = true;
} catch (const Error& e) {
  viewer_.logMessage(LogLevel::error, e.what());  // the request is invalid; the scene stays as it is
}

bool ViewerSession::draw() {
  updateInterfaceScale();
  const std::optional<Swapchain::Frame> frame = swapchain_.begin();
  if (!frame) return false;
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - last_).count();
  last_ = now;
  ++frame_;
  ++viewer_.frames;
  try {
    check(viewer_.frames != options_.loseAtFrame, ErrorCode::deviceLost, "--lose-device");
    if (viewer_.frames == options_.loseSurfaceAtFrame) swapchain_.simulateLostSurface();
    if (auto times = timers_[frame->slot]->read(); !times.empty()) {
      viewer_.history.addDevice(timed_[frame->slot], times);
      viewer_.deviceTimes = std::move(times);
    }
    timers_[frame->slot]->reset(frame->commands);
    timed_[frame->slot] = viewer_.frames;
    viewer_.history.add(viewer_.frames, std::exchange(drawingPaused_, false) ? std::nanf("") : float(1e3 * seconds));
    const std::size_t before = viewer_.current, items = viewer_.items.size();
    showPanels();
    handleInput(std::min(seconds, kMaxStepSeconds));
    if (viewer_.current != before || viewer_.items.size() != items) imageOutdated_ = true;
    if (imageOutdated_) redraws_ = std::max(redraws_, 1);
    recordImage(*frame, std::min(seconds, kMaxStepSeconds));
    drawer_->record(frame->commands, {frame->view, frame->extent, swapchain_.generation()});
  } catch (const Error& e) {
    swapchain_.abandon(*frame);
    --frame_;
    if (e.code() == ErrorCode::deviceLost || !viewer_.item()) throw;
    // Close a scene that cannot be drawn; the others stay open.
    viewer_.logMessage(LogLevel::error, fmt::format("{}: {}", viewer_.item()->name, e.what()));
    waitIdle(device_);
    viewer_.closeCurrent();
    redraws_ = 3;
    imageOutdated_ = true;
    return true;
  }
  if (!swapchain_.end(*frame)) redraws_ = std::max(redraws_, 1);
  const OpenItem* shown = currentItemOnDevice() ? viewer_.item() : nullptr;
  if (shown && !viewer_.firstPicture) {
    waitIdle(device_);
    viewer_.firstPicture = std::chrono::duration<double>(std::chrono::steady_clock::now() - options_.begun).count();
  }
  window_.setTitle(shown ? shown->name + " - ibr" : "ibr");
  handleRequests();
  return true;
}

}  // namespace ibr::app
