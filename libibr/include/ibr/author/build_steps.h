// SPDX-License-Identifier: Apache-2.0
// A build in steps that many processes or machines run, on a folder that all of them see. The scene is that of build(),
// byte for byte. Needs ibr::author. Use: libibr/docs/cluster.md.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "ibr/author/build.h"
#include "ibr/log.h"

namespace ibr {

/// Name of the last step: build() with sceneStepOptions().
inline constexpr const char* kSceneStep = "scene";
inline constexpr std::size_t kPhotographsPerStep = 8;  // default number of photographs of a step

/// A step may run once all of its inputs exist and are complete.
struct BuildStep {
  std::string name;                           // "tracks", "depth-0003"
  std::vector<std::filesystem::path> inputs;  // photographs, masks, files of the model, outputs of earlier steps
  std::filesystem::path output;               // written last, and at once; only this step writes the file
  double seconds = 0;                         // predicted processor time
  double memory = 0;                          // predicted peak with one thread, bytes
};

/// Lists the steps of a build; each precedes the steps that need it. The list depends on the options, the model and the
/// photographs' headers, not on the results of steps. Throws Error: invalidInput for options that steps do not support,
/// which are a draft, estimated or refined poses and moving objects; else as build().
std::vector<BuildStep> buildSteps(const BuildOptions& options, std::size_t photographsPerStep = kPhotographsPerStep,
                                  const LogCallback& log = {});

/// Runs a step other than kSceneStep. Options and `photographsPerStep` must be those of the list; threads, memory and
/// the paths of folders may differ. A step whose output is valid returns soon. A stopped step leaves no partial file.
/// Several processes may run the same step at the same time. Throws Error: invalidInput for an unknown name, and for
/// inputs that were made with other options; io for missing inputs, and for photographs that have changed since an
/// earlier step; else as build(). Threading as build().
void runBuildStep(const BuildOptions& options, std::size_t photographsPerStep, const std::string& name,
                  const ProgressCallback& progress = {}, const LogCallback& log = {});

/// Options for the build() that is the last step. This build finds the results of all steps in the cache, and keeps
/// the cache.
BuildOptions sceneStepOptions(BuildOptions options);

}  // namespace ibr
