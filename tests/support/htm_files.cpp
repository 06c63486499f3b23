// SPDX-License-Identifier: Apache-2.0
#include "support/htm_files.h"

#include <fstream>
#include <iomanip>

#include "io/image_file.h"

namespace fs = std::filesystem;

namespace ibr::test {
namespace {

std::ofstream text(const fs::path& file) {
  std::ofstream out(file);
  out << std::setprecision(17);
  return out;
}

}  // namespace

void writeSparse(const fs::path& folder, const std::vector<HtmCamera>& cameras) {
  fs::create_directories(folder);
  text(folder / "points3D.txt") << "# none\n";
  std::ofstream lenses = text(folder / "cameras.txt"), images = text(folder / "images.txt");
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Camera& camera = cameras[i].camera;
    const Intrinsics& k = camera.intrinsics;
    lenses << i + 1 << " PINHOLE " << k.width << ' ' << k.height << ' ' << k.fx << ' ' << k.fy << ' ' << k.cx << ' '
           << k.cy << '\n';
    // COLMAP's axes: y down, z forward.
    const glm::dquat q = glm::conjugate(camera.pose.rotation * glm::dquat(0.0, 1.0, 0.0, 0.0));
    const glm::dvec3 t = -(q * camera.pose.position);
    images << i + 1 << ' ' << q.w << ' ' << q.x << ' ' << q.y << ' ' << q.z << ' ' << t.x << ' ' << t.y << ' ' << t.z
           << ' ' << i + 1 << ' ' << cameras[i].name << ".png\n\n";
  }
}

void writeHtmFiles(const BumpyModel& bumpy, const fs::path& folder) {
  fs::create_directories(folder / "images");
  fs::create_directories(folder / "masks");
  const TriangleMesh& mesh = bumpy.model.surface.mesh;
  std::ofstream obj = text(folder / "mesh.obj");
  for (const glm::dvec3& p : mesh.positions) obj << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const glm::uvec3& t : mesh.triangles) obj << "f " << t.x + 1 << ' ' << t.y + 1 << ' ' << t.z + 1 << '\n';
  for (std::size_t i = 0; i < bumpy.pictures.size(); ++i) {
    const HtmCamera& camera = bumpy.model.cameras[i];
    Image8 mask(camera.camera.intrinsics.width, camera.camera.intrinsics.height, 1);
    const std::vector<SurfaceHit> hits = surfaceHits(mesh, camera.camera);
    for (std::size_t p = 0; p < hits.size(); ++p) mask.values[p] = hits[p].triangle >= 0 ? 255 : 0;
    writeImage(folder / "images" / (camera.name + ".png"), bumpy.pictures[i].photograph);
    writeImage(folder / "masks" / (camera.name + ".png"), mask);
  }
  writeSparse(folder / "sparse", bumpy.model.cameras);
}

}  // namespace ibr::test
