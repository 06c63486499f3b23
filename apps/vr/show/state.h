// SPDX-License-Identifier: Apache-2.0
// The program's options, and the state that survives the loss of the headset or its device.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "shared/cli/context.h"
#include "vr/headset/frame_log.h"
#include "vr/headset/xr_session.h"
#include "vr/show/stereo_scene.h"
#include "vr/walk/governor.h"
#include "vr/walk/scale_cache.h"
#include "window/window.h"

namespace ibr::app {

struct VrOptions {
  std::vector<std::filesystem::path> places;  // at least one
  RenderSettings settings;
  GpuSceneOptions gpuScene;
  WalkSettings walk;
  std::optional<SpaceKind> space;       // nullopt: STAGE if available
  double eyeHeight = 1.6;               // for LOCAL, m
  std::optional<double> unitsPerMetre;  // nullopt: the scene's cached scale, else 1
  bool floor = true;                    // guiding grid at the height of the real floor
  bool governorEnabled = true;          // the frame governor may draw less
  bool mirror = true;                   // window with the left eye's image, if there is a display
  bool validation = false;
  std::filesystem::path pipelineCache;  // file; empty: none
  std::uint64_t frames = 0;             // to show before the program ends; 0: until the user leaves
  std::filesystem::path screenshot;     // of both eyes, written at the end; empty: none
  std::filesystem::path screenshots;    // folder for screenshots that the user requests
  std::uint64_t screenshotEvery = 0;    // writes every n-th frame, which waits for the writer, for tests; 0: none
};

struct VrState {
  const VrOptions& options;
  const Context& context;
  FrameLog& log;
  ScaleCache& scales;
  SceneReading& reading;                                  // of the current scene, while its entry of `files` is null
  std::vector<std::shared_ptr<const LoadedScene>> files;  // of options.places; null until loaded
  std::size_t current = 0;                                // index into options.places
  Window* window = nullptr;                               // the mirror; null: none
  WalkSettings walking;
  double eyeHeight = 1.6;                        // for LOCAL, m
  bool governorEnabled = true;                   // as VrOptions::governorEnabled; the menu changes it
  Composition composition = Composition::cells;  // likewise, of VrOptions::settings
  bool leaving = false;                          // the user leaves, or all requested frames were shown
  std::optional<std::size_t> previousScene;      // previous scene, to return to if the current one cannot be shown
  std::optional<WalkState> previousWalk;
  std::optional<WalkState> walk;  // in the current scene
  std::uint64_t shown = 0;        // frames of scenes
  std::uint64_t losses = 0;       // of the headset or its device
  std::atomic<std::uint64_t> validationMessages{0};
  std::string headset, eyes;  // names for people

  /// Initial world units per metre of a scene.
  double initialScale(std::size_t sceneIndex) const {
    return options.unitsPerMetre.value_or(scales.of(options.places[sceneIndex]).value_or(1));
  }
  /// Stores the current scale for the next run if the user has changed it. Returns true if changed.
  bool saveScale() {
    const bool changed = walk && walk->tracking.unitsPerMetre != walk->initialUnitsPerMetre;
    if (changed) scales.store(options.places[current], walk->tracking.unitsPerMetre);
    return changed;
  }

  std::vector<std::filesystem::path> pictures;  // written files
};

}  // namespace ibr::app
