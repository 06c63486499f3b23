// SPDX-License-Identifier: Apache-2.0
// Editing of camera paths: keys are added, moved, re-timed and deleted. A path is plain data (camera_path.h), so copies
// serve as undo states. cameraAt shows a path, writeCameraPath saves it, and reading returns the same bits. A path is
// always valid for readCameraPath, except that it may have no keys. Edits that would make the path invalid throw
// Error{invalidInput} and leave the path unchanged.
#pragma once

#include <cstddef>

#include "shared/camera/camera_path.h"

namespace ibr::app {

/// Inserts a key at its time and returns its index. Replaces a key within a millisecond.
std::size_t putKey(CameraPath& path, const CameraKey& key);

/// Appends a key after the last one. The time between both is the way (poseDistance) at `unitsPerSecond` > 0, at least
/// a frame. The first key is at 0 s.
std::size_t appendKey(CameraPath& path, const Pose& pose, double fovY, double unitsPerSecond);

/// Moves a key to another time and returns its new index. A key may pass others, but not come within 1 ms of one.
std::size_t moveKey(CameraPath& path, std::size_t key, double time);

void deleteKey(CameraPath& path, std::size_t key);

/// Returns the way from one pose to another, world units: the root of the sum of squares of the straight distance and
/// of the turn, which counts `unitsPerRadian` per radian.
double poseDistance(const Pose& from, const Pose& to, double unitsPerRadian);

/// Returns twice the median distance between consecutive keys at different positions; 1 if there are none. Half a
/// radian then takes as long as the median step.
double unitsPerRadianOf(const CameraPath& path);

/// Re-times the keys for the same mean speed on every segment along the spline, `unitsPerSecond` > 0. The first key
/// keeps its time. Where the camera stands still between two keys, the duration of this pause is
/// unchanged.
void retimeAtSpeed(CameraPath& path, double unitsPerSecond);

/// Re-times the keys for the same speed on every segment and a total duration `seconds` > 0. Pauses are included: their
/// durations scale by the same factor.
void retimeToLast(CameraPath& path, double seconds);

}  // namespace ibr::app
