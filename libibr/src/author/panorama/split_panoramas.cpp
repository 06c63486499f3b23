// SPDX-License-Identifier: Apache-2.0
// Splits a folder of panoramas into pinhole images with a COLMAP model ([T] §4.2).
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numbers>
#include <optional>

#include "author/photographs/photographs.h"
#include "base/check.h"
#include "base/file.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "ibr/author/panorama.h"
#include "ibr/author/poses.h"
#include "io/image_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kMaxPixels = std::int64_t(1) << 28;  // of a face
constexpr double kBytesPerPixel = 12;                       // of a face: RGB 3, JPEG's coefficients 6, its file

// Returns the processor time of this thread.
double cpuSeconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// Returns the length of the common folder of all names, including the last '/'.
std::size_t commonFolder(const std::vector<PosedImage>& images) {
  const std::string& first = images.front().name;
  std::size_t length = first.rfind('/') == first.npos ? 0 : first.rfind('/') + 1;
  for (const PosedImage& image : images)
    while (length > 0 && image.name.compare(0, length, first, 0, length) != 0) {
      const auto before = length < 2 ? first.npos : first.rfind('/', length - 2);
      length = before == first.npos ? 0 : before + 1;
    }
  return length;
}

class Splitter {
 public:
  Splitter(const SplitOptions& options, const ProgressCallback& progress, const LogCallback& log)
      : options_(options), progress_(progress), log_(log) {}

  SplitReport run() {
    const Stopwatch watch;
    checkOptions();
    readInput();
    std::map<fs::path, std::string> stems;  // of the images to be written, with their panorama's name
    for (const PosedImage& image : input_.images) {
      const auto [other, fresh] = stems.emplace(fs::path(image.name).replace_extension(), image.name);
      check(fresh, ErrorCode::invalidInput, "{} and {}: their images would have the same names", other->second,
            image.name);
    }
    for (std::size_t i = 0; i < input_.images.size(); ++i) splitOne(i);
    carryTracks();
    writeColmapModel(result_, options_.output / "sparse");
    report_.panoramas = input_.images.size();
    report_.pictures = result_.images.size();
    report_.seconds = watch.seconds();
    return std::move(report_);
  }

 private:
  void checkOptions() {
    const double fov = options_.fovDegrees;
    check(fov > 0 && fov < 180, ErrorCode::invalidInput, "the field of view is {} degrees, must be between 0 and 180",
          fov);
    check(options_.views >= 0, ErrorCode::invalidInput, "views is {}, must be 0 or more", options_.views);
    check(options_.size >= 0, ErrorCode::invalidInput, "size is {} px, must be 0 or more", options_.size);
    check(options_.threads >= 0, ErrorCode::invalidInput, "threads is {}, must be 0 or more", options_.threads);
    check(!options_.output.empty(), ErrorCode::invalidInput, "the output folder of the images is not set");
    faces_ = options_.views == 0 ? cubeFaces() : horizonFaces(options_.views);
    if (options_.views > 0 && options_.poles)
      for (const PanoramaFace& face : cubeFaces())
        if (face.name == "up" || face.name == "down") faces_.push_back(face);
  }

  void readInput() {
    if (options_.model.empty()) {
      check(!fs::is_directory(options_.input), ErrorCode::invalidInput,
            "{}: is a folder; to split all panoramas in it, give their poses with the option model",
            options_.input.string());
      const ImageFileInfo info = probeImage(options_.input);
      Camera camera;
      camera.intrinsics = {CameraModel::equirectangular, info.width, info.height};
      input_.images.push_back({options_.input.filename().string(), camera});
      folder_ = options_.input.parent_path().empty() ? "." : options_.input.parent_path();
      return;
    }
    check(fs::is_directory(options_.input), ErrorCode::io, "{}: is not a folder of panoramas", options_.input.string());
    input_ = readPoseFile(options_.model, options_.input, log_);
    folder_ = options_.input;
    std::vector<std::optional<std::uint32_t>> now(input_.images.size());
    std::vector<PosedImage> panoramas;
    for (std::size_t i = 0; i < input_.images.size(); ++i) {
      if (input_.images[i].camera.intrinsics.model == CameraModel::equirectangular) {
        now[i] = std::uint32_t(panoramas.size());
        panoramas.push_back(input_.images[i]);
      } else {
        report_.skipped.push_back(input_.images[i].name);
      }
    }
    input_.images = std::move(panoramas);
    check(!input_.images.empty(), ErrorCode::invalidInput, "{}: has no panorama", options_.model.string());
    for (Track& track : input_.tracks) {
      std::erase_if(track.observations, [&](const TrackObservation& o) { return !now[o.image]; });
      for (TrackObservation& o : track.observations) o.image = *now[o.image];
    }
  }

  void splitOne(std::size_t number) {
    const PosedImage& image = input_.images[number];
    progressed(number * faces_.size());
    const double start = cpuSeconds();
    const Photograph photo = findPhotograph(folder_, image, 0);
    const PanoramaSampler sampler(loadPhotograph(photo));
    report_.readSeconds += cpuSeconds() - start;

    const int width = photo.camera.intrinsics.width;
    if (width != 2 * photo.camera.intrinsics.height && log_)
      log_(LogLevel::warning, fmt::format("{}: {}x{} px; a full panorama is twice as wide as high",
                                          photo.source.string(), width, photo.camera.intrinsics.height));
    const double fov = options_.fovDegrees * std::numbers::pi / 180;
    const int size = options_.size > 0 ? options_.size : faceSize(width, fov);
    check(std::int64_t(size) * size <= kMaxPixels, ErrorCode::invalidInput,
          "{}: faces of {} px are too large; give a smaller size or field of view", photo.source.string(), size);
    report_.size = size;
    const Intrinsics intrinsics = faceIntrinsics(size, fov);
    const bool jpeg = options_.format == ImageFileFormat::jpeg ||
                      (options_.format == ImageFileFormat::asSource && isJpeg(photo.source));
    const fs::path name = fs::path(image.name.substr(commonFolder(input_.images))).replace_extension();
    for (const PanoramaFace& face : faces_)
      result_.images.push_back(
          {fmt::format("{}_{}.{}", name.generic_string(), face.name, jpeg ? "jpg" : "png"),
           {intrinsics, {image.camera.pose.position, image.camera.pose.rotation * face.rotation}}});

    std::vector<double> sampled(faces_.size(), 0), written(faces_.size(), 0);
    const auto job = [&](std::size_t f) {
      const double began = cpuSeconds();
      const Image8 picture = sampler.view(intrinsics, faces_[f].rotation);
      sampled[f] = cpuSeconds() - began;
      const fs::path file = pathInside(pictures(), result_.images[number * faces_.size() + f].name);
      makeFolders(file.parent_path());
      writeImage(file, picture, kJpegQuality);
      written[f] = cpuSeconds() - began - sampled[f];
    };
    makeFolders(pictures());
    const int threads = threadsFor(options_.threads, kBytesPerPixel * size * size);
    const auto report = [&](std::size_t done) { return reportProgress(number * faces_.size() + done); };
    check(runJobs(faces_.size(), threads, job, report), ErrorCode::cancelled, "the splitting was cancelled");
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      report_.sampleSeconds += sampled[f];
      report_.writeSeconds += written[f];
    }
  }

  // Maps a panorama's observations to the faces that contain their directions.
  void carryTracks() {
    for (const Track& track : input_.tracks) {
      Track carried{track.position, {}};
      for (const TrackObservation& o : track.observations) {
        const glm::dvec3 direction = unproject(input_.images[o.image].camera.intrinsics, o.pixel);
        for (std::size_t f = 0; f < faces_.size(); ++f) {
          const std::size_t picture = o.image * faces_.size() + f;
          const Intrinsics& k = result_.images[picture].camera.intrinsics;
          const auto at = project(k, glm::conjugate(faces_[f].rotation) * direction);
          if (at && at->x >= 0 && at->y >= 0 && at->x <= k.width && at->y <= k.height)
            carried.observations.push_back({std::uint32_t(picture), *at});
        }
      }
      report_.observations += carried.observations.size();
      if (!carried.observations.empty()) result_.tracks.push_back(std::move(carried));
    }
  }

  fs::path pictures() const { return options_.output / "images"; }
  bool reportProgress(std::size_t done) const {
    return !progress_ || progress_({"splitting panoramas", done, input_.images.size() * faces_.size()});
  }
  void progressed(std::size_t done) const {
    check(reportProgress(done), ErrorCode::cancelled, "the splitting was cancelled");
  }

  const SplitOptions& options_;
  const ProgressCallback& progress_;
  const LogCallback& log_;
  std::vector<PanoramaFace> faces_;
  fs::path folder_;    // root of the names of input_
  PosedModel input_;   // panoramas only
  PosedModel result_;  // faces of a panorama, consecutive
  SplitReport report_;
};

}  // namespace

SplitReport splitPanoramas(const SplitOptions& options, const ProgressCallback& progress, const LogCallback& log) {
  return Splitter(options, progress, log).run();
}

}  // namespace ibr
