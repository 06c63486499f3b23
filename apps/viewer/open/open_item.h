// SPDX-License-Identifier: Apache-2.0
// A place that is open in the viewer: a scene, a harmonised model or 3D video, with the camera as it was left ([T]
// §4.1.1). What a device holds of it is a PlaceOnDevice: it may be lost and made anew.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ibr/htm.h"
#include "ibr/htm_sequence.h"
#include "ibr/renderer.h"
#include "shared/camera/camera_path.h"
#include "shared/camera/navigation.h"
#include "shared/report/graph_view.h"
#include "viewer/open/effects.h"
#include "viewer/open/trust.h"

namespace ibr::app {

/// A photograph of a place, to snap to.
struct Viewpoint {
  std::string name;
  Camera camera;
};

struct OpenItem {
  std::uint64_t number = 0;  // of all that were opened: another place may later lie where this one lay
  std::filesystem::path path;
  std::string name;  // of the folder
  // One of them:
  std::optional<Scene> scene;
  std::optional<HtmModel> model;  // of 3D video its first frame's
  std::unique_ptr<HtmSequence> video;

  std::vector<Viewpoint> viewpoints;
  double step = 1;       // median distance from a photograph to its nearest one, world units
  RoamingBounds bounds;  // where views may be trusted
  GraphView map;         // from where the places of the photographs are best looked at

  // As it was left.
  Navigation walk;
  bool bounded = false;                 // the camera stays within `bounds`
  CameraPath route{1280, 720, 30, {}};  // recorded key by key; the size is that of the window it is saved from
  double routeTime = 0;                 // s, while it is shown
  bool showingRoute = false, repeatingRoute = false;
  Pose routePose;        // what was shown of it last: who has moved the view since then ends it
  double routeFovY = 0;  // radians
  RenderSettings settings;
  HtmSettings htmSettings;
  double time = 0;  // s, of 3D video
  bool playing = false;
  /// Puts a key of where the view is behind the route's last one; the way there takes as long as at the speed of
  /// flying.
  void addRouteKey();
  /// Shows the route from its beginning, at its own rate.
  void showRoute();

  bool changed = false;    // a panel has changed what is shown
  bool showGraph = false;  // frusta and cells over the picture

  // What is asked of the device, and what it found.
  std::optional<glm::dvec2> pickAt;  // px: the view goes round what is seen there from now on
  std::optional<Trust> trust;        // of the view that stands
  bool wantsEffects = false;
  std::optional<Effects> effects;

  std::vector<Pose> poses() const;  // of viewpoints
  /// To a photograph's view, in so many seconds.
  void flyToViewpoint(std::size_t viewpoint, double seconds = 0.6);
};

/// Reads a place's files. For any thread. Throws Error that names the file.
OpenItem openPlace(const std::filesystem::path& path);

/// The view in a picture of that size.
Camera cameraOf(const OpenItem& place, VkExtent2D extent);

bool sameView(const Camera& a, const Camera& b);

}  // namespace ibr::app
