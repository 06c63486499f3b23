// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

namespace ibr::app {
namespace {

using Vertices = std::vector<ShapeVertex>;

constexpr double kTau = 2 * glm::pi<double>();
constexpr double kMaxMarkDistance = 60, kFadesFrom = 0.6;        // m; fading begins at this share of it
constexpr double kMinMarkDistance = 0.5, kClearAt = 1.5;         // m from the eye
constexpr double kRing = 0.2, kRingWidth = 0.03, kPost = 0.006;  // m
constexpr double kMinRingAngle = 0.012;                          // radians, min. apparent radius of a ring
constexpr double kEdge = 1000;                                   // a tangent beyond any field of view
constexpr double kMaxOpening = 1.7, kMinOpening = 0.364;         // tangents of the vignette's opening, strength 0 and 1
constexpr double kRim = 1.5;                                     // of the opening: from there on, all is black
constexpr double kGridRadius = 6, kGridStep = 0.5;               // m

struct Colour {
  double red = 1, green = 1, blue = 1, alpha = 1;
};
constexpr Colour kMark{0.75, 0.9, 1, 0.55}, kPointed{1, 0.8, 0.25, 0.95}, kHand{0.85, 0.87, 0.9, 1};
constexpr Colour kHandDark{0.45, 0.48, 0.52, 1}, kBeam{0.75, 0.9, 1, 0.6}, kGrid{0.6, 0.7, 0.8, 0.9};

std::uint32_t packed(const Colour& colour, double opacity = 1) {
  const auto byte = [](double value) { return std::uint32_t(std::lround(255 * std::clamp(value, 0.0, 1.0))); };
  return byte(colour.red) | byte(colour.green) << 8 | byte(colour.blue) << 16 | byte(colour.alpha * opacity) << 24;
}

// Adds a quad with one colour along its near side and one along its far side.
void addBand(Vertices& vertices, const std::array<glm::dvec3, 2>& near, const std::array<glm::dvec3, 2>& far,
             std::uint32_t nearColour, std::uint32_t farColour) {
  const ShapeVertex a{near[0], nearColour}, b{near[1], nearColour}, c{far[1], farColour}, d{far[0], farColour};
  vertices.insert(vertices.end(), {a, b, c, a, c, d});
}

// A ring between two radii around `centre`, in the plane of two unit axes; angles start at `x`.
struct Annulus {
  glm::dvec3 centre, x, y;
  double inner = 0, outer = 1;
};

void addAnnulus(Vertices& vertices, const Annulus& ring, double from, double to, int segments, std::uint32_t inner,
                std::uint32_t outer) {
  const auto at = [&](double radius, double angle) {
    return ring.centre + radius * (std::cos(angle) * ring.x + std::sin(angle) * ring.y);
  };
  for (int i = 0; i < segments; ++i) {
    const double a = from + (to - from) * i / segments, b = from + (to - from) * (i + 1) / segments;
    addBand(vertices, {at(ring.inner, a), at(ring.inner, b)}, {at(ring.outer, a), at(ring.outer, b)}, inner, outer);
  }
}

double smooth(double low, double high, double value) {
  const double t = std::clamp((value - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// Returns the unit vector across a band that runs along `along` and faces the eye.
glm::dvec3 across(glm::dvec3 along, glm::dvec3 toEye) {
  const glm::dvec3 side = glm::cross(along, toEye);
  const double length = glm::length(side);
  return length > 1e-9 * glm::length(along) * glm::length(toEye) ? side / length : glm::dvec3(1, 0, 0);
}

struct Mark {
  double distance;  // from the eye, m
  glm::dvec3 photograph;
};

void addMark(Vertices& vertices, const Mark& mark, glm::dvec3 eye, double height, bool pointed) {
  const glm::dvec3 ground = mark.photograph - glm::dvec3(0, height, 0);
  const double opacity = pointed ? 1 : 1 - smooth(kFadesFrom * kMaxMarkDistance, kMaxMarkDistance, mark.distance);
  const Colour& colour = pointed ? kPointed : kMark;
  const double radius = std::max(kRing, kMinRingAngle * mark.distance), width = radius * kRingWidth / kRing;
  const std::uint32_t ring = packed(colour, opacity * smooth(kMinMarkDistance, kClearAt, glm::distance(ground, eye)));
  const std::uint32_t top = packed(colour, opacity * smooth(kMinMarkDistance, kClearAt, mark.distance));
  addAnnulus(vertices, {ground, {1, 0, 0}, {0, 0, 1}, radius - width, radius}, 0, kTau, mark.distance < 10 ? 24 : 12,
             ring, ring);
  const glm::dvec3 side =
      across({0, 1, 0}, eye - mark.photograph) * std::max(kPost, 0.1 * kMinRingAngle * mark.distance);
  addBand(vertices, {ground - side, ground + side}, {mark.photograph - side, mark.photograph + side}, ring, top);
}

}  // namespace

void addMarks(Shapes& shapes, const Spots& spots, const Tracking& tracking, const Pose& head,
              double photographHeightMetres, std::optional<std::size_t> pointed) {
  std::array<SpotDistance, kMaxMarks> nearest;
  std::size_t left =
      nearestSpots(spots, inWorld(tracking, head.position), kMaxMarkDistance * tracking.unitsPerMetre, nearest);
  while (left > 0) {
    const std::size_t spot = nearest[--left].spot;
    const glm::dvec3 photograph = inTracking(tracking, spots[spot].position);
    addMark(shapes.inSpace, {glm::distance(photograph, head.position), photograph}, head.position,
            photographHeightMetres, spot == pointed);
  }
}

void addHand(Shapes& shapes, const Pose& aim) {
  const auto at = [&](double x, double y, double z) {
    return glm::vec3(aim.position + aim.rotation * glm::dvec3(x, y, z));
  };
  const glm::vec3 tip = at(0, 0, 0), left = at(-0.02, -0.012, 0.14), right = at(0.02, -0.012, 0.14),
                  top = at(0, 0.02, 0.14);
  const std::uint32_t light = packed(kHand), dark = packed(kHandDark);
  const auto face = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c, std::uint32_t colour) {
    shapes.inSpace.insert(shapes.inSpace.end(), {{a, colour}, {b, colour}, {c, colour}});
  };
  face(tip, left, top, light);
  face(tip, top, right, light);
  face(tip, right, left, dark);
  face(left, right, top, dark);
}

void addRay(Shapes& shapes, const Pose& head, const Pose& aim, double metres, bool hasTarget) {
  const double length = std::clamp(std::isfinite(metres) ? metres : 0, 0.0, kMaxMarkDistance);
  if (length == 0) return;
  const glm::dvec3 along = viewAxis(aim), end = aim.position + length * along;
  const glm::dvec3 side = across(along, head.position - aim.position);
  const double thin = 0.002, thick = std::max(0.002, 0.001 * length);
  const Colour& colour = hasTarget ? kPointed : kBeam;
  addBand(shapes.inSpace, {aim.position - thin * side, aim.position + thin * side},
          {end - thick * side, end + thick * side}, packed(colour), packed(colour, hasTarget ? 1 : 0));
}

double rayLength(const Spot& spot, const Tracking& tracking, const Pose& aim, double photographHeightMetres) {
  const glm::dvec3 photograph = inTracking(tracking, spot.position) - aim.position;
  const glm::dvec3 ground = photograph - glm::dvec3(0, photographHeightMetres, 0), along = viewAxis(aim);
  const auto cosine = [&](glm::dvec3 to) { return glm::dot(to, along) / glm::length(to); };
  return glm::length(cosine(ground) >= cosine(photograph) ? ground : photograph);
}

void addFade(Shapes& shapes, double strength) {
  if (!(strength > 0)) return;
  const std::uint32_t black = packed({0, 0, 0, 1}, strength);
  addBand(shapes.onView, {glm::dvec3(-kEdge, -kEdge, -1), {kEdge, -kEdge, -1}},
          {glm::dvec3(-kEdge, kEdge, -1), {kEdge, kEdge, -1}}, black, black);
}

void addVignette(Shapes& shapes, double strength) {
  if (!(strength > 0)) return;
  const double s = std::min(strength, 1.0), opening = std::lerp(kMaxOpening, kMinOpening, s);
  const std::uint32_t black = packed({0, 0, 0, 1}, std::min(1.0, 4 * s)), clear = packed({0, 0, 0, 0});
  const Annulus rim{{0, 0, -1}, {1, 0, 0}, {0, 1, 0}, opening, kRim * opening};
  Annulus around = rim;
  around.inner = rim.outer;
  around.outer = 2 * kEdge;
  addAnnulus(shapes.onView, rim, 0, kTau, 64, clear, black);
  addAnnulus(shapes.onView, around, 0, kTau, 64, black, black);
}

void addFloorGrid(Shapes& shapes, const Pose& head) {
  const double thin = 0.006;
  const glm::dvec3 x(1, 0, 0), z(0, 0, 1), feet(head.position.x, 0, head.position.z);
  // Adds a grid line across `side`, brightest next to the feet.
  const auto line = [&](glm::dvec3 along, glm::dvec3 side, double offset) {
    if (!(std::abs(offset) < kGridRadius)) return;
    const glm::dvec3 middle = feet + offset * side;
    const double reach = std::sqrt(kGridRadius * kGridRadius - offset * offset);
    const std::uint32_t bright = packed(kGrid, 1 - std::abs(offset) / kGridRadius), clear = packed(kGrid, 0);
    for (const glm::dvec3& end : {middle - reach * along, middle + reach * along})
      addBand(shapes.inSpace, {middle - thin * side, middle + thin * side}, {end - thin * side, end + thin * side},
              bright, clear);
  };
  const int lines = int(kGridRadius / kGridStep) + 1;
  for (int i = -lines; i <= lines; ++i) {
    line(z, x, kGridStep * (std::round(feet.x / kGridStep) + i) - feet.x);
    line(x, z, kGridStep * (std::round(feet.z / kGridStep) + i) - feet.z);
  }
}

void addProgressRing(Shapes& shapes, const Pose& head, std::optional<double> progress, double seconds) {
  const glm::dvec3 ahead = facingOf(head.rotation), right = glm::cross(ahead, glm::dvec3(0, 1, 0));
  const glm::dvec3 middle = glm::dvec3(head.position.x, 1, head.position.z) + 2.0 * ahead;
  const Annulus ring{middle, {0, 1, 0}, right, 0.14, 0.17};
  const bool known = progress && std::isfinite(*progress);
  const double turn = std::fmod(seconds, 2.0) / 2 * kTau;
  const double from = known ? 0 : turn, to = known ? kTau * std::clamp(*progress, 0.0, 1.0) : turn + kTau / 4;
  const std::uint32_t dim = packed(kGrid, 0.3), bright = packed(kMark, 1.5);
  addAnnulus(shapes.inSpace, ring, 0, kTau, 48, dim, dim);
  if (to > from) addAnnulus(shapes.inSpace, ring, from, to, 48, bright, bright);
}

}  // namespace ibr::app
