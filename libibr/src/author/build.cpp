// SPDX-License-Identifier: Apache-2.0
// From posed photographs to a scene folder ([T] §2.4.1): model → cells → matches and meshes, a cell at a time → scene.
//
// A finished cell is kept in OUTPUT/.build until the scene is written, under a hash of its members' files, cameras and
// points, so that a build that was stopped goes on, and one with other options takes over what is the same.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <thread>
#include <unordered_map>

#include "author/backdrop.h"
#include "author/cell_cache.h"
#include "author/cells.h"
#include "author/hash.h"
#include "author/match.h"
#include "author/mesh.h"
#include "author/own_depth.h"
#include "author/panorama_cell.h"
#include "author/parallel.h"
#include "author/photographs.h"
#include "author/posed_model.h"
#include "base/check.h"
#include "ibr/author.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kVersion = 1;   // of the cells' making: raise it when they come out differently
constexpr double kMatchPixels = 2e6;    // photographs are matched at no more than this
constexpr double kBytesPerPixel = 400;  // that matching takes, of one member's pixels
constexpr std::uint64_t kBackdropVersion = 1;
constexpr double kBytesOfBackdrop = 200e6;
constexpr double kExactPx = 0.1;  // median reprojection error up to which poses count as exact
constexpr double kLeastCoverage = 0.05;

using Clock = std::chrono::steady_clock;
double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Optical flow depends on how many threads share it.
class SingleThreadedOpenCv {
 public:
  SingleThreadedOpenCv() : before_(cv::getNumThreads()) { cv::setNumThreads(1); }
  SingleThreadedOpenCv(const SingleThreadedOpenCv&) = delete;
  SingleThreadedOpenCv& operator=(const SingleThreadedOpenCv&) = delete;
  ~SingleThreadedOpenCv() { cv::setNumThreads(before_); }

 private:
  int before_;
};

Image8 shrunk(const Image8& picture, int width, int height) {
  Image8 small(width, height, 3);
  const cv::Mat from(picture.height, picture.width, CV_8UC3, const_cast<std::uint8_t*>(picture.values.data()));
  cv::Mat to(height, width, CV_8UC3, small.values.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  return small;
}

MatchView viewOf(const Photograph& photo) {
  MatchView view{photo.camera, loadPhotograph(photo)};
  const double pixels = double(view.picture.width) * view.picture.height;
  if (pixels <= kMatchPixels) return view;
  const double scale = std::sqrt(kMatchPixels / pixels);
  const int width = std::max(1, int(view.picture.width * scale)),
            height = std::max(1, int(view.picture.height * scale));
  view.camera.intrinsics = resized(photo.camera.intrinsics, width, height);
  view.picture = shrunk(view.picture, width, height);
  return view;
}

bool isPanorama(const Photograph& photo) {
  return photo.camera.intrinsics.model == CameraModel::equirectangular;
}

class Builder {
 public:
  Builder(const BuildOptions& options, const ProgressCallback& progress, const LogCallback& log)
      : options_(options), progress_(progress), log_(log) {}

  BuildReport run() {
    const auto start = Clock::now();
    readInput();
    const SingleThreadedOpenCv quiet;
    storePhotographs();
    makeCells();
    if (options_.backdrops) makeBackdrops();
    step("writing the scene", 0, 1);
    saveScene(scene_, options_.output);
    fs::remove_all(keep());
    report_.seconds = secondsSince(start);
    return std::move(report_);
  }

 private:
  fs::path keep() const { return options_.output / ".build"; }

  bool wanted(std::string_view stage, std::size_t done, std::size_t total) const {
    return !progress_ || progress_({stage, done, total});
  }
  void step(std::string_view stage, std::size_t done, std::size_t total) const {
    check(wanted(stage, done, total), ErrorCode::cancelled, "the build was cancelled while {}", stage);
  }
  int threads(double bytesEach) const {
    const int asked = options_.threads > 0 ? options_.threads : std::max(1, int(std::thread::hardware_concurrency()));
    const double memory = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGE_SIZE));
    return std::clamp(int(0.5 * memory / std::max(bytesEach, 1.0)), 1, asked);
  }
  void runAll(std::string_view stage, std::size_t count, double bytesEach,
              const std::function<void(std::size_t)>& job) const {
    const bool finished =
        runJobs(count, threads(bytesEach), job, [&](std::size_t done) { return wanted(stage, done, count); });
    check(finished, ErrorCode::cancelled, "the build was cancelled while {}; called again it goes on from there",
          stage);
  }

  void readInput() {
    check(options_.threads >= 0, ErrorCode::invalidInput, "{} threads are not 0 or more", options_.threads);
    check(options_.maxSize >= 0, ErrorCode::invalidInput, "largest size {} px is not 0 or more", options_.maxSize);
    const int spacing = options_.backdropSpacing;
    check(spacing >= 2 && spacing <= 32 && std::has_single_bit(unsigned(spacing)), ErrorCode::invalidInput,
          "spacing {} px of backdrops' vertices is not 2, 4, 8, 16 or 32", spacing);
    check(!options_.output.empty(), ErrorCode::invalidInput, "no folder is named for the scene");
    check(fs::is_directory(options_.photographs), ErrorCode::io, "{}: is not a folder", options_.photographs.string());
    step("reading the model", 0, 1);
    model_ = options_.panoramas.empty() ? readColmapModel(options_.model, log_) : readPanoramas(options_.panoramas);
    std::set<std::string> known;
    for (const PosedImage& image : model_.images) known.insert(image.name);
    for (const std::string& name : listPictures(options_.photographs))
      if (!known.contains(name)) report_.dropped.push_back({name, "not registered: the model has no pose for it"});
    removeImages(model_, options_.exclude);
    check(!model_.images.empty(), ErrorCode::invalidInput, "{}: no image is left",
          (options_.panoramas.empty() ? options_.model : options_.panoramas).string());
    for (const PosedImage& image : model_.images)
      photographs_.push_back(findPhotograph(options_.photographs, image, options_.maxSize));
    refine_ = reprojectionError(model_) > kExactPx;
    plan_ = planCells(model_, options_);
    report_.dropped.insert(report_.dropped.end(), plan_.dropped.begin(), plan_.dropped.end());
  }

  void storePhotographs() {
    fs::create_directories(keep());
    hashes_.resize(photographs_.size());
    runAll("storing photographs", photographs_.size(), 64e6,
           [&](std::size_t i) { hashes_[i] = storePhotograph(photographs_[i], options_.output, options_.texture); });
    for (const Photograph& photo : photographs_)
      scene_.nodes.push_back({photo.name, photo.camera, photo.imageFile, photo.textureFile});
    const bool panoramic = std::ranges::all_of(photographs_, isPanorama);
    scene_.acquisition = panoramic ? "panoramic" : plan_.ordered ? "ordered" : "unordered";
    scene_.settings = fmt::format(
        R"({{"dimension":{},"maxSize":{},"texture":"{}","thetaDegrees":{},"seed":{},"refine":{},"backdrops":{},)"
        R"("backdropSpacing":{}}})",
        options_.dimension, options_.maxSize, textureFormatName(options_.texture), options_.thetaDegrees, options_.seed,
        refine_, options_.backdrops, options_.backdropSpacing);
  }

  // Points that all members see; if they are few, those that two see.
  std::vector<glm::dvec3> pointsOf(const std::vector<std::uint32_t>& members) const {
    constexpr std::size_t kEnough = 30;
    std::vector<glm::dvec3> all, some;
    for (const Track& track : model_.tracks) {
      const auto seen = std::count_if(track.observations.begin(), track.observations.end(), [&](const auto& o) {
        return std::find(members.begin(), members.end(), o.image) != members.end();
      });
      if (seen >= 2) some.push_back(track.position);
      if (std::size_t(seen) == members.size()) all.push_back(track.position);
    }
    return all.size() >= kEnough ? all : some;
  }

  void addPhotograph(Hash& hash, std::uint32_t i) const {
    hash.add(hashes_[i]);
    const Intrinsics& k = photographs_[i].camera.intrinsics;
    const Pose& pose = photographs_[i].camera.pose;
    hash.add(photographs_[i].applyOrientation);
    for (const double v : {double(k.width), double(k.height), k.fx, k.fy, k.cx, k.cy, pose.position.x, pose.position.y,
                           pose.position.z, pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z})
      hash.add(v);
  }
  static void addPoints(Hash& hash, const std::vector<glm::dvec3>& points) {
    for (const glm::dvec3& p : points)
      for (int c = 0; c < 3; ++c) hash.add(p[c]);
  }

  std::uint64_t keyOf(const std::vector<std::uint32_t>& members, const std::vector<glm::dvec3>& points) const {
    Hash hash;
    hash.add(kVersion);
    hash.add(options_.seed);
    hash.add(refine_);
    for (const std::uint32_t i : members) addPhotograph(hash, i);
    addPoints(hash, points);
    return hash.value();
  }

  struct Made {
    CellMesh cell;
    double seconds = 0;
    bool resumed = false;
    std::uint64_t key = 0;
  };

  CellMesh pinholes(const std::vector<std::uint32_t>& members, const std::vector<glm::dvec3>& points,
                    std::uint64_t key) const {
    std::vector<MatchView> views;
    std::vector<Camera> stored;
    for (const std::uint32_t i : members) {
      views.push_back(viewOf(photographs_[i]));
      stored.push_back(photographs_[i].camera);
    }
    const DenseMatch match = matchViews(views, points, {refine_});
    if (options_.backdrops) {
      std::vector<ImageF> depths;
      for (std::size_t i = 0; i < views.size(); ++i)
        depths.push_back(ownDepth(match, views[i].camera, i, backdropSize(stored[i].intrinsics)));
      storeDepths(keep(), key, depths);
    }
    return buildMesh(stored, views, match);
  }
  CellMesh panoramas(const std::vector<std::uint32_t>& members, const std::vector<glm::dvec3>& points) const {
    std::vector<PanoramaView> views;
    for (const std::uint32_t i : members) views.push_back({photographs_[i].camera, loadPhotograph(photographs_[i])});
    return panoramaCell(views, points, {refine_});
  }

  Made makeCell(const std::vector<std::uint32_t>& members) const {
    const auto start = Clock::now();
    const std::vector<glm::dvec3> points = pointsOf(members);
    const std::uint64_t key = keyOf(members, points);
    const bool panoramic = isPanorama(photographs_[members[0]]);
    if (auto kept = fetchCell(keep(), key);
        kept && (panoramic || !options_.backdrops || fetchDepths(keep(), key).has_value()))
      return {std::move(*kept), secondsSince(start), true, key};
    Made made{panoramic ? panoramas(members, points) : pinholes(members, points, key), 0, false, key};
    storeCell(keep(), key, made.cell);
    made.seconds = secondsSince(start);
    return made;
  }

  std::string namesOf(const std::vector<std::uint32_t>& members) const {
    std::string text;
    for (const std::uint32_t i : members) text += (text.empty() ? "" : ", ") + photographs_[i].name;
    return text;
  }

  void makeCells() {
    double pixels = 0;
    for (const Photograph& photo : photographs_)
      pixels = std::max(pixels, double(photo.camera.intrinsics.width) * photo.camera.intrinsics.height);
    std::vector<Made> made(plan_.cells.size());
    runAll("matching cells", plan_.cells.size(), kBytesPerPixel * std::min(pixels, kMatchPixels),
           [&](std::size_t c) { made[c] = makeCell(plan_.cells[c]); });
    for (std::size_t c = 0; c < made.size(); ++c) {
      const std::vector<std::uint32_t>& members = plan_.cells[c];
      Cell cell{members, std::move(made[c].cell.mesh), made[c].cell.quality};
      if (!(cell.quality.coverage >= kLeastCoverage)) {
        report_.dropped.push_back(
            {namesOf(members), fmt::format("its members agree on {:.1f} % of their picture, less than {:.0f} %",
                                           100 * cell.quality.coverage, 100 * kLeastCoverage)});
        continue;
      }
      BuildReport::CellLine line;
      for (const std::uint32_t i : members) line.members.push_back(photographs_[i].name);
      line.points = cell.mesh.pointCount();
      line.triangles = cell.mesh.triangles.size();
      line.tier0 = cell.mesh.tier0Count();
      line.quality = cell.quality;
      line.seconds = made[c].seconds;
      line.resumed = made[c].resumed;
      report_.cells.push_back(std::move(line));
      scene_.cells.push_back(std::move(cell));
      keys_.push_back(made[c].key);
    }
  }

  std::vector<std::size_t> cellsWith(std::uint32_t photograph) const {
    std::vector<std::size_t> cells;
    for (std::size_t c = 0; c < scene_.cells.size(); ++c)
      if (std::ranges::count(scene_.cells[c].members, photograph) > 0) cells.push_back(c);
    return cells;
  }

  // How far a virtual camera is likely to be away from a photograph: the longest edge of its cells, or of all; median.
  double stepOf(const std::vector<std::size_t>& cells) const {
    std::vector<double> sizes;
    for (std::size_t c = 0; c < scene_.cells.size(); ++c) {
      if (!cells.empty() && std::ranges::count(cells, c) == 0) continue;
      double& size = sizes.emplace_back(0.0);
      for (const std::uint32_t i : scene_.cells[c].members)
        for (const std::uint32_t j : scene_.cells[c].members)
          size =
              std::max(size, glm::distance(scene_.nodes[i].camera.pose.position, scene_.nodes[j].camera.pose.position));
    }
    return sizes.empty() ? 0.0 : median(sizes);
  }

  // What the cells found in a photograph; in one that is in no cell, what its tracks say.
  ImageF knownDepth(std::uint32_t photograph, const std::vector<std::size_t>& cells, double step) const {
    Camera camera = photographs_[photograph].camera;
    const glm::ivec2 size = backdropSize(camera.intrinsics);
    camera.intrinsics = resized(camera.intrinsics, size.x, size.y);
    if (cells.empty()) return depthOfPoints(camera, pointsSeenBy(model_, photograph));
    std::vector<ImageF> maps;
    for (const std::size_t c : cells) {
      const std::vector<std::uint32_t>& members = scene_.cells[c].members;
      auto depths = fetchDepths(keep(), keys_[c]);
      check(depths.has_value(), ErrorCode::io, "{}: what was kept of a cell is gone; build again", keep().string());
      maps.push_back(std::move((*depths)[std::size_t(std::ranges::find(members, photograph) - members.begin())]));
    }
    ImageF depth = medianDepth(maps);
    dropIslands(depth, step * std::max(camera.intrinsics.fx, camera.intrinsics.fy));
    return depth;
  }

  std::uint64_t backdropKey(std::uint32_t photograph, const std::vector<std::size_t>& cells, double step) const {
    Hash hash;
    hash.add(kBackdropVersion);
    hash.add(options_.backdropSpacing);
    hash.add(step);
    addPhotograph(hash, photograph);
    for (const std::size_t c : cells) hash.add(keys_[c]);
    if (cells.empty()) addPoints(hash, pointsSeenBy(model_, photograph));
    return hash.value();
  }

  Made makeBackdrop(std::uint32_t photograph) const {
    const auto start = Clock::now();
    const std::vector<std::size_t> cells = cellsWith(photograph);
    const double step = stepOf(cells);
    const std::uint64_t key = backdropKey(photograph, cells, step);
    if (auto kept = fetchCell(keep(), key)) return {std::move(*kept), secondsSince(start), true, key};
    const Photograph& photo = photographs_[photograph];
    const ImageF depth = knownDepth(photograph, cells, step);
    const Image8 colours = shrunk(loadPhotograph(photo), depth.width, depth.height);
    Made made{buildBackdrop(photo.camera, depth, colours, {step, options_.backdropSpacing}), 0, false, key};
    storeCell(keep(), key, made.cell);
    made.seconds = secondsSince(start);
    return made;
  }

  void makeBackdrops() {
    std::vector<std::uint32_t> pinholes;
    for (std::uint32_t i = 0; i < photographs_.size(); ++i)
      if (!isPanorama(photographs_[i])) pinholes.push_back(i);
    std::vector<Made> made(pinholes.size());
    runAll("completing backdrops", made.size(), kBytesOfBackdrop,
           [&](std::size_t b) { made[b] = makeBackdrop(pinholes[b]); });
    for (std::size_t b = 0; b < made.size(); ++b) {
      const MorphMesh& mesh = made[b].cell.mesh;
      report_.backdrops.push_back({photographs_[pinholes[b]].name, mesh.pointCount(), mesh.triangles.size(),
                                   made[b].cell.quality.coverage, made[b].seconds, made[b].resumed});
      scene_.backdrops.push_back({{pinholes[b]}, std::move(made[b].cell.mesh), made[b].cell.quality});
    }
  }

  const BuildOptions& options_;
  const ProgressCallback& progress_;
  const LogCallback& log_;
  BuildReport report_;
  PosedModel model_;
  CellPlan plan_;
  std::vector<Photograph> photographs_;  // of model_.images
  std::vector<std::uint64_t> hashes_;    // of their files
  bool refine_ = false;
  Scene scene_;
  std::vector<std::uint64_t> keys_;  // of scene_.cells
};

}  // namespace

BuildReport build(const BuildOptions& options, const ProgressCallback& progress, const LogCallback& log) {
  return Builder(options, progress, log).run();
}

}  // namespace ibr
