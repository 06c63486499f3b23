// SPDX-License-Identifier: Apache-2.0
#include "author/geometry/lens_distortion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "base/check.h"

namespace ibr {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMaxAxisAngle = 89.9 / 180.0 * kPi;  // max angle to the axis for perspective models

constexpr std::array<std::size_t, kLensModelCount> kParameterCounts{3, 4, 4, 5, 8, 8, 12, 5, 4, 5, 12};

bool isFisheye(LensModel model) {
  return model == LensModel::opencvFisheye || model == LensModel::simpleRadialFisheye ||
         model == LensModel::radialFisheye || model == LensModel::thinPrismFisheye;
}

// True for models with one focal length for both axes.
bool isSimple(LensModel model) {
  return model == LensModel::simplePinhole || model == LensModel::simpleRadial || model == LensModel::radial ||
         model == LensModel::simpleRadialFisheye || model == LensModel::radialFisheye;
}

LensDistortion distortionOf(LensModel model, std::span<const double> k) {
  switch (model) {
    case LensModel::simplePinhole:
    case LensModel::pinhole:
      return {};
    case LensModel::simpleRadial:
    case LensModel::simpleRadialFisheye:
      return {.numerator = {k[0]}};
    case LensModel::radial:
    case LensModel::radialFisheye:
      return {.numerator = {k[0], k[1]}};
    case LensModel::opencv:
      return {.numerator = {k[0], k[1]}, .tangential = {k[2], k[3]}};
    case LensModel::opencvFisheye:
      return {.numerator = {k[0], k[1], k[2], k[3]}};
    case LensModel::fullOpencv:
      return {.numerator = {k[0], k[1], k[4]}, .denominator = {k[5], k[6], k[7]}, .tangential = {k[2], k[3]}};
    case LensModel::fov:
      return {.omega = k[0]};
    case LensModel::thinPrismFisheye:
      return {.numerator = {k[0], k[1], k[4], k[5]}, .tangential = {k[2], k[3]}, .prism = {k[6], k[7]}};
  }
  return {};
}

// h(s) of d(m) = m·h(|m|²), and its derivative.
struct Factor {
  double value, slope;
};

template <std::size_t N>
Factor polynomial(const std::array<double, N>& k, double s) {
  double value = 0, slope = 0;
  for (std::size_t i = N; i-- > 0;) {
    slope = slope * s + double(i + 1) * k[i];
    value = (value + k[i]) * s;
  }
  return {1 + value, slope};
}

Factor fovFactor(double omega, double s) {
  const double a = 2 * std::tan(0.5 * omega), t = a * a * s;
  const double middle = std::abs(omega) < 1e-4 ? 1 + omega * omega / 12 : a / omega;
  if (t < 1e-6) return {middle * (1 - t / 3 + t * t / 5), middle * a * a * (-1.0 / 3 + 2 * t / 5)};
  const double r = std::sqrt(s), x = a * r, angle = std::atan(x);
  return {middle * angle / x, middle * (1 / (1 + t) - angle / x) / (2 * s)};
}

Factor factor(const LensDistortion& l, double s) {
  if (l.omega != 0) return fovFactor(l.omega, s);
  const Factor n = polynomial(l.numerator, s), d = polynomial(l.denominator, s);
  return {n.value / d.value, (n.slope - n.value / d.value * d.slope) / d.value};
}

// Radius at which the radial part stops growing, limited to a maximum. Searched in equal steps of the angle to the
// axis; `fisheye` selects how an angle is converted to a radius.
double foldRadius(const LensDistortion& l, bool fisheye) {
  const auto radius = [&](double angle) { return fisheye ? angle : std::tan(angle); };
  const auto grows = [&](double angle) {
    const double r = radius(angle);
    return polynomial(l.denominator, r * r).value > 0 && radial(l, r).slope > 0;
  };
  const double most = fisheye ? kPi : kMaxAxisAngle;
  constexpr int kSteps = 4000;
  for (int i = 0; i <= kSteps; ++i) {
    if (grows(most * i / kSteps)) continue;
    if (i == 0) return 0;
    double low = most * (i - 1) / kSteps, high = most * i / kSteps;
    for (int step = 0; step < 60; ++step) (grows(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
    return radius(low);
  }
  return radius(most);
}

bool isRadial(const LensDistortion& l) {
  return l.tangential == std::array<double, 2>{} && l.prism == std::array<double, 2>{};
}

// Inverts the radial part within [0, limit]: Newton, with bisection where a step would leave the current interval.
// Returns an end of the range if `value` lies beyond it.
double inverseRadial(const LensDistortion& l, double value, double limit) {
  double low = 0, high = limit, r = std::min(value / radial(l, 0).slope, limit);
  for (int step = 0; step < 200; ++step) {
    const RadialValue at = radial(l, r);
    (at.value < value ? low : high) = r;
    double next = r - (at.value - value) / at.slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - r) <= 1e-16 * (1 + r)) return next;
    r = next;
  }
  return r;
}

}  // namespace

std::size_t parameterCount(LensModel model) {
  return kParameterCounts[std::size_t(model)];
}

std::vector<double> parametersOf(const Lens& lens) {
  std::vector<double> list{lens.focal().x};
  if (!isSimple(lens.model())) list.push_back(lens.focal().y);
  list.insert(list.end(), {lens.centre().x, lens.centre().y});
  const LensDistortion& l = lens.distortion();
  const auto add = [&](const auto& values, std::size_t from, std::size_t to) {
    list.insert(list.end(), values.begin() + std::ptrdiff_t(from), values.begin() + std::ptrdiff_t(to));
  };
  if (lens.model() == LensModel::fov) {
    list.push_back(l.omega);
    return list;
  }
  const std::size_t count = parameterCount(lens.model()) - list.size();
  if (lens.model() == LensModel::opencvFisheye) {
    add(l.numerator, 0, 4);
    return list;
  }
  add(l.numerator, 0, std::min<std::size_t>(count, 2));
  if (count >= 4) add(l.tangential, 0, 2);
  if (lens.model() == LensModel::fullOpencv) {
    add(l.numerator, 2, 3);
    add(l.denominator, 0, 3);
  }
  if (lens.model() == LensModel::thinPrismFisheye) {
    add(l.numerator, 2, 4);
    add(l.prism, 0, 2);
  }
  return list;
}

RadialValue radial(const LensDistortion& l, double r) {
  const Factor h = factor(l, r * r);
  return {r * h.value, h.value + 2 * r * r * h.slope};
}

Distorted distort(const LensDistortion& l, glm::dvec2 m) {
  const double s = glm::dot(m, m), xy = m.x * m.y;
  const Factor h = factor(l, s);
  const auto [p1, p2] = l.tangential;
  const auto [s1, s2] = l.prism;
  Distorted d;
  d.point = {m.x * h.value + 2 * p1 * xy + p2 * (s + 2 * m.x * m.x) + s1 * s,
             m.y * h.value + 2 * p2 * xy + p1 * (s + 2 * m.y * m.y) + s2 * s};
  d.jacobian[0] = {h.value + 2 * h.slope * m.x * m.x + 2 * p1 * m.y + 6 * p2 * m.x + 2 * s1 * m.x,
                   2 * h.slope * xy + 2 * p2 * m.y + 2 * p1 * m.x + 2 * s2 * m.x};
  d.jacobian[1] = {2 * h.slope * xy + 2 * p1 * m.x + 2 * p2 * m.y + 2 * s1 * m.y,
                   h.value + 2 * h.slope * m.y * m.y + 2 * p2 * m.x + 6 * p1 * m.y + 2 * s2 * m.y};
  return d;
}

Lens::Lens(LensModel model, int width, int height, std::span<const double> p)
    : model_(model), width_(width), height_(height) {
  check(p.size() == parameterCount(model), ErrorCode::invalidInput, "a lens has {} parameters, but its model takes {}",
        p.size(), parameterCount(model));
  check(std::ranges::all_of(p, [](double v) { return std::isfinite(v); }), ErrorCode::invalidInput,
        "a lens has a parameter that is not finite");
  check(width >= 1 && height >= 1, ErrorCode::invalidInput, "the image size of a lens is {}x{} px, less than 1x1 px",
        width, height);
  const std::size_t c = isSimple(model) ? 1 : 2;
  focal_ = {p[0], p[c - 1]};
  centre_ = {p[c], p[c + 1]};
  check(focal_.x > 0 && focal_.y > 0, ErrorCode::invalidInput, "focal lengths {} and {} of a lens are not positive",
        focal_.x, focal_.y);
  distortion_ = distortionOf(model, p.subspan(c + 2));
  check(std::abs(distortion_.omega) < kPi, ErrorCode::invalidInput, "ω {} of a lens is not within ±π",
        distortion_.omega);
  maxRadius_ = foldRadius(distortion_, isFisheye(model));
}

bool Lens::isPerspective() const {
  return !isFisheye(model_);
}

bool Lens::distorts() const {
  return isFisheye(model_) || !(distortion_ == LensDistortion{});
}

std::optional<glm::dvec2> Lens::project(glm::dvec3 direction) const {
  const double x = direction.x, y = -direction.y, z = -direction.z;  // y down, z forward
  glm::dvec2 m(x / z, y / z);
  if (isFisheye(model_)) {
    const double across = std::hypot(x, y);
    if (!(across > 0) && !(across == 0 && z > 0)) return std::nullopt;  // NaN, too
    const double angle = std::atan2(across, z);
    m = across > 0 ? glm::dvec2(x, y) * (angle / across) : glm::dvec2(0);
  } else if (!(z > 0)) {
    return std::nullopt;
  }
  glm::dvec2 d = m;
  if (distorts()) {
    if (!(glm::length(m) <= maxRadius_)) return std::nullopt;
    const Distorted at = distort(distortion_, m);
    if (!isRadial(distortion_) && !(glm::determinant(at.jacobian) > 0)) return std::nullopt;
    d = at.point;
  }
  const glm::dvec2 pixel = focal_ * d + centre_;
  return std::isfinite(pixel.x) && std::isfinite(pixel.y) ? std::optional(pixel) : std::nullopt;
}

std::optional<glm::dvec3> Lens::unproject(glm::dvec2 pixel) const {
  const glm::dvec2 d = (pixel - centre_) / focal_;
  const double length = glm::length(d);
  if (!std::isfinite(length)) return std::nullopt;
  constexpr double kAccuracy = 1e-10;
  glm::dvec2 m = d;
  if (!(distortion_ == LensDistortion{})) {
    if (!(maxRadius_ > 0)) return std::nullopt;
    // Newton, starting from the inverse of the radial part, which is exact for purely radial distortion.
    m = length > 0 ? d * (inverseRadial(distortion_, length, maxRadius_) / length) : d;
    Distorted at = distort(distortion_, m);
    double error = glm::distance(at.point, d);
    for (int step = 0; step < 50 && error > 1e-15 && !isRadial(distortion_); ++step) {
      if (!(glm::determinant(at.jacobian) > 0)) return std::nullopt;
      const glm::dvec2 whole = glm::inverse(at.jacobian) * (at.point - d);
      double share = 1;
      bool better = false;
      for (int half = 0; half < 30 && !better; ++half, share *= 0.5) {
        const glm::dvec2 next = m - share * whole;
        if (!(glm::length(next) <= maxRadius_)) continue;
        const Distorted there = distort(distortion_, next);
        if (!(glm::distance(there.point, d) < error)) continue;
        m = next;
        at = there;
        error = glm::distance(at.point, d);
        better = true;
      }
      if (!better) break;
    }
    if (!(error <= kAccuracy * (1 + length)) || !(glm::determinant(at.jacobian) > 0)) return std::nullopt;
  }
  const double r = glm::length(m);
  if (!(r <= maxRadius_ * (1 + kAccuracy)) && distorts()) return std::nullopt;
  if (!isFisheye(model_)) return glm::normalize(glm::dvec3(m.x, -m.y, -1.0));
  const double share = r > 0 ? std::sin(r) / r : 1.0;
  return glm::dvec3(m.x * share, -m.y * share, -std::cos(r));
}

}  // namespace ibr
