// SPDX-License-Identifier: Apache-2.0
// From posed photographs to a scene folder ([T] §2.4.1): model → cells → matches and meshes, a cell at a time → scene.
//
// A finished cell is kept in OUTPUT/.build until the scene is written, under a hash of its members' files, cameras and
// points, so that a build that was stopped goes on, and one with other options takes over what is the same.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <thread>
#include <unordered_map>

#include "author/cell_cache.h"
#include "author/cells.h"
#include "author/hash.h"
#include "author/match.h"
#include "author/mesh.h"
#include "author/panorama_cell.h"
#include "author/parallel.h"
#include "author/photographs.h"
#include "base/check.h"
#include "ibr/author.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kVersion = 1;   // of the cells' making: raise it when they come out differently
constexpr double kMatchPixels = 2e6;    // photographs are matched at no more than this
constexpr double kBytesPerPixel = 400;  // that matching takes, of one member's pixels
constexpr double kExactPx = 0.1;        // median reprojection error up to which poses count as exact
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

void removeExcluded(PosedModel& model, const std::vector<std::string>& exclude) {
  const std::set<std::string> names(exclude.begin(), exclude.end());
  for (const std::string& name : names)
    check(std::any_of(model.images.begin(), model.images.end(), [&](const auto& i) { return i.name == name; }),
          ErrorCode::invalidInput, "\"{}\" is to be left out, but the model has no such image", name);
  constexpr std::uint32_t kGone = ~0u;
  std::vector<std::uint32_t> index;
  std::vector<PosedImage> kept;
  for (PosedImage& image : model.images) {
    const bool keep = !names.contains(image.name);
    index.push_back(keep ? std::uint32_t(kept.size()) : kGone);
    if (keep) kept.push_back(std::move(image));
  }
  model.images = std::move(kept);
  for (Track& track : model.tracks) {
    std::erase_if(track.observations, [&](const TrackObservation& o) { return index[o.image] == kGone; });
    for (TrackObservation& o : track.observations) o.image = index[o.image];
  }
  std::erase_if(model.tracks, [](const Track& track) { return track.observations.empty(); });
}

// Median distance between observations and projections of the tracks' points, px.
double reprojectionError(const PosedModel& model) {
  std::vector<double> errors;
  for (const Track& track : model.tracks)
    for (const TrackObservation& seen : track.observations) {
      const Camera& camera = model.images[seen.image].camera;
      const auto pixel =
          project(camera.intrinsics, glm::inverse(camera.pose.rotation) * (track.position - camera.pose.position));
      if (pixel) errors.push_back(glm::distance(*pixel, seen.pixel));
    }
  if (errors.empty()) return 0;
  const auto middle = errors.begin() + std::ptrdiff_t(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

MatchView viewOf(const Photograph& photo) {
  MatchView view{photo.camera, loadPhotograph(photo)};
  const double pixels = double(view.picture.width) * view.picture.height;
  if (pixels <= kMatchPixels) return view;
  const double scale = std::sqrt(kMatchPixels / pixels);
  const int width = std::max(1, int(view.picture.width * scale)),
            height = std::max(1, int(view.picture.height * scale));
  Image8 small(width, height, 3);
  const cv::Mat from(view.picture.height, view.picture.width, CV_8UC3, view.picture.values.data());
  cv::Mat to(height, width, CV_8UC3, small.values.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  view.camera.intrinsics = resized(photo.camera.intrinsics, width, height);
  view.picture = std::move(small);
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
    check(!options_.output.empty(), ErrorCode::invalidInput, "no folder is named for the scene");
    check(fs::is_directory(options_.photographs), ErrorCode::io, "{}: is not a folder", options_.photographs.string());
    step("reading the model", 0, 1);
    model_ = options_.panoramas.empty() ? readColmapModel(options_.model, log_) : readPanoramas(options_.panoramas);
    std::set<std::string> known;
    for (const PosedImage& image : model_.images) known.insert(image.name);
    for (const std::string& name : listPictures(options_.photographs))
      if (!known.contains(name)) report_.dropped.push_back({name, "not registered: the model has no pose for it"});
    removeExcluded(model_, options_.exclude);
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
        R"({{"dimension":{},"maxSize":{},"texture":"{}","thetaDegrees":{},"seed":{},"refine":{}}})", options_.dimension,
        options_.maxSize, textureFormatName(options_.texture), options_.thetaDegrees, options_.seed, refine_);
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

  std::uint64_t keyOf(const std::vector<std::uint32_t>& members, const std::vector<glm::dvec3>& points) const {
    Hash hash;
    hash.add(kVersion);
    hash.add(options_.seed);
    hash.add(refine_);
    for (const std::uint32_t i : members) {
      hash.add(hashes_[i]);
      const Intrinsics& k = photographs_[i].camera.intrinsics;
      const Pose& pose = photographs_[i].camera.pose;
      hash.add(photographs_[i].applyOrientation);
      for (const double v :
           {double(k.width), double(k.height), k.fx, k.fy, k.cx, k.cy, pose.position.x, pose.position.y,
            pose.position.z, pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z})
        hash.add(v);
    }
    for (const glm::dvec3& p : points)
      for (int c = 0; c < 3; ++c) hash.add(p[c]);
    return hash.value();
  }

  struct Made {
    CellMesh cell;
    double seconds = 0;
    bool resumed = false;
  };

  CellMesh pinholes(const std::vector<std::uint32_t>& members, const std::vector<glm::dvec3>& points) const {
    std::vector<MatchView> views;
    std::vector<Camera> stored;
    for (const std::uint32_t i : members) {
      views.push_back(viewOf(photographs_[i]));
      stored.push_back(photographs_[i].camera);
    }
    return buildMesh(stored, views, matchViews(views, points, {refine_}));
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
    if (auto kept = fetchCell(keep(), key)) return {std::move(*kept), secondsSince(start), true};
    Made made{isPanorama(photographs_[members[0]]) ? panoramas(members, points) : pinholes(members, points), 0, false};
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
};

}  // namespace

BuildReport build(const BuildOptions& options, const ProgressCallback& progress, const LogCallback& log) {
  return Builder(options, progress, log).run();
}

}  // namespace ibr
