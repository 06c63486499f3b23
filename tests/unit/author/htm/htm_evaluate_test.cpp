// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_evaluate.h"

#include <catch2/catch.hpp>
#include <numeric>

#include "htm_object.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

using Divided = std::vector<std::uint8_t>;

// Four squares of two faces each, and a camera that looks at their centre from straight above.
struct Squares {
  TriangleMesh mesh = test::flatGrid(2);
  std::vector<HtmView> views{test::plainView(test::lookingAt({1, 1, 4}, {1, 1, 0}, 120, 90))};
  std::vector<FaceVisibility> visibility = std::vector<FaceVisibility>(8, FaceVisibility{1, 0});
  std::vector<double> differences = std::vector<double>(8, 2.0);

  EvaluatedFaces evaluated(const EvaluateOptions& options) const {
    const EvaluatedFaces faces = evaluateFaces(mesh, projectedMeshes(mesh, views), visibility, differences, options);
    CHECK(faces.divided == std::size_t(std::accumulate(faces.divide.begin(), faces.divide.end(), 0)));
    return faces;
  }
};

}  // namespace

TEST_CASE("faces above the difference threshold are divided, unless the mean difference is small") {
  Squares squares;
  squares.differences[3] = 4.0;
  squares.differences[5] = 4.1;
  const EvaluateOptions options{.meanDifference = 2, .faceDifference = 4, .selfOccluded = true, .minFacePx = 0};
  CHECK(squares.evaluated(options).divide == Divided{0, 0, 0, 0, 0, 1, 0, 0});
  CHECK(squares.evaluated(options).hidden == 0);
  squares.differences.assign(8, 1.0);
  squares.differences[5] = 9;  // the mean of all faces is 2
  CHECK(squares.evaluated(options).divided == 0);
}

TEST_CASE("partly hidden faces are divided, whatever their difference") {
  Squares squares;
  squares.visibility[2].partly = squares.visibility[6].partly = 1;
  squares.differences[6] = 50;
  EvaluateOptions options{.meanDifference = 2, .faceDifference = 4, .selfOccluded = true, .minFacePx = 0};
  CHECK(squares.evaluated(options).divide == Divided{0, 0, 1, 0, 0, 0, 1, 0});
  CHECK(squares.evaluated(options).hidden == 1);
  options.selfOccluded = false;
  CHECK(squares.evaluated(options).divide == Divided{0, 0, 0, 0, 0, 0, 1, 0});
}

TEST_CASE("small faces are not divided, where the size of a face is its largest over the cameras") {
  Squares squares;
  squares.differences.assign(8, 90.0);
  const double focal = squares.views[0].camera.intrinsics.fx, area = 0.5 * (focal / 4) * (focal / 4);  // px² of each
  EvaluateOptions options{.meanDifference = 1, .faceDifference = 4, .selfOccluded = true, .minFacePx = 1.01 * area};
  CHECK(squares.evaluated(options).divided == 0);
  options.minFacePx = 0.99 * area;
  CHECK(squares.evaluated(options).divided == 8);
  squares.visibility[4].seen = 0;
  CHECK(squares.evaluated(options).divide == Divided{1, 1, 1, 1, 0, 1, 1, 1});
  squares.views.insert(squares.views.begin(), test::plainView(test::lookingAt({1, 1, 40}, {1, 1, 0}, 120, 90)));
  for (FaceVisibility& face : squares.visibility) face.seen = 3;
  CHECK(squares.evaluated(options).divided == 8);
  squares.visibility[1].seen = 1;  // only the far camera sees the face
  CHECK(squares.evaluated(options).divide == Divided{1, 0, 1, 1, 1, 1, 1, 1});
  // All faces are behind the camera, although their visibility is set.
  squares.views = {test::plainView(test::lookingAt({1, 1, -4}, {1, 1, -9}, 120, 90))};
  for (FaceVisibility& face : squares.visibility) face.seen = 1;
  CHECK(squares.evaluated(options).divided == 0);
}

TEST_CASE("no face of an empty mesh is divided") {
  CHECK(evaluateFaces({}, {}, {}, {}, {}).divide.empty());
}

}  // namespace ibr
