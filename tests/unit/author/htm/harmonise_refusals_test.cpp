// SPDX-License-Identifier: Apache-2.0
// Invalid input of harmonise(), and cancellation.
#include <catch2/catch.hpp>
#include <cmath>

#include "small_body.h"
#include "support/error_of.h"
#include "support/extremes.h"

namespace ibr {

using test::body;
using test::plainOptions;
using test::theBody;

TEST_CASE("invalid meshes, photographs and options are rejected") {
  const auto photographs = test::photographsOf(theBody());
  const TriangleMesh& mesh = theBody().model.surface.mesh;
  const auto refused = [&](const TriangleMesh& of, const std::vector<HtmPhotograph>& by, const HtmOptions& options,
                           const std::string& what) {
    INFO(what);
    const Error error = test::errorOf([&] { harmonise(of, by, options); });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Catch::Contains(what));
  };
  const HtmOptions good = plainOptions();
  refused(mesh, {}, good, "0 cameras");
  refused(mesh, std::vector<HtmPhotograph>(65, photographs[0]), good, "65 cameras");
  refused({}, photographs, good, "face");
  TriangleMesh far = test::moved(mesh, {100, 100, 100});
  refused(far, photographs, good, "face");
  TriangleMesh broken = mesh;
  broken.triangles[7].y = glm::uint(mesh.positions.size());
  refused(broken, photographs, good, "face 7");
  broken = mesh;
  broken.positions[5].z = std::nan("");
  refused(broken, photographs, good, "vertex 5");
  auto by = photographs;
  by[2].picture = Image8(160, 119, 3);
  refused(mesh, by, good, by[2].camera.name);
  by[2].picture = Image8(160, 120, 1);
  refused(mesh, by, good, by[2].camera.name);
  by = photographs;
  by[1].mask = Image8(80, 60, 1);
  refused(mesh, by, good, "mask");
  by = photographs;
  by[4].camera.camera.intrinsics.model = CameraModel::equirectangular;
  refused(mesh, by, good, by[4].camera.name);
  by = photographs;
  by[3].camera.camera.intrinsics.fx = std::nan("");
  refused(mesh, by, good, "cameras[3].camera");
  by[3].camera.camera.intrinsics.fx = 0;
  refused(mesh, by, good, "cameras[3].camera");
  by = photographs;
  by[5].camera.camera.pose.rotation *= 2.0;
  refused(mesh, by, good, "cameras[5].camera");
  by[5].camera.camera.pose = photographs[5].camera.camera.pose;
  by[5].camera.name = by[2].camera.name;
  refused(mesh, by, good, "cameras[5].name");
  by = photographs;
  by[0].camera.camera.intrinsics.width = 40000;
  by[0].camera.camera.intrinsics.height = 1;
  by[0].picture = Image8(40000, 1, 3);
  refused(mesh, by, good, by[0].camera.name);
  const auto with = [&](auto&& change) {
    HtmOptions options = good;
    change(options);
    return options;
  };
  refused(mesh, photographs, with([](HtmOptions& o) { o.rounds = 0; }), "rounds");
  refused(mesh, photographs, with([](HtmOptions& o) { o.radius = 0; }), "radius");
  refused(mesh, photographs, with([](HtmOptions& o) { o.laterRadius = 65; }), "laterRadius");
  refused(mesh, photographs, with([](HtmOptions& o) { o.smoothness = std::nan(""); }), "smoothness");
  refused(mesh, photographs, with([](HtmOptions& o) { o.alpha = 1.1; }), "alpha");
  refused(mesh, photographs, with([](HtmOptions& o) { o.gamma1 = 0; }), "gamma1");
  refused(mesh, photographs, with([](HtmOptions& o) { o.outlierPx = 0; }), "outlierPx");
  refused(mesh, photographs, with([](HtmOptions& o) { o.complementPx = -1; }), "complementPx");
  refused(mesh, photographs, with([](HtmOptions& o) { o.adjustRounds = -1; }), "adjustRounds");
  refused(mesh, photographs, with([](HtmOptions& o) { o.adjustSmoothness = -1; }), "adjustSmoothness");
  refused(mesh, photographs, with([](HtmOptions& o) { o.minTexture = HUGE_VAL; }), "minTexture");
  refused(mesh, photographs, with([](HtmOptions& o) { o.inconsistentShare = -0.1; }), "inconsistentShare");
  refused(mesh, photographs, with([](HtmOptions& o) { o.meanDifference = std::nan(""); }), "meanDifference");
  refused(mesh, photographs, with([](HtmOptions& o) { o.minFacePx = -1; }), "minFacePx");
  refused(mesh, photographs, with([](HtmOptions& o) { o.rejectCorrelation = 2; }), "rejectCorrelation");
  refused(mesh, photographs, with([](HtmOptions& o) { o.softPx = 0; }), "softPx");
}

TEST_CASE("harmonising can be cancelled at any step") {
  const test::BumpyModel bumpy = body(3);
  HtmOptions options = plainOptions();
  options.faces = 150;
  options.adjustRounds = 1;
  options.radius = 2;
  const auto photographs = test::photographsOf(bumpy);
  int steps = 0;
  harmonise(bumpy.model.surface.mesh, photographs, options, [&](const Progress&) { return ++steps > 0; });
  for (int last = 0; last < std::min(steps, 30); ++last) {
    int left = last;
    const auto stop = [&](const Progress&) { return left-- > 0; };
    CHECK(test::errorOf([&] { harmonise(bumpy.model.surface.mesh, photographs, options, stop); }).code() ==
          ErrorCode::cancelled);
  }
}

TEST_CASE("extreme option values are rejected by name, or give a valid model", "[N16]") {
  const auto small = body(4);
  const auto photographs = test::photographsOf(small);
  struct Field {
    const char* name;
    double HtmOptions::*value;
  };
  const Field fields[] = {{"inconsistentSize", &HtmOptions::inconsistentSize},
                          {"inconsistentDifference", &HtmOptions::inconsistentDifference},
                          {"inconsistentShare", &HtmOptions::inconsistentShare},
                          {"adjustSmoothness", &HtmOptions::adjustSmoothness},
                          {"shapeSmoothness", &HtmOptions::shapeSmoothness},
                          {"radius", &HtmOptions::radius},
                          {"laterRadius", &HtmOptions::laterRadius},
                          {"minTexture", &HtmOptions::minTexture},
                          {"smoothness", &HtmOptions::smoothness},
                          {"complementPx", &HtmOptions::complementPx},
                          {"outlierPx", &HtmOptions::outlierPx},
                          {"alpha", &HtmOptions::alpha},
                          {"gamma1", &HtmOptions::gamma1},
                          {"meanDifference", &HtmOptions::meanDifference},
                          {"faceDifference", &HtmOptions::faceDifference},
                          {"minFacePx", &HtmOptions::minFacePx},
                          {"rejectDifference", &HtmOptions::rejectDifference},
                          {"rejectCorrelation", &HtmOptions::rejectCorrelation},
                          {"softPx", &HtmOptions::softPx}};
  int refused = 0, made = 0;
  for (const Field& field : fields)
    for (const double value : test::kExtremes) {
      HtmOptions options = plainOptions();
      options.rounds = 2;
      options.adjustRounds = 1;
      options.faces = 100;
      options.maxFaces = 300;
      options.inconsistentShare = 0.1;
      options.*field.value = value;
      INFO(field.name << " = " << value);
      try {
        const HtmResult result = harmonise(small.model.surface.mesh, photographs, options);
        for (const Fault& fault : validate(result.model)) FAIL_CHECK(fault.field << ": " << fault.message);
        for (const glm::vec2& complement : result.model.complements)
          REQUIRE((std::isfinite(complement.x) && std::isfinite(complement.y)));
        ++made;
      } catch (const Error& e) {
        CHECK(e.code() == ErrorCode::invalidInput);
        CHECK_THAT(e.what(), Catch::Contains(field.name));
        ++refused;
      }
    }
  CHECK(refused > 90);
  CHECK(made > 50);
}

}  // namespace ibr
