// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"

namespace ibr {

void checkHtmOptions(const HtmOptions& o) {
  const auto inRange = [](const char* name, double value, double low, double high) {
    check(value >= low && value <= high, ErrorCode::invalidInput, "harmonise: {} is {}, must be {} to {}", name, value,
          low, high);
  };
  inRange("inconsistentSize", o.inconsistentSize, 0, 1e6);
  inRange("inconsistentDifference", o.inconsistentDifference, 0, 255);
  inRange("inconsistentShare", o.inconsistentShare, 0, 1);
  inRange("adjustRounds", o.adjustRounds, 0, 16);
  inRange("adjustSmoothness", o.adjustSmoothness, 0, 1e6);
  inRange("shapeSmoothness", o.shapeSmoothness, 0, 1e6);
  inRange("radius", o.radius, 1, 2 * kMaxTemplateRadius);
  inRange("laterRadius", o.laterRadius, 1, 2 * kMaxTemplateRadius);
  inRange("minTexture", o.minTexture, 0, 255);
  inRange("smoothness", o.smoothness, 0, 1e6);
  inRange("complementPx", o.complementPx, 0, 1e6);
  inRange("outlierPx", o.outlierPx, 1e-3, 1e6);
  inRange("alpha", o.alpha, 0, 1);
  inRange("gamma1", o.gamma1, 1e-6, 1e6);
  inRange("rounds", o.rounds, 1, 16);
  inRange("meanDifference", o.meanDifference, 0, 255);
  inRange("faceDifference", o.faceDifference, 0, 255);
  inRange("minFacePx", o.minFacePx, 0, 1e12);
  inRange("rejectDifference", o.rejectDifference, 0, 255);
  inRange("rejectCorrelation", o.rejectCorrelation, -1, 1);
  inRange("softPx", o.softPx, 1e-3, 1e3);
}

void checkHtmMesh(const TriangleMesh& mesh) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    for (int c = 0; c < 3; ++c)
      check(std::isfinite(mesh.positions[v][c]), ErrorCode::invalidInput,
            "harmonise: vertex {} of the mesh is not finite", v);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k)
      check(mesh.triangles[f][k] < mesh.positions.size(), ErrorCode::invalidInput,
            "harmonise: face {} of the mesh has vertex index {}, but there are {} vertices", f, mesh.triangles[f][k],
            mesh.positions.size());
}

void checkHtmPhotographs(std::span<const HtmPhotograph> photographs) {
  check(!photographs.empty() && photographs.size() <= kMaxHtmCameraCount, ErrorCode::invalidInput,
        "harmonise: {} cameras, must be 1 to {}", photographs.size(), kMaxHtmCameraCount);
  HtmModel model;
  for (const HtmPhotograph& p : photographs) {
    check(p.camera.camera.intrinsics.model == CameraModel::pinhole, ErrorCode::invalidInput,
          "{}: is not a pinhole camera", p.camera.name);
    model.cameras.push_back(p.camera);
  }
  if (const std::vector<Fault> faults = validate(model, 1); !faults.empty())
    fail(ErrorCode::invalidInput, "harmonise: {} {}", faults[0].field, faults[0].message);
  for (const HtmPhotograph& p : photographs) {
    const Intrinsics& k = p.camera.camera.intrinsics;
    check(std::max(k.width, k.height) <= std::numeric_limits<std::int16_t>::max(), ErrorCode::invalidInput,
          "{}: {} × {} px are too large for templates, whose coordinates have 16 bits", p.camera.name, k.width,
          k.height);  // TemplateSample
    check(p.picture.channels == 3 && p.picture.width == k.width && p.picture.height == k.height,
          ErrorCode::invalidInput, "{}: the photograph is {} × {} px, its camera {} × {} px", p.camera.name,
          p.picture.width, p.picture.height, k.width, k.height);
    check(p.mask.empty() || (p.mask.channels == 1 && p.mask.width == k.width && p.mask.height == k.height),
          ErrorCode::invalidInput, "{}: the mask is {} × {} px, its camera {} × {} px", p.camera.name, p.mask.width,
          p.mask.height, k.width, k.height);
  }
}

}  // namespace ibr
