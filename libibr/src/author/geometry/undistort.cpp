// SPDX-License-Identifier: Apache-2.0
// Removes lens distortion from images (ibr/author/lens.h). Plane points (x, y) below lie on z = −1 in camera axes, y
// down. Their projections by the lens decide which pixels a pinhole can show.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/check.h"
#include "ibr/author/lens.h"

namespace ibr {
namespace {

const double kMaxTangent = std::tan(kMaxHalfFovDegrees / 180.0 * std::numbers::pi);

std::optional<glm::dvec2> seenAt(const Lens& lens, glm::dvec2 plane) {
  return lens.project({plane.x, -plane.y, -1.0});
}

bool inPicture(const Lens& lens, glm::dvec2 pixel) {
  return pixel.x >= 0 && pixel.y >= 0 && pixel.x <= lens.width() && pixel.y <= lens.height();
}

struct Rectangle {
  double left, right, top, bottom;
};

// True if the whole rectangle was photographed: tests its edges and a coarse inner grid.
bool whole(const Lens& lens, const Rectangle& r) {
  constexpr int kEdge = 96, kEvery = 8;
  for (int i = 0; i <= kEdge; ++i)
    for (int j = 0; j <= kEdge; ++j) {
      const bool edge = i == 0 || j == 0 || i == kEdge || j == kEdge;
      if (!edge && (i % kEvery != 0 || j % kEvery != 0)) continue;
      const auto pixel =
          seenAt(lens, {std::lerp(r.left, r.right, double(i) / kEdge), std::lerp(r.top, r.bottom, double(j) / kEdge)});
      if (!pixel || !inPicture(lens, *pixel)) return false;
    }
  return true;
}

// Largest t in [0, 1] up to which `holds` is true. Precondition: true at 0, and false for all t above a limit.
template <class F>
double largest(F&& holds) {
  if (holds(1.0)) return 1.0;
  double low = 0, high = 1;
  for (int step = 0; step < 40; ++step) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

// Largest rectangle that was photographed completely: first scaled in proportion, then each side extended.
Rectangle cropped(const Lens& lens, glm::dvec2 middle) {
  const double w = kMaxTangent;
  const Rectangle limits{-w, w, -w, w};
  const auto reach = [&](glm::dvec2 end) {
    // In small steps: parts behind a gap do not count.
    constexpr int kSteps = 256;
    const auto seen = [&](double t) {
      const auto pixel = seenAt(lens, middle + t * (end - middle));
      return pixel && inPicture(lens, *pixel);
    };
    int step = 0;
    while (step < kSteps && seen(double(step + 1) / kSteps)) ++step;
    return step / double(kSteps);
  };
  const double left = reach({limits.left, middle.y}), right = reach({limits.right, middle.y});
  const double top = reach({middle.x, limits.top}), bottom = reach({middle.x, limits.bottom});
  const auto scaled = [&](double s) {
    return Rectangle{std::lerp(middle.x, limits.left, s * left), std::lerp(middle.x, limits.right, s * right),
                     std::lerp(middle.y, limits.top, s * top), std::lerp(middle.y, limits.bottom, s * bottom)};
  };
  Rectangle r = scaled(largest([&](double s) { return whole(lens, scaled(s)); }));
  for (double Rectangle::*side : {&Rectangle::left, &Rectangle::right, &Rectangle::top, &Rectangle::bottom}) {
    const double from = r.*side;
    const auto moved = [&](double t) {
      Rectangle wider = r;
      wider.*side = std::lerp(from, limits.*side, t);
      return wider;
    };
    r = moved(largest([&](double t) { return whole(lens, moved(t)); }));
  }
  return r;
}

// Bounding rectangle of all that was photographed.
Rectangle kept(const Lens& lens, glm::dvec2 middle) {
  constexpr int kGrid = 128, kFold = 720;
  Rectangle r{middle.x, middle.x, middle.y, middle.y};
  const auto add = [&](glm::dvec3 ray) {
    if (!(ray.z < 0)) return;
    const double x = std::clamp(ray.x / -ray.z, -kMaxTangent, kMaxTangent);
    const double y = std::clamp(-ray.y / -ray.z, -kMaxTangent, kMaxTangent);
    r = {std::min(r.left, x), std::max(r.right, x), std::min(r.top, y), std::max(r.bottom, y)};
  };
  for (int i = 0; i <= kGrid; ++i)
    for (int j = 0; j <= kGrid; ++j)
      if (const auto ray = lens.unproject({double(lens.width()) * i / kGrid, double(lens.height()) * j / kGrid}))
        add(*ray);
  // Near a fold, a small step in the image is a large one in the plane.
  for (int i = 0; i < kFold; ++i) {
    const double angle = 2 * std::numbers::pi * i / kFold, most = (1 - 1e-9) * lens.maxRadius();
    const glm::dvec3 ray = lens.isPerspective() ? glm::dvec3(most * std::cos(angle), most * std::sin(angle), -1.0)
                                                : glm::dvec3(std::sin(most) * std::cos(angle),
                                                             std::sin(most) * std::sin(angle), -std::cos(most));
    if (const auto pixel = lens.project(ray); pixel && inPicture(lens, *pixel)) add(ray);
  }
  return r;
}

double lanczos(double x) {
  constexpr double kLobes = 3;
  if (std::abs(x) < 1e-9) return 1;
  if (std::abs(x) >= kLobes) return 0;
  const double a = std::numbers::pi * x;
  return kLobes * std::sin(a) * std::sin(a / kLobes) / (a * a);
}

constexpr int kTaps = 6, kPhases = 1024;

// Weights of the six samples around a position, by its fraction; their sum is 1.
std::vector<std::array<float, kTaps>> makeWeights() {
  std::vector<std::array<float, kTaps>> table(kPhases + 1);
  for (int p = 0; p <= kPhases; ++p) {
    double sum = 0;
    for (int k = 0; k < kTaps; ++k) sum += lanczos(k - 2 - double(p) / kPhases);
    for (int k = 0; k < kTaps; ++k)
      table[std::size_t(p)][std::size_t(k)] = float(lanczos(k - 2 - double(p) / kPhases) / sum);
  }
  return table;
}

class Sampler {
 public:
  explicit Sampler(const Image8& picture) : picture_(picture), weights_(makeWeights()) {}

  // Samples at a position in px (pixel centres at .5); the border pixels are repeated.
  void sample(glm::dvec2 at, std::span<std::uint8_t> result) const {
    const double x = std::floor(at.x - 0.5), y = std::floor(at.y - 0.5);
    const auto& across = weights_[std::size_t(std::lround((at.x - 0.5 - x) * kPhases))];
    const auto& down = weights_[std::size_t(std::lround((at.y - 0.5 - y) * kPhases))];
    std::array<float, 4> sum{};
    for (int j = 0; j < kTaps; ++j) {
      const int row = std::clamp(int(y) + j - 2, 0, picture_.height - 1);
      std::array<float, 4> line{};
      for (int i = 0; i < kTaps; ++i) {
        const auto value = picture_.pixel(std::clamp(int(x) + i - 2, 0, picture_.width - 1), row);
        for (std::size_t c = 0; c < result.size(); ++c) line[c] += across[std::size_t(i)] * float(value[c]);
      }
      for (std::size_t c = 0; c < result.size(); ++c) sum[c] += down[std::size_t(j)] * line[c];
    }
    for (std::size_t c = 0; c < result.size(); ++c) result[c] = std::uint8_t(std::clamp(sum[c] + 0.5f, 0.0f, 255.0f));
  }

 private:
  const Image8& picture_;
  std::vector<std::array<float, kTaps>> weights_;
};

}  // namespace

Intrinsics undistorted(const Lens& lens, Border border) {
  const auto ray = lens.unproject({0.5 * lens.width(), 0.5 * lens.height()});
  const glm::dvec2 middle =
      ray && ray->z < 0 ? glm::dvec2(ray->x / -ray->z, ray->y / ray->z) : glm::dvec2(2 * kMaxTangent);
  check(std::max(std::abs(middle.x), std::abs(middle.y)) < kMaxTangent, ErrorCode::invalidInput,
        "the centre of an image of {}x{} px is not within {}° of the axis of its lens", lens.width(), lens.height(),
        kMaxHalfFovDegrees);
  const Rectangle r = border == Border::crop ? cropped(lens, middle) : kept(lens, middle);
  // At its centre the lens magnifies by the derivative of its distortion.
  const double magnified =
      lens.distortion().omega != 0 ? 2 * std::tan(0.5 * lens.distortion().omega) / lens.distortion().omega : 1.0;
  Intrinsics k;
  k.fx = lens.focal().x * magnified;
  k.fy = lens.focal().y * magnified;
  const double width = (r.right - r.left) * k.fx, height = (r.bottom - r.top) * k.fy;
  const auto pixels = [&](double size) {
    return std::max(1, int(border == Border::crop ? std::floor(size) : std::ceil(size)));
  };
  k.width = pixels(width);
  k.height = pixels(height);
  k.cx = -r.left * k.fx + 0.5 * (k.width - width);
  k.cy = -r.top * k.fy + 0.5 * (k.height - height);
  return k;
}

Image8 undistort(const Image8& picture, const Lens& lens, const Intrinsics& pinhole) {
  const glm::dvec2 scale(double(picture.width) / lens.width(), double(picture.height) / lens.height());
  const Sampler sampler(picture);
  Image8 result(pinhole.width, pinhole.height, picture.channels);
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x) {
      const auto seen = seenAt(lens, {(x + 0.5 - pinhole.cx) / pinhole.fx, (y + 0.5 - pinhole.cy) / pinhole.fy});
      if (seen && inPicture(lens, *seen)) sampler.sample(*seen * scale, result.pixel(x, y));
    }
  return result;
}

std::optional<glm::dvec2> undistort(glm::dvec2 pixel, const Lens& lens, const Intrinsics& pinhole) {
  const auto ray = lens.unproject(pixel);
  const auto moved = ray ? project(pinhole, *ray) : std::nullopt;
  if (!moved || moved->x < 0 || moved->y < 0 || moved->x > pinhole.width || moved->y > pinhole.height)
    return std::nullopt;
  return moved;
}

bool photographed(glm::dvec2 pixel, const Lens& lens, const Intrinsics& pinhole) {
  const auto seen = seenAt(lens, {(pixel.x - pinhole.cx) / pinhole.fx, (pixel.y - pinhole.cy) / pinhole.fy});
  return seen && inPicture(lens, *seen);
}

}  // namespace ibr
