// SPDX-License-Identifier: Apache-2.0
// Barycentric coordinates of the virtual camera in a cell's simplex: [T] §2.5.1, eqs 1–3, and their clamping to the
// closest point of the simplex.
//
// Departure: [T] inverts a 4×4 matrix of positions. Here positions are relative to one corner, and signed volumes with
// compensated products solve the system. Large worlds and flat simplices keep their precision.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "ibr/conventions.h"

namespace ibr {

using Weights = std::array<double, 4>;  // one per member, 0 beyond the last

struct Barycentric {
  Weights free{};           // λ of the orthogonal projection of p on the simplex's span; sums to 1, may be negative
  Weights clamped{};        // λ of the point of the simplex closest to p; in [0, 1], sums to 1
  double distance = 0;      // from p to that closest point, world units
  bool degenerate = false;  // corners coincide, are collinear or coplanar: `free` is of the largest proper face
};

/// corners: 1 to 4 finite points. p: finite.
Barycentric barycentric(std::span<const glm::dvec3> corners, glm::dvec3 p);

/// Applies f(x) = 6x⁵ − 15x⁴ + 10x³ ([T] §2.5.1) to each weight, then normalises. `weights` are clamped coordinates.
Weights smoothstep(const Weights& weights);

}  // namespace ibr
