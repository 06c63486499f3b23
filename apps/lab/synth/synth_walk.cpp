// SPDX-License-Identifier: Apache-2.0
#include "lab/synth/synth_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <span>

#include "base/check.h"
#include "base/child_process.h"
#include "base/file.h"
#include "base/median.h"
#include "base/parallel.h"
#include "base/random.h"
#include "batch/files/colmap_views.h"
#include "io/image_file.h"
#include "lab/generate/hand_held_walk.h"
#include "lab/generate/surface_renderer.h"
#include "lab/generate/walk_hall.h"
#include "shared/cli/progress.h"

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace ibr::app {
namespace {

constexpr double kFovY = 0.7;               // rad: 66° across for 16:9
constexpr double kSharpDistance = 2;        // m, at which a texel is a pixel
constexpr double kMaxDensity = 400;         // texels per metre: limits memory
constexpr std::size_t kLeastSubFrames = 8;  // against aliasing, also where nothing moves
constexpr double kSubFramesPerPixel = 1;    // of smear
constexpr std::size_t kTruthSamples = 32;
constexpr int kSmearStep = 8;     // px between the points whose smear is measured
constexpr int kSmearChords = 12;  // of an exposure, along which a point's motion is measured

// Frames that may see a truth view's points are compared every kSeenStep seconds. At least kSeenBy of them have to see
// a point.
constexpr double kSeenStep = 0.4;
constexpr int kSeenBy = 2;
constexpr int kSeenPixels = 16;         // px of the photographs for a pixel of this comparison
constexpr double kSeenTolerance = 0.1;  // of the distance
constexpr double kMinSeen = 0.98;       // share of a truth view's points
constexpr int kTruthTrials = 60;

Camera cameraOf(const Intrinsics& intrinsics, const Pose& pose) {
  return {intrinsics, pose};
}

Intrinsics reduced(const Intrinsics& k, int step) {
  return resized(k, std::max(8, k.width / step), std::max(8, k.height / step));
}

// Calls visit(point) for the surface point at each pixel of a camera.
template <class Visit>
void visitPoints(const SurfaceRenderer& renderer, const Camera& camera, Visit&& visit) {
  const ImageF inverse = renderer.inverseDepth(camera);
  for (int y = 0; y < inverse.height; ++y)
    for (int x = 0; x < inverse.width; ++x) {
      const double w = inverse.pixel(x, y)[0];
      if (w <= 0) continue;
      const glm::dvec3 ray = unproject(camera.intrinsics, {x + 0.5, y + 0.5});
      visit(camera.pose.position + camera.pose.rotation * (ray / (-ray.z * w)));
    }
}

std::optional<glm::dvec2> pixelOf(const Camera& camera, glm::dvec3 point) {
  return project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (point - camera.pose.position));
}

// Median over the image of the length of a point's way during the exposure, px.
double smearOf(const SurfaceRenderer& renderer, const HandHeldWalk& walk, const Intrinsics& intrinsics, double time,
               double shutter) {
  std::vector<Camera> cameras;
  for (int i = 0; i <= kSmearChords; ++i)
    cameras.push_back(cameraOf(intrinsics, walk.poseAt(time + shutter * (double(i) / kSmearChords - 0.5))));
  std::vector<double> lengths;
  visitPoints(renderer, cameraOf(reduced(intrinsics, kSmearStep), walk.poseAt(time)), [&](glm::dvec3 point) {
    double length = 0;
    auto before = pixelOf(cameras[0], point);
    for (std::size_t i = 1; i < cameras.size(); ++i) {
      const auto after = pixelOf(cameras[i], point);
      if (!before || !after) return;
      length += glm::length(*after - *before);
      before = after;
    }
    lengths.push_back(length);
  });
  return lengths.empty() ? 0 : median(lengths);
}

struct Frame {
  Image8 image;
  double smear = 0;           // px
  std::size_t subFrames = 0;  // the frame is the mean of them, in linear light
};

Frame renderFrame(const SurfaceRenderer& renderer, const HandHeldWalk& walk, const Intrinsics& intrinsics, double time,
                  double shutter) {
  Frame frame;
  frame.smear = smearOf(renderer, walk, intrinsics, time, shutter);
  frame.subFrames = std::max(kLeastSubFrames, std::size_t(std::ceil(kSubFramesPerPixel * frame.smear)));
  ImageF sum(intrinsics.width, intrinsics.height, 3);
  for (std::size_t i = 0; i < frame.subFrames; ++i) {
    const double at = time + shutter * ((double(i) + 0.5) / double(frame.subFrames) - 0.5);
    renderer.addSamples(cameraOf(intrinsics, walk.poseAt(at)), sampleOffset(i), sum);
  }
  frame.image = encodedMean(sum, frame.subFrames);
  return frame;
}

// What the sharp frames of the walk see.
class SeenByWalk {
 public:
  SeenByWalk(const SurfaceRenderer& renderer, const HandHeldWalk& walk, const Intrinsics& intrinsics)
      : renderer_(renderer), intrinsics_(reduced(intrinsics, kSeenPixels)) {
    double last = -kSeenStep;
    for (std::size_t i = 0; i < walk.frameTimes().size(); ++i) {
      const double time = walk.frameTimes()[i];
      if (walk.jolted()[i] || time < last + kSeenStep) continue;
      last = time;
      cameras_.push_back(cameraOf(intrinsics_, walk.poseAt(time)));
      inverseDepths_.push_back(renderer.inverseDepth(cameras_.back()));
    }
  }
  // Share of the points of a view.
  double share(const Pose& pose) const {
    std::size_t points = 0, seen = 0;
    visitPoints(renderer_, cameraOf(intrinsics_, pose), [&](glm::dvec3 point) {
      int by = 0;
      for (std::size_t c = 0; c < cameras_.size() && by < kSeenBy; ++c) by += sees(c, point);
      ++points;
      seen += by == kSeenBy;
    });
    return points == 0 ? 0 : double(seen) / double(points);
  }

 private:
  bool sees(std::size_t c, glm::dvec3 point) const {
    const auto pixel = pixelOf(cameras_[c], point);
    if (!pixel || !(pixel->x >= 0 && pixel->y >= 0 && pixel->x < intrinsics_.width && pixel->y < intrinsics_.height))
      return false;
    const double along = glm::dot(point - cameras_[c].pose.position, viewAxis(cameras_[c].pose));
    const double inverse = inverseDepths_[c].pixel(int(pixel->x), int(pixel->y))[0];
    return std::abs(inverse * along - 1) < kSeenTolerance;
  }

  const SurfaceRenderer& renderer_;
  Intrinsics intrinsics_;
  std::vector<Camera> cameras_;
  std::vector<ImageF> inverseDepths_;
};

struct TruthView {
  View view;
  double seen;  // share of its points that the walk's sharp frames see
};

// A view beside the way, between two frames: 10 to 35 cm off, turned by up to 0.12 radians. Of several trials, the
// first one is taken that the walk has seen, or else the most seen one.
TruthView truthView(int index, int count, const WalkHall& hall, const HandHeldWalk& walk, const SeenByWalk& seen,
                    const Intrinsics& intrinsics, std::uint64_t seed) {
  Random random(seed * 1000 + 77 + std::uint64_t(index));
  const std::vector<double>& times = walk.frameTimes();
  TruthView best{{fmt::format("truth{:02}.png", index), {intrinsics, {}}, 0}, -1};
  for (int trial = 0; trial < kTruthTrials && best.seen < kMinSeen; ++trial) {
    const double share = 0.02 + 0.94 * (index + 0.15 + random.uniform(0, 0.7)) / count;  // little is seen at the ends
    const double at = share * double(times.size() - 1);
    const auto before = std::min(std::size_t(at), times.size() - 2);
    const double time = 0.5 * (times[before] + times[before + 1]);
    Pose pose = walk.steadyPoseAt(time);
    const double around = random.uniform(0, 2 * std::numbers::pi), away = random.uniform(0.1, 0.33);
    pose.position += glm::dvec3(away * std::cos(around), random.uniform(-0.12, 0.12), away * std::sin(around));
    pose.rotation = glm::normalize(glm::angleAxis(random.uniform(-0.12, 0.12), glm::dvec3(0, 1, 0)) * pose.rotation *
                                   glm::angleAxis(random.uniform(-0.08, 0.08), glm::dvec3(1, 0, 0)));
    if (!hall.hasRoom(pose.position)) continue;
    if (const double now = seen.share(pose); now > best.seen) {
      best.seen = now;
      best.view.camera.pose = pose;
      best.view.time = time;
    }
  }
  check(best.seen >= 0, ErrorCode::invalidInput, "no truth view fits beside part {} of the walk", index);
  return best;
}

Json transformsOf(const Intrinsics& k, const std::vector<View>& views) {
  Json frames = Json::array();
  for (const View& view : views) {
    const glm::dmat3 axes = glm::mat3_cast(view.camera.pose.rotation);
    const glm::dvec3 at = view.camera.pose.position;
    Json rows = Json::array();
    for (int row = 0; row < 3; ++row) rows.push_back({axes[0][row], axes[1][row], axes[2][row], at[row]});
    rows.push_back({0, 0, 0, 1});
    frames.push_back({{"file_path", view.name}, {"transform_matrix", std::move(rows)}});
  }
  return {{"camera_model", "PINHOLE"},
          {"w", k.width},
          {"h", k.height},
          {"fl_x", k.fx},
          {"fl_y", k.fy},
          {"cx", k.cx},
          {"cy", k.cy},
          {"frames", std::move(frames)}};
}

// A file under another name until it is complete; removed if it never is.
class PartialFile {
 public:
  explicit PartialFile(fs::path path) : path_(std::move(path)), partial_(path_) { partial_ += ".part"; }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile() {
    std::error_code ignored;
    fs::remove(partial_, ignored);
  }
  const fs::path& partial() const { return partial_; }
  void complete() {
    std::error_code error;
    fs::rename(partial_, path_, error);
    check(!error, ErrorCode::io, "{}: cannot be written: {}", path_.string(), error.message());
  }

 private:
  fs::path path_, partial_;
};

std::vector<std::string> encoder(const WalkVideoOptions& options, PictureSize size, const fs::path& file) {
  std::string filter = "scale=out_color_matrix=bt709:out_range=tv";
  // Raw frames have no times: the times of HandHeldWalk are written here again, as ticks.
  if (options.variableRate)
    filter += fmt::format(",settb=1/90000,setpts='({})/({}*TB)'", HandHeldWalk::variableTime("N"), options.fps);
  std::vector<std::string> arguments{"ffmpeg",
                                     "-nostdin",
                                     "-v",
                                     "error",
                                     "-y",
                                     "-f",
                                     "rawvideo",
                                     "-pix_fmt",
                                     "rgb24",
                                     "-video_size",
                                     fmt::format("{}x{}", size.width, size.height),
                                     "-framerate",
                                     fmt::format("{}", options.fps),
                                     "-i",
                                     "pipe:0",
                                     "-vf",
                                     filter};
  if (options.variableRate)
    arguments.insert(arguments.end(),
                     {"-fps_mode", "passthrough", "-enc_time_base", "1:90000", "-video_track_timescale", "90000"});
  arguments.insert(
      arguments.end(),
      {"-c:v",         "libx264",     "-preset",   "veryfast",         "-crf",  "12",         "-pix_fmt",
       "yuv420p",      "-colorspace", "bt709",     "-color_primaries", "bt709", "-color_trc", "bt709",
       "-color_range", "tv",          "-movflags", "+faststart",       "-f",    "mp4",        file.string()});
  return arguments;
}

class WalkWriter {
 public:
  WalkWriter(const WalkVideoOptions& options, const Context& context)
      : options_(options),
        context_(context),
        size_(options.size.width == 0 ? PictureSize{640, 360} : options.size),
        folder_(options.output),
        intrinsics_(pinholeFromFov(size_.width, size_.height, kFovY)),
        threads_(threadsFor(context.options().threads, 30.0 * size_.width * size_.height)),
        hall_(makeWalkHall(context.options().seed)),
        walk_({options.seconds, options.fps, options.shutter, options.variableRate,
               2 * std::atan(0.5 * size_.width / intrinsics_.fx), context.options().seed}),
        progress_(context),
        renderer_(hall_.surfaces, std::min(kMaxDensity, intrinsics_.fx / kSharpDistance), threads_,
                  [this](std::size_t done) {
                    return progress_.show({"generating textures", done, hall_.surfaces.size()});
                  }) {}

  void writeVideo() {
    makeFolders(folder_);
    PartialFile file(folder_ / "walk.mp4");
    ChildWriter ffmpeg(encoder(options_, size_, file.partial()));
    const std::size_t count = walk_.frameTimes().size(), batch = std::size_t(threads_) * 8;
    for (std::size_t first = 0; first < count; first += batch) {
      std::vector<Frame> frames(std::min(batch, count - first));
      const auto shown = [&](std::size_t done) { return progress_.show({"rendering the video", first + done, count}); };
      const bool whole = runJobs(
          frames.size(), threads_,
          [&](std::size_t i) {
            frames[i] = renderFrame(renderer_, walk_, intrinsics_, walk_.frameTimes()[first + i], options_.shutter);
          },
          shown);
      check(whole, ErrorCode::cancelled, "stopped");
      for (Frame& frame : frames) {
        check(ffmpeg.write(std::as_bytes(std::span(frame.image.values)), [&] { return shown(frames.size()); }),
              ErrorCode::cancelled, "stopped");
        smears_.push_back(frame.smear);
        subFrames_.push_back(frame.subFrames);
      }
    }
    check(ffmpeg.finish([&] {
      return progress_.show({"encoding the video", count, count});
    }),
          ErrorCode::cancelled, "stopped");
    file.complete();
  }

  void writeTruth() {
    const fs::path truth = folder_ / "truth";
    makeFolders(truth / "images");
    const SeenByWalk seen(renderer_, walk_, intrinsics_);
    const auto count = std::size_t(options_.views);
    views_.resize(count);
    const auto take = [&](std::size_t i) {
      views_[i] = truthView(int(i), options_.views, hall_, walk_, seen, intrinsics_, context_.options().seed);
      ImageF sum(intrinsics_.width, intrinsics_.height, 3);
      for (std::size_t s = 0; s < kTruthSamples; ++s) renderer_.addSamples(views_[i].view.camera, sampleOffset(s), sum);
      writeImage(truth / "images" / views_[i].view.name, encodedMean(sum, kTruthSamples));
    };
    check(runJobs(count, threads_, take,
                  [&](std::size_t done) {
                    return progress_.show({"rendering the truth", done, count});
                  }),
          ErrorCode::cancelled, "stopped");
    std::vector<View> views;
    for (const TruthView& view : views_) views.push_back(view.view);
    writeColmapViews(truth / "sparse", views);
    for (View& view : views) view.name = "images/" + view.name;
    writeFile(truth / "transforms.json", transformsOf(intrinsics_, views).dump(1));
  }

  void writeFacts() {
    std::vector<View> views;
    for (std::size_t i = 0; i < walk_.frameTimes().size(); ++i) {
      const double time = walk_.frameTimes()[i];
      views.push_back({fmt::format("walk_{:06}.jpg", i), cameraOf(intrinsics_, walk_.poseAt(time)), time});
    }
    writeFile(folder_ / "transforms.json", transformsOf(intrinsics_, views).dump(1));
    Json parts = Json::array(), truth = Json::array(), blurred = Json::array(), speeds = Json::array();
    for (const HandHeldWalk::Part& part : walk_.parts())
      parts.push_back({{"name", part.name}, {"firstFrame", part.firstFrame}, {"speed", part.speed}});
    for (const TruthView& view : views_)
      truth.push_back({{"name", view.view.name}, {"time", view.view.time}, {"seen", view.seen}});
    for (std::size_t i = 0; i < walk_.jolted().size(); ++i)
      if (walk_.jolted()[i]) blurred.push_back(i);
    for (const double time : walk_.frameTimes()) speeds.push_back(walk_.speedAt(time));
    const Json facts{{"video", "walk.mp4"},
                     {"frames", walk_.frameTimes().size()},
                     {"fps", options_.fps},
                     {"variableRate", options_.variableRate},
                     {"shutter", options_.shutter},
                     {"size", {size_.width, size_.height}},
                     {"seed", context_.options().seed},
                     {"parts", std::move(parts)},
                     {"truth", std::move(truth)},
                     {"blurred", std::move(blurred)},
                     {"times", walk_.frameTimes()},
                     {"smears", smears_},
                     {"speeds", std::move(speeds)},
                     {"subFrames", subFrames_}};
    writeFile(folder_ / "walk.json", facts.dump(1));
  }

  // Medians of the smears of frames with and without jolts, px.
  std::array<double, 2> medianSmears() const {
    std::array<std::vector<double>, 2> smears;
    for (std::size_t i = 0; i < smears_.size(); ++i) smears[walk_.jolted()[i]].push_back(smears_[i]);
    return {smears[0].empty() ? 0 : median(smears[0]), smears[1].empty() ? 0 : median(smears[1])};
  }
  std::size_t frames() const { return smears_.size(); }
  std::size_t blurred() const { return std::size_t(std::ranges::count(walk_.jolted(), true)); }
  double leastSeen() const {
    double least = 1;
    for (const TruthView& view : views_) least = std::min(least, view.seen);
    return least;
  }

 private:
  WalkVideoOptions options_;
  const Context& context_;
  PictureSize size_;
  fs::path folder_;
  Intrinsics intrinsics_;
  int threads_;
  WalkHall hall_;
  HandHeldWalk walk_;
  ProgressLine progress_;
  SurfaceRenderer renderer_;
  std::vector<double> smears_;  // by frame, px
  std::vector<std::size_t> subFrames_;
  std::vector<TruthView> views_;
};

}  // namespace

void checkWalkVideoOptions(const WalkVideoOptions& options) {
  if (options.size.width % 2 != 0 || options.size.height % 2 != 0)
    refuseOption("--size", "a video needs an even width and height");
  if (options.seconds * options.fps < 30) refuseOption("--seconds", "a walk needs at least 30 frames");
  if (options.shutter * options.fps > kMaxShutterShare)
    refuseOption("--shutter", fmt::format("is more than {} of the time between frames, {:.4f} s", kMaxShutterShare,
                                          1 / options.fps));
}

ExitCode synthesiseWalk(const WalkVideoOptions& options, const Context& context) {
  checkFolderWritable(options.output);
  WalkWriter writer(options, context);
  writer.writeVideo();
  writer.writeTruth();
  writer.writeFacts();
  const auto [sharp, blurred] = writer.medianSmears();
  context.print(
      "{}/walk.mp4: {} frames, {} of them blurred; median smears {:.1f} and {:.1f} px; {} views in {}/truth\n",
      options.output, writer.frames(), writer.blurred(), sharp, blurred, options.views, options.output);
  context.report(Json{{"folder", options.output},
                      {"frames", writer.frames()},
                      {"blurred", writer.blurred()},
                      {"sharpSmear", sharp},
                      {"blurredSmear", blurred},
                      {"views", options.views},
                      {"leastSeen", writer.leastSeen()}});
  return kExitOk;
}

}  // namespace ibr::app
