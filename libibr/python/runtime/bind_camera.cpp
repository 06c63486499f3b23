// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <glm/mat3x3.hpp>
#include <limits>

#include "ibr/camera.h"
#include "runtime/bind.h"
#include "support/arrays.h"
#include "support/record.h"
#include "support/runtime_enums.h"

namespace py = pybind11;

namespace ibr::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

// The shape (length,) or (n, length); returns n. Throws ValueError.
py::ssize_t rowsOf(const Numbers& array, py::ssize_t length, const char* name) {
  if (array.ndim() == 1 && array.shape(0) == length) return 1;
  if (array.ndim() == 2 && array.shape(1) == length) return array.shape(0);
  throw py::value_error(fmt::format("{}: the shape must be ({},) or (n, {})", name, length, length));
}

// An array of the input's number of dimensions, with rows of another length.
py::array_t<double> likeRows(const Numbers& input, py::ssize_t length) {
  std::vector<py::ssize_t> shape{length};
  if (input.ndim() == 2) shape.insert(shape.begin(), input.shape(0));
  return py::array_t<double>(shape);
}

py::array_t<double> directionsOf(const Intrinsics& intrinsics, const Numbers& pixels) {
  const py::ssize_t count = rowsOf(pixels, 2, "pixels");
  py::array_t<double> directions = likeRows(pixels, 3);
  for (py::ssize_t i = 0; i < count; ++i) {
    const double* pixel = pixels.data() + 2 * i;
    const glm::dvec3 direction = unproject(intrinsics, {pixel[0], pixel[1]});
    for (glm::length_t c = 0; c < 3; ++c) directions.mutable_data()[3 * i + c] = direction[c];
  }
  return directions;
}

py::array_t<double> pixelsOf(const Intrinsics& intrinsics, const Numbers& directions) {
  const py::ssize_t count = rowsOf(directions, 3, "directions");
  py::array_t<double> pixels = likeRows(directions, 2);
  for (py::ssize_t i = 0; i < count; ++i) {
    const double* direction = directions.data() + 3 * i;
    const auto pixel = project(intrinsics, {direction[0], direction[1], direction[2]});
    pixels.mutable_data()[2 * i] = pixel ? pixel->x : std::numeric_limits<double>::quiet_NaN();
    pixels.mutable_data()[2 * i + 1] = pixel ? pixel->y : std::numeric_limits<double>::quiet_NaN();
  }
  return pixels;
}

py::array_t<double> matrixOf(const Pose& pose) {
  py::array_t<double> matrix({4, 4});
  const glm::dmat3 rotation = glm::mat3_cast(pose.rotation);
  for (glm::length_t row = 0; row < 3; ++row) {
    for (glm::length_t column = 0; column < 3; ++column) matrix.mutable_at(row, column) = rotation[column][row];
    matrix.mutable_at(row, 3) = pose.position[row];
    matrix.mutable_at(3, row) = 0;
  }
  matrix.mutable_at(3, 3) = 1;
  return matrix;
}

Pose poseOf(const Numbers& matrix) {
  constexpr double kTolerance = 1e-3;  // as validate() has for rotations
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4)
    throw py::value_error("matrix: the shape must be (4, 4)");
  glm::dmat3 rotation;
  Pose pose;
  for (glm::length_t row = 0; row < 3; ++row) {
    for (glm::length_t column = 0; column < 3; ++column) rotation[column][row] = matrix.at(row, column);
    pose.position[row] = matrix.at(row, 3);
  }
  const glm::dmat3 product = glm::transpose(rotation) * rotation;
  bool isRigid = std::abs(glm::determinant(rotation) - 1) <= kTolerance && matrix.at(3, 3) == 1;
  for (glm::length_t i = 0; i < 3; ++i) {
    isRigid = isRigid && std::isfinite(pose.position[i]) && matrix.at(3, i) == 0;
    for (glm::length_t j = 0; j < 3; ++j) isRigid = isRigid && std::abs(product[i][j] - (i == j ? 1 : 0)) <= kTolerance;
  }
  if (!isRigid) throw py::value_error("matrix: is not a rotation and a translation");
  pose.rotation = glm::normalize(glm::quat_cast(rotation));
  return pose;
}

}  // namespace

std::vector<Camera> camerasOf(py::handle views) {
  if (py::isinstance<Camera>(views)) return {views.cast<Camera>()};
  try {
    return views.cast<std::vector<Camera>>();
  } catch (const py::cast_error&) {
    throw py::type_error("views: must be a Camera or a sequence of cameras");
  }
}

void bindCamera(py::module_& module) {
  Record<Intrinsics> intrinsics(
      module, "Intrinsics",
      "Projection of a camera. Pixels: (0, 0) is the top-left corner of the top-left pixel, y "
      "down; pixel centres are at (i + 0.5, j + 0.5).");
  intrinsics.field("model", &Intrinsics::model, "CameraModel")
      .field("width", &Intrinsics::width, "px")
      .field("height", &Intrinsics::height, "px")
      .field("fx", &Intrinsics::fx, "Focal length along x, px; pinholes only")
      .field("fy", &Intrinsics::fy, "Focal length along y, px; pinholes only")
      .field("cx", &Intrinsics::cx, "Principal point, px; pinholes only")
      .field("cy", &Intrinsics::cy, "Principal point, px; pinholes only")
      .constructible();
  intrinsics.type()
      .def_static("from_fov", &pinholeFromFov, py::arg("width"), py::arg("height"), py::arg("fov_y"),
                  "Pinhole with square pixels and a centred principal point; fov_y: vertical field of view, radians.")
      .def_static("from_tangents", &pinholeFromTangents, py::arg("width"), py::arg("height"), py::arg("left"),
                  py::arg("right"), py::arg("up"), py::arg("down"),
                  "Pinhole from the tangents of its edges, x right, y up on the plane z = -1.")
      .def("resized", &resized, py::arg("width"), py::arg("height"), "Intrinsics of the image scaled to this size, px.")
      .def("unproject", &directionsOf, py::arg("pixels"),
           "Unit viewing directions of pixels, in camera axes (x right, y up, looking along -z). Shapes: (2,) to (3,), "
           "or (n, 2) to (n, 3).")
      .def(
          "project", &pixelsOf, py::arg("directions"),
          "Pixels at which directions of any length, in camera axes, are seen; NaN where they are not. Shapes: (3,) to "
          "(2,), or (n, 3) to (n, 2).");

  Record<Pose> pose(module, "Pose", "Maps camera axes to world axes: world = position + rotation * camera.");
  pose.field("position", &Pose::position, "Camera centre, world units, shape (3,)")
      .field("rotation", &Pose::rotation, "Unit quaternion (x, y, z, w)")
      .constructible();
  pose.type()
      .def_property_readonly("matrix", &matrixOf, "4 x 4 matrix from camera to world coordinates")
      .def_property_readonly("axis", &viewAxis, "Viewing axis, unit, world axes")
      .def_static(
          "from_matrix", &poseOf, py::arg("matrix"),
          "Pose of a 4 x 4 matrix from camera to world coordinates. Raises ValueError for a matrix that scales, "
          "shears or mirrors by more than 0.001.");

  Record<Camera> camera(module, "Camera", "Intrinsics and pose.");
  camera.field("intrinsics", &Camera::intrinsics, "Intrinsics").field("pose", &Camera::pose, "Pose").constructible();
}

}  // namespace ibr::python
