// SPDX-License-Identifier: Apache-2.0
// Triangle meshes from files and, coloured, to files.
//
// Readers trust nothing: counts are held against the file's size before memory is taken. Files are read by code of our
// own: CGAL's readers say only that they failed, take a missing coordinate for 0 and misread faces with tabs.
#pragma once

#include <filesystem>
#include <glm/gtc/type_precision.hpp>
#include <vector>

#include "ibr/htm_model.h"

namespace ibr {

/// PLY (text and binary, both byte orders), OBJ, or the triangles of a glTF document (.gltf, .glb) placed by its nodes;
/// told apart by the name's extension. Polygons become fans around their first corner. Positions keep the file's axes
/// and unit. Throws Error{io} where the file cannot be read, Error{unsupported} for another extension and
/// Error{invalidInput}, which names the file and what is wrong: cut short, no face, a face with an index that has no
/// vertex, a coordinate that is not finite.
TriangleMesh readTriangleMesh(const std::filesystem::path& path);

/// The three of them, for readTriangleMesh; indices and values are checked there.
TriangleMesh readPly(const std::filesystem::path& path);
TriangleMesh readObj(const std::filesystem::path& path);
TriangleMesh readGltfTriangles(const std::filesystem::path& path);

/// Display-encoded colours: as many as there are vertices or faces, or none.
struct MeshColours {
  std::vector<glm::u8vec3> vertices, faces;
};

/// Binary little-endian PLY with positions as doubles: reads back bit by bit. Throws Error{io}, or Error{invalidInput}
/// where numbers of colours do not fit.
void writePly(const std::filesystem::path& path, const TriangleMesh& mesh, const MeshColours& colours = {});

}  // namespace ibr
