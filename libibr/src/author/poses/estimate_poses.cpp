// SPDX-License-Identifier: Apache-2.0
// Estimates poses with the program COLMAP (Schönberger and Frahm 2016), step by step in a cached folder.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "author/poses/colmap_photographs.h"
#include "author/poses/colmap_program.h"
#include "author/poses/colmap_run.h"
#include "base/check.h"
#include "base/file.h"
#include "ibr/author/poses.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxExhaustive = 60;  // maximum number of photographs for exhaustive matching
constexpr std::size_t kPairsBetween = 60;   // number of photographs of other folders that each one is paired with
constexpr std::size_t kBlocks = 8;          // number of blocks of photographs that are matched pair by pair
constexpr const char* kFeaturesStage = "finding features with COLMAP";
constexpr const char* kMatchingStage = "matching features with COLMAP";
constexpr const char* kMappingStage = "estimating poses with COLMAP";
constexpr const char* kAddingStage = "adding photographs with COLMAP";
constexpr const char* kSharedCameraId = "1";  // COLMAP's camera id, if all photographs share one

// Inputs of all steps.
struct Estimate {
  const PoseOptions& options;
  const LogCallback& log;
  const ColmapPhotographs& photographs;
  const ColmapProgram& colmap;
  const ColmapRun& run;

  fs::path file(const char* name) const { return options.folder / name; }
  std::string imageFolder() const { return colmapImageFolder(options, photographs).string(); }
  std::string threads() const { return std::to_string(options.threads > 0 ? options.threads : -1); }
};

void step(const Estimate& e, const std::string& command, const char* stage, const std::vector<std::string>& arguments) {
  e.colmap.run(e.run.mark, command, stage, arguments, e.photographs.names.size());
}

void findFeatures(const Estimate& e, const ColmapProgram::OptionNames& option) {
  // Photographs of one size usually share one lens: a shared focal length is estimated more reliably.
  std::vector<std::string> arguments{"--database_path",
                                     e.run.databaseFile.string(),
                                     "--image_path",
                                     e.imageFolder(),
                                     "--image_list_path",
                                     e.run.listFile.string(),
                                     "--ImageReader.single_camera",
                                     haveOneSize(e.options, e.photographs, e.run.photographs) ? "1" : "0",
                                     "--ImageReader.single_camera_per_folder",
                                     foldersHaveOneSize(e.options, e.photographs, e.run.photographs) ? "1" : "0",
                                     option.extraction + ".use_gpu",
                                     "0",
                                     option.extraction + ".num_threads",
                                     e.threads()};
  std::vector<std::size_t> all(e.photographs.names.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (!e.run.added.empty() && haveOneSize(e.options, e.photographs, all))
    arguments.insert(arguments.end(), {"--ImageReader.existing_camera_id", kSharedCameraId});
  if (writeColmapMasks(e.options, e.photographs))
    arguments.insert(arguments.end(), {"--ImageReader.mask_path", e.file("masks").string()});
  step(e, "feature_extractor", kFeaturesStage, arguments);
}

// Pairs each added photograph with all others: a pair of names a line.
std::string addedPairs(const Estimate& e) {
  const std::vector<std::string>& names = e.photographs.names;
  std::string pairs;
  for (const std::size_t i : e.run.added)
    for (std::size_t j = 0; j < names.size(); ++j)
      if (j < i || (j > i && !std::ranges::binary_search(e.run.added, j))) pairs += names[i] + ' ' + names[j] + '\n';
  return pairs;
}

// Pairs of photographs of different folders, a pair of names a line; empty if all are in one folder. Sequential
// matching pairs names that follow each other, and so no folder with another. Each photograph gets about kPairsBetween
// others, spread evenly over the other folders.
std::string pairsBetweenFolders(const std::vector<std::string>& names) {
  std::map<std::string, std::vector<std::size_t>> folders;
  for (std::size_t i = 0; i < names.size(); ++i) folders[fs::path(names[i]).parent_path().string()].push_back(i);
  if (folders.size() < 2) return {};
  const std::size_t each = std::max<std::size_t>(1, kPairsBetween / (folders.size() - 1));
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [folder, members] : folders)
    for (std::size_t place = 0; place < members.size(); ++place)
      for (const auto& [other, there] : folders) {
        if (other == folder) continue;
        const std::size_t count = std::min(each, there.size());
        for (std::size_t k = 0; k < count; ++k)  // neighbours get others
          pairs.insert(std::minmax(members[place], there[(k * there.size() / count + place) % there.size()]));
      }
  std::string lines;
  for (const auto& [a, b] : pairs) lines += names[a] + ' ' + names[b] + '\n';
  return lines;
}

void matchPairs(const Estimate& e, std::vector<std::string> arguments, const char* listName, const std::string& pairs) {
  writeFile(e.file(listName), pairs);
  arguments.insert(arguments.end(), {"--match_list_path", e.file(listName).string(), "--match_type", "pairs"});
  step(e, "matches_importer", kMatchingStage, arguments);
}

void matchFeatures(const Estimate& e, const ColmapProgram::OptionNames& option) {
  std::vector<std::string> arguments{"--database_path",
                                     e.run.databaseFile.string(),
                                     option.matching + ".use_gpu",
                                     "0",
                                     option.matching + ".num_threads",
                                     e.threads()};
  if (!e.run.added.empty()) return matchPairs(e, arguments, "added-pairs.txt", addedPairs(e));
  const std::size_t count = e.photographs.names.size();
  const bool all = count <= kMaxExhaustive;
  if (!all) {
    step(e, "sequential_matcher", kMatchingStage, arguments);
    const std::string pairs = pairsBetweenFolders(e.photographs.names);
    if (pairs.empty()) return;
    if (isReadInPairs(e.photographs.names)) return matchPairs(e, arguments, "folder-pairs.txt", pairs);
    if (e.log)
      e.log(LogLevel::warning,
            "photographs of different folders are not matched with each other, because COLMAP reads "
            "no names with spaces in pairs: rename them without spaces");
    return;
  }
  // COLMAP reports and stores matches block by block: a single block shows no progress, and is lost when stopped.
  const std::size_t side = std::max<std::size_t>(2, (count + kBlocks - 1) / kBlocks);
  arguments.insert(arguments.end(), {"--ExhaustiveMatching.block_size", std::to_string(side)});
  step(e, "exhaustive_matcher", kMatchingStage, arguments);
}

void mapOnce(const Estimate& e, const std::vector<std::string>& more) {
  fs::remove_all(e.file("sparse"));  // a half-finished model is started again
  makeFolders(e.file("sparse"));
  std::vector<std::string> arguments{
      "--database_path", e.file("database.db").string(), "--image_path",         e.imageFolder(),
      "--output_path",   e.file("sparse").string(),      "--Mapper.num_threads", e.threads()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  step(e, "mapper", kMappingStage, arguments);
}

void estimateAll(const Estimate& e) {
  const ColmapProgram::OptionNames option = e.colmap.optionNames(kFeaturesStage);
  findFeatures(e, option);
  matchFeatures(e, option);
  mapOnce(e, {});
  if (!fs::is_empty(e.file("sparse"))) return;
  // COLMAP starts from two photographs side by side; a walk straight ahead has none.
  if (e.log)
    e.log(LogLevel::info, "COLMAP found no initial pair of photographs; retrying with pairs in forward motion");
  fs::remove(e.file("mapper.done"));
  mapOnce(e, {"--Mapper.init_max_forward_motion", "1", "--Mapper.init_min_tri_angle", "4"});
}

// Added photographs are registered to existing points only, not to each other.
void warnOfUnregistered(const Estimate& e) {
  const std::vector<std::string>& names = e.photographs.names;
  std::set<std::string> posed;
  for (const PosedImage& image : readColmapModel(largestColmapModel(e.options, names.size()).model).images)
    posed.insert(image.name);
  std::vector<std::string> left;
  for (const std::size_t i : e.run.added)
    if (!posed.contains(names[i])) left.push_back(names[i]);
  if (e.log && !left.empty())
    e.log(LogLevel::warning,
          fmt::format("{} of {} added photographs overlap too little with photographs that have poses, for example "
                      "{}: delete {} to estimate all poses again",
                      left.size(), e.run.added.size(), left[0], e.options.folder.string()));
}

// Keeps existing poses and points bit-identical: cached depth that used them stays valid.
void addPhotographs(const Estimate& e) {
  const ColmapProgram::OptionNames option = e.colmap.optionNames(kFeaturesStage);
  findFeatures(e, option);
  matchFeatures(e, option);
  const fs::path after = e.file("added"), database = e.run.databaseFile;
  if (const std::vector<fs::path> models = colmapModels(e.options); !models.empty()) {
    makeFolders(after);
    step(e, "image_registrator", kAddingStage,
         {"--database_path", database.string(), "--input_path", models[0].string(), "--output_path", after.string(),
          "--Mapper.num_threads", e.threads()});
  }
  // These steps may be repeated whenever the process stops.
  if (fs::exists(after) && !fs::is_empty(after)) {
    fs::remove_all(e.file("sparse"));
    makeFolders(e.file("sparse"));
    fs::rename(after, e.file("sparse") / "0");
  }
  if (fs::exists(database)) fs::rename(database, e.file("database.db"));
  fs::rename(e.file("added-key"), e.file("key"));
  warnOfUnregistered(e);
}

// Logs the model of the report. Throws Error{invalidInput} if there is none.
PoseReport checkedReport(const Estimate& e) {
  const PoseReport report = largestColmapModel(e.options, e.photographs.names.size());
  check(report.registered > 0, ErrorCode::invalidInput,
        "{}: COLMAP found no poses: the photographs overlap too little or were taken too close together; its log is "
        "{}",
        e.options.photographs.string(), e.file("mapper.log").string());
  if (e.log) {
    e.log(LogLevel::info, fmt::format("COLMAP registered {} of {} photographs, with {} points: {}", report.registered,
                                      report.photographs, report.points, report.model.string()));
    if (const std::size_t groups = colmapModels(e.options).size(); groups > 1)
      e.log(LogLevel::warning,
            fmt::format("the photographs form {} groups without common points: only the largest is used", groups));
  }
  return report;
}

}  // namespace

PoseReport estimatePoses(const PoseOptions& options, const ProgressCallback& progress, const LogCallback& log) {
  check(fs::is_directory(options.photographs), ErrorCode::io, "{}: is not a folder", options.photographs.string());
  check(!options.folder.empty(), ErrorCode::invalidInput, "the folder for COLMAP's files is not set");
  const ColmapPhotographs photographs = colmapPhotographs(options);
  const ColmapProgram colmap(options.program, options.folder, progress);
  const ColmapRun run = prepareColmapRun(options, photographs, colmap, progress);
  const Estimate estimate{options, log, photographs, colmap, run};
  if (!run.added.empty())
    addPhotographs(estimate);
  else if (!fs::exists(options.folder / "mapper.done"))
    estimateAll(estimate);
  return checkedReport(estimate);
}

}  // namespace ibr
