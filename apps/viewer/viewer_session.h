// SPDX-License-Identifier: Apache-2.0
// The viewer on a device, from its making until it is lost or the window closes.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "ibr/offscreen.h"
#include "ibr/shader_reload.h"
#include "viewer/control/memory_budget.h"
#include "viewer/control/viewer.h"
#include "viewer/open/place_on_device.h"
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
  double interfaceScale = 0;  // 0: that of the monitor
  // For tests: of all frames, when the device and the window's surface are as if lost, 0: never; the window is as if it
  // took no formats but sRGB.
  std::size_t loseAtFrame = 0, loseSurfaceAtFrame = 0;
  bool onlySrgb = false;
  std::chrono::steady_clock::time_point begun{};  // the program
  int frames = 0;                                 // to show before it ends; 0: until the window is closed
  std::filesystem::path screenshot;               // written at the end; empty: none
  std::filesystem::path shaders;                  // of a source tree: edits show while the viewer runs; empty: none
  std::filesystem::path screenshots;              // folder for those that are asked for, camera paths and videos
};

class Session {
 public:
  Session(Window& window, Interface& interface, Viewer& viewer, const SessionOptions& options);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();  // waits for the device

  /// Until the window closes or the frames asked for have been shown. Throws Error: deviceLost, where making another
  /// session may go on.
  void run();

  /// How many messages the validation layer has sent.
  std::uint64_t validationMessages() const noexcept { return device_.validationMessages(); }

 private:
  double pause() const;  // how long to wait for events, s; 0: something moves
  bool draw();           // false: there is nothing to draw into now
  void fitInterface();
  void showPanels();
  void obeyHands(double seconds);
  void recordPicture(const Swapchain::Frame& frame, double seconds);
  void grantWishes();
  void paste();
  std::filesystem::path saveRoute();  // empty: there was nothing to save
  void makeVideo();
  void takeScreenshot(const std::filesystem::path& file);
  void findOut();
  void forgetClosed();
  void reloadShaders();
  PlaceOnDevice* drawnPlace();

  Window& window_;
  Interface& interface_;
  Viewer& viewer_;
  const SessionOptions& options_;
  Device device_;
  MemoryMeter memory_;
  Swapchain swapchain_;
  std::optional<InterfaceDrawer> drawer_;
  std::array<std::unique_ptr<ScopeTimer>, kFramesInFlight> timers_;
  std::array<std::size_t, kFramesInFlight> timed_{};  // frames that they have timed
  std::optional<ShaderReloader> shaders_;
  std::map<std::uint64_t, std::unique_ptr<PlaceOnDevice>> drawn_;  // by OpenItem::number
  std::unique_ptr<Offscreen> picture_;  // the place without the interface, of the window's size
  std::uint64_t frame_ = 0;             // shown or being recorded
  int redraws_ = 3;                     // frames to be drawn before it may rest: the interface settles in two
  bool pictureWanted_ = true;           // the place is to be drawn anew
  std::chrono::steady_clock::time_point last_;
  bool rested_ = true;  // since the last frame
};

}  // namespace ibr::app
