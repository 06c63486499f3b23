// SPDX-License-Identifier: Apache-2.0
#include "example_model.h"

#include "io/image_file.h"
#include "support/test_meshes.h"

namespace fs = std::filesystem;

namespace ibr::test {

HtmModel exampleModel() {
  HtmModel model;
  for (int i = 0; i < 2; ++i) {
    HtmCamera camera;
    camera.name = i == 0 ? "left.png" : "right.png";
    camera.camera.intrinsics = {CameraModel::pinhole, 32 + 16 * i, 24, 30, 31, 15.5 + i, 12};
    camera.camera.pose.position = glm::dvec3(5e5 + 0.25 * i, 5.4e6, 303);
    camera.imageFile = "images/" + camera.name;
    camera.visibilityFile = "visibility/" + camera.name;
    model.cameras.push_back(camera);
  }
  model.surface.mesh = cube({5e5 - 0.5, 5.4e6 - 0.5, 299});
  model.surface.members = {3, 1, 2, 0, 3, 3, 1, 2};
  for (std::size_t k = 0; k < 4 * 8; ++k) model.complements.emplace_back(0.5f * float(k), -float(k));
  model.source = HtmSurface{sphere(8), std::vector<CameraSet>(sphere(8).positions.size(), 3)};
  model.settings = R"({"alpha":0.3,"gamma1":10})";
  return model;
}

void writeExampleModel(const fs::path& folder) {
  const HtmModel model = exampleModel();
  fs::create_directories(folder / "images");
  fs::create_directories(folder / "visibility");
  for (const HtmCamera& camera : model.cameras) {
    const Intrinsics& k = camera.camera.intrinsics;
    writeImage(folder / camera.imageFile, Image8(k.width, k.height, 3));
    writeImage(folder / camera.visibilityFile, Image8(k.width, k.height, 1));
  }
  saveHtmModel(model, folder);
}

}  // namespace ibr::test
