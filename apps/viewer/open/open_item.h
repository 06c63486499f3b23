// SPDX-License-Identifier: Apache-2.0
// An open scene, harmonised model or 3D video, with its camera and settings ([T] §4.1.1). Its GPU resources are a
// ItemOnDevice, which may be lost and created again.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "base/background.h"
#include "ibr/htm.h"
#include "ibr/htm_sequence.h"
#include "ibr/renderer.h"
#include "shared/camera/camera_path.h"
#include "shared/camera/navigation.h"
#include "shared/report/graph_view.h"
#include "viewer/open/comparison.h"
#include "viewer/open/map_marks.h"
#include "viewer/open/trust.h"

namespace ibr::app {

/// A photograph's name and camera; the view can fly there.
struct Viewpoint {
  std::string name;
  Camera camera;
};

struct OpenItem {
  std::uint64_t number = 0;  // unique among all that were opened, because a path or address may be reused
  std::filesystem::path path;
  std::string name;  // the folder's name
  // A scene or a model; 3D video has `model` and `video`.
  std::optional<Scene> scene;
  std::optional<HtmModel> model;  // of 3D video: the first frame's model
  std::unique_ptr<HtmSequence> video;

  std::vector<Viewpoint> viewpoints;
  double step = 1;          // median distance of a photograph to its nearest neighbour, world units
  RoamingBounds bounds;     // region near the photographs, where views may be trusted
  SceneBounds sceneBounds;  // of `scene`
  GraphView map;            // projection for the map of capture sites
  MapMarks mapMarks;        // in this projection

  // The user's view and settings.
  Navigation navigation;
  bool bounded = false;                      // the camera stays within `bounds`
  CameraPath cameraPath{1280, 720, 30, {}};  // recorded key by key; size of the window at the last save
  double pathTime = 0;                       // s since the start of the path, while it is shown
  bool playingPath = false, loopingPath = false;
  Pose pathPose;        // last pose shown from the path: any other movement of the view ends the playback
  double pathFovY = 0;  // radians
  RenderSettings settings;
  HtmSettings htmSettings;
  double time = 0;  // s, of 3D video
  bool playing = false;
  /// Appends a key at the current view to the path. The time from the previous key follows from the flying
  /// speed.
  void addPathKey();
  /// Plays the path from its beginning, in real time.
  void showCameraPath();

  bool changed = false;    // a panel changed something that affects the image
  bool showGraph = false;  // draws frusta and cells over the image

  // Requests to the device, and their results.
  std::optional<glm::dvec2> pickPixel;  // px of a click: the point seen there becomes the orbit centre
  std::optional<Trust> trust;           // of the current view, while it rests
  bool comparisonRequested = false;
  std::optional<SettingsComparison> comparison;

  bool hasAnchors = false;          // sceneBounds has anchors for RenderSettings::alignCells
  Background<SceneBounds> aligned;  // bounds with anchors, being computed

  std::vector<Pose> poses() const;  // of viewpoints
  /// Returns true if a frame may align cells without waiting for anchors; else computes them on another thread.
  bool canAlign();
  /// Moves the view to a photograph within `seconds`.
  void flyToViewpoint(std::size_t viewpoint, double seconds = 0.6);
};

/// Reads the files. May run on any thread. Throws Error that names the file, and Error{cancelled} soon after a stop was
/// requested.
OpenItem openItem(const std::filesystem::path& path, const std::stop_token& stop = {});

/// Returns the current view as a pinhole camera for an image of this size.
Camera cameraOf(const OpenItem& item, VkExtent2D extent);

bool sameView(const Camera& a, const Camera& b);

}  // namespace ibr::app
