// SPDX-License-Identifier: Apache-2.0
#include "author/poses/bundle_adjust.h"

#include <ceres/loss_function.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <memory>
#include <set>

#include "author/poses/bundle_residual.h"

namespace ibr {
namespace {

// Unknowns that Ceres changes; all zero at the start except a point's inverse distance. Each kind is one array: within
// a group, Ceres orders by address, and sums in that order.
struct Unknowns {
  std::vector<std::array<double, kPoseUnknowns>> poses;
  std::vector<std::array<double, kLensUnknowns>> lenses;
  std::vector<std::array<double, kPointUnknowns>> points;
};

class Residual final : public ceres::SizedCostFunction<2, kPoseUnknowns, kLensUnknowns, kPointUnknowns> {
 public:
  Residual(const Camera& camera, const AnchoredPoint& point, glm::dvec2 pixel)
      : camera_(camera), point_(point), pixel_(pixel) {}

  bool Evaluate(double const* const* unknowns, double* residual, double** jacobians) const override {
    const auto found =
        bundleResidual(camera_, point_, pixel_, unknowns[0], unknowns[1], unknowns[2], jacobians != nullptr);
    if (!found) return false;
    residual[0] = found->off.x;
    residual[1] = found->off.y;
    if (!jacobians) return true;
    const auto copy = [](const auto& rows, double* to) {
      if (!to) return;
      for (const auto& row : rows) to = std::copy(row.begin(), row.end(), to);
    };
    copy(found->poseJacobian, jacobians[0]);
    copy(found->lensJacobian, jacobians[1]);
    copy(found->pointJacobian, jacobians[2]);
    return true;
  }

 private:
  const Camera& camera_;
  const AnchoredPoint& point_;
  glm::dvec2 pixel_;
};

// Gaussian prior with mean zero and these standard deviations.
template <std::size_t n>
ceres::CostFunction* prior(const std::array<double, n>& deviations) {
  ceres::Matrix weights = ceres::Matrix::Zero(n, n);
  for (std::size_t i = 0; i < n; ++i) weights(Eigen::Index(i), Eigen::Index(i)) = 1 / deviations[i];
  return new ceres::NormalPrior(weights, ceres::Vector::Zero(n));
}

class Adjustment {
 public:
  Adjustment(std::span<const BundleCamera> cameras, std::span<const BundlePoint> points, const BundleOptions& options)
      : cameras_(cameras), inputPoints_(points), options_(options) {
    unknowns_.poses.resize(cameras.size());
    unknowns_.points.resize(points.size());
    for (const BundleCamera& camera : cameras) lensOf_.try_emplace(camera.intrinsics, lensOf_.size());
    unknowns_.lenses.resize(lensOf_.size());
    for (const BundlePoint& point : points) {
      anchored_.push_back(anchored(point));
      unknowns_.points[anchored_.size() - 1][2] = anchored_.back().inverseDistance;
    }
  }

  Bundle run() {
    addPoints();
    if (problem_.NumResidualBlocks() > 0) {
      addPriors();
      ceres::Solver::Options solver;
      solver.linear_solver_type = ceres::SPARSE_SCHUR;
      solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // others call a BLAS that may use threads
      solver.linear_solver_ordering.reset(order_.release());
      solver.num_threads = 1;
      solver.max_num_iterations = options_.rounds;
      solver.max_num_consecutive_invalid_steps = 20;  // a point that moves behind a camera makes one
      solver.function_tolerance = options_.minDecrease;
      solver.logging_type = ceres::SILENT;
      ceres::Solver::Summary summary;
      ceres::Solve(solver, &problem_, &summary);
    }
    return result();
  }

 private:
  AnchoredPoint anchored(const BundlePoint& point) const {
    glm::dvec3 middle(0.0);
    for (const BundleObservation& seen : point.seen)
      middle += cameras_[seen.camera].camera.pose.position / double(point.seen.size());
    return anchorPoint(point.position, middle);
  }

  bool counts(const BundlePoint& point) const {
    const auto ahead = [&](const BundleObservation& seen) {
      return seenAt(cameras_[seen.camera].camera, point.position).has_value();
    };
    return point.seen.size() >= 2 && std::ranges::all_of(point.seen, ahead);
  }

  void addPoints() {
    for (std::size_t p = 0; p < inputPoints_.size(); ++p) {
      if (!counts(inputPoints_[p])) continue;
      for (const BundleObservation& seen : inputPoints_[p].seen) {
        const BundleCamera& camera = cameras_[seen.camera];
        double* const pose = unknowns_.poses[seen.camera].data();
        double* const lens = unknowns_.lenses[lensOf_.at(camera.intrinsics)].data();
        double* const point = unknowns_.points[p].data();
        problem_.AddResidualBlock(new Residual(camera.camera, anchored_[p], seen.pixel), loss_.get(), pose, lens,
                                  point);
        order_->AddElementToGroup(point, 0);
        order_->AddElementToGroup(pose, 1);
        order_->AddElementToGroup(lens, 2);
      }
    }
  }

  void addPriors() {
    const double r = options_.radians, s = options_.shift;
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
      double* const pose = unknowns_.poses[i].data();
      if (!problem_.HasParameterBlock(pose)) continue;
      if (cameras_[i].fixed)
        problem_.SetParameterBlockConstant(pose);
      else
        problem_.AddResidualBlock(prior<kPoseUnknowns>({r, r, r, s, s, s}), nullptr, pose);
    }
    std::set<std::uint32_t> kept;
    for (const BundleCamera& camera : cameras_)
      if (camera.keepIntrinsics) kept.insert(camera.intrinsics);
    for (const auto& [number, index] : lensOf_) {
      double* const lens = unknowns_.lenses[index].data();
      if (!problem_.HasParameterBlock(lens)) continue;
      if (options_.focal > 0 && options_.centrePx > 0 && !kept.contains(number))
        problem_.AddResidualBlock(prior<kLensUnknowns>({options_.focal, options_.centrePx, options_.centrePx}), nullptr,
                                  lens);
      else
        problem_.SetParameterBlockConstant(lens);
    }
  }

  Bundle result() const {
    Bundle bundle;
    for (std::size_t i = 0; i < cameras_.size(); ++i)
      bundle.cameras.push_back(movedCamera(cameras_[i].camera, unknowns_.poses[i].data(),
                                           unknowns_.lenses[lensOf_.at(cameras_[i].intrinsics)].data()));
    for (std::size_t p = 0; p < inputPoints_.size(); ++p)
      bundle.points.push_back(placedPoint(anchored_[p], unknowns_.points[p].data()));
    return bundle;
  }

  std::span<const BundleCamera> cameras_;
  std::span<const BundlePoint> inputPoints_;
  const BundleOptions& options_;
  std::vector<AnchoredPoint> anchored_;
  Unknowns unknowns_;
  std::map<std::uint32_t, std::size_t> lensOf_;  // by BundleCamera::intrinsics
  std::unique_ptr<ceres::LossFunction> loss_ =
      options_.cauchyPx > 0 ? std::unique_ptr<ceres::LossFunction>(new ceres::CauchyLoss(options_.cauchyPx))
                            : std::make_unique<ceres::SoftLOneLoss>(options_.softPx);
  std::unique_ptr<ceres::ParameterBlockOrdering> order_ = std::make_unique<ceres::ParameterBlockOrdering>();
  ceres::Problem problem_{[] {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }()};
};

}  // namespace

Bundle adjustBundle(std::span<const BundleCamera> cameras, std::span<const BundlePoint> points,
                    const BundleOptions& options) {
  return Adjustment(cameras, points, options).run();
}

}  // namespace ibr
