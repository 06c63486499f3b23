// SPDX-License-Identifier: Apache-2.0
// Non-finite and extreme input of lenses and of panorama faces gives finite results or an Error.
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "ibr/author/lens.h"
#include "ibr/author/panorama.h"
#include "ibr/error.h"
#include "support/extremes.h"

using namespace ibr;

namespace {

std::vector<double> parametersOf(LensModel model) {
  std::vector<double> parameters(parameterCount(model), 0.01);
  const bool two = parameters.size() > 5 || model == LensModel::pinhole || model == LensModel::fov;
  const bool single = model == LensModel::simplePinhole || model == LensModel::simpleRadial ||
                      model == LensModel::radial || model == LensModel::simpleRadialFisheye ||
                      model == LensModel::radialFisheye;
  const std::size_t focals = single || !two ? 1 : 2;
  for (std::size_t i = 0; i < focals; ++i) parameters[i] = 500;
  parameters[focals] = 320, parameters[focals + 1] = 240;
  return parameters;
}

void expectFinite(const Lens& lens) {
  CHECK(std::isfinite(lens.maxRadius()));
  for (const double x : test::kExtremes)
    for (const double y : test::kExtremes) {
      if (const auto ray = lens.unproject({x, y})) {
        REQUIRE(std::abs(glm::length(*ray) - 1) < 1e-9);
      }
      for (const double z : {-1.0, 1.0, 0.0, test::Limits::quiet_NaN()})
        if (const auto pixel = lens.project({x, y, z})) REQUIRE((std::isfinite(pixel->x) && std::isfinite(pixel->y)));
    }
}

}  // namespace

TEST_CASE("a lens with extreme parameters is rejected or gives only finite results", "[N13][N16]") {
  int refused = 0, made = 0;
  for (std::size_t m = 0; m < kLensModelCount; ++m) {
    const auto model = LensModel(m);
    const std::vector<double> usual = parametersOf(model);
    expectFinite(Lens(model, 640, 480, usual));
    for (std::size_t p = 0; p < usual.size(); ++p)
      for (const double value : test::kExtremes) {
        std::vector<double> parameters = usual;
        parameters[p] = value;
        INFO("model " << m << ", parameter " << p << " = " << value);
        try {
          const Lens lens(model, 640, 480, parameters);
          ++made;
          expectFinite(lens);
        } catch (const Error& e) {
          CHECK(e.code() == ErrorCode::invalidInput);
          ++refused;
        }
      }
  }
  CHECK(made > 100);
  CHECK(refused > 100);
}

TEST_CASE("panorama faces are rejected or finite for any angle", "[N10][N16]") {
  for (const double value : test::kExtremes) {
    INFO(value);
    if (value > 0 && value < 3) {  // denormal and smallest normal numbers: a field of view of almost 0
      CHECK(faceSize(2048, value) == 1);
    } else {
      CHECK_THROWS_AS(faceIntrinsics(64, value), Error);
      CHECK_THROWS_AS(faceSize(2048, value), Error);
    }
    try {
      const PanoramaSampler sampler(Image8(8, 4, 3, 100));
      Intrinsics pinhole = pinholeFromFov(4, 4, 1);
      pinhole.fx = value;
      const Image8 picture = sampler.view(pinhole, {1, 0, 0, 0});
      CHECK((picture == Image8(4, 4, 3, 100)));
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::invalidInput);
    }
  }
}
