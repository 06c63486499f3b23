// SPDX-License-Identifier: Apache-2.0
// Options and report of frame times, for a scene (`ibr bench`) and for synthetic scenes (`ibr-lab bench`).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "batch/bench/frame_bench.h"
#include "shared/cli/context.h"
#include "shared/cli/options.h"
#include "shared/report/table.h"

namespace ibr::app {

struct BenchRun {
  PictureSize size;  // 0: 1920x1080
  int views = 3;
  BenchCase wanted;
  GpuSceneOptions gpuScene;
};

/// Declares --views, --repeat, --stereo, the render settings and the GPU scene's options. Returns --stereo.
Option declareBenchRun(CLI::App& app, BenchRun& run);

class BenchReport {
 public:
  BenchReport();
  void add(const std::string& scene, const RenderSettings& settings, const BenchResult& result);
  /// Prints the table and writes the JSON report.
  void print(const Context& context, const Device& device, const BenchRun& run, const std::string& scene) const;

 private:
  Table table_;
  nlohmann::ordered_json frames_ = nlohmann::ordered_json::array(), passes_ = nlohmann::ordered_json::array();
};

}  // namespace ibr::app
