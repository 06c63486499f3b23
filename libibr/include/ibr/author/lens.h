// SPDX-License-Identifier: Apache-2.0
// Camera models of pose estimators, with lens distortion, and undistortion of images. Needs ibr::author.
//
// Directions are in camera axes (x right, y up, looking along −z); pixels are measured from the image's top-left corner
// (conventions.h). A direction is seen at the pixel f·d(m) + c (Brown 1971; Kannala and Brandt 2006; for FOV Devernay
// and Faugeras 2001). m is the point, y down, where the direction meets the plane z = −1. Fisheyes scale m to the
// length θ, the direction's angle to the axis. Beyond the radius at which d folds back, nothing is seen. All functions
// are pure.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// The camera models of COLMAP 3.8, with COLMAP's numbers and order of parameters.
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
inline constexpr std::size_t kLensModelCount = 11;  // number of LensModels

/// Returns the number of a model's parameters.
std::size_t parameterCount(LensModel model);

/// Distortion d(m) of all models (ibr/author/lens.h): m·N(r²)/D(r²), or m·atan(2 r tan(ω/2))/(ω r) for FOV, with r =
/// |m|; plus tangential and thin-prism terms.
struct LensDistortion {
  std::array<double, 4> numerator{};    // k_i of N = 1 + Σ k_i r^(2i)
  std::array<double, 3> denominator{};  // k_i of D = 1 + Σ k_i r^(2i)
  std::array<double, 2> tangential{};   // p1, p2
  std::array<double, 2> prism{};        // sx1, sy1
  double omega = 0;                     // ω, radians; 0: none

  bool operator==(const LensDistortion&) const = default;
};

/// A lens: a camera model with its parameters and image size.
class Lens {
 public:
  /// Makes a lens. `width`, `height`: of the image, px. `parameters`: in the order of LensModel, lengths in px. Throws
  /// Error{invalidInput} for a wrong number of parameters, a parameter that is not finite, a focal length or
  /// size <= 0, and |ω| >= π.
  Lens(LensModel model, int width, int height, std::span<const double> parameters);

  LensModel model() const { return model_; }  // camera model
  int width() const { return width_; }        // image width, px
  int height() const { return height_; }      // image height, px
  /// Returns false for a pinhole, and for a perspective model whose distortion terms are all zero.
  bool distorts() const;
  /// Returns true if m lies in the plane z = −1, false for fisheyes.
  bool isPerspective() const;
  glm::dvec2 focal() const { return focal_; }                       // focal lengths in x and y, px
  glm::dvec2 centre() const { return centre_; }                     // principal point, px
  const LensDistortion& distortion() const { return distortion_; }  // terms of d(m)
  /// Returns the maximum |m| before d folds back: at most tan 89.9° for perspective models, and at most π for fisheyes.
  double maxRadius() const { return maxRadius_; }

  /// Returns the pixel at which a direction of any length is seen, also outside the image; nullopt if there is none.
  std::optional<glm::dvec2> project(glm::dvec3 direction) const;
  /// Returns the unit direction that is seen at a pixel, also outside the image; nullopt if there is none. m is
  /// accurate to 1e-10.
  std::optional<glm::dvec3> unproject(glm::dvec2 pixel) const;

  bool operator==(const Lens&) const = default;

 private:
  LensModel model_;
  int width_, height_;
  glm::dvec2 focal_, centre_;
  LensDistortion distortion_;
  double maxRadius_;
};

/// Extent of an undistorted image.
enum class Border : std::uint8_t {
  crop,  // a rectangle of photographed pixels alone, none of whose sides can be moved outwards
  keep,  // all photographed pixels; the others are black
};

/// Maximum half field of view of an undistorted image, in x and in y, since a pinhole stretches directions beyond it.
inline constexpr double kMaxHalfFovDegrees = 60.0;

/// Returns the pinhole of the undistorted image. Its axis, and the size of its pixels there, are those of the lens.
/// Throws Error{invalidInput} if the image's centre sees no direction within kMaxHalfFovDegrees.
Intrinsics undistorted(const Lens& lens, Border border = Border::crop);

/// Resamples a picture that `lens` took as `pinhole` would have taken it. The picture may have another size than
/// `lens`, in the same proportions; the result has the size of `pinhole`. Lanczos filter of three lobes, which repeats
/// the edge of the picture outwards. Pixels whose centre the picture does not cover are black. Precondition:
/// pinhole.model is pinhole.
Image8 undistort(const Image8& picture, const Lens& lens, const Intrinsics& pinhole);

/// Returns the pixel of `pinhole` that shows the same direction as a pixel of `lens`; nullopt if there is none, or if
/// it is outside the image of `pinhole`.
std::optional<glm::dvec2> undistort(glm::dvec2 pixel, const Lens& lens, const Intrinsics& pinhole);

/// Returns true if the photograph covers a pixel of `pinhole`; false in the black border of Border::keep.
bool photographed(glm::dvec2 pixel, const Lens& lens, const Intrinsics& pinhole);

}  // namespace ibr
