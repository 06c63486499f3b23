// SPDX-License-Identifier: Apache-2.0
// Inputs of `ibr tradeoff`: options, scenes, views and the results of other commands; their key and their description.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batch/tradeoff/tradeoff_measure.h"
#include "ibr/device.h"
#include "shared/camera/camera_path.h"
#include "shared/cli/context.h"
#include "shared/cli/options.h"

namespace ibr::app {

/// Options of the command line.
struct TradeoffOptions {
  std::string scene, truth, poses, output, sweep, command;
  std::vector<std::string> only;           // views of the truth
  std::vector<std::string> knobs, builds;  // builds: NAME=SCENE
  int autoViews = 0, shrink = 1, repeat = 9, walk = 3000;
  PictureSize size;
  bool grid = true, list = false, check = false;
};

/// The scene and its further builds.
struct TradeoffBuilds {
  std::vector<std::string> names, folders;  // names: without the first scene; folders: of all
  std::vector<Scene> scenes;
};

/// Loads the scene and options.builds. Throws Error: invalidInput for a build that is not NAME=SCENE, and as loadScene.
TradeoffBuilds loadTradeoffBuilds(const TradeoffOptions& options);

/// Returns the views to measure: those of the truth, of --poses and of --path. Five automatic views if there are no
/// others. Reads the photographs of the truth, and reduces them by options.shrink: means of shrink × shrink px. Throws
/// Error.
std::vector<TradeoffSubject> tradeoffSubjects(const TradeoffOptions& options, const Scene& scene,
                                              const Context& context);

/// Returns the views of a walk through the scene, of the size of the first subject; empty if options.walk is 0.
/// Precondition: there is a subject.
std::vector<View> tradeoffWalk(const TradeoffOptions& options, const Scene& scene,
                               const std::vector<TradeoffSubject>& subjects);

/// Returns the maximum width and height of all views, px.
VkExtent2D maxExtentOf(const std::vector<TradeoffSubject>& subjects, const std::vector<View>& walk);

/// Reads the report of `ibr-lab sweep`; null if `file` is empty. Throws Error: io; invalidInput for another file.
nlohmann::ordered_json readSweepReport(const std::string& file);

/// Returns the key of all inputs of images and times, except the setting.
std::uint64_t tradeoffKey(const TradeoffOptions& options, const TradeoffBuilds& builds,
                          const std::vector<TradeoffSubject>& subjects, const Device& device, const Context& context);

/// Returns TradeoffReport::about: values common to all rows.
nlohmann::ordered_json tradeoffAbout(const TradeoffOptions& options, const TradeoffBuilds& builds,
                                     const std::vector<TradeoffSubject>& subjects, const Device& device,
                                     const Context& context);

}  // namespace ibr::app
