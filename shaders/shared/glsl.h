// SPDX-License-Identifier: Apache-2.0
// Lets one header serve GLSL and C++. In C++ the declarations are in namespace ibr::shader and use GLM's types. Layout
// is scalar on both sides (GL_EXT_scalar_block_layout), so a struct has the same bytes.
#ifndef IBR_SHARED_GLSL_H
#define IBR_SHARED_GLSL_H

#ifdef __cplusplus
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
namespace ibr::shader {
using glm::mat3;
using glm::mat4;
using glm::uvec2;
using glm::uvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using std::abs;
using std::ceil;
using std::clamp;
using std::exp2;
using std::floor;
using std::log2;
using std::max;
using std::min;
using std::sqrt;
using uint = std::uint32_t;
}  // namespace ibr::shader
#define IBR_SHARED_BEGIN namespace ibr::shader {
#define IBR_SHARED_END }
#define IBR_FUNCTION inline
#define IBR_CONSTANT inline constexpr
#else
#define IBR_SHARED_BEGIN
#define IBR_SHARED_END
#define IBR_FUNCTION
#define IBR_CONSTANT const
#endif

#endif
