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

namespace ibr::app {

/// A photograph of a place, to snap to.
struct Viewpoint {
  std::string name;
  Camera camera;
};

struct Place {
  std::filesystem::path path;
  std::string name;  // of the folder
  // One of them:
  std::optional<Scene> scene;
  std::optional<HtmModel> model;  // of 3D video its first frame's
  std::unique_ptr<HtmSequence> video;

  std::vector<Viewpoint> viewpoints;
  glm::dvec3 up{0, 1, 0};  // unit: as the photographs were held
  double step = 1;         // median distance from a photograph to its nearest one, world units

  // As it was left.
  Pose pose;
  double fovY = 1;
  double speed = 1;                       // world units a second
  std::size_t snapped = std::size_t(-1);  // of viewpoints, where the view stands; none: it has moved since
  RenderSettings settings;
  HtmSettings htmSettings;
  double time = 0;  // s, of 3D video
  bool playing = false;
  bool changed = false;  // a panel has changed what is shown

  /// To a photograph's view.
  void snapTo(std::size_t viewpoint);
};

/// Reads a place's files. For any thread. Throws Error that names the file.
Place openPlace(const std::filesystem::path& path);

/// The view in a picture of that size.
Camera cameraOf(const Place& place, VkExtent2D extent);

bool sameView(const Camera& a, const Camera& b);

}  // namespace ibr::app
