// SPDX-License-Identifier: Apache-2.0
// Estimates poses with the program COLMAP (Schönberger and Frahm 2016), step by step in a cached folder.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>

#include "author/photographs/masks.h"
#include "author/photographs/photographs.h"
#include "author/poses/colmap_program.h"
#include "base/check.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "ibr/author/photographs.h"
#include "ibr/author/poses.h"
#include "io/image_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kVersion = 3;          // of the steps: raise it when their results change
constexpr std::size_t kMaxExhaustive = 60;     // maximum number of photographs for exhaustive matching
constexpr std::size_t kMaxAddedPairs = 10000;  // maximum number of pairs matched to add photographs
constexpr double kMaxAddedShare = 0.5;         // maximum share of added photographs, of the previous ones
constexpr double kMaxUnregisteredShare = 0.2;  // maximum share of the previous ones that the model may lack
constexpr std::size_t kBlocks = 8;             // of photographs, matched pair by pair
constexpr double kBytesPerPixel = 14;          // memory for reading and rotating a photograph
constexpr const char* kCheckingStage = "checking photographs";
constexpr const char* kFeaturesStage = "finding features with COLMAP";
constexpr const char* kMatchingStage = "matching features with COLMAP";
constexpr const char* kMappingStage = "estimating poses with COLMAP";
constexpr const char* kAddingStage = "adding photographs with COLMAP";
constexpr const char* kSharedCameraId = "1";  // COLMAP's camera id, if all photographs share one

// False if `folder` is an empty path.
bool isWithin(const fs::path& file, const fs::path& folder) {
  if (folder.empty()) return false;
  const fs::path inside = fs::weakly_canonical(file).lexically_relative(fs::weakly_canonical(folder));
  return !inside.empty() && *inside.begin() != "..";
}

class Estimator {
 public:
  Estimator(const PoseOptions& options, const ProgressCallback& progress, const LogCallback& log)
      : options_(options), progress_(progress), log_(log), colmap_(options.program, options.folder, progress) {}

  PoseReport run() {
    check(fs::is_directory(options_.photographs), ErrorCode::io, "{}: is not a folder", options_.photographs.string());
    check(!options_.folder.empty(), ErrorCode::invalidInput, "the folder for COLMAP's files is not set");
    names_ = scanPhotographFolder(options_.photographs).pictures;
    std::erase_if(names_, [&](const std::string& name) {
      return isWithin(options_.photographs / name, options_.excludedFolder) ||
             std::ranges::find(options_.exclude, name) != options_.exclude.end();
    });
    checkEnoughForPoses(options_.photographs, names_.size());
    prepare();
    if (!added_.empty()) {
      addPhotographs();
    } else if (!fs::exists(file("mapper.done"))) {
      findFeatures();
      matchFeatures();
      estimate();
    }
    return report();
  }

 private:
  fs::path file(const std::string& name) const { return options_.folder / name; }
  fs::path databaseFile() const { return file(mark_ + "database.db"); }
  fs::path listFile() const { return file(mark_ + "photographs.txt"); }

  // Discards results of other photographs or settings; keeps poses if photographs were only added.
  void prepare() {
    probe();
    const std::vector<std::string> key = keyLines();
    const bool ours = fs::exists(file("key"));
    check(ours || !fs::exists(options_.folder) || fs::is_empty(options_.folder), ErrorCode::invalidInput,
          "{}: is not empty and has no poses of an earlier run; choose another folder", options_.folder.string());
    const std::string text = fmt::format("{}\n", fmt::join(key, "\n"));
    if (ours && readTextFile(file("key")) != text) {
      added_ = addedTo(readTextFile(file("key")), key);
      if (!canAdd(text)) added_.clear();
      if (added_.empty()) fs::remove_all(options_.folder);
    }
    makeFolders(options_.folder);
    if (added_.empty()) {
      writeFile(file("key"), text);
      for (std::size_t i = 0; i < names_.size(); ++i) inThisRun_.push_back(i);
    } else {
      prepareToAdd(text);
    }
    if (!fs::exists(listFile())) {
      checkPhotographs();
      std::string list;
      for (const std::size_t i : inThisRun_) list += names_[i] + '\n';
      writeFile(listFile(), list);
    }
  }

  bool isAdditionStarted(const std::string& key) const {
    return fs::exists(file("added-key")) && readTextFile(file("added-key")) == key;
  }

  // Poor models, and those of few photographs, are estimated again: the result may be a different model.
  bool canAdd(const std::string& key) const {
    const std::size_t before = names_.size() - added_.size();
    if (added_.empty() || !fs::exists(file("mapper.done")) || double(added_.size()) > kMaxAddedShare * double(before) ||
        added_.size() * names_.size() > kMaxAddedPairs)
      return false;
    // COLMAP reads pairs of names word by word.
    if (std::ranges::any_of(names_, [](const std::string& name) { return name.find(' ') != name.npos; })) return false;
    if (isAdditionStarted(key)) return true;
    return models().size() == 1 && double(largestModel().registered) >= (1 - kMaxUnregisteredShare) * double(before);
  }

  // Discards the steps of another, stopped addition: this one starts from the database before that addition.
  void prepareToAdd(const std::string& key) {
    inThisRun_ = added_;
    mark_ = "added-";
    if (isAdditionStarted(key)) return;
    fs::remove(file("added-key"));
    for (const char* step : {"feature_extractor", "matches_importer", "image_registrator"})
      fs::remove(colmap_.doneFile(mark_, step));
    fs::remove(listFile());
    if (fs::exists(file("database.db")))
      fs::copy_file(file("database.db"), databaseFile(), fs::copy_options::overwrite_existing);
    fs::remove_all(file("added"));
    writeFile(file("added-key"), key);
  }

  // Indices of the photographs of `now` that `before` lacks; none if anything else differs.
  static std::vector<std::size_t> addedTo(const std::string& before, const std::vector<std::string>& now) {
    std::set<std::string> lines;
    for (std::size_t at = 0, end; (end = before.find('\n', at)) != before.npos; at = end + 1)
      lines.insert(before.substr(at, end - at));
    std::vector<std::size_t> added;
    if (!lines.contains(now[0])) return {};
    for (std::size_t i = 1; i < now.size(); ++i)
      if (!lines.contains(now[i])) added.push_back(i - 1);
    return lines.size() + added.size() == now.size() ? added : std::vector<std::size_t>();
  }

  void probe() {
    std::vector<std::string> faults(names_.size());
    infos_.resize(names_.size());
    for (std::size_t i = 0; i < names_.size(); ++i)
      collectFault(faults[i], [&] { infos_[i] = probeImage(source(names_[i])); });
    checkReadable(std::move(faults));
  }

  // Returns a line for the common settings, then a line for each photograph.
  std::vector<std::string> keyLines() const {
    std::vector<std::string> lines{
        fmt::format("{} {}", kVersion, options_.orientation == Orientation::stored ? "stored" : "upright")};
    for (const std::string& name : names_) {
      Hash hash;
      hash.add(std::uint64_t(fs::file_size(source(name))));
      hash.add(std::int64_t(fs::last_write_time(source(name)).time_since_epoch().count()));
      if (const auto mask = maskOf(name)) hash.add(readFile(*mask));
      lines.push_back(fmt::format("{:016x} {}", hash.value(), name));
    }
    return lines;
  }

  // Finds damaged files before hours of work. If some photographs are rotated, all are placed in a folder of their own.
  void checkPhotographs() {
    double most = 0;
    for (const ImageFileInfo& info : infos_) most = std::max(most, double(info.width) * info.height);
    const bool turns = anyRotated();
    if (added_.empty()) fs::remove_all(file("upright"));
    std::vector<std::string> faults(inThisRun_.size());
    const bool finished = runJobs(
        inThisRun_.size(), threadsFor(options_.threads, kBytesPerPixel * most),
        [&](std::size_t i) {
          collectFault(faults[i], [&] {
            if (!turns)
              readImage(source(names_[inThisRun_[i]]));
            else
              copyUpright(inThisRun_[i]);
          });
        },
        [&](std::size_t done) { return reportProgress(kCheckingStage, done, inThisRun_.size()); });
    check(finished, ErrorCode::cancelled, "cancelled while {}", kCheckingStage);
    checkReadable(std::move(faults));
  }

  void copyUpright(std::size_t i) const {
    const fs::path to = file("upright") / names_[i];
    makeFolders(to.parent_path());
    if (isRotated(i)) return writeUpright(source(names_[i]), to);
    readImage(source(names_[i]));
    fs::remove(to);
    fs::create_symlink(fs::absolute(source(names_[i])), to);
  }

  template <class F>
  static void collectFault(std::string& fault, F&& read) {
    try {
      read();
    } catch (const Error& error) {
      if (!isFileError(error)) throw;
      fault = error.what();
    }
  }

  fs::path source(const std::string& name) const { return options_.photographs / name; }
  std::optional<fs::path> maskOf(const std::string& name) const {
    return options_.masks.empty() ? std::nullopt : findMaskFile(options_.masks, name);
  }
  bool isRotated(std::size_t i) const {
    return options_.orientation != Orientation::stored && infos_[i].orientation != 1;
  }
  bool anyRotated() const {
    for (std::size_t i = 0; i < infos_.size(); ++i)
      if (isRotated(i)) return true;
    return false;
  }
  // Folder from which COLMAP reads the photographs.
  fs::path pictures() const { return anyRotated() ? file("upright") : options_.photographs; }

  // True if all photographs, once upright, have the same size.
  bool sameSize(const std::vector<std::size_t>& photographs) const {
    const auto size = [this](std::size_t i) {
      const bool swaps = isRotated(i) && infos_[i].orientation >= 5;
      return swaps ? std::pair(infos_[i].height, infos_[i].width) : std::pair(infos_[i].width, infos_[i].height);
    };
    return std::ranges::all_of(photographs, [&](std::size_t i) { return size(i) == size(photographs[0]); });
  }

  bool reportProgress(const char* stage, std::size_t done, std::size_t total) const {
    return !progress_ || progress_({stage, done, total});
  }

  void step(const std::string& command, const char* stage, const std::vector<std::string>& arguments) const {
    colmap_.run(mark_, command, stage, arguments, names_.size());
  }

  std::string threads() const { return std::to_string(options_.threads > 0 ? options_.threads : -1); }

  // Copies masks under the names that COLMAP expects. Returns false if there are none.
  bool copyMasks() const {
    bool any = false;
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (const auto mask = maskOf(names_[i])) {
        const fs::path to = file("masks") / (names_[i] + ".png");
        makeFolders(to.parent_path());
        if (isRotated(i))
          writeImage(to, upright(readImage(*mask), infos_[i].orientation));
        else
          writeFile(to, readFile(*mask));
        any = true;
      }
    return any;
  }

  void findFeatures() {
    option_ = colmap_.optionNames(kFeaturesStage);
    // Photographs of one size usually share one lens: a shared focal length is estimated more reliably.
    std::vector<std::string> arguments{"--database_path",
                                       databaseFile().string(),
                                       "--image_path",
                                       pictures().string(),
                                       "--image_list_path",
                                       listFile().string(),
                                       "--ImageReader.single_camera",
                                       sameSize(inThisRun_) ? "1" : "0",
                                       option_.extraction + ".use_gpu",
                                       "0",
                                       option_.extraction + ".num_threads",
                                       threads()};
    std::vector<std::size_t> all(names_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    if (!added_.empty() && sameSize(all))
      arguments.insert(arguments.end(), {"--ImageReader.existing_camera_id", kSharedCameraId});
    if (copyMasks()) arguments.insert(arguments.end(), {"--ImageReader.mask_path", file("masks").string()});
    step("feature_extractor", kFeaturesStage, arguments);
  }

  void matchFeatures() {
    std::vector<std::string> arguments{"--database_path",
                                       databaseFile().string(),
                                       option_.matching + ".use_gpu",
                                       "0",
                                       option_.matching + ".num_threads",
                                       threads()};
    if (!added_.empty()) {
      writePairs();
      arguments.insert(arguments.end(),
                       {"--match_list_path", file("added-pairs.txt").string(), "--match_type", "pairs"});
      return step("matches_importer", kMatchingStage, arguments);
    }
    const bool all = names_.size() <= kMaxExhaustive;
    // COLMAP reports and stores matches block by block: a single block shows no progress, and is lost when stopped.
    if (all) {
      const std::size_t side = std::max<std::size_t>(2, (names_.size() + kBlocks - 1) / kBlocks);
      arguments.insert(arguments.end(), {"--ExhaustiveMatching.block_size", std::to_string(side)});
    }
    step(all ? "exhaustive_matcher" : "sequential_matcher", kMatchingStage, arguments);
  }

  // Pairs each added photograph with all others.
  void writePairs() const {
    std::string pairs;
    for (const std::size_t i : added_)
      for (std::size_t j = 0; j < names_.size(); ++j)
        if (j < i || (j > i && !std::ranges::binary_search(added_, j))) pairs += names_[i] + ' ' + names_[j] + '\n';
    writeFile(file("added-pairs.txt"), pairs);
  }

  void estimate() {
    estimateOnce({});
    if (!fs::is_empty(file("sparse"))) return;
    // COLMAP starts from two photographs side by side; a walk straight ahead has none.
    if (log_)
      log_(LogLevel::info, "COLMAP found no initial pair of photographs; retrying with pairs in forward motion");
    fs::remove(file("mapper.done"));
    estimateOnce({"--Mapper.init_max_forward_motion", "1", "--Mapper.init_min_tri_angle", "4"});
  }

  void estimateOnce(const std::vector<std::string>& more) {
    fs::remove_all(file("sparse"));  // a half-finished model is started again
    makeFolders(file("sparse"));
    std::vector<std::string> arguments{
        "--database_path", file("database.db").string(), "--image_path",         pictures().string(),
        "--output_path",   file("sparse").string(),      "--Mapper.num_threads", threads()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    step("mapper", kMappingStage, arguments);
  }

  // Keeps existing poses and points bit-identical: cached depth that used them stays valid.
  void addPhotographs() {
    findFeatures();
    matchFeatures();
    const fs::path after = file("added");
    if (!models().empty()) {
      makeFolders(after);
      step("image_registrator", kAddingStage,
           {"--database_path", databaseFile().string(), "--input_path", models()[0].string(), "--output_path",
            after.string(), "--Mapper.num_threads", threads()});
    }
    // These steps may be repeated whenever the process stops.
    if (fs::exists(after) && !fs::is_empty(after)) {
      fs::remove_all(file("sparse"));
      makeFolders(file("sparse"));
      fs::rename(after, file("sparse") / "0");
    }
    if (fs::exists(databaseFile())) fs::rename(databaseFile(), file("database.db"));
    fs::rename(file("added-key"), file("key"));
    warnOfUnregistered();
  }

  // Added photographs are registered to existing points only, not to each other.
  void warnOfUnregistered() const {
    std::set<std::string> posed;
    for (const PosedImage& image : readColmapModel(largestModel().model).images) posed.insert(image.name);
    std::vector<std::string> left;
    for (const std::size_t i : added_)
      if (!posed.contains(names_[i])) left.push_back(names_[i]);
    if (log_ && !left.empty())
      log_(LogLevel::warning,
           fmt::format("{} of {} added photographs overlap too little with photographs that have poses, for example "
                       "{}: delete {} to estimate all poses again",
                       left.size(), added_.size(), left[0], options_.folder.string()));
  }

  std::vector<fs::path> models() const {
    std::vector<fs::path> folders;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(file("sparse"), none))
      if (entry.is_directory()) folders.push_back(entry.path());
    std::ranges::sort(folders);
    return folders;
  }

  PoseReport largestModel() const {
    PoseReport report;
    report.photographs = names_.size();
    for (const fs::path& folder : models()) {
      const PosedModel model = readColmapModel(folder);
      if (model.images.size() <= report.registered) continue;
      report.model = folder;
      report.registered = model.images.size();
      report.points = model.tracks.size();
    }
    return report;
  }

  PoseReport report() const {
    const PoseReport report = largestModel();
    check(report.registered > 0, ErrorCode::invalidInput,
          "{}: COLMAP found no poses: the photographs overlap too little or were taken too close together; its log is "
          "{}",
          options_.photographs.string(), file("mapper.log").string());
    if (log_) {
      log_(LogLevel::info, fmt::format("COLMAP registered {} of {} photographs, with {} points: {}", report.registered,
                                       report.photographs, report.points, report.model.string()));
      if (const std::size_t groups = models().size(); groups > 1)
        log_(LogLevel::warning, fmt::format("the photographs form {} groups without common points: only the largest is "
                                            "used",
                                            groups));
    }
    return report;
  }

  const PoseOptions& options_;
  const ProgressCallback& progress_;
  const LogCallback& log_;
  std::vector<std::string> names_;
  std::vector<ImageFileInfo> infos_;
  std::vector<std::size_t> added_;      // since poses were estimated
  std::vector<std::size_t> inThisRun_;  // photographs of this run: added_, or all
  std::string mark_;                    // prefix of this run's files
  const ColmapProgram colmap_;
  ColmapProgram::OptionNames option_;
};

}  // namespace

PoseReport estimatePoses(const PoseOptions& options, const ProgressCallback& progress, const LogCallback& log) {
  return Estimator(options, progress, log).run();
}

}  // namespace ibr
