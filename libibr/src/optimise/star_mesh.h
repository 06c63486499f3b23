// SPDX-License-Identifier: Apache-2.0
// A mesh to be aligned, for all methods: the triangles around each point, the triangles that must not fold over, the
// points that may move at once, and the freedom of points on the border.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "ibr/optimiser.h"

namespace ibr {

using Positions = std::vector<std::vector<glm::ivec2>>;  // member × point, 1/128 px

/// A list of lists.
template <class T>
struct Rows {
  std::vector<std::uint32_t> first{0};  // rows + 1
  std::vector<T> values;
  std::span<const T> operator[](std::size_t row) const {
    return std::span(values).subspan(first[row], first[row + 1] - first[row]);
  }
  void add(std::span<const T> row) {
    values.insert(values.end(), row.begin(), row.end());
    first.push_back(std::uint32_t(values.size()));
  }
};

/// Freedom of a point to move.
enum class BorderKind : std::uint8_t { interior, slides, fixed };

struct StarMesh {
  std::vector<glm::ivec2> size;    // d, of the images, px
  Rows<glm::uvec2> star;           // n: the other corners of judged triangles, in the triangle's order
  Rows<glm::uvec2> kept;           // n: of triangles that are only kept from folding over …
  Rows<std::uint32_t> keptWhere;   // … bit i: in image i, if not folded over at the start; one word each
  std::vector<glm::uvec2> chord;   // n: of a point that slides, its neighbours on the border; (0, 0) = interior
  std::vector<BorderKind> border;  // n
  Rows<std::uint32_t> colours;     // points that may move, in classes that share no triangle, ascending
  std::size_t vertexCount() const { return border.size(); }
  std::size_t memberCount() const { return size.size(); }
};

/// Throws Error{invalidInput} with the field: sizes that differ, indices out of range, positions outside their image,
/// images that are not RGB, judged triangles that are folded over. A judged triangle that is folded over in the mean
/// of two images or of all is left out of the stars, and its corners are fixed.
StarMesh starMeshOf(const Alignment& alignment);

/// True if a triangle is positive in each image, in the mean of each two and in the mean of all. Exact.
bool isUnfolded(const Positions& at, const glm::uvec3& t);

/// Maximum displacement of a point in `member`, 1/128 px: at most `most`, 0 if it cannot move. Within it, no judged
/// triangle folds over in the image, in its mean with any other or in the mean of all ([T] fig. 15).
int maxMove(const StarMesh& mesh, const Positions& at, std::uint32_t point, std::size_t member, int most);

/// Offset of candidate `instance` >= 1 from the point; `seed` is the point's own in this step.
glm::ivec2 candidateOffset(const StarMesh& mesh, const Positions& at, std::uint32_t point, std::size_t member,
                           int radius, std::uint32_t seed, std::uint32_t instance);

/// True if the offset keeps the point in the image and folds no triangle that is not folded already. Exact.
bool fits(const StarMesh& mesh, const Positions& at, std::uint32_t point, std::size_t member, glm::ivec2 offset);

}  // namespace ibr
