// SPDX-License-Identifier: Apache-2.0
// Coordinate conventions of libibr. Every header states its departures; there are none so far.
//
// World    right-handed, metres where the poses are metric (scale is never normalised away), double precision.
// Camera   x right, y up, looks along -z (as OpenGL, OpenXR, glTF). A pose maps camera axes to world.
// Pixel    (0, 0) is the top-left corner of the top-left pixel, y down; pixel centres at (i + 0.5, j + 0.5).
// Panorama equirectangular, unit direction d in camera axes:
//          x = (atan2(d.x, -d.z) / 2π + ½)·width,  y = (½ − asin(d.y) / π)·height.
// Colour   8-bit photographs are display-encoded (sRGB) and blended as such, as the papers do, unless said otherwise.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
