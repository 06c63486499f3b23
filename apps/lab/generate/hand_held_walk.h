// SPDX-License-Identifier: Apache-2.0
// The motion of a camera that somebody carries through a walk hall, as a function of time, with known blurred frames.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ibr/camera.h"

namespace ibr {

struct HandHeldWalkOptions {
  double seconds = 60, fps = 30;
  double shutter = 0.006;     // exposure of a frame, s; at most kMaxShutterShare of the time between frames
  bool variableRate = false;  // times between frames vary by a quarter
  double angle = 1;           // horizontal field of view, radians; the smears of jolts are shares of the image's width
  std::uint64_t seed = 1;
};

/// Longer exposures would reach into the jolt of the next frame.
constexpr double kMaxShutterShare = 0.3;

/// Deterministic for its options. Lengths in metres, y up.
class HandHeldWalk {
 public:
  /// A part of the walk with a speed of its own, in frames.
  struct Part {
    std::string name;
    std::size_t firstFrame;
    double speed;  // m/s
  };

  explicit HandHeldWalk(const HandHeldWalkOptions& options);

  /// Pose at any time, with shake and jolts.
  Pose poseAt(double time) const;
  /// Pose at any time without shake and jolts.
  Pose steadyPoseAt(double time) const;
  /// Speed along the way, m/s.
  double speedAt(double time) const;

  /// Middles of the exposures, s; the first is 0.
  const std::vector<double>& frameTimes() const { return times_; }
  /// Formula of a frame's time by its number, in means between frames, with variableRate.
  static std::string variableTime(const std::string& number);
  /// By frame: true if the camera is jolted during the exposure. About 28 % of the frames.
  const std::vector<bool>& jolted() const { return jolted_; }
  const std::vector<Part>& parts() const { return parts_; }

 private:
  struct Wave {
    double frequency, phase, amplitude;  // Hz, radians
  };
  // A sum of waves of several frequency bands.
  struct Shake {
    std::vector<Wave> waves;
    double at(double time) const;
  };
  struct Jolt {
    double time;
    glm::dvec3 axis;  // unit, camera axes
    double radians;   // times pulse()
  };
  double tableAt(const std::vector<double>& table, double time) const;
  void planFrames();
  void planSpeed();
  void planShake();
  void planJolts();

  HandHeldWalkOptions options_;
  std::vector<double> times_;
  std::vector<bool> jolted_;
  std::vector<Part> parts_;
  std::vector<double> travelled_, around_, turned_;  // by kStep: m; radians around the hall; radians on the spot
  double start_ = 0, direction_ = 1, wobble_ = 0;
  Shake position_[3], rotation_[3], look_, amount_;
  std::vector<Jolt> jolts_;  // by time
};

}  // namespace ibr
