// SPDX-License-Identifier: Apache-2.0
#include "author/surface/triangle_mesh_file.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/check.h"
#include "base/file.h"
#include "scene/scene_faults.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "files are written in native byte order");

void checkMesh(const TriangleMesh& mesh, const fs::path& path) {
  check(!mesh.triangles.empty(), ErrorCode::invalidInput, "{}: has no face", path.string());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    check(finite(mesh.positions[v]), ErrorCode::invalidInput, "{}: vertex {} is not finite", path.string(), v);
  for (const glm::uvec3& t : mesh.triangles) {
    const std::uint32_t largest = std::max({t.x, t.y, t.z});
    check(largest < mesh.positions.size(), ErrorCode::invalidInput,
          "{}: a face has vertex index {}, but there are {} vertices", path.string(), largest, mesh.positions.size());
  }
}

template <class T>
void append(std::string& bytes, const T& value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(&bytes[at], &value, sizeof value);
}

}  // namespace

TriangleMesh readTriangleMesh(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  TriangleMesh mesh;
  if (extension == ".ply")
    mesh = readPly(path);
  else if (extension == ".obj")
    mesh = readObj(path);
  else if (extension == ".gltf" || extension == ".glb")
    mesh = readGltfTriangles(path);
  else
    fail(ErrorCode::unsupported, "{}: not a supported mesh file; use .ply, .obj, .gltf or .glb", path.string());
  checkMesh(mesh, path);
  return mesh;
}

void writePly(const fs::path& path, const TriangleMesh& mesh, const MeshColours& colours) {
  check(colours.vertices.empty() || colours.vertices.size() == mesh.positions.size(), ErrorCode::invalidInput,
        "{}: {} colours for {} vertices", path.string(), colours.vertices.size(), mesh.positions.size());
  check(colours.faces.empty() || colours.faces.size() == mesh.triangles.size(), ErrorCode::invalidInput,
        "{}: {} colours for {} faces", path.string(), colours.faces.size(), mesh.triangles.size());
  const char* rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\n"
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n{}"
      "element face {}\nproperty list uchar uint vertex_indices\n{}end_header\n",
      mesh.positions.size(), colours.vertices.empty() ? "" : rgb, mesh.triangles.size(),
      colours.faces.empty() ? "" : rgb);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    append(bytes, mesh.positions[v]);
    if (!colours.vertices.empty()) append(bytes, colours.vertices[v]);
  }
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    append(bytes, std::uint8_t(3));
    append(bytes, mesh.triangles[f]);
    if (!colours.faces.empty()) append(bytes, colours.faces[f]);
  }
  writeFile(path, bytes);
}

}  // namespace ibr
