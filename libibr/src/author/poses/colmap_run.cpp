// SPDX-License-Identifier: Apache-2.0
#include "author/poses/colmap_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <system_error>

#include "base/check.h"
#include "base/file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxAddedPairs = 10000;  // maximum number of pairs matched to add photographs
constexpr double kMaxAddedShare = 0.5;         // maximum share of added photographs, of the previous ones
constexpr double kMaxUnregisteredShare = 0.2;  // maximum share of the previous ones that the model may lack

// Indices of the photographs of the key `now` that the key `before` lacks; none if anything else differs.
std::vector<std::size_t> addedTo(const std::string& before, const std::vector<std::string>& now) {
  std::set<std::string> lines;
  for (std::size_t at = 0, end; (end = before.find('\n', at)) != before.npos; at = end + 1)
    lines.insert(before.substr(at, end - at));
  std::vector<std::size_t> added;
  if (!lines.contains(now[0])) return {};
  for (std::size_t i = 1; i < now.size(); ++i)
    if (!lines.contains(now[i])) added.push_back(i - 1);
  return lines.size() + added.size() == now.size() ? added : std::vector<std::size_t>();
}

bool isAdditionStarted(const fs::path& folder, const std::string& key) {
  return fs::exists(folder / "added-key") && readTextFile(folder / "added-key") == key;
}

// Poor models, and those of few photographs, are estimated again: the result may be a different model.
bool canAdd(const PoseOptions& options, const std::vector<std::string>& names, std::size_t added,
            const std::string& key) {
  const std::size_t before = names.size() - added;
  if (added == 0 || !fs::exists(options.folder / "mapper.done") || double(added) > kMaxAddedShare * double(before) ||
      added * names.size() > kMaxAddedPairs)
    return false;
  if (!isReadInPairs(names)) return false;
  if (isAdditionStarted(options.folder, key)) return true;
  return colmapModels(options).size() == 1 &&
         double(largestColmapModel(options, names.size()).registered) >= (1 - kMaxUnregisteredShare) * double(before);
}

// Discards the steps of another, stopped addition: this one starts from the database before that addition.
void startAddition(const fs::path& folder, const ColmapRun& run, const ColmapProgram& colmap, const std::string& key) {
  fs::remove(folder / "added-key");
  for (const char* step : {"feature_extractor", "matches_importer", "image_registrator"})
    fs::remove(colmap.doneFile(run.mark, step));
  fs::remove(run.listFile);
  if (fs::exists(folder / "database.db"))
    fs::copy_file(folder / "database.db", run.databaseFile, fs::copy_options::overwrite_existing);
  fs::remove_all(folder / "added");
  writeFile(folder / "added-key", key);
}

}  // namespace

bool isReadInPairs(const std::vector<std::string>& names) {
  return std::ranges::none_of(names, [](const std::string& name) { return name.find(' ') != name.npos; });
}

ColmapRun prepareColmapRun(const PoseOptions& options, const ColmapPhotographs& photographs,
                           const ColmapProgram& colmap, const ProgressCallback& progress) {
  const fs::path &folder = options.folder, keyFile = folder / "key";
  const std::vector<std::string>& names = photographs.names;
  const std::vector<std::string> lines = colmapKeyLines(options, photographs);
  const bool ours = fs::exists(keyFile);
  check(ours || !fs::exists(folder) || fs::is_empty(folder), ErrorCode::invalidInput,
        "{}: is not empty and has no poses of an earlier run; choose another folder", folder.string());
  const std::string key = fmt::format("{}\n", fmt::join(lines, "\n"));
  ColmapRun run;
  if (ours && readTextFile(keyFile) != key) {
    run.added = addedTo(readTextFile(keyFile), lines);
    if (!canAdd(options, names, run.added.size(), key)) run.added.clear();
    if (run.added.empty()) fs::remove_all(folder);
  }
  makeFolders(folder);
  const bool adds = !run.added.empty();
  run.mark = adds ? "added-" : "";
  run.databaseFile = folder / (run.mark + "database.db");
  run.listFile = folder / (run.mark + "photographs.txt");
  run.photographs = run.added;
  if (!adds) {
    writeFile(keyFile, key);
    run.photographs.resize(names.size());
    std::iota(run.photographs.begin(), run.photographs.end(), std::size_t{0});
  } else if (!isAdditionStarted(folder, key)) {
    startAddition(folder, run, colmap, key);
  }
  if (!fs::exists(run.listFile)) {
    if (!adds) fs::remove_all(folder / "upright");
    checkColmapPhotographs(options, photographs, run.photographs, progress);
    std::string list;
    for (const std::size_t i : run.photographs) list += names[i] + '\n';
    writeFile(run.listFile, list);
  }
  return run;
}

std::vector<fs::path> colmapModels(const PoseOptions& options) {
  std::vector<fs::path> folders;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(options.folder / "sparse", none))
    if (entry.is_directory()) folders.push_back(entry.path());
  std::ranges::sort(folders);
  return folders;
}

PoseReport largestColmapModel(const PoseOptions& options, std::size_t photographs) {
  PoseReport report;
  report.photographs = photographs;
  for (const fs::path& folder : colmapModels(options)) {
    const PosedModel model = readColmapModel(folder);
    if (model.images.size() <= report.registered) continue;
    report.model = folder;
    report.registered = model.images.size();
    report.points = model.tracks.size();
  }
  return report;
}

}  // namespace ibr
