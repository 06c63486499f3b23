// SPDX-License-Identifier: Apache-2.0
#include "author/surface/triangle_mesh_file.h"

#include <catch2/catch.hpp>
#include <cstring>

#include "base/file.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

using Catch::Contains;

const char* const kPly =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
    "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0.5 255\n4 0 1 2 3\n";
const char* const kObj =
    "# made by hand\nmtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0 \r\nv 0 1 0.5\nvt 0 0\n\ng one\nusemtl a\n"
    "f 1/1/1\t2//1 -2 4/1\nl 1 2\n";

TriangleMesh bent() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5}}, {{0, 1, 2}, {0, 2, 3}}};
}

// Returns a glTF document with one mesh and two nodes, the second one a child of the first.
std::string gltf(const std::string& buffer, const std::string& more = "") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
         R"("nodes":[{"children":[1],"translation":[10,0,0]},{"mesh":0,"scale":[1,1,2]}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1)" +
         more + R"(},{"attributes":{"POSITION":0},"mode":1}]}],)" +
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0.5]},)"
         R"({"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":6}],)"
         R"("buffers":[{)" +
         buffer + R"("byteLength":54}]})";
}

std::string gltfBytes() {
  const float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.25F};
  const unsigned char indices[] = {0, 1, 2, 0, 2, 3};
  std::string bytes(54, '\0');
  std::memcpy(bytes.data(), positions, 48);
  std::memcpy(&bytes[48], indices, 6);
  return bytes;
}

std::string glb(std::string json, std::string binary) {
  while (json.size() % 4) json += ' ';
  while (binary.size() % 4) binary += '\0';
  const auto word = [](std::size_t value) {
    const auto number = std::uint32_t(value);
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &number, 4);
    return bytes;
  };
  return "glTF" + word(2) + word(28 + json.size() + binary.size()) + word(json.size()) + "JSON" + json +
         word(binary.size()) + std::string("BIN\0", 4) + binary;
}

struct Files {
  test::TemporaryFolder folder;
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    writeFile(folder.path() / name, text);
    return folder.path() / name;
  }
  void refused(const std::string& name, const std::string& text, const std::string& why) const {
    const std::filesystem::path path = write(name, text);
    const Error error = test::errorOf([&] { readTriangleMesh(path); });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Contains(path.string()) && Contains(why));
  }
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

TEST_CASE("every file format gives the same mesh") {
  const Files files;
  CHECK(readTriangleMesh(files.write("a.ply", kPly)) == bent());
  CHECK(readTriangleMesh(files.write("a.OBJ", kObj)) == bent());
  TriangleMesh moved = bent();
  for (glm::dvec3& p : moved.positions) p.x += 10;
  files.write("a.bin", gltfBytes());
  CHECK(readTriangleMesh(files.write("a.gltf", gltf(R"("uri":"a.bin",)"))) == moved);
  CHECK(readTriangleMesh(files.write("a.glb", glb(gltf(""), gltfBytes()))) == moved);
}

TEST_CASE("glTF strips, fans, missing indices and mirrored nodes are read") {
  const Files files;
  files.write("a.bin", gltfBytes());
  const std::string plain = gltf(R"("uri":"a.bin",)");
  const auto triangles = [&](const std::string& text) {
    return readTriangleMesh(files.write("b.gltf", text)).triangles;
  };
  CHECK(triangles(replaced(plain, R"("scale":[1,1,2])", R"("scale":[-1,1,2])")) ==
        std::vector<glm::uvec3>{{0, 2, 1}, {0, 3, 2}});
  const std::string bare = replaced(plain, R"(,"indices":1})", R"(,"mode":5})");
  CHECK(triangles(bare) == std::vector<glm::uvec3>{{0, 1, 2}, {1, 3, 2}});
  CHECK(triangles(replaced(bare, R"("mode":5)", R"("mode":6)")) == std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}});
  const std::string matrix = R"("matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,5,6,7,1])";
  const TriangleMesh turned = readTriangleMesh(files.write("c.gltf", replaced(plain, R"("scale":[1,1,2])", matrix)));
  CHECK(turned.positions[1] == glm::dvec3(15, 7, 7));
  files.refused("d.gltf", replaced(plain, R"("children":[1])", R"("children":[0])"), "/nodes/0");
}

TEST_CASE("binary PLY of both byte orders is read") {
  const Files files;
  const TriangleMesh mesh = bent();
  const std::string header =
      "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 2\nproperty uchar flags\nproperty list uchar uint vertex_indices\nend_header\n";
  std::string little, big;
  const auto put = [&](const auto& value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    little += bytes;
    big += std::string(bytes.rbegin(), bytes.rend());
  };
  for (const glm::dvec3& p : mesh.positions)
    for (int k = 0; k < 3; ++k) put(p[k]);
  for (const glm::uvec3& t : mesh.triangles) {
    put(std::uint8_t(9));
    put(std::uint8_t(3));
    for (int k = 0; k < 3; ++k) put(t[k]);
  }
  const std::string start = "ply\nformat binary_";
  CHECK(readTriangleMesh(files.write("l.ply", start + "little_endian 1.0\n" + header + little)) == mesh);
  CHECK(readTriangleMesh(files.write("b.ply", start + "big_endian 1.0\n" + header + big)) == mesh);
  for (std::size_t cut = 1; cut <= little.size(); cut += 5)
    files.refused("cut.ply", start + "little_endian 1.0\n" + header + little.substr(0, little.size() - cut), "short");
}

TEST_CASE("a written mesh is read back unchanged") {
  const Files files;
  TriangleMesh mesh = test::sphere(10);
  mesh.positions[3] = {1.0 / 3, 1e300, -0.0};
  writePly(files.folder.path() / "s.ply", mesh);
  CHECK(readTriangleMesh(files.folder.path() / "s.ply") == mesh);
  MeshColours colours;
  colours.vertices.assign(mesh.positions.size(), {1, 2, 3});
  colours.faces.assign(mesh.triangles.size(), {255, 0, 128});
  writePly(files.folder.path() / "c.ply", mesh, colours);
  CHECK(readTriangleMesh(files.folder.path() / "c.ply") == mesh);
  colours.faces.pop_back();
  CHECK_THROWS_AS(writePly(files.folder.path() / "d.ply", mesh, colours), Error);
}

TEST_CASE("faults in mesh files are reported") {
  const Files files;
  files.refused("a.ply", "plyy\n", "PLY");
  files.refused("a.ply", "ply\nformat ascii 1.0\n", "end_header");
  files.refused("a.ply", replaced(kPly, "ascii", "latin"), "latin");
  files.refused("a.ply", replaced(kPly, "float x", "float w"), "x, y");
  files.refused("a.ply", replaced(kPly, "vertex_index", "corners"), "vertex_indices");
  files.refused("a.ply", replaced(kPly, "vertex 4", "vertex 4000000000"), "4000000000");
  files.refused("a.ply", replaced(kPly, "face 1", "face 2"), "short");
  files.refused("a.ply", replaced(kPly, "face 1", "face 0"), "face");
  files.refused("a.ply", replaced(kPly, "1 1 0 255", "1 nan 0 255"), "nan");
  files.refused("a.ply", replaced(kPly, "4 0 1 2 3", "4 0 1 2 4"), "index 4");
  files.refused("a.ply", replaced(kPly, "4 0 1 2 3", "4 0 1 2 -1"), "-1");
  files.refused("a.ply", replaced(kPly, "4 0 1 2 3", "2 0 1 2 3"), "2 corners");
  files.refused("a.ply", "", "end_header");
  files.refused("a.obj", "", "face");
  files.refused("a.obj", replaced(kObj, "v 1 0 0", "v 1 0"), "line 4");
  files.refused("a.obj", replaced(kObj, "v 1 0 0", "v inf 0 0"), "inf");
  files.refused("a.obj", replaced(kObj, "4/1", "5/1"), "index 4");
  files.refused("a.obj", replaced(kObj, "4/1", "0/1"), "0/1");
  files.refused("a.obj", replaced(kObj, "-2 4/1", "-7 4/1"), "-7");
  files.refused("a.obj", "v 0 0 0\nf 1 1\n", "line 2");
  const std::string binary = glb(gltf(""), gltfBytes());
  files.refused("a.glb", binary.substr(0, binary.size() - 8), "a.glb");
  files.refused("a.glb", binary.substr(0, 10), "a.glb");
  files.refused("a.glb", glb(gltf(R"("uri":"../../a.bin",)"), gltfBytes()), "/buffers/0/uri");
  files.refused("a.glb", glb(replaced(gltf(""), "5121", "5126"), gltfBytes()), "/accessors/1/componentType");
  std::string wild = gltfBytes();
  wild[53] = 4;
  files.refused("a.glb", glb(gltf(""), wild), "/meshes/0/primitives/0/indices");
  CHECK(test::errorOf([&] { readTriangleMesh(files.folder.path() / "missing.ply"); }).code() == ErrorCode::io);
  CHECK(test::errorOf([&] { readTriangleMesh(files.folder.path() / "a.stl"); }).code() == ErrorCode::unsupported);
}

}  // namespace
}  // namespace ibr
