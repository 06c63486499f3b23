// SPDX-License-Identifier: Apache-2.0
// The viewer's state, independent of the device: open scenes, the scene that is shown, jobs, messages.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "base/background.h"
#include "ibr/log.h"
#include "ibr/scope_timer.h"
#include "viewer/control/frame_times.h"
#include "viewer/control/job.h"
#include "viewer/open/open_item.h"

namespace ibr::app {

struct LogLine {
  LogLevel level;
  std::string text;
};

/// A scene whose files are being read.
struct Opening {
  std::filesystem::path path;
  Background<OpenItem> item;
};

struct Viewer {
  std::vector<std::shared_ptr<OpenItem>> items;  // in the order of opening; a thread that uploads shares its item
  std::size_t current = 0;                       // index into items; unused if empty
  std::size_t activeTab = 0;                     // index into items, of the panel's tab
  std::vector<Opening> opening;
  std::vector<std::unique_ptr<Job>> jobs;
  std::deque<LogLine> log;
  LogCallback mirror;                           // also receives every message
  RenderSettings first;                         // initial settings of every scene
  std::optional<CameraPath> initialCameraPath;  // path of the first scene that is opened, played in a loop

  bool showInterface = true;      // F2
  bool showHelp = false;          // F1
  std::size_t activePage = 0;     // index of the side panel's page
  bool focusNextPanel = false;    // F6: moves the keyboard focus to the next panel, or back to the view
  bool panelFocused = false;      // a panel has the keyboard focus
  std::size_t focusedPanel = 0;   // panel that F6 focused last
  float interfaceScale = 1;       // relative to the monitor's scale; ctrl +, ctrl -
  bool resetLayout = false;       // panels reset to their default sizes in the next frame
  glm::vec2 layoutWindowSize{0};  // size of the window for which the side panel was laid out
  bool screenshotRequested = false, copyRequested = false, pasteRequested = false, savePathRequested = false,
       videoRequested = false;
  bool closeRequested = false;
  bool showOpenDialog = false;         // ctrl O
  std::string openDialogText;          // text of that dialog
  bool openDialogHasKeyboard = false;  // its field was active since the dialog appeared
  std::set<int>
      shortcutKeys;  // keys pressed with ctrl and still down: they must not move the camera if ctrl is released first
  std::string message;            // shown over the image for some seconds
  bool messageIsWarning = false;  // `message` is a warning: shown even if the interface is hidden
  std::chrono::steady_clock::time_point messageUntil{};

  std::vector<std::pair<std::string, std::string>> shaderErrors;  // file and compiler output

  // Statistics of the last frames.
  std::vector<ScopeTime> deviceTimes;
  FrameHistory history;
  std::optional<double> firstPicture;  // s, from program start until the device had drawn a scene
  std::size_t frames = 0;              // drawn
  std::size_t onDevice = 0;            // number of scenes
  bool failed = false;                 // a scene could not be opened or drawn

  OpenItem* item() { return current < items.size() ? items[current].get() : nullptr; }

  /// Starts reading a scene. A scene that is already open is shown; one that is being read or built is not started
  /// twice. A folder of photographs is built into a scene first.
  void open(const std::filesystem::path& path);
  /// Takes scenes that have been read, and opens results of finished jobs. Returns true if anything changed.
  bool collectOpenedItems();
  void closeCurrent();
  bool collectFinishedJobs();                         // takes finished jobs; a scene that was rebuilt is opened again
  void show(std::string text);                        // writes to the log, and over the image for 3 s
  void logMessage(LogLevel level, std::string text);  // writes to the log; warnings also over the image
  void post(LogLevel level, std::string_view text);   // the same from any thread, at the next call of takePosted
  bool hasPosted() const;
  void takePosted();

 private:
  mutable std::mutex postedMutex_;
  std::vector<LogLine> posted_;
};

}  // namespace ibr::app
