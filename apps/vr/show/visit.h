// SPDX-License-Identifier: Apache-2.0
// What is asked of the program, and what stays when the headset or its device is lost and made anew.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "shared/cli/context.h"
#include "vr/headset/frame_log.h"
#include "vr/headset/xr_session.h"
#include "vr/show/stereo_place.h"
#include "vr/walk/governor.h"
#include "vr/walk/kept_scales.h"
#include "window/window.h"

namespace ibr::app {

struct VrOptions {
  std::vector<std::filesystem::path> places;  // at least one
  RenderSettings settings;
  GpuSceneOptions gpuScene;
  WalkSettings walk;
  std::optional<SpaceKind> space;       // nullopt: STAGE where there is one
  double eyeHeight = 1.6;               // of LOCAL, m
  std::optional<double> unitsPerMetre;  // of the world; nullopt: as the scene's user left it, else 1
  bool floor = true;                    // the guiding floor, at the real one's height
  bool governed = true;                 // the frame governor may draw less
  bool mirror = true;                   // a window that shows the left eye, where there is a display
  bool validation = false;
  std::filesystem::path pipelineCache;  // file; empty: none
  std::uint64_t frames = 0;             // to show before it ends; 0: until the user leaves
  std::filesystem::path screenshot;     // of both eyes, written at the end; empty: none
  std::filesystem::path screenshots;    // folder for those that are asked for
  std::uint64_t screenshotEvery = 0;    // frames from one that nobody asks for to the next, for tests; 0: none
};

struct Visit {
  const VrOptions& options;
  const Context& context;
  FrameLog& log;
  KeptScales& scales;
  std::vector<std::shared_ptr<const PlaceFiles>> files;  // of options.places; null until they are read
  std::size_t current = 0;                               // of options.places
  Window* window = nullptr;                              // the mirror; null: there is none
  WalkSettings walking;
  double eyeHeight = 1.6;                        // of LOCAL, m
  bool governed = true;                          // as in VrOptions; the menu changes it
  Composition composition = Composition::cells;  // likewise, of VrOptions::settings
  bool leaving = false;                          // the user does, or all frames asked for were shown
  std::optional<std::size_t> former;             // place to come back to where the current one cannot be shown
  std::optional<WalkState> formerWalk;
  std::optional<WalkState> walk;  // in the current place
  std::uint64_t shown = 0;        // frames of places
  std::uint64_t losses = 0;       // of the headset or its device
  std::atomic<std::uint64_t> validationMessages{0};
  std::string headset, eyes;  // as a person would cite them

  /// World units, of a place when it is entered.
  double firstScale(std::size_t place) const {
    return options.unitsPerMetre.value_or(scales.of(options.places[place]).value_or(1));
  }
  /// For the next time, where the user has changed it.
  bool keepScale() {
    const bool changed = walk && walk->tracking.unitsPerMetre != walk->firstUnitsPerMetre;
    if (changed) scales.keep(options.places[current], walk->tracking.unitsPerMetre);
    return changed;
  }

  std::vector<std::filesystem::path> pictures;  // that were written
};

}  // namespace ibr::app
