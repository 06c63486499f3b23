// SPDX-License-Identifier: Apache-2.0
// A camera path that a person makes: keys are added, moved, re-timed and deleted. It is plain data (camera_path.h):
// copies are for undoing, cameraAt shows it, writeCameraPath saves it, and what is read again is the same to the last
// bit. It always is what readCameraPath takes, but for having no key at all: whatever would not be is refused with
// Error{invalidInput} and the path is as before.
#pragma once

#include <cstddef>

#include "shared/camera/camera_path.h"

namespace ibr::app {

/// Puts a key at its time and gives its place; one that is within a millisecond is replaced.
std::size_t putKey(CameraPath& path, const CameraKey& key);

/// Puts a key behind the last one, so much later as the way there takes at `unitsPerSecond` > 0 (wayBetween), at least
/// a frame. The first key is at 0 s.
std::size_t appendKey(CameraPath& path, const Pose& pose, double fovY, double unitsPerSecond);

/// The key is at another time, and its place is given. It may pass others, but not come within a millisecond of one.
std::size_t moveKey(CameraPath& path, std::size_t key, double time);

void deleteKey(CameraPath& path, std::size_t key);

/// World units from one pose to another along a line; a turn counts as a way, `unitsPerRadian` for each radian: the
/// root of the sum of both squares.
double wayBetween(const Pose& from, const Pose& to, double unitsPerRadian);

/// Twice the median of the ways between keys that differ in place, 1 where there are none: half a radian takes as long
/// as the usual step.
double unitsPerRadianOf(const CameraPath& path);

/// New times, so that the camera goes along the spline at the same speed from key to key: between any two keys it is on
/// average `unitsPerSecond` > 0. The first key keeps its time; where the camera stands still it stands as long as
/// before.
void retimeAtSpeed(CameraPath& path, double unitsPerSecond);

/// The same speed from key to key, and `seconds` > 0 from first to last, standing still included: pauses become shorter
/// or longer by the same share.
void retimeToLast(CameraPath& path, double seconds);

}  // namespace ibr::app
