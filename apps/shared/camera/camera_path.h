// SPDX-License-Identifier: Apache-2.0
// Camera path: keys in time, interpolated by splines.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ibr/camera.h"

namespace ibr::app {

struct CameraKey {
  double time = 0;  // s
  glm::dvec3 position{0.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  // unit, camera axes to world
  double fovY = 0;                          // radians, 0 < fovY < π
};

struct CameraPath {
  int width = 0, height = 0;    // px
  double fps = 0;               // frames a second, > 0
  std::vector<CameraKey> keys;  // at least one, times strictly increasing
};

/// A camera with the name of its image; '/' separates folders.
struct View {
  std::string name;
  Camera camera;
  double time = 0;  // s, along a path; 0 for views without time
};

/// Returns the camera at a time; constant before the first and after the last key. The path passes through every key
/// with continuous velocity. Evenly spaced keys on a line give even motion. Rotations take the shorter way.
Camera cameraAt(const CameraPath& path, double time);

/// Returns one view every 1/fps s from the first key to the last, named frame_0000, frame_0001, …
std::vector<View> frames(const CameraPath& path);

/// Throws Error{invalidInput} that names `name` and the field, for the limits of readCameraPath: sizes from 1 to 65536,
/// fps from 0.001 to 1000, keys at least a microsecond apart, at most a day and a million frames.
void checkCameraPath(const CameraPath& path, const std::string& name);

/// File format: {"version":1,"size":[w,h],"fps":30,"keys":[{"time","position":[x,y,z],"rotation":[x,y,z,w],
/// "fovY" in radians}]}. Throws Error (io, invalidInput) that names file and field.
CameraPath readCameraPath(const std::filesystem::path& file);
void writeCameraPath(const std::filesystem::path& file, const CameraPath& path);

}  // namespace ibr::app
