// SPDX-License-Identifier: Apache-2.0
#include "author/steps/step_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "author/steps/input_record.h"
#include "author/steps/parts_file.h"
#include "base/check.h"
#include "base/hash.h"
#include "ibr/version.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kVersion = 1;  // of the files: raise when their contents change

void writeSweeps(CacheWriter& out, const std::vector<std::optional<ViewSweep>>& sweeps) {
  out.value(std::uint64_t(sweeps.size()));
  for (const std::optional<ViewSweep>& sweep : sweeps) {
    out.value(sweep.has_value());
    if (!sweep) continue;
    out.list(sweep->sources);
    out.value(sweep->range.far);
    out.value(sweep->range.near);
  }
}

std::vector<std::optional<ViewSweep>> readSweeps(CacheReader& in) {
  std::vector<std::optional<ViewSweep>> sweeps(in.value<std::uint64_t>());
  for (std::optional<ViewSweep>& sweep : sweeps) {
    if (!in.value<bool>()) continue;
    sweep.emplace();
    sweep->sources = in.list<std::uint32_t>();
    sweep->range.far = in.value<double>();
    sweep->range.near = in.value<double>();
  }
  return sweeps;
}

template <class T>
void writeLists(CacheWriter& out, const std::vector<std::vector<T>>& lists) {
  out.value(std::uint64_t(lists.size()));
  for (const std::vector<T>& list : lists) out.list(list);
}
template <class T>
std::vector<std::vector<T>> readLists(CacheReader& in) {
  std::vector<std::vector<T>> lists(in.value<std::uint64_t>());
  for (std::vector<T>& list : lists) list = in.list<T>();
  return lists;
}

fs::path planFile(const BuildOptions& options) {
  return stepFile(options, "tracks");
}

}  // namespace

std::vector<Batch> batchesOf(std::size_t photographs, std::size_t photographsPerStep) {
  check(photographsPerStep >= 1, ErrorCode::invalidInput, "photographsPerStep is 0, must be 1 or more");
  std::vector<Batch> batches;
  for (std::size_t begin = 0; begin < photographs; begin += photographsPerStep)
    batches.push_back({batches.size(), begin, std::min(begin + photographsPerStep, photographs)});
  return batches;
}

std::uint64_t optionsKey(const BuildOptions& options, std::size_t photographsPerStep) {
  Hash hash;
  hash.add(kVersion);
  hash.add(version());  // machines with different versions do not share steps
  hash.add(photographsPerStep);
  for (const std::string& name : options.exclude) hash.add(std::string_view(name));
  for (const bool flag :
       {options.skipMissing, options.stripMetadata, options.keepBorder, options.masks.empty(), options.backdrops})
    hash.add(flag);
  for (const int value : {int(options.orientation), int(options.tracks), options.dimension, options.maxSize,
                          int(options.depth), int(options.matcher), int(options.triangleFilter)})
    hash.add(value);
  hash.add(options.thetaDegrees);
  hash.add(options.seed);
  return hash.value();
}

fs::path stepFile(const BuildOptions& options, const std::string& step) {
  return options.output / ".build" / "steps" / step;  // scenes may share a cache folder
}

std::string batchStep(const char* kind, std::size_t batch) {
  return fmt::format("{}-{:04}", kind, batch);
}

void storeModel(const BuildOptions& options, std::uint64_t key, const StepModel& model) {
  CacheWriter out;
  writeInputRecord(out, model.input, options);
  out.value(std::uint64_t(model.pairs.size()));
  for (const auto& [first, second] : model.pairs) {
    out.value(first);
    out.value(second);
  }
  out.value(model.hash);
  writeParts(stepFile(options, "model"), key, {{out.take()}});
}

StepModel fetchModel(const BuildOptions& options, std::uint64_t key) {
  CacheReader in = PartsFile(stepFile(options, "model"), key, "model").part(0);
  StepModel model{readInputRecord(in, options), {}};
  model.pairs.resize(in.value<std::uint64_t>());
  for (auto& [first, second] : model.pairs) {
    first = in.value<std::uint32_t>();
    second = in.value<std::uint32_t>();
  }
  model.hash = in.value<std::uint64_t>();
  return model;
}

void storeHashes(const BuildOptions& options, std::uint64_t key, std::size_t batch, const PhotographHashes& hashes) {
  CacheWriter out;
  out.list(hashes.photographs);
  out.list(hashes.files);
  writeParts(stepFile(options, batchStep("photographs", batch)), key, {{out.take()}});
}

PhotographHashes fetchHashes(const BuildOptions& options, std::uint64_t key, std::size_t batch) {
  const std::string step = batchStep("photographs", batch);
  CacheReader in = PartsFile(stepFile(options, step), key, step.c_str()).part(0);
  PhotographHashes hashes{in.list<std::uint64_t>(), {}};
  hashes.files = in.list<std::uint64_t>();
  return hashes;
}

void storePlan(const BuildOptions& options, std::uint64_t key, const PlannedBuild& build,
               const std::vector<PlannedBatch>& batches) {
  std::vector<std::vector<std::byte>> parts;
  CacheWriter common;
  common.value(build.source);
  common.value(build.residualPx);
  writeInputRecord(common, build.input, options);
  common.list(build.files);
  parts.push_back(common.take());
  for (const PlannedBatch& batch : batches) {
    CacheWriter out;
    writeSweeps(out, batch.sweeps);
    writeLists(out, batch.points);
    writeLists(out, batch.cells);
    writeTracks(out, batch.tracks);
    parts.push_back(out.take());
  }
  writeParts(planFile(options), key, parts);
}

PlannedBuild fetchPlan(const BuildOptions& options, std::uint64_t key) {
  CacheReader in = PartsFile(planFile(options), key, "tracks").part(0);
  PlannedBuild build;
  build.source = in.value<std::uint64_t>();
  build.residualPx = in.value<double>();
  build.input = readInputRecord(in, options);
  build.files = in.list<std::uint64_t>();
  return build;
}

PlannedBatch fetchPlannedBatch(const BuildOptions& options, std::uint64_t key, std::size_t batch) {
  CacheReader in = PartsFile(planFile(options), key, "tracks").part(1 + batch);
  PlannedBatch planned;
  planned.sweeps = readSweeps(in);
  planned.points = readLists<glm::dvec3>(in);
  planned.cells = readLists<std::uint32_t>(in);
  planned.tracks = readTracks(in);
  return planned;
}

std::optional<std::uint64_t> plannedSource(const BuildOptions& options, std::uint64_t key) {
  std::error_code ignored;
  if (!fs::exists(planFile(options), ignored)) return std::nullopt;
  try {
    return PartsFile(planFile(options), key, "tracks").part(0).value<std::uint64_t>();
  } catch (const Error&) {
    return std::nullopt;
  }
}

void storeNames(const BuildOptions& options, const std::string& step, const std::vector<std::string>& names) {
  writeFile(stepFile(options, step), fmt::format("{}\n", fmt::join(names, "\n")));
}

std::vector<std::string> fetchNames(const BuildOptions& options, const std::string& step) {
  const fs::path file = stepFile(options, step);
  std::error_code ignored;
  check(fs::is_regular_file(file, ignored), ErrorCode::io, "{}: is missing; run the step {} first", file.string(),
        step);
  std::vector<std::string> names;
  const std::string text = readTextFile(file);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    names.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return names;
}

}  // namespace ibr
