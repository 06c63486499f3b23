// SPDX-License-Identifier: Apache-2.0
// Reads triangle meshes from files, and writes coloured ones.
//
// Readers trust no input: counts are checked against the file's size before any allocation. Own readers replace CGAL's,
// which report only failure, take a missing coordinate for 0 and misread faces with tabs.
#pragma once

#include <filesystem>
#include <glm/gtc/type_precision.hpp>
#include <vector>

#include "ibr/htm_model.h"

namespace ibr {

/// Reads PLY (text and binary, both byte orders), OBJ, or the triangles of a glTF document (.gltf, .glb) placed by its
/// nodes; the extension decides. Polygons become fans around their first corner. Positions keep the file's axes and
/// unit. Throws Error{io} if the file cannot be read, Error{unsupported} for another extension, and
/// Error{invalidInput} that names the file and the fault: truncated, no face, a face index without a vertex, a
/// coordinate that is not finite.
TriangleMesh readTriangleMesh(const std::filesystem::path& path);

/// Readers of the three formats, for readTriangleMesh, which checks indices and values.
TriangleMesh readPly(const std::filesystem::path& path);
TriangleMesh readObj(const std::filesystem::path& path);
TriangleMesh readGltfTriangles(const std::filesystem::path& path);

/// Display-encoded colours: one per vertex or per face, or none.
struct MeshColours {
  std::vector<glm::u8vec3> vertices, faces;
};

/// Writes binary little-endian PLY with positions as doubles, which reads back bit-identical. Throws Error{io}, or
/// Error{invalidInput} if the number of colours does not match.
void writePly(const std::filesystem::path& path, const TriangleMesh& mesh, const MeshColours& colours = {});

}  // namespace ibr
