// SPDX-License-Identifier: Apache-2.0
// Images and the vectors of meshes as NumPy arrays.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <glm/gtc/type_precision.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "ibr/image.h"
#include "support/vectors.h"

namespace ibr::python {

/// Returns height × width × channels values, or height × width of an image with one channel. The array owns them;
/// nothing is copied.
pybind11::array toArray(Image8&& image);
pybind11::array toArray(ImageF&& image);

/// Copies an array of dtype uint8, height × width or height × width × channels. `name` is the argument's, for messages.
/// Throws TypeError for another dtype, ValueError for another shape or number of channels.
Image8 imageOf(const pybind11::array& array, const std::string& name, const std::vector<int>& channels);

/// Throws TypeError if the object is no array.
pybind11::array arrayOf(pybind11::handle object, const std::string& name);

/// RGB or RGBA, as metrics take it.
inline Image8 colourOf(const pybind11::array& array, const std::string& name) {
  return imageOf(array, name, {3, 4});
}
/// One channel; None is an empty image.
Image8 maskOf(const pybind11::object& array, const std::string& name);

template <class T>
inline constexpr glm::length_t kLength = 1;
template <glm::length_t L, class T, glm::qualifier Q>
inline constexpr glm::length_t kLength<glm::vec<L, T, Q>> = L;
template <class T>
struct NumberOf {
  using Type = T;
};
template <glm::length_t L, class T, glm::qualifier Q>
struct NumberOf<glm::vec<L, T, Q>> {
  using Type = T;
};

/// Returns a read-only array of n numbers, or n × L numbers of vectors, over the memory of `values`, which `owner`
/// keeps alive.
template <class T>
pybind11::array viewOf(const std::vector<T>& values, pybind11::handle owner) {
  using Number = typename NumberOf<T>::Type;
  static_assert(sizeof(T) == sizeof(Number) * std::size_t(kLength<T>));
  std::vector<pybind11::ssize_t> shape{pybind11::ssize_t(values.size())};
  if (kLength < T >> 1) shape.push_back(kLength<T>);
  return readOnly(pybind11::array_t<Number>(shape, reinterpret_cast<const Number*>(values.data()), owner));
}

/// Returns one view for each list.
template <class T>
pybind11::tuple viewsOf(const std::vector<std::vector<T>>& lists, pybind11::handle owner) {
  pybind11::tuple all(lists.size());
  for (std::size_t i = 0; i < lists.size(); ++i) all[i] = viewOf(lists[i], owner);
  return all;
}

/// Copies n numbers, or n × L numbers of vectors. Integers convert to integers, and integers and floating-point numbers
/// to floating-point numbers. Throws TypeError for another dtype, ValueError for another shape and for integers out of
/// range.
template <class T>
std::vector<T> vectorsOf(const pybind11::array& array, const std::string& name) {
  namespace py = pybind11;
  using Number = typename NumberOf<T>::Type;
  const char kind = array.dtype().kind();
  if (!(kind == 'i' || kind == 'u' || (kind == 'f' && std::is_floating_point_v<Number>)))
    throw py::type_error(name + ": the dtype " + std::string(py::str(array.dtype())) + " does not convert to " +
                         std::string(py::str(py::dtype::of<Number>())));
  const py::ssize_t length = kLength<T>;
  if (array.ndim() != (length == 1 ? 1 : 2) || (length > 1 && array.shape(1) != length))
    throw py::value_error(name + ": the shape must be " +
                          (length == 1 ? std::string("(n,)") : "(n, " + std::to_string(length) + ")"));
  const auto numbers = py::array_t<Number, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!numbers) throw py::error_already_set();
  if (std::is_integral_v<Number> &&
      !py::module_::import("numpy").attr("array_equal")(numbers, array).template cast<bool>())
    throw py::value_error(name + ": a number is out of range");
  const T* first = reinterpret_cast<const T*>(numbers.data());
  return {first, first + numbers.shape(0)};
}

}  // namespace ibr::python
