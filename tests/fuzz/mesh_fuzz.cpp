// SPDX-License-Identifier: Apache-2.0
// Fuzz target for triangle meshes from PLY, OBJ and glTF.
#include "author/surface/triangle_mesh_file.h"
#include "fuzz_target.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr const char* kPly = R"(ply
format ascii 1.0
comment made by hand
element vertex 4
property float x
property double y
property float z
property uchar red
element face 2
property list uchar int vertex_indices
end_header
0 0 0 1
1 0 0 2
1 1 0.5 3
0 1 0 4
3 0 1 2
4 0 1 2 3
)";
constexpr const char* kObj =
    "# made by hand\nv 0 0 0\nv 1 0 0\nv 1 1 .5\nv 0 1 0\nvn 0 0 1\nf 1 2/3 3//1\nf -4 -3 -2 -1\n";
constexpr const char* kGltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"children":[1],"translation":[1,2,3]},{"mesh":0,"scale":[1,1,2]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":3}],
"buffers":[{"byteLength":39,"uri":"a.bin"}]})";
const char* const kNames[] = {"a.ply", "a.obj", "a.gltf"};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const TemporaryFolder folder;
  static const bool once = (put(folder / "a.bin", std::string("\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0\0\0\0\0"
                                                              "\0\0\0\0\0\0\200?\0\0\0\0\0\1\2",
                                                              39)),
                            true);
  const Chosen input = chosen(data, size, 3);
  const std::filesystem::path file = folder / kNames[input.file];
  put(file, input.bytes);
  return answers([&] {
    const TriangleMesh mesh = readTriangleMesh(file);
    for (const glm::uvec3& t : mesh.triangles)
      demand(once && t.x < mesh.positions.size() && t.y < mesh.positions.size() && t.z < mesh.positions.size());
  });
}

std::vector<std::string> ibr::test::seeds() {
  const TemporaryFolder folder;
  put(folder / "a.ply", kPly);
  writePly(folder / "b.ply", readTriangleMesh(folder / "a.ply"));
  return {char(0) + std::string(kPly), seedOf(0, folder / "b.ply"), char(1) + std::string(kObj),
          char(2) + std::string(kGltf)};
}
