// SPDX-License-Identifier: Apache-2.0
// Poses by the program COLMAP (Schönberger and Frahm 2016), step by step in a folder that is kept.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <fstream>
#include <optional>

#include "author/photographs/masks.h"
#include "author/photographs/photographs.h"
#include "author/photographs/picture_folder.h"
#include "base/check.h"
#include "base/child_process.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/parse.h"
#include "ibr/author.h"
#include "io/image_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kVersion = 2;        // of the steps: raise it when they come out differently
constexpr std::size_t kMostExhaustive = 60;  // photographs that are all matched with each other
constexpr std::size_t kBlocks = 8;           // of photographs, matched two by two
constexpr std::size_t kLinesInErrors = 12;
constexpr double kBytesPerPixel = 14;  // that reading and turning a photograph take
constexpr const char* kLooking = "looking at photographs";
constexpr const char* kFeatures = "finding features with COLMAP";
constexpr const char* kMatching = "matching features with COLMAP";
constexpr const char* kMapping = "estimating poses with COLMAP";

struct Count {
  std::size_t done, total;
};

std::optional<std::size_t> numberAt(std::string_view text, std::size_t& at) {
  const std::size_t end = std::min(text.find_first_not_of("0123456789", at), text.size());
  const auto value = parseInt(text.substr(at, end - at));
  at = end;
  return value && *value >= 0 ? std::optional(std::size_t(*value)) : std::nullopt;
}

// "… [3/12] …", or "… [2/3, 1/4] …" of blocks of blocks.
std::optional<Count> bracketed(std::string_view line) {
  std::size_t at = line.find('[');
  if (at == line.npos) return std::nullopt;
  std::optional<Count> count;
  while (at < line.size() && line[at] != ']') {
    at = std::min(line.find_first_of("0123456789", at), line.size());
    const auto done = numberAt(line, at);
    if (!done || at >= line.size() || line[at] != '/') return std::nullopt;
    const auto total = numberAt(line, ++at);
    if (!total || *total == 0 || *done > *total) return std::nullopt;
    count = count ? Count{(count->done - std::min<std::size_t>(count->done, 1)) * *total + *done, count->total * *total}
                  : Count{*done, *total};
  }
  return count;
}

// "Registering image #5 (12)", of newer versions "(num_reg_frames=12)".
std::optional<std::size_t> registered(std::string_view line) {
  if (line.find("Registering image") == line.npos) return std::nullopt;
  const std::size_t open = line.rfind('(');
  if (open == line.npos) return std::nullopt;
  std::size_t at = std::min(line.find_first_of("0123456789", open), line.size());
  return numberAt(line, at);
}

// Of an empty folder: nothing is.
bool isWithin(const fs::path& file, const fs::path& folder) {
  if (folder.empty()) return false;
  const fs::path inside = fs::weakly_canonical(file).lexically_relative(fs::weakly_canonical(folder));
  return !inside.empty() && *inside.begin() != "..";
}

class Estimator {
 public:
  Estimator(const PoseOptions& options, const ProgressCallback& progress, const LogCallback& log)
      : options_(options), progress_(progress), log_(log) {}

  PoseReport run() {
    check(fs::is_directory(options_.photographs), ErrorCode::io, "{}: is not a folder", options_.photographs.string());
    check(!options_.folder.empty(), ErrorCode::invalidInput, "no folder is named for what COLMAP makes");
    names_ = lookInto(options_.photographs).pictures;
    std::erase_if(names_, [&](const std::string& name) {
      return isWithin(options_.photographs / name, options_.without) ||
             std::ranges::find(options_.exclude, name) != options_.exclude.end();
    });
    checkEnoughForPoses(options_.photographs, names_.size());
    prepare();
    if (!fs::exists(file("mapper.done"))) {
      findFeatures();
      matchFeatures();
      estimate();
    }
    return largestModel();
  }

 private:
  fs::path file(const std::string& name) const { return options_.folder / name; }

  // What was made of other photographs, or in another way, is thrown away.
  void prepare() {
    probe();
    const std::string key = fmt::format("{:016x}\n", hash());
    const bool ours = fs::exists(file("key"));
    check(ours || !fs::exists(options_.folder) || fs::is_empty(options_.folder), ErrorCode::invalidInput,
          "{}: is not empty, and nothing that was estimated here before", options_.folder.string());
    if (ours && readTextFile(file("key")) != key) fs::remove_all(options_.folder);
    makeFolders(options_.folder);
    writeFile(file("key"), key);
    if (!fs::exists(file("photographs.txt"))) {
      look();
      std::string list;
      for (const std::string& name : names_) list += name + '\n';
      writeFile(file("photographs.txt"), list);
    }
  }

  void probe() {
    std::vector<std::string> faults(names_.size());
    infos_.resize(names_.size());
    for (std::size_t i = 0; i < names_.size(); ++i) tell(faults[i], [&] { infos_[i] = probeImage(source(names_[i])); });
    checkReadable(std::move(faults));
  }

  std::uint64_t hash() const {
    Hash hash;
    hash.add(kVersion);
    hash.add(options_.orientation == Orientation::stored);
    for (const std::string& name : names_) {
      hash.add(std::string_view(name));
      hash.add(std::uint64_t(fs::file_size(source(name))));
      hash.add(std::int64_t(fs::last_write_time(source(name)).time_since_epoch().count()));
      if (const auto mask = maskOf(name)) hash.add(readFile(*mask));
    }
    return hash.value();
  }

  // Damage is found before hours go into the others. Where some are to be turned, all stand in a folder of ours.
  void look() {
    double most = 0;
    for (const ImageFileInfo& info : infos_) most = std::max(most, double(info.width) * info.height);
    const bool turns = turnsAny();
    fs::remove_all(file("upright"));
    std::vector<std::string> faults(names_.size());
    const bool finished = runJobs(
        names_.size(), threadsFor(options_.threads, kBytesPerPixel * most),
        [&](std::size_t i) {
          tell(faults[i], [&] {
            if (!turns)
              readImage(source(names_[i]));
            else
              copyUpright(i);
          });
        },
        [&](std::size_t done) { return wanted(kLooking, done, names_.size()); });
    check(finished, ErrorCode::cancelled, "{} was cancelled", kLooking);
    checkReadable(std::move(faults));
  }

  void copyUpright(std::size_t i) const {
    const fs::path to = file("upright") / names_[i];
    makeFolders(to.parent_path());
    if (isTurned(i)) return writeUpright(source(names_[i]), to);
    readImage(source(names_[i]));
    fs::create_symlink(fs::absolute(source(names_[i])), to);
  }

  template <class F>
  static void tell(std::string& fault, F&& read) {
    try {
      read();
    } catch (const Error& error) {
      if (!isOfFile(error)) throw;
      fault = error.what();
    }
  }

  fs::path source(const std::string& name) const { return options_.photographs / name; }
  std::optional<fs::path> maskOf(const std::string& name) const {
    return options_.masks.empty() ? std::nullopt : maskFileOf(options_.masks, name);
  }
  bool isTurned(std::size_t i) const {
    return options_.orientation != Orientation::stored && infos_[i].orientation != 1;
  }
  bool turnsAny() const {
    for (std::size_t i = 0; i < infos_.size(); ++i)
      if (isTurned(i)) return true;
    return false;
  }
  // Where COLMAP finds the photographs.
  fs::path pictures() const { return turnsAny() ? file("upright") : options_.photographs; }

  // Of the upright pictures, too.
  bool sameSize() const {
    const auto size = [this](std::size_t i) {
      const bool swaps = isTurned(i) && infos_[i].orientation >= 5;
      return swaps ? std::pair(infos_[i].height, infos_[i].width) : std::pair(infos_[i].width, infos_[i].height);
    };
    for (std::size_t i = 1; i < infos_.size(); ++i)
      if (size(i) != size(0)) return false;
    return true;
  }

  bool wanted(const char* stage, std::size_t done, std::size_t total) const {
    return !progress_ || progress_({stage, done, total});
  }

  // Runs a command of the program unless it has been run to its end before.
  void step(const std::string& command, const char* stage, const std::vector<std::string>& arguments,
            const std::function<std::optional<Count>(std::string_view)>& progressOf) {
    if (fs::exists(file(command + ".done"))) return;
    std::vector<std::string> line{options_.program, command};
    line.insert(line.end(), arguments.begin(), arguments.end());
    const fs::path logFile = file(command + ".log");
    std::ofstream all(logFile, std::ios::app);
    std::deque<std::string> last;
    Count count{0, names_.size()};
    bool nothing = false;  // it did what it could
    const ChildResult result = run(
        line,
        [&](std::string_view text) {
          all << text << '\n';
          last.emplace_back(text);
          if (last.size() > kLinesInErrors) last.pop_front();
          nothing = nothing || text.find("failed to create sparse model") != text.npos;
          if (const auto now = progressOf(text)) count = *now;
        },
        [&] { return wanted(stage, std::min(count.done, count.total), count.total); });
    check(!result.stopped, ErrorCode::cancelled, "{} was cancelled; called again it goes on from there", stage);
    if (nothing) return;
    check(result.status == 0, ErrorCode::io, "{} {} failed with exit status {}. Its last lines (all are in {}):\n{}",
          options_.program, command, result.status, logFile.string(), fmt::join(last, "\n"));
    writeFile(file(command + ".done"), std::string_view("done\n"));
  }

  ChildResult run(const std::vector<std::string>& line, const std::function<void(std::string_view)>& print,
                  const std::function<bool()>& goesOn) const {
    try {
      return runChild(line, {{"QT_QPA_PLATFORM", "offscreen"}}, print, goesOn);
    } catch (const Error& e) {
      if (e.code() != ErrorCode::io) throw;
      fail(ErrorCode::io,
           "{}. Photographs without poses need the program COLMAP: install it (Debian: apt-get install colmap) or name "
           "it (--colmap), or give poses (--model, --transforms, --panoramas)",
           e.what());
    }
  }

  // Version 4 has other names for what is done on a graphics card.
  void learnNames() {
    bool newer = false;
    run(
        {options_.program, "feature_extractor", "--help"},
        [&](std::string_view text) { newer = newer || text.find("FeatureExtraction.use_gpu") != text.npos; },
        [&] { return wanted(kFeatures, 0, names_.size()); });
    extraction_ = newer ? "--FeatureExtraction" : "--SiftExtraction";
    matching_ = newer ? "--FeatureMatching" : "--SiftMatching";
  }

  std::string threads() const { return std::to_string(options_.threads > 0 ? options_.threads : -1); }

  // Under the names that COLMAP looks for. False where there are none.
  bool copyMasks() const {
    bool any = false;
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (const auto mask = maskOf(names_[i])) {
        const fs::path to = file("masks") / (names_[i] + ".png");
        makeFolders(to.parent_path());
        if (isTurned(i))
          writeImage(to, upright(readImage(*mask), infos_[i].orientation));
        else
          writeFile(to, readFile(*mask));
        any = true;
      }
    return any;
  }

  void findFeatures() {
    learnNames();
    // Photographs of one size are most often of one lens: its focal length is then found more surely.
    std::vector<std::string> arguments{"--database_path",
                                       file("database.db").string(),
                                       "--image_path",
                                       pictures().string(),
                                       "--image_list_path",
                                       file("photographs.txt").string(),
                                       "--ImageReader.single_camera",
                                       sameSize() ? "1" : "0",
                                       extraction_ + ".use_gpu",
                                       "0",
                                       extraction_ + ".num_threads",
                                       threads()};
    if (copyMasks()) arguments.insert(arguments.end(), {"--ImageReader.mask_path", file("masks").string()});
    step("feature_extractor", kFeatures, arguments, bracketed);
  }

  void matchFeatures() {
    std::vector<std::string> arguments{"--database_path",          file("database.db").string(),
                                       matching_ + ".use_gpu",     "0",
                                       matching_ + ".num_threads", threads()};
    const bool all = names_.size() <= kMostExhaustive;
    // COLMAP tells and keeps what it matched block by block: of one block, nothing is seen, and a stop loses all of it.
    if (all) {
      const std::size_t side = std::max<std::size_t>(2, (names_.size() + kBlocks - 1) / kBlocks);
      arguments.insert(arguments.end(), {"--ExhaustiveMatching.block_size", std::to_string(side)});
    }
    step(all ? "exhaustive_matcher" : "sequential_matcher", kMatching, arguments, bracketed);
  }

  void estimate() {
    estimateOnce({});
    if (!fs::is_empty(file("sparse"))) return;
    // COLMAP begins with two photographs side by side; on a walk straight ahead there are none.
    if (log_)
      log_(LogLevel::info,
           "COLMAP found no two photographs to begin with: once more, with such as lie one behind the other");
    fs::remove(file("mapper.done"));
    estimateOnce({"--Mapper.init_max_forward_motion", "1", "--Mapper.init_min_tri_angle", "4"});
  }

  void estimateOnce(const std::vector<std::string>& more) {
    fs::remove_all(file("sparse"));  // a half-finished one is begun anew
    makeFolders(file("sparse"));
    std::vector<std::string> arguments{
        "--database_path", file("database.db").string(), "--image_path",         pictures().string(),
        "--output_path",   file("sparse").string(),      "--Mapper.num_threads", threads()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    step("mapper", kMapping, arguments, [this](std::string_view text) -> std::optional<Count> {
      const auto done = registered(text);
      if (!done) return std::nullopt;
      return Count{*done, names_.size()};
    });
  }

  PoseReport largestModel() const {
    PoseReport report;
    report.photographs = names_.size();
    std::vector<fs::path> folders;
    for (const auto& entry : fs::directory_iterator(file("sparse")))
      if (entry.is_directory()) folders.push_back(entry.path());
    std::ranges::sort(folders);
    for (const fs::path& folder : folders) {
      const PosedModel model = readColmapModel(folder);
      if (model.images.size() <= report.registered) continue;
      report.model = folder;
      report.registered = model.images.size();
      report.points = model.tracks.size();
    }
    check(report.registered > 0, ErrorCode::invalidInput,
          "{}: COLMAP found no poses: these photographs share too little of what they show, or were taken too near one "
          "another. Its words are in {}",
          options_.photographs.string(), file("mapper.log").string());
    if (log_) {
      log_(LogLevel::info, fmt::format("COLMAP registered {} of {} photographs, with {} points: {}", report.registered,
                                       report.photographs, report.points, report.model.string()));
      if (folders.size() > 1)
        log_(LogLevel::warning,
             fmt::format("the photographs fall into {} groups that share nothing: only the largest is "
                         "used",
                         folders.size()));
    }
    return report;
  }

  const PoseOptions& options_;
  const ProgressCallback& progress_;
  const LogCallback& log_;
  std::vector<std::string> names_;
  std::vector<ImageFileInfo> infos_;
  std::string extraction_, matching_;
};

}  // namespace

PoseReport estimatePoses(const PoseOptions& options, const ProgressCallback& progress, const LogCallback& log) {
  return Estimator(options, progress, log).run();
}

}  // namespace ibr
