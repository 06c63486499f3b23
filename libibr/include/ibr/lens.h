// SPDX-License-Identifier: Apache-2.0
// Camera models as pose estimators have them, with lens distortion, and pictures freed of it. Needs ibr::author.
//
// A direction is in camera axes (x right, y up, looking along −z); a pixel has the origin at the top-left corner of the
// picture (conventions.h). With m the point at which a direction meets the plane z = −1 (or, of fisheyes, the point in
// its direction at distance θ, the angle to the axis), y down, the pixel is f·d(m) + c (Brown 1971; Kannala and Brandt
// 2006; Devernay and Faugeras 2001 for FOV). Beyond the radius at which d folds back nothing is seen.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// The camera models of COLMAP 3.8, by its numbers. Their parameters stand in its order.
enum class LensModel : std::uint8_t {
  simplePinhole,        // f, cx, cy
  pinhole,              // fx, fy, cx, cy
  simpleRadial,         // f, cx, cy, k
  radial,               // f, cx, cy, k1, k2
  opencv,               // fx, fy, cx, cy, k1, k2, p1, p2
  opencvFisheye,        // fx, fy, cx, cy, k1, k2, k3, k4
  fullOpencv,           // fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6
  fov,                  // fx, fy, cx, cy, ω
  simpleRadialFisheye,  // f, cx, cy, k
  radialFisheye,        // f, cx, cy, k1, k2
  thinPrismFisheye,     // fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, sx1, sy1
};
inline constexpr std::size_t kLensModels = 11;

/// How many parameters a model has.
std::size_t parameterCount(LensModel model);

/// d(m) of the head of this file, all models in one: m·N(r²)/D(r²) (or atan(2 r tan(ω/2))/(ω r)) with r = |m|, and
/// tangential and thin-prism terms.
struct LensDistortion {
  std::array<double, 4> numerator{};    // N = 1 + Σ k_i r^(2i)
  std::array<double, 3> denominator{};  // D likewise
  std::array<double, 2> tangential{};   // p1, p2
  std::array<double, 2> prism{};        // sx1, sy1
  double omega = 0;                     // ω, radians; 0: none

  bool operator==(const LensDistortion&) const = default;
};

class Lens {
 public:
  /// Throws Error{invalidInput} for another number of parameters than the model has, one that is not finite, a focal
  /// length or size that is not positive, and |ω| >= π.
  Lens(LensModel model, int width, int height, std::span<const double> parameters);

  LensModel model() const { return model_; }
  int width() const { return width_; }    // px
  int height() const { return height_; }  // px
  /// False where it sees as a pinhole does: a pinhole, or a perspective model whose terms are all zero.
  bool distorts() const;
  /// m is in the plane z = −1; else it is the fisheyes'.
  bool perspective() const;
  /// Focal lengths and principal point in px, and what of it is distorted.
  glm::dvec2 focal() const { return focal_; }
  glm::dvec2 centre() const { return centre_; }
  const LensDistortion& distortion() const { return distortion_; }
  /// The greatest |m| before d folds back; for perspective models at most the tangent of 89.9°, for fisheyes at most π.
  double limit() const { return limit_; }

  /// Pixel at which a direction of any length is seen, also outside the picture; nullopt where there is none.
  std::optional<glm::dvec2> project(glm::dvec3 direction) const;
  /// Unit direction that is seen at a pixel, also outside the picture; nullopt where there is none. To 1e-10 of m.
  std::optional<glm::dvec3> unproject(glm::dvec2 pixel) const;

  bool operator==(const Lens&) const = default;

 private:
  LensModel model_;
  int width_, height_;
  glm::dvec2 focal_, centre_;
  LensDistortion distortion_;
  double limit_;
};

/// What an undistorted picture keeps.
enum class Border : std::uint8_t {
  crop,  // a rectangle in which every pixel was photographed, none of whose sides can be moved outwards
  keep,  // all that was photographed; pixels that were not are black
};

/// Half of the widest field of view of an undistorted picture, across and down: a pinhole stretches what lies farther.
inline constexpr double kWidestHalfAngle = 60.0;  // degrees

/// The pinhole of the undistorted picture: pixels of the same size as the lens has in its middle, same axis. Throws
/// Error{invalidInput} where the middle of the picture sees nothing within kWidestHalfAngle.
Intrinsics undistorted(const Lens& lens, Border border = Border::crop);

/// The picture that `pinhole` would have taken, from one that `lens` took; both may be of another size than their
/// camera, in the same proportions. Lanczos filter of three lobes; outside the photograph (at most half a pixel with
/// Border::crop) its edge is repeated, beyond that the picture is black. Precondition: pinhole.model is pinhole.
Image8 undistort(const Image8& picture, const Lens& lens, const Intrinsics& pinhole);

/// The pixel of `pinhole` that shows what `lens` shows at a pixel; nullopt where none does or it is outside the
/// picture.
std::optional<glm::dvec2> undistort(glm::dvec2 pixel, const Lens& lens, const Intrinsics& pinhole);

/// Whether a pixel of `pinhole` was photographed: false in the black border of Border::keep.
bool photographed(glm::dvec2 pixel, const Lens& lens, const Intrinsics& pinhole);

}  // namespace ibr
