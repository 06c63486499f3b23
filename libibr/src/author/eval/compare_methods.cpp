// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <ctime>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <opencv2/core.hpp>
#include <optional>

#include "author/geometry/posed_model.h"
#include "author/jobs/build_jobs.h"
#include "author/match/matcher_choice.h"
#include "author/match/plane_labels.h"
#include "author/mesh/mesh.h"
#include "base/bilinear.h"
#include "base/check.h"
#include "base/file.h"
#include "base/raster.h"
#include "ibr/author/photographs.h"
#include "ibr/lab/accuracy.h"
#include "ibr/lab/matchers.h"
#include "io/image_file.h"

namespace fs = std::filesystem;

namespace ibr {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double cpuSeconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

struct Subject {
  std::vector<MatchView> views;
  std::vector<Camera> cameras;
  std::vector<glm::dvec3> points;
  bool posed = false;
  double reprojectionPx = 0;
  std::vector<ExactDepthView> depth;
};

Image8 readSmall(const fs::path& file, int maxSize) {
  Image8 picture = readImage(file);
  Image8 rgb(picture.width, picture.height, 3);
  for (std::size_t p = 0; p < rgb.values.size() / 3; ++p)
    for (std::size_t c = 0; c < 3; ++c)
      rgb.values[3 * p + c] = picture.values[std::size_t(picture.channels) * p + (picture.channels >= 3 ? c : 0)];
  const int longest = std::max(rgb.width, rgb.height);
  if (maxSize == 0 || longest <= maxSize) return rgb;
  return downscaled(rgb, std::max(1, rgb.width * maxSize / longest), std::max(1, rgb.height * maxSize / longest));
}

std::vector<ExactDepthView> depthViews(const MatchCase& which) {
  std::vector<ExactDepthView> views;
  for (const PosedImage& image : readColmapModel(which.depth / "sparse").images) {
    const fs::path file = which.depth / "depth" / fs::path(image.name).replace_extension(".png");
    const Image<std::uint16_t> steps = readGrey16(file);
    ImageF depth(steps.width, steps.height, 1);
    std::ranges::transform(steps.values, depth.values.begin(),
                           [&](std::uint16_t s) { return float(which.depthUnit * double(s)); });
    views.push_back({image.camera, std::move(depth)});
  }
  return views;
}

Subject subjectOf(const MatchCase& which) {
  Subject subject;
  for (const fs::path& file : which.images) subject.views.push_back({{}, readSmall(file, which.maxSize)});
  if (which.model.empty()) {
    for (MatchView& view : subject.views) {
      Intrinsics& k = view.camera.intrinsics;
      k.width = view.picture.width;
      k.height = view.picture.height;
      k.fx = k.fy = std::max(k.width, k.height);
      k.cx = 0.5 * k.width;
      k.cy = 0.5 * k.height;
    }
  } else {
    const PosedModel model = readColmapModel(which.model);
    std::vector<std::uint32_t> members;
    for (std::size_t i = 0; i < which.images.size(); ++i) {
      const auto image = std::ranges::find_if(model.images, [&](const PosedImage& posed) {
        return fs::path(posed.name).filename() == which.images[i].filename();
      });
      check(image != model.images.end(), ErrorCode::invalidInput, "{}: has no image {}", which.model.string(),
            which.images[i].filename().string());
      members.push_back(std::uint32_t(image - model.images.begin()));
      MatchView& view = subject.views[i];
      view.camera = image->camera;
      view.camera.intrinsics = resized(image->camera.intrinsics, view.picture.width, view.picture.height);
    }
    std::vector<std::uint32_t> tracks;
    for (std::uint32_t t = 0; t < model.tracks.size(); ++t) {
      const auto seen = std::ranges::count_if(model.tracks[t].observations, [&](const TrackObservation& o) {
        return std::ranges::find(members, o.image) != members.end();
      });
      if (seen < 2) continue;
      tracks.push_back(t);
      subject.points.push_back(model.tracks[t].position);
    }
    for (const MatchView& view : subject.views) subject.cameras.push_back(view.camera);
    subject.reprojectionPx = cellReprojectionError(model, members, subject.cameras, tracks);
    subject.posed = !tracks.empty();
    if (!which.depth.empty()) subject.depth = depthViews(which);
    return subject;
  }
  for (const MatchView& view : subject.views) subject.cameras.push_back(view.camera);
  return subject;
}

// Ground truth: position in the second matched image of a pixel of the first.
class PairTruth {
 public:
  PairTruth(const MatchCase& which, const Subject& subject) {
    const Image8 &first = subject.views[0].picture, &second = subject.views[1].picture;
    if (!which.disparity.empty()) {
      disparity_ = readImage(which.disparity);
      scale_ = {double(disparity_->width) / first.width, double(disparity_->height) / first.height};
    }
    if (!which.homography.empty()) {
      const cv::FileStorage storage(which.homography.string(), cv::FileStorage::READ | cv::FileStorage::FORMAT_XML);
      cv::Mat h;
      if (storage.isOpened()) storage.getFirstTopLevelNode() >> h;
      check(h.rows == 3 && h.cols == 3 && h.type() == CV_64F, ErrorCode::invalidInput, "{}: holds no 3×3 matrix",
            which.homography.string());
      homography_ = cv::Matx33d(h);
      const Image8 whole = readImage(which.images[0]);
      scale_ = {double(whole.width) / first.width, double(whole.height) / first.height};
      const Image8 other = readImage(which.images[1]);
      scaleSecond_ = {double(other.width) / second.width, double(other.height) / second.height};
    }
  }

  std::optional<glm::dvec2> operator()(glm::dvec2 pixel) const {
    const glm::dvec2 at = pixel * scale_;
    if (homography_) {  // in pixel coordinates with the first centre at 0
      const cv::Vec3d q = *homography_ * cv::Vec3d(at.x - 0.5, at.y - 0.5, 1);
      return glm::dvec2(q[0] / q[2] + 0.5, q[1] / q[2] + 0.5) / scaleSecond_;
    }
    if (!disparity_ || at.x < 0 || at.y < 0 || at.x >= disparity_->width || at.y >= disparity_->height)
      return std::nullopt;
    const double d = disparity_->pixel(int(at.x), int(at.y))[0];
    if (d == 0) return std::nullopt;
    return (at - glm::dvec2(d, 0)) / scale_;
  }

 private:
  std::optional<Image8> disparity_;
  std::optional<cv::Matx33d> homography_;
  glm::dvec2 scale_{1.0}, scaleSecond_{1.0};
};

std::vector<double> pairErrors(const PairTruth& truth, const MorphMesh& mesh) {
  std::vector<bool> used(mesh.vertexCount(), false);
  for (std::size_t t = 0, count = mesh.tier0Count(); t < count; ++t)
    for (int k = 0; k < 3; ++k) used[mesh.triangles[t][k]] = true;
  std::vector<double> errors;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (const auto at = used[v] ? truth(mesh.match[0][v]) : std::nullopt)
      errors.push_back(glm::distance(*at, glm::dvec2(mesh.match[1][v])));
  return errors;
}

// Colours of all members, warped by the triangles of tier 0 to the first member's pixels, where covered.
struct Warped {
  std::vector<std::vector<glm::vec3>> colour;  // of each member, for the pixels below in turn
  std::vector<glm::ivec2> pixel;
};
Warped warpedToFirst(const Subject& subject, const MorphMesh& mesh) {
  const std::size_t d = subject.views.size();
  const Image8& first = subject.views[0].picture;
  Warped result{std::vector<std::vector<glm::vec3>>(d), {}};
  std::vector<bool> done(first.values.size() / 3, false);
  for (std::size_t t = 0, count = mesh.tier0Count(); t < count; ++t) {
    const glm::uvec3& v = mesh.triangles[t];
    const std::vector<glm::vec2>& at = mesh.match[0];
    forTrianglePixels(at[v.x], at[v.y], at[v.z], first.width, first.height, [&](int x, int y, const glm::dvec3& w) {
      const std::size_t pixel = std::size_t(y) * std::size_t(first.width) + std::size_t(x);
      if (done[pixel]) return;
      done[pixel] = true;
      result.pixel.emplace_back(x, y);
      for (std::size_t i = 0; i < d; ++i) {
        const std::vector<glm::vec2>& m = mesh.match[i];
        result.colour[i].emplace_back(bilinear(
            subject.views[i].picture, w.x * glm::dvec2(m[v.x]) + w.y * glm::dvec2(m[v.y]) + w.z * glm::dvec2(m[v.z])));
      }
    });
  }
  return result;
}

// PSNR after the gain and offset per channel that fit b to a best.
double compensatedPsnr(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  if (a.empty()) return kNan;
  double square = 0;
  for (int c = 0; c < 3; ++c) {
    double sa = 0, sb = 0, sbb = 0, sab = 0, saa = 0;
    const double n = double(a.size());
    for (std::size_t p = 0; p < a.size(); ++p) {
      const double u = double(a[p][c]), v = double(b[p][c]);
      sa += u, sb += v, saa += u * u, sbb += v * v, sab += u * v;
    }
    const double covariance = sab / n - sa / n * (sb / n), own = sbb / n - sb / n * (sb / n);
    const double gain = own > 1e-9 ? covariance / own : 0;
    square += std::max(saa / n - sa / n * (sa / n) - gain * covariance, 0.0) / 3;
  }
  return 10 * std::log10(255 * 255 / std::max(square, 1e-9));
}

double shareWithin(const std::vector<double>& errors, double limit) {
  return errors.empty()
             ? kNan
             : double(std::ranges::count_if(errors, [&](double e) { return e <= limit; })) / double(errors.size());
}

MatchScore scoreOf(const MatchCase& which, const Subject& subject, const PairTruth& truth, const CellMesh& cell) {
  MatchScore score;
  score.name = which.name;
  const MorphMesh& mesh = cell.mesh;
  std::vector<bool> used(mesh.vertexCount(), false);
  for (std::size_t t = 0, count = mesh.tier0Count(); t < count; ++t)
    for (int k = 0; k < 3; ++k) used[mesh.triangles[t][k]] = true;
  score.vertices = std::size_t(std::ranges::count(used, true));
  score.completeness = score.precision = kNan;
  std::vector<double> errors;
  if (!subject.depth.empty()) {
    Scene scene;
    for (std::size_t i = 0; i < subject.views.size(); ++i)
      scene.nodes.push_back({std::to_string(i), subject.cameras[i], {}, {}});
    std::vector<std::uint32_t> members(subject.views.size());
    std::iota(members.begin(), members.end(), 0u);
    scene.cells.push_back({members, mesh, cell.quality});
    const MatchAccuracy accuracy = matchAccuracy(scene, subject.depth, 1)[0];
    errors = accuracy.vertexErrorsPx;
    score.completeness = accuracy.coVisibleTier0 / accuracy.coVisible;
    score.precision = accuracy.correctTier0 / accuracy.tier0;
  } else if (subject.views.size() == 2) {
    errors = pairErrors(truth, mesh);
  }
  score.within1Px = shareWithin(errors, 1);
  score.beyond3Px = errors.empty() ? kNan : 1 - shareWithin(errors, 3);
  score.medianPx = errors.empty() ? kNan : median(errors);

  const Warped warped = warpedToFirst(subject, mesh);
  const Image8& first = subject.views[0].picture;
  score.coverage = double(warped.pixel.size()) / (double(first.width) * first.height);
  double sum = 0, pairs = 0;
  for (std::size_t i = 0; i < subject.views.size(); ++i)
    for (std::size_t j = i + 1; j < subject.views.size(); ++j, ++pairs)
      sum += compensatedPsnr(warped.colour[i], warped.colour[j]);
  score.memberPsnr = sum / pairs;
  score.ecc = cell.quality.ecc;
  score.homogeneous = homogeneousShare(mesh);
  score.picture = Image8(first.width, first.height, 3);
  for (std::size_t p = 0; p < warped.pixel.size(); ++p) {
    glm::vec3 mean(0.0f);
    for (const auto& member : warped.colour) mean += member[p] / float(warped.colour.size());
    for (int c = 0; c < 3; ++c)
      score.picture.pixel(warped.pixel[p].x, warped.pixel[p].y)[std::size_t(c)] = std::uint8_t(mean[c] + 0.5f);
  }
  return score;
}

}  // namespace

std::vector<MatchScore> compareMatchMethods(const MatchCase& which, std::uint64_t seed) {
  const SingleThreadedOpenCv quiet;
  const Subject subject = subjectOf(which);
  const PairTruth truth(which, subject);
  std::vector<MatchScore> scores;
  for (const MatchMethod method : {MatchMethod::sweep, MatchMethod::flow, MatchMethod::homographic}) {
    if (method == MatchMethod::sweep && !subject.posed) continue;
    const double start = cpuSeconds();
    const CellMatchOptions options{method, subject.posed && subject.reprojectionPx <= kMaxSweepErrorPx,
                                   subject.reprojectionPx > kExactPx, seed};
    const DenseMatch match = matchCell(subject.views, subject.points, options);
    const double matched = cpuSeconds() - start;
    for (const TriangleFilter filter : {TriangleFilter::consistency, TriangleFilter::homogeneous}) {
      if (filter == TriangleFilter::homogeneous && !match.vertices) continue;
      const double meshing = cpuSeconds();
      const CellMesh cell = buildMesh(subject.cameras, subject.views, match, filter);
      const double seconds = matched + cpuSeconds() - meshing;
      MatchScore& score = scores.emplace_back(scoreOf(which, subject, truth, cell));
      score.method = method;
      score.filter = filter;
      score.cpuSeconds = seconds;
    }
  }
  return scores;
}

}  // namespace ibr
