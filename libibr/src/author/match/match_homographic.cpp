// SPDX-License-Identifier: Apache-2.0
#include "author/match/match_homographic.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <opencv2/imgproc.hpp>

#include "author/features/epipolar.h"
#include "author/features/features.h"
#include "author/match/mask_pairs.h"
#include "author/match/plane_patch.h"
#include "author/match/position_depth.h"
#include "author/match/propagate.h"
#include "author/match/track_mesh.h"
#include "author/match/vertices.h"
#include "author/photographs/masks.h"
#include "author/pixels/cv_view.h"
#include "author/sweep/homographies.h"
#include "author/sweep/window_agreement.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace {

constexpr int kMaxFeatures = 12'000;
constexpr double kMaxDescriptorRatio = 0.85;
constexpr double kMaxEpipolarPx = 2.0;
constexpr int kMaxRounds = 4;                 // of matching and sealing
constexpr double kMinRematchGain = 0.02;      // minimum gain of a round, of the sealed tracks, for another round
constexpr double kMaxCyclePx = 3.0;           // maximum difference of two paths to a feature of a third member
constexpr double kMaxNeighbourErrorPx = 4.0;  // maximum distance of a match from where its neighbours' planes put it
constexpr double kMaxAlignmentPx = 1.5;       // maximum distance that the last refinement moves a match
constexpr double kMinCorrelation = 0.6;       // of a match that is kept
constexpr double kMaxLabelPx = 1.0;           // maximum distance of a match from a plane that it lies on

class HomographicMatcher {
 public:
  HomographicMatcher(std::span<const MatchView> views, const HomographicOptions& options)
      : views_(views), options_(options), d_(views.size()), cameras_(camerasOf(views)), fit_(cameras_, options.posed) {
    for (const MatchView& v : views) {
      const Image8 grey = toGrey(fillMasked(v.picture, v.mask));
      features_.push_back(detectFeatures(grey, kMaxFeatures));
      cv::Mat value = cvView(grey_.emplace_back(grey.width, grey.height, 1));
      cvView(grey).convertTo(value, CV_32F);
    }
  }

  DenseMatch run() {
    decompose();
    const PlanePatches patches(grey_, cameras_, options_.exact);
    const Propagation with{planes_, patches, features_};
    dropContradicted(tracks_, planes_, kMaxNeighbourErrorPx);
    refineLocally(tracks_, with);
    extrapolateLocally(tracks_, with);
    matchFocused(tracks_, with);
    extrapolateLocally(tracks_, with);
    align(patches);
    dropFolded(tracks_, d_);
    refit();
    return dense();
  }

 private:
  static std::vector<Camera> camerasOf(std::span<const MatchView> views) {
    std::vector<Camera> cameras;
    for (const MatchView& v : views) cameras.push_back(v.camera);
    return cameras;
  }

  // Pairs with poses and two positions have epipolar lines.
  bool guided(std::size_t i, std::size_t j) const {
    return options_.posed && glm::distance(cameras_[i].pose.position, cameras_[j].pose.position) > 0;
  }

  // Guided matching compares features only with those near their epipolar line.
  std::vector<FeatureMatch> matchPair(std::size_t i, std::size_t j, const std::vector<std::vector<bool>>& taken) const {
    if (guided(i, j))
      return matchGuided(cameras_[i], features_[i], cameras_[j], features_[j], {kMaxEpipolarPx, kMaxDescriptorRatio});
    return mutualMatches(features_[i], features_[j], kMaxDescriptorRatio, taken[i], taken[j]);
  }

  // Tracks through all members of features that no plane has sealed; all pairs of members must agree.
  std::vector<PlaneTrack> matchUnsealed() const {
    std::vector<std::vector<bool>> taken;
    for (std::size_t i = 0; i < d_; ++i) {
      taken.emplace_back(features_[i].count(), false);
      for (const PlaneTrack& track : tracks_) taken[i][track.feature[i]] = true;
    }
    std::vector<std::vector<std::uint32_t>> to[kMaxMembers];
    for (std::size_t i = 0; i < d_; ++i) {
      to[i].resize(d_);
      for (std::size_t j = i + 1; j < d_; ++j) {
        to[i][j].assign(features_[i].count(), kNoFeature);
        for (const FeatureMatch& m : matchPair(i, j, taken))
          if (!taken[i][m.a] && !taken[j][m.b]) to[i][j][m.a] = m.b;
      }
    }
    std::vector<PlaneTrack> found;
    for (std::uint32_t f = 0; f < features_[0].count(); ++f) {
      PlaneTrack track;
      track.feature[0] = f;
      track.at[0] = features_[0].at[f];
      bool sound = true;
      for (std::size_t j = 1; sound && j < d_; ++j) {
        const std::uint32_t g = to[0][j][f];
        sound = g != kNoFeature;
        if (!sound) break;
        track.feature[j] = g;
        track.at[j] = features_[j].at[g];
        for (std::size_t i = 1; i < j; ++i)
          if (const std::uint32_t other = to[i][j][track.feature[i]]; other != kNoFeature)
            sound = sound && glm::distance(features_[j].at[other], features_[j].at[g]) <= kMaxCyclePx;
      }
      if (sound) found.push_back(track);
    }
    return found;
  }

  // Matching again finds more when features no longer compete with sealed ones. Guided pairs ignore sealed features:
  // another round would only find again what no plane took, so one round suffices.
  int rounds() const {
    for (std::size_t i = 0; i < d_; ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (!guided(j, i)) return kMaxRounds;
    return 1;
  }

  void decompose() {
    for (int round = 0; round < rounds(); ++round) {
      const std::size_t sealed = tracks_.size();
      for (const PlaneTrack& track : matchUnsealed()) tracks_.push_back(track);
      // Unsealed tracks may still lie on a plane found earlier.
      for (PlaneTrack& track : tracks_)
        for (std::size_t p = 0; track.plane < 0 && p < planes_.size(); ++p)
          if (planes_[p].error(track) < kMaxPlaneErrorPx) track.plane = int(p);
      while (sealLargestPlane(fit_, tracks_, planes_, options_.seed + planes_.size())) {
      }
      std::erase_if(tracks_, [](const PlaneTrack& track) { return track.plane < 0; });
      if (double(tracks_.size()) < double(sealed) * (1 + kMinRematchGain) || tracks_.empty()) break;
    }
  }

  void align(const PlanePatches& patches) {
    std::vector<bool> keep(tracks_.size(), true);
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      PlaneTrack& track = tracks_[t];
      if (track.plane < 0) continue;  // focused matches were aligned when found
      const PlaneMaps& plane = planes_[std::size_t(track.plane)];
      PlaneTrack moved = track;
      if (options_.exact) moved.at = *plane(track.at[0]);
      const double correlation = patches.align(plane, {moved.at.data(), d_}, kMaxAlignmentPx);
      keep[t] = correlation >= kMinCorrelation;
      track.at = moved.at;
    }
    keepOnly(tracks_, keep);
  }

  // Fits the planes again to the current matches.
  void refit() {
    std::vector<std::vector<const PlaneTrack*>> on(planes_.size());
    for (const PlaneTrack& track : tracks_)
      if (track.plane >= 0) on[std::size_t(track.plane)].push_back(&track);
    for (std::size_t p = 0; p < planes_.size(); ++p)
      if (on[p].size() >= minOnPlane(fit_))
        if (const auto plane = fit_(on[p])) planes_[p] = *plane;
  }

  DenseMatch dense() {
    const int width = views_[0].picture.width, height = views_[0].picture.height;
    DenseMatch match;
    match.frame = views_[0].camera;
    match.refined = true;
    match.depthKnown = false;
    match.good = Image8(width, height, 1);
    match.seen.assign(d_, Image8(width, height, 1));
    MatchedVertices& vertices = match.vertices.emplace();
    vertices.matched.resize(d_);
    vertices.planes = planeLabels(tracks_, planes_, kMaxLabelPx);
    TrackField field = fieldOf(tracks_, trackTriangles(tracks_), vertices.planes, planes_, d_, {width, height});
    match.position = std::move(field.position);

    std::vector<FrameToMember> maps;
    for (const Camera& camera : cameras_) maps.push_back(frameToMember(match.frame, camera));
    for (const PlaneTrack& track : tracks_) {
      vertices.frame.emplace_back(track.at[0]);
      vertices.inverseDepth.push_back(positionDepth(maps, track.at[0], {track.at.data(), d_}).inverseDepth);
      for (std::size_t i = 0; i < d_; ++i) vertices.matched[i].emplace_back(track.at[i]);
    }
    gate(match, cvView(field.known) > 0);
    depthFromPositions(match, cameras_);
    return match;
  }

  void gate(DenseMatch& match, const cv::Mat& known) const {
    MaskPairs pairs(views_, match.position);
    std::vector<cv::Mat> inside, warped;
    for (std::size_t i = 0; i < d_; ++i) {
      const ImageF& picture = grey_[i];
      cv::Mat corner, sampled;
      cv::inRange(cvView(match.position[i]), cv::Scalar(0, 0), cv::Scalar(picture.width, picture.height),
                  inside.emplace_back());
      cv::subtract(cvView(match.position[i]), cv::Scalar(0.5, 0.5), corner);
      cv::remap(cvView(picture), sampled, corner, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
      warped.push_back(sampled);
    }
    for (std::size_t i = 0; i < d_; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const WindowAgreement found = agreement(warped[i], warped[j]);
        const cv::Mat both = known & inside[i] & inside[j];
        pairs.add(i, j, both & found.alike);
        for (const std::size_t k : {i, j}) cvView(match.seen[k]).setTo(1, both & found.textured & pairs.used(i, j));
      }
    cvView(match.good).setTo(1, pairs.good() & known);
  }

  std::span<const MatchView> views_;
  HomographicOptions options_;
  std::size_t d_;
  std::vector<Camera> cameras_;
  PlaneFitter fit_;
  std::vector<ImageF> grey_;
  std::vector<Features> features_;
  std::vector<PlaneTrack> tracks_;
  std::vector<PlaneMaps> planes_;
};

}  // namespace

DenseMatch matchByHomographies(std::span<const MatchView> views, const HomographicOptions& options) {
  return HomographicMatcher(views, options).run();
}

}  // namespace ibr
