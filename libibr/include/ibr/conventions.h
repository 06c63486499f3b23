// SPDX-License-Identifier: Apache-2.0
// Conventions of libibr; headers state exceptions. [T] and [H] are the papers named in README.md.
//
// World    right-handed, double precision; metres where the poses are metric (scale is never normalised).
// Camera   x right, y up, looks along −z (as OpenGL, OpenXR, glTF). A pose maps camera axes to world axes.
// Pixel    (0, 0) is the top-left corner of the top-left pixel, y down; pixel centres at (i + 0.5, j + 0.5).
// Panorama equirectangular, unit direction d in camera axes:
//          x = (atan2(d.x, −d.z) / 2π + ½)·width,  y = (½ − asin(d.y) / π)·height.
// Colour   8-bit photographs are display-encoded (sRGB) and blended as such, as in the papers, unless stated otherwise.
// GLM      packed types; quaternions stored as x, y, z, w and constructed from (w, x, y, z).
//          Assertions below refuse callers whose GLM_FORCE_… settings change this.
#pragma once

#include <cstddef>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <type_traits>

namespace ibr {

static_assert(std::is_same_v<glm::dvec3, glm::vec<3, double, glm::packed_highp>>,
              "libibr needs packed GLM types: unset GLM_FORCE_DEFAULT_ALIGNED_GENTYPES and GLM_FORCE_ALIGNED");
static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && alignof(glm::vec3) == alignof(float) &&
                  sizeof(glm::dvec3) == 3 * sizeof(double) && alignof(glm::dvec3) == alignof(double) &&
                  sizeof(glm::dquat) == 4 * sizeof(double) && alignof(glm::dquat) == alignof(double),
              "libibr needs GLM types without padding");
static_assert(offsetof(glm::dquat, x) == 0 && offsetof(glm::dquat, w) == 3 * sizeof(double),
              "libibr needs quaternions stored as x, y, z, w: unset GLM_FORCE_QUAT_DATA_WXYZ");
static_assert(std::is_same_v<glm::length_t, int>,
              "libibr needs GLM's indices of type int: unset GLM_FORCE_SIZE_T_LENGTH");
static_assert(std::is_trivially_copyable_v<glm::dvec3>,
              "libibr needs trivially copyable GLM types: unset GLM_FORCE_CTOR_INIT and GLM_FORCE_CXX98");
#if defined(GLM_FORCE_QUAT_CTOR_XYZW) || defined(GLM_FORCE_QUAT_DATA_XYZW)
static_assert(false,
              "libibr calls GLM's quaternion constructor with (w, x, y, z): unset GLM_FORCE_QUAT_CTOR_XYZW and "
              "GLM_FORCE_QUAT_DATA_XYZW");
#endif

}  // namespace ibr
