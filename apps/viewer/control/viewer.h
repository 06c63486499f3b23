// SPDX-License-Identifier: Apache-2.0
// What the viewer knows, whatever device draws it: the places that are open, what is shown of them, what was said.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "gpu/draw/scope.h"
#include "ibr/log.h"
#include "viewer/control/frame_times.h"
#include "viewer/control/job.h"
#include "viewer/open/open_item.h"

namespace ibr::app {

struct LogLine {
  LogLevel level;
  std::string text;
};

/// A place whose files are being read.
struct Opening {
  std::filesystem::path path;
  std::future<OpenItem> place;
};

struct Viewer {
  std::vector<std::unique_ptr<OpenItem>> places;  // in the order in which they were opened
  std::size_t current = 0;                        // of places, where there is one
  std::size_t shownTab = 0;                       // of places, in the panel
  std::vector<Opening> opening;
  std::vector<std::unique_ptr<Job>> jobs;
  std::deque<LogLine> log;
  LogCallback mirror;                    // also gets what is said
  RenderSettings first;                  // of scenes when they are opened
  std::optional<CameraPath> firstRoute;  // shown, again and again, of the first place that is opened

  bool showInterface = true;    // F2
  bool showHelp = false;        // F1
  std::size_t shownPanel = 0;   // of the side panel's
  bool wantsPanelKeys = false;  // F6: the keyboard goes to the next panel, or back to the view
  bool panelHasKeys = false;    // it is there
  std::size_t keyPanel = 0;     // where F6 has brought it last
  float interfaceScale = 1;     // of that of the monitor; ctrl +, ctrl -
  bool layOut = false;          // panels are to take the sizes that they begin with
  glm::vec2 laidOutFor{0};      // size of the window that the side panel lies in
  bool wantsScreenshot = false, wantsCopy = false, wantsPaste = false, wantsRoute = false, wantsVideo = false;
  bool wantsClose = false;
  bool asksForFolder = false;  // ctrl O
  std::string typedFolder;     // there, last
  std::set<int>
      shortcutKeys;  // places of keys pressed with ctrl that are still down: they do not fly when ctrl is let go first
  std::string message;  // for a moment, over the picture
  bool warned = false;  // it is to be seen even where the interface is hidden
  std::chrono::steady_clock::time_point messageUntil{};

  std::vector<std::pair<std::string, std::string>> shaderFaults;  // file and the compiler's text

  // Of the last frames.
  std::vector<ScopeTime> deviceTimes;
  FrameHistory history;
  std::optional<double> firstPicture;  // s, from the program's start until the device had drawn a place
  std::size_t frames = 0;              // drawn
  std::size_t onDevice = 0;            // places
  bool failed = false;                 // something could not be opened or drawn

  OpenItem* place() { return current < places.size() ? places[current].get() : nullptr; }

  /// Begins to read a place; one that is open already is shown, and what is being read or made already is waited for. A
  /// folder of photographs is made a scene first.
  void open(const std::filesystem::path& path);
  /// Takes what has been read, and opens what has been made. Says whether there was anything.
  bool takeOpened();
  void closeCurrent();
  bool takeDone();                             // jobs; a place that was made anew is opened anew
  void show(std::string text);                 // into the log, and over the picture for a moment
  void say(LogLevel level, std::string text);  // into the log, and warnings over the picture
};

}  // namespace ibr::app
