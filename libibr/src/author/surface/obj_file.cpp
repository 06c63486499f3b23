// SPDX-License-Identifier: Apache-2.0
// Reads Wavefront OBJ: the vertices and faces of all groups; everything else is ignored.
#include <string_view>

#include "author/surface/triangle_mesh_file.h"
#include "base/check.h"
#include "base/file.h"
#include "base/parse.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kSpaces = " \t\r";

// Removes the next word from a line and returns it; empty at the line's end.
std::string_view nextWord(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kSpaces), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kSpaces));
  line.remove_prefix(word.size());
  return word;
}

}  // namespace

TriangleMesh readObj(const fs::path& path) {
  const std::string text = readTextFile(path);
  TriangleMesh mesh;
  std::size_t number = 0;
  const auto demand = [&](bool holds, std::string_view word, const char* what) {
    check(holds, ErrorCode::invalidInput, "{}: line {}: \"{}\" {}", path.string(), number, word.substr(0, 40), what);
  };
  for (std::string_view rest = text; !rest.empty();) {
    std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    ++number;
    const std::string_view key = nextWord(line);
    if (key == "v") {
      glm::dvec3& position = mesh.positions.emplace_back();
      for (int k = 0; k < 3; ++k) {
        const std::string_view word = nextWord(line);
        const auto value = parseDouble(word);
        demand(value.has_value(), word, "is not a finite coordinate");
        position[k] = *value;
      }
    } else if (key == "f") {
      std::uint32_t first = 0, last = 0;
      std::size_t corners = 0;
      for (std::string_view word = nextWord(line); !word.empty(); word = nextWord(line), ++corners) {
        const auto value = parseInt(word.substr(0, word.find('/')));
        demand(value && *value != 0, word, "is not a vertex index");
        const std::int64_t index = *value > 0 ? *value - 1 : std::int64_t(mesh.positions.size()) + *value;
        demand(index >= 0 && index <= std::int64_t(0xffffffff), word, "is out of the range of vertices");
        const auto corner = std::uint32_t(index);
        if (corners == 0) first = corner;
        if (corners >= 2) mesh.triangles.emplace_back(first, last, corner);
        last = corner;
      }
      demand(corners >= 3, key, "has fewer than three corners");
    }
  }
  return mesh;
}

}  // namespace ibr
