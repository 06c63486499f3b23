// SPDX-License-Identifier: Apache-2.0
#include "author/local_adjust.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "author/posed_model.h"

namespace ibr {
namespace {

constexpr std::size_t kMostTracks = 1000, kFewTracks = 20;
constexpr double kSoftPx = 0.5;           // where squares turn into distances
constexpr double kPriorRadians = 0.01;    // one standard deviation, against reprojections of 1 px
constexpr double kPriorShift = 0.02;      // likewise, in distances from the first member
constexpr int kRounds = 30, kPose = 6;    // rotation about the camera's axes, then shift in the world
constexpr double kEnoughDecrease = 1e-5;  // of the cost, to go on

// The part of an observation's derivatives that belongs to its camera and to its point: rows of x and y.
struct Jacobian {
  std::array<std::array<double, kPose>, 2> pose;
  std::array<glm::dvec3, 2> point;
};

// Lower triangle of a symmetric positive matrix in place, by Cholesky; false where it is not positive.
bool solve(std::vector<double>& a, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = a[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
      if (i == j && !(sum > 0)) return false;
      a[i * n + j] = i == j ? std::sqrt(sum) : sum / a[j * n + j];
    }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i * n + k] * b[k];
    b[i] /= a[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k * n + i] * b[k];
    b[i] /= a[i * n + i];
  }
  return true;
}

class Adjuster {
 public:
  Adjuster(std::span<const Camera> members, std::span<const LocalTrack> tracks)
      : start_(members), cameras_(members.begin(), members.end()), tracks_(tracks) {
    for (const LocalTrack& track : tracks) points_.push_back(track.position);
    const glm::dvec3 first = members[0].pose.position;
    for (const Camera& member : members) {
      longest_ = std::max(longest_, glm::distance(member.pose.position, first));
    }
    moved_.resize(kPose * (members.size() - 1), 0.0);
  }

  double medianError() const {
    std::vector<double> errors;
    for (std::size_t t = 0; t < tracks_.size(); ++t)
      for (std::size_t i = 0; i < cameras_.size(); ++i)
        if (tracks_[t].pixel[i]) {
          const auto at = seen(cameras_[i], points_[t]);
          errors.push_back(at ? glm::distance(*at, *tracks_[t].pixel[i]) : INFINITY);
        }
    return median(errors);
  }

  void run() {
    double before = cost(), damping = 1e-3;
    for (int round = 0; round < kRounds && damping < 1e8; ++round) {
      const std::vector<Camera> cameras = cameras_;
      const std::vector<glm::dvec3> points = points_;
      const std::vector<double> moved = moved_;
      const bool stepped = step(damping);
      const double after = stepped ? cost() : INFINITY;
      if (after < before) {
        const bool enough = before - after < kEnoughDecrease * before;
        before = after;
        damping = std::max(damping * 0.1, 1e-9);
        if (enough) break;
        continue;
      }
      cameras_ = cameras;
      points_ = points;
      moved_ = moved;
      damping *= 10;
    }
  }

  std::vector<Pose> poses() const {
    std::vector<Pose> poses;
    for (const Camera& camera : cameras_) poses.push_back(camera.pose);
    return poses;
  }

 private:
  static std::optional<glm::dvec2> seen(const Camera& camera, glm::dvec3 point) {
    return project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (point - camera.pose.position));
  }
  double priorWeight(int parameter) const {
    const double deviation = parameter < 3 ? kPriorRadians : kPriorShift * std::max(longest_, 1e-12);
    return 1 / (deviation * deviation);
  }

  // Infinite where a point has come behind a camera that sees it.
  double cost() const {
    double sum = 0;
    for (std::size_t t = 0; t < tracks_.size(); ++t)
      for (std::size_t i = 0; i < cameras_.size(); ++i) {
        if (!tracks_[t].pixel[i]) continue;
        const auto at = seen(cameras_[i], points_[t]);
        if (!at) return INFINITY;
        const glm::dvec2 off = *at - *tracks_[t].pixel[i];
        sum += 2 * kSoftPx * kSoftPx * (std::sqrt(1 + glm::dot(off, off) / (kSoftPx * kSoftPx)) - 1);
      }
    for (std::size_t p = 0; p < moved_.size(); ++p) sum += priorWeight(int(p) % kPose) * moved_[p] * moved_[p];
    return sum;
  }

  static Jacobian derivatives(const Camera& camera, glm::dvec3 point) {
    const Intrinsics& k = camera.intrinsics;
    const glm::dmat3 toCamera = glm::mat3_cast(glm::conjugate(camera.pose.rotation));
    const glm::dvec3 p = toCamera * (point - camera.pose.position);
    // px = cx − fx x/z, py = cy + fy y/z
    const std::array<glm::dvec3, 2> byPlace{glm::dvec3(-k.fx / p.z, 0, k.fx * p.x / (p.z * p.z)),
                                            glm::dvec3(0, k.fy / p.z, -k.fy * p.y / (p.z * p.z))};
    Jacobian j;
    for (std::size_t r = 0; r < 2; ++r) {
      j.point[r] = glm::transpose(toCamera) * byPlace[r];
      const glm::dvec3 turn = glm::cross(byPlace[r], p);  // the camera turns by θ: the point moves by p × θ in its axes
      for (int c = 0; c < 3; ++c) {
        j.pose[r][std::size_t(c)] = turn[c];
        j.pose[r][std::size_t(c + 3)] = -j.point[r][c];
      }
    }
    return j;
  }

  // Gauss–Newton, damped: A·poses + Σ B_t·point_t = −g, B_tᵀ·poses + C_t·point_t = −h_t for each point.
  bool step(double damping) {
    const std::size_t d = cameras_.size(), n = moved_.size();
    std::vector<double> a(n * n, 0), g(n, 0);
    struct Point {
      glm::dmat3 inverse;
      glm::dvec3 h{0.0};
      std::vector<glm::dvec3> b;  // a row a parameter of the poses
    };
    std::vector<Point> points(tracks_.size());
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      Point& point = points[t];
      point.b.assign(n, glm::dvec3(0));
      glm::dmat3 c(0.0);
      for (std::size_t i = 0; i < d; ++i) {
        if (!tracks_[t].pixel[i]) continue;
        const auto at = seen(cameras_[i], points_[t]);
        if (!at) return false;
        const glm::dvec2 off = *at - *tracks_[t].pixel[i];
        const double weight = 1 / std::sqrt(1 + glm::dot(off, off) / (kSoftPx * kSoftPx));
        const Jacobian j = derivatives(cameras_[i], points_[t]);
        for (std::size_t r = 0; r < 2; ++r) {
          const double error = off[int(r)];
          c += weight * glm::outerProduct(j.point[r], j.point[r]);
          point.h += weight * error * j.point[r];
          if (i == 0) continue;
          const std::size_t first = kPose * (i - 1);
          for (std::size_t p = 0; p < kPose; ++p) {
            point.b[first + p] += weight * j.pose[r][p] * j.point[r];
            g[first + p] += weight * error * j.pose[r][p];
            for (std::size_t q = 0; q < kPose; ++q)
              a[(first + p) * n + first + q] += weight * j.pose[r][p] * j.pose[r][q];
          }
        }
      }
      const double least = 1e-12 * (c[0][0] + c[1][1] + c[2][2]);  // a far point's depth may be free
      for (int k = 0; k < 3; ++k) c[k][k] += damping * c[k][k] + least;
      point.inverse = glm::inverse(c);
    }
    for (std::size_t p = 0; p < n; ++p) {
      a[p * n + p] += priorWeight(int(p) % kPose);
      g[p] += priorWeight(int(p) % kPose) * moved_[p];
      a[p * n + p] *= 1 + damping;
    }
    for (const Point& point : points)
      for (std::size_t p = 0; p < n; ++p) {
        const glm::dvec3 row = point.inverse * point.b[p];
        g[p] -= glm::dot(row, point.h);
        for (std::size_t q = 0; q <= p; ++q) a[p * n + q] -= glm::dot(row, point.b[q]);
      }
    if (!solve(a, g)) return false;
    for (std::size_t t = 0; t < points.size(); ++t) {
      glm::dvec3 right = -points[t].h;
      for (std::size_t p = 0; p < n; ++p) right += g[p] * points[t].b[p];  // poses move by −g
      points_[t] += points[t].inverse * right;
    }
    for (std::size_t p = 0; p < n; ++p) moved_[p] -= g[p];
    for (std::size_t i = 1; i < d; ++i) {
      const double* const m = &moved_[kPose * (i - 1)];
      const glm::dvec3 turn(m[0], m[1], m[2]);
      const double angle = glm::length(turn);
      const glm::dquat turned = angle > 0 ? glm::angleAxis(angle, turn / angle) : glm::dquat(1, 0, 0, 0);
      cameras_[i].pose.rotation = glm::normalize(start_[i].pose.rotation * turned);
      cameras_[i].pose.position = start_[i].pose.position + glm::dvec3(m[3], m[4], m[5]);
    }
    return true;
  }

  std::span<const Camera> start_;
  std::vector<Camera> cameras_;
  std::span<const LocalTrack> tracks_;
  std::vector<glm::dvec3> points_;
  std::vector<double> moved_;  // of members 1 …: rotation vector and shift since the start
  double longest_ = 0;         // distance from the first member
};

}  // namespace

std::vector<LocalTrack> localTracks(const PosedModel& model, std::span<const std::vector<std::uint32_t>> tracksOf,
                                    std::span<const std::uint32_t> members) {
  std::vector<std::uint32_t> all;
  for (const std::uint32_t i : members) all.insert(all.end(), tracksOf[i].begin(), tracksOf[i].end());
  std::sort(all.begin(), all.end());
  std::vector<std::vector<std::uint32_t>> seenBy(members.size() + 1);
  for (auto first = all.begin(); first != all.end();) {
    const auto last = std::upper_bound(first, all.end(), *first);
    seenBy[std::size_t(last - first)].push_back(*first);
    first = last;
  }
  std::vector<LocalTrack> tracks;
  for (std::size_t count = members.size(); count >= 2; --count) {
    const std::vector<std::uint32_t>& list = seenBy[count];
    const std::size_t room = kMostTracks - tracks.size(), wanted = std::min(room, list.size());
    for (std::size_t k = 0; k < wanted; ++k) {  // evenly: neighbours in the model are neighbours in pictures
      const Track& track = model.tracks[list[k * list.size() / wanted]];
      LocalTrack local{track.position, std::vector<std::optional<glm::dvec2>>(members.size())};
      for (const TrackObservation& seen : track.observations)
        if (const auto at = std::ranges::find(members, seen.image); at != members.end())
          local.pixel[std::size_t(at - members.begin())] = seen.pixel;
      tracks.push_back(std::move(local));
    }
  }
  return tracks;
}

std::vector<Pose> locallyAdjusted(std::span<const Camera> members, std::span<const LocalTrack> tracks,
                                  double leastPx) {
  Adjuster adjuster(members, tracks);
  if (tracks.size() >= kFewTracks && adjuster.medianError() >= leastPx) adjuster.run();
  return adjuster.poses();
}

}  // namespace ibr
