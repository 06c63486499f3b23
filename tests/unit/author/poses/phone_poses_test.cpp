// SPDX-License-Identifier: Apache-2.0
#include "author/poses/phone_poses.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "author/build/build_input.h"
#include "support/json.h"
#include "support/temporary_folder.h"
#include "support/turned_photograph.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

// Two photographs with poses in transforms.json, which has no tracks.
struct Capture {
  test::TemporaryFolder folder;
  Json transforms{{"w", 48}, {"h", 32}, {"fl_x", 50}, {"frames", Json::array()}};
  BuildOptions options;
  std::string logged;

  explicit Capture(const std::string& maker) {
    for (const double x : {0.0, 1.0}) {
      const std::string name = x == 0 ? "a.jpg" : "b.jpg";
      test::writeTurned(folder / "photos" / name, Image8(48, 32, 3, 90), 1, maker);
      const Json matrix{{1, 0, 0, x}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
      transforms["frames"].push_back({{"file_path", name}, {"transform_matrix", matrix}});
    }
    options.photographs = folder / "photos";
    options.model = folder / "transforms.json";
    options.output = folder / "scene";
  }
  bool isRefined() {
    writeFile(options.model, transforms.dump());
    logged.clear();
    return readInput(options, [&](LogLevel, std::string_view text) { logged += text; }).refinesPoses;
  }
};

}  // namespace

TEST_CASE("makers of phones are recognised in any case of letters") {
  for (const char* maker : {"Apple", "samsung", "SAMSUNG", "Google", "Xiaomi", "HUAWEI", "OnePlus", "LG Electronics",
                            "LGE", "HMD Global", "Samsung Electronics"})
    CHECK(isPhoneMaker(maker));
  for (const char* maker : {"", "Canon", "NIKON CORPORATION", "SONY", "DJI", "Applebee", "LG", " Apple"})
    CHECK_FALSE(isPhoneMaker(maker));
}

TEST_CASE("poses without tracks are refined by default if a phone took most photographs") {
  Capture phone("LGE"), camera("Ab");
  CHECK(phone.isRefined());
  CHECK_THAT(phone.logged, Contains("--refine-poses off"));
  CHECK_FALSE(camera.isRefined());
  CHECK(camera.logged.empty());
  test::writeTurned(phone.folder / "photos/b.jpg", Image8(48, 32, 3, 90), 1);  // one of two is no majority
  CHECK_FALSE(phone.isRefined());
}

TEST_CASE("poses are refined by default if transforms.json has depth maps, as apps of phones write it") {
  Capture depth("Ab"), scale("Ab");
  depth.transforms["frames"][0]["depth_path"] = "images/0.depth.png";
  CHECK(depth.isRefined());
  scale.transforms["integer_depth_scale"] = 1e-4;
  CHECK(scale.isRefined());
  const fs::path file = scale.folder / "other";
  for (const char* text :
       {"", "[]", "{}", "{\"frames\": 3}", "{\"frames\": []}", "{\"frames\": [3]}", "{\"frames\": ["}) {
    writeFile(file, std::string(text));
    CHECK_FALSE(isPhoneAppFile(file));
  }
  CHECK_FALSE(isPhoneAppFile(scale.folder / "none"));
  CHECK_FALSE(isPhoneAppFile(scale.folder.path()));
}

TEST_CASE("a choice of refinement overrides the default, and poses with tracks are not refined by default") {
  Capture phone("LGE");
  phone.options.refinePoses = RefinePoses::off;
  CHECK_FALSE(phone.isRefined());
  Capture camera("Ab");
  camera.options.refinePoses = RefinePoses::on;
  CHECK(camera.isRefined());
  CHECK(camera.logged.empty());

  phone.options.refinePoses = RefinePoses::automatic;
  PosedModel model = readPoseFile(phone.options.model, phone.options.photographs);
  const glm::dvec3 point(0.5, 0, -10);
  model.tracks = {{point, {}}};
  for (std::uint32_t i = 0; i < 2; ++i) {
    const Camera& seen = model.images[i].camera;
    model.tracks[0].observations.push_back({i, project(seen.intrinsics, point - seen.pose.position).value()});
  }
  writeColmapModel(model, phone.folder / "model");
  phone.options.model = phone.folder / "model";
  CHECK_FALSE(readInput(phone.options, {}).refinesPoses);
}
