// SPDX-License-Identifier: Apache-2.0
// Conventions of libibr; headers state exceptions. [T] and [H] are the papers named in README.md.
//
// World    right-handed, double precision; metres where the poses are metric (scale is never normalised).
// Camera   x right, y up, looks along −z (as OpenGL, OpenXR, glTF). A pose maps camera axes to world axes.
// Pixel    (0, 0) is the top-left corner of the top-left pixel, y down; pixel centres at (i + 0.5, j + 0.5).
// Panorama equirectangular, unit direction d in camera axes:
//          x = (atan2(d.x, −d.z) / 2π + ½)·width,  y = (½ − asin(d.y) / π)·height.
// Colour   8-bit photographs are display-encoded (sRGB) and blended as such, as in the papers, unless stated otherwise.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
