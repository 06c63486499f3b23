// SPDX-License-Identifier: Apache-2.0
#include "shared/report/graph_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace ibr::app {
namespace {

constexpr double kEqualSpreadRatio = 1.15;  // ratio below which two spreads count as equal
constexpr double kLevel = 0.3;              // |cos| between an axis and up below which the axis counts as horizontal

struct Spreads {
  std::array<glm::dvec3, 3> axis;  // largest spread first
  std::array<double, 3> spread;
};

// Eigenvectors of a symmetric matrix by Jacobi rotations.
Spreads spreadsOf(glm::dmat3 m) {
  glm::dmat3 vectors(1.0);
  for (int sweep = 0; sweep < 30; ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (m[p][q] == 0.0) continue;
        const double angle = 0.5 * std::atan2(2 * m[p][q], m[q][q] - m[p][p]);
        const double c = std::cos(angle), s = std::sin(angle);
        glm::dmat3 turn(1.0);
        turn[p][p] = turn[q][q] = c;
        turn[q][p] = s;
        turn[p][q] = -s;
        m = glm::transpose(turn) * m * turn;
        vectors = vectors * turn;
      }
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return m[a][a] > m[b][b]; });
  Spreads spreads;
  for (std::size_t k = 0; k < 3; ++k) {
    spreads.axis[k] = vectors[order[k]];
    spreads.spread[k] = std::sqrt(std::max(m[order[k]][order[k]], 0.0));
  }
  return spreads;
}

glm::dvec3 unitOr(glm::dvec3 v, glm::dvec3 otherwise) {
  return glm::length(v) > 1e-9 ? glm::normalize(v) : otherwise;
}

// Returns a unit vector orthogonal to `v`.
glm::dvec3 aside(glm::dvec3 v) {
  return glm::normalize(glm::cross(v, std::abs(v.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
}

}  // namespace

glm::dvec2 GraphView::flat(glm::dvec3 point) const {
  return {glm::dot(point - centre, right), glm::dot(point - centre, up)};
}

GraphView graphView(const Scene& scene) {
  GraphView view;
  glm::dvec3 up(0.0), back(0.0);
  for (const Node& node : scene.nodes) {
    view.centre += node.camera.pose.position / double(scene.nodes.size());
    up += node.camera.pose.rotation * glm::dvec3(0, 1, 0);
    back -= viewAxis(node.camera.pose);
  }
  up = unitOr(up, {0, 1, 0});
  glm::dmat3 covariance(0.0);
  double scale = 0;
  for (const Node& node : scene.nodes) scale = std::max(scale, glm::distance(node.camera.pose.position, view.centre));
  if (scale > 0)
    for (const Node& node : scene.nodes) {
      const glm::dvec3 p = (node.camera.pose.position - view.centre) / scale;
      covariance += glm::outerProduct(p, p);
    }
  const auto [axis, spread] = spreadsOf(covariance);
  const double least = kEqualSpreadRatio * spread[2] + 1e-3 * spread[0];
  glm::dvec3 toward = axis[2];
  if (!(spread[0] > least)) {
    toward = up;
  } else if (spread[1] <= least) {
    toward = unitOr(up - glm::dot(up, axis[0]) * axis[0], axis[2]);
  }
  const glm::dvec3 side = std::abs(glm::dot(toward, up)) > kLevel ? up : back;
  view.toward = glm::dot(toward, side) < 0 ? -toward : toward;
  view.right = unitOr(axis[0] - glm::dot(axis[0], view.toward) * view.toward, aside(view.toward));
  view.up = glm::cross(view.toward, view.right);
  return view;
}

}  // namespace ibr::app
