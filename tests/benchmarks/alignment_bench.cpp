// SPDX-License-Identifier: Apache-2.0
// Throughput of candidate evaluation: the paper's method, ours on the device and on the CPU, with and without
// pruning, and OpenCV's computeECC on patches of a star's size. All judge the same candidates of an unchanged mesh
// (a guard refuses every move), in turns; a line is the median over the turns. Then prints how often pruning selects
// another candidate than the full evaluation, by radius.
//
//   cmake --build build --target ibr_alignment_bench && build/tests/benchmarks/ibr_alignment_bench [turns] [side]
//   [cells]
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <string>
#include <utility>
#include <vector>

#include "ibr/device.h"
#include "ibr/optimiser.h"
#include "support/planted.h"

namespace {

using namespace ibr;

struct Way {
  const char* name;
  AlignmentMethod method;
  bool prune;
  std::vector<double> rate;  // 10⁶ pixel pairs a second, counting those of the unpruned evaluation
};

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? 0 : values[values.size() / 2];
}

// Selected moves: a point with its match in all images.
using Picks = std::vector<std::pair<std::uint32_t, std::vector<std::array<int, 2>>>>;

AlignmentCycle cycleOf(const Way& way, Alignment& alignment, const Device& device, double radiusPx = 5,
                       Picks* picks = nullptr) {
  AlignmentOptions options;
  options.radiusPx = radiusPx;
  options.method = way.method;
  options.prune = way.prune;
  options.maxCycles = 1;
  options.scaledInstances = false;
  options.guard = [&](std::uint32_t point, std::span<const glm::ivec2> match) {
    if (!picks) return false;
    auto& pick = picks->emplace_back(point, std::vector<std::array<int, 2>>());
    for (const glm::ivec2& at : match) pick.second.push_back({at.x, at.y});
    return false;
  };
  return align(alignment, options, &device).cycles.at(0);
}

// Speed of warping a patch and computeECC, as an OpenCV user evaluates a candidate; 10⁶ pixels a second.
double openCvRate(const Image8& picture, int patch, int repeats) {
  const cv::Mat image(picture.height, picture.width, CV_8UC3, const_cast<std::uint8_t*>(picture.values.data()));
  cv::Mat warped, grey, reference, referenceGrey;
  const cv::Matx23d still(1, 0, 100, 0, 1, 100);
  cv::warpAffine(image, reference, still, {patch, patch}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
  cv::cvtColor(reference, referenceGrey, cv::COLOR_RGB2GRAY);
  const auto start = std::chrono::steady_clock::now();
  double sum = 0;
  for (int i = 0; i < repeats; ++i) {
    const cv::Matx23d map(1, 0.001 * (i % 7), 100 + 0.1 * (i % 11), 0, 1, 100 + 0.1 * (i % 5));
    cv::warpAffine(image, warped, map, {patch, patch}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
    cv::cvtColor(warped, grey, cv::COLOR_RGB2GRAY);
    sum += cv::computeECC(referenceGrey, grey);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (sum == 0) fmt::print("(nothing correlates)\n");
  return double(repeats) * patch * patch / seconds / 1e6;
}

void printWrongPicks(Alignment& alignment, const Device& device) {
  fmt::print("\nradius px   points that move   other picks when pruned\n");
  for (const double radius : {5.0, 2.5, 1.25, 0.625}) {
    Picks whole, pruned;
    cycleOf({"", AlignmentMethod::cpu, false, {}}, alignment, device, radius, &whole);
    cycleOf({"", AlignmentMethod::cpu, true, {}}, alignment, device, radius, &pruned);
    std::ranges::sort(whole);
    std::ranges::sort(pruned);
    Picks same;
    std::ranges::set_intersection(whole, pruned, std::back_inserter(same));
    fmt::print("{:9} {:18} {:20} ({:.1f} %)\n", radius, whole.size(), whole.size() - same.size(),
               100.0 * double(whole.size() - same.size()) / double(whole.size()));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int turns = argc > 1 ? std::atoi(argv[1]) : 3, side = argc > 2 ? std::atoi(argv[2]) : 640,
            cells = argc > 3 ? std::atoi(argv[3]) : 16;
  test::Planted planted = test::planted(2, side, cells, 2.0, 5);
  const Device device = Device::create();
  std::vector<Way> ways{{"raster (the paper's)", AlignmentMethod::raster, false, {}},
                        {"compute", AlignmentMethod::compute, false, {}},
                        {"cpu", AlignmentMethod::cpu, false, {}},
                        {"compute, pruned", AlignmentMethod::compute, true, {}},
                        {"cpu, pruned", AlignmentMethod::cpu, true, {}}};
  std::vector<double> openCv;
  std::uint64_t work = 0, candidates = 0;
  for (int turn = 0; turn < turns; ++turn) {
    for (Way& way : ways) {
      const AlignmentCycle cycle = cycleOf(way, planted.alignment, device);
      if (!way.prune) work = cycle.pixels, candidates = cycle.mutations;
      way.rate.push_back(double(work) / cycle.seconds / 1e6);
      fmt::print(stderr, "turn {}: {:22} {:8.3f} s, {} candidates, {} pixels\n", turn, way.name, cycle.seconds,
                 cycle.mutations, cycle.pixels);
    }
    openCv.push_back(openCvRate(planted.pictures[0], 38, 20000));
  }
  fmt::print("{}\n{} candidates, {} pixel pairs; RGB\n", device.name(), candidates, work);
  fmt::print("{:24} {:>14} {:>10}\n", "", "10^6 pairs/s", "ratio");
  for (const Way& way : ways) {
    std::vector<double> ratios;
    for (int turn = 0; turn < turns; ++turn)
      ratios.push_back(way.rate[std::size_t(turn)] / ways[0].rate[std::size_t(turn)]);
    fmt::print("{:24} {:14.1f} {:9.2f}x\n", way.name, median(way.rate), median(ratios));
  }
  fmt::print("{:24} {:14.1f}   38 x 38 px, grey, warpAffine and computeECC, {} threads\n", "OpenCV", median(openCv),
             cv::getNumThreads());
  printWrongPicks(planted.alignment, device);
}
