// SPDX-License-Identifier: Apache-2.0
// [H] table 1: time of a harmonised model's frame, stage by stage, at XGA with 15 XGA photographs and about 5,000
// triangles. The views orbit between the photographs; a line is the median over the views.
//
//   cmake --build build --target ibr_htm_bench && build/tests/benchmarks/ibr_htm_bench [cameras] [share] [views]
//
// share: approximate share of the image that the object covers.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "ibr/htm.h"
#include "ibr/offscreen.h"
#include "ibr/scope_timer.h"
#include "support/bumpy_model.h"

namespace {

using namespace ibr;
using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? 0 : values[values.size() / 2];
}

}  // namespace

int main(int count, char** words) {
  const auto word = [&](int i, double otherwise) { return count > i ? std::atof(words[i]) : otherwise; };
  const int cameras = int(word(1, 15));
  const double share = word(2, 0.17);
  const int views = int(word(3, 40));
  const test::BumpyModel bumpy =
      test::bumpyModel({.cameras = cameras, .width = 1024, .height = 768, .longitudes = 70, .latitudes = 37});
  Device device = Device::create({});
  const GpuHtmModel model(device, bumpy.model, bumpy.source());
  const HtmBounds bounds = htmBounds(bumpy.model);
  const VkExtent2D extent{1024, 768};
  const HtmRenderer renderer(device, model, {.maxExtent = extent});
  Offscreen offscreen(device, extent);
  ScopeTimer timer(device, 2);
  fmt::print("{}: {} triangles, {} vertices, {} cameras\n", device.name(), bumpy.model.surface.mesh.triangles.size(),
             bumpy.model.vertexCount(), cameras);
  fmt::print("{:<15}{:>9}{:>13}{:>15}{:>8}{:>9}\n", "", "weights", "coordinates", "rasterisation", "frame", "covered");
  for (const auto& [name, method] :
       {std::pair{"harmonised", HtmMethod::harmonised}, std::pair{"blended", HtmMethod::blended},
        std::pair{"vertex colours", HtmMethod::vertexColours}}) {
    std::vector<double> weights, coordinates, rasterisation, frames;
    double covered = 0;
    for (int v = -3; v < views; ++v) {  // the first three are warm-up
      test::BumpyOptions around = bumpy.options;
      around.distance *= std::sqrt(0.39 / share);
      Camera view = test::ringCamera(around, 2 * std::numbers::pi * (v + 0.37) / views, 0.1);
      view.intrinsics = bumpy.model.cameras[0].camera.intrinsics;
      const auto begin = Clock::now();
      const HtmFramePlan plan = planHtmFrame(bumpy.model, bounds, {view, {.method = method}});
      const double planned = millisecondsSince(begin);
      const Image8 picture = offscreen.render([&](VkCommandBuffer commands) {
        timer.reset(commands);
        renderer.record(commands, plan, offscreen.target(), &timer);
      });
      if (v < 0) continue;
      frames.push_back(millisecondsSince(begin));
      weights.push_back(planned);
      for (const ScopeTime& scope : timer.read())
        (scope.name == std::string("coordinates") ? coordinates : rasterisation).push_back(scope.milliseconds);
      for (std::size_t i = 3; i < picture.values.size(); i += 4) covered += picture.values[i] > 0;
    }
    fmt::print("{:<15}{:>9.4f}{:>13.3f}{:>15.2f}{:>8.2f}{:>8.1f}%\n", name, median(weights), median(coordinates),
               median(rasterisation), median(frames), 100 * covered / (1024.0 * 768 * views));
  }
}
