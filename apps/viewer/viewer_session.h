// SPDX-License-Identifier: Apache-2.0
// A viewer session on one device, until the device is lost or the window closes.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "base/background.h"
#include "ibr/offscreen.h"
#include "ibr/shader_reload.h"
#include "shared/draw/picture_writer.h"
#include "viewer/control/memory_budget.h"
#include "viewer/control/viewer.h"
#include "viewer/open/item_on_device.h"
#include "viewer/panels/panels.h"
#include "window/interface.h"
#include "window/interface_drawer.h"
#include "window/swapchain.h"

namespace ibr::app {

struct SessionOptions {
  std::string device;
  std::filesystem::path pipelineCache;  // file; empty: none
  bool validation = false;
  GpuSceneOptions gpuScene;
  double interfaceScale = 0;  // 0: the monitor's scale
  // For tests. Frame numbers, counted over all sessions, at which the device and the window's surface are lost on
  // purpose; 0: never. onlySrgb accepts sRGB surface formats only.
  std::size_t loseAtFrame = 0, loseSurfaceAtFrame = 0;
  bool onlySrgb = false;
  std::chrono::steady_clock::time_point begun{};  // start of the program
  int frames = 0;                                 // to show before the program ends; 0: until the window is closed
  std::filesystem::path screenshot;               // written at the end; empty: none
  std::filesystem::path shaders;                  // folder of shader sources, reloaded when edited; empty: none
  std::filesystem::path screenshots;              // folder for screenshots, camera paths and videos
};

class ViewerSession {
 public:
  ViewerSession(Window& window, Interface& interface, Viewer& viewer, const SessionOptions& options);
  ViewerSession(const ViewerSession&) = delete;
  ViewerSession& operator=(const ViewerSession&) = delete;
  ~ViewerSession();  // waits for the device

  /// Runs until the window closes or SessionOptions::frames frames were shown. Throws Error; after deviceLost another
  /// session may be created.
  void run();

  /// Number of messages from the validation layer.
  std::uint64_t validationMessages() const noexcept { return owner_.validationMessages(); }

 private:
  double pause() const;  // s to wait for events; 0: something moves
  bool draw();           // false: no frame could be drawn
  void updateInterfaceScale();
  void showPanels();
  void handleInput(double seconds);
  void recordImage(const Swapchain::Frame& frame, double seconds);
  void handleRequests();
  void paste();
  std::filesystem::path saveCameraPath();  // returns the written file; empty: nothing to save
  void startVideoJob();
  void takeScreenshot(const std::filesystem::path& file);  // empty: the next free one of the folder for screenshots
  void reportPictures(const std::vector<PictureResult>& results);  // throws the error of a required one
  void runSceneQueries();
  void releaseClosedItems();
  void reloadShaders();
  Device sharedDevice();                // the same device for another thread
  ItemOnDevice* currentItemOnDevice();  // nullptr: no item, or it is being uploaded
  ItemOnDevice* uploadCurrentItem();    // starts the upload, and takes its result
  Background<UploadedScene> startUpload(std::shared_ptr<const OpenItem> item);
  bool isUploading() { return viewer_.item() && !currentItemOnDevice(); }

  Window& window_;
  Interface& interface_;
  Viewer& viewer_;
  const SessionOptions& options_;
  Device owner_;           // owns the Vulkan device
  std::mutex queueMutex_;  // held by the threads that submit
  Device device_;          // owner_ with this lock
  MemoryMeter memory_;
  Swapchain swapchain_;
  std::optional<InterfaceDrawer> drawer_;
  std::array<std::unique_ptr<ScopeTimer>, kFramesInFlight> timers_;
  std::array<std::size_t, kFramesInFlight> timed_{};  // numbers of the frames that the timers measure
  std::optional<ShaderReloader> shaders_;
  std::map<std::uint64_t, std::unique_ptr<ItemOnDevice>> itemsOnDevice_;  // by OpenItem::number
  std::map<std::uint64_t, Background<UploadedScene>> uploads_;            // likewise
  std::vector<Background<UploadedScene>> stoppedUploads_;                 // of closed items
  std::unique_ptr<Offscreen> sceneImage_;  // image without the interface, with the window's size
  PictureWriter writer_{wakeWindow};
  std::uint64_t frame_ = 0;    // number of the last frame, shown or being recorded
  int redraws_ = 3;            // frames to draw before drawing pauses: the interface settles within two
  bool imageOutdated_ = true;  // the scene's image must be drawn again
  std::chrono::steady_clock::time_point last_;
  bool drawingPaused_ = true;  // drawing has paused since the last frame, so the next frame time is not recorded
};

}  // namespace ibr::app
