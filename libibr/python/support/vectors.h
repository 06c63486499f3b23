// SPDX-License-Identifier: Apache-2.0
// GLM's vectors and quaternions as NumPy arrays. Any sequence of the right number of numbers converts; arrays that
// Python receives are read-only copies. A quaternion is (x, y, z, w).
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace ibr::python {

/// Marks an array as read-only, so that writing to a copy of a value is an error instead of having no effect.
inline pybind11::array readOnly(pybind11::array array) {
  array.attr("setflags")(pybind11::arg("write") = false);
  return array;
}

/// Returns count numbers of one dimension; an empty array if the source has another shape or is not numeric.
template <class T>
pybind11::array_t<T> numbersOf(pybind11::handle source, pybind11::ssize_t count) {
  using Numbers = pybind11::array_t<T, pybind11::array::c_style | pybind11::array::forcecast>;
  if (pybind11::isinstance<pybind11::str>(source) || source.is_none()) return {};
  const auto numbers = Numbers::ensure(source);
  if (!numbers || numbers.ndim() != 1 || numbers.shape(0) != count) return {};
  return numbers;
}

}  // namespace ibr::python

namespace pybind11::detail {

template <glm::length_t L, class T, glm::qualifier Q>
struct type_caster<glm::vec<L, T, Q>> {
  using Vector = glm::vec<L, T, Q>;
  PYBIND11_TYPE_CASTER(Vector, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    const array_t<T> numbers = ibr::python::numbersOf<T>(source, L);
    if (numbers.size() != L) return false;
    for (glm::length_t i = 0; i < L; ++i) value[i] = numbers.at(i);
    return true;
  }
  static handle cast(const Vector& source, return_value_policy, handle) {
    const ssize_t length = L;
    array_t<T> numbers(length);
    for (glm::length_t i = 0; i < L; ++i) numbers.mutable_at(i) = source[i];
    return ibr::python::readOnly(numbers).release();
  }
};

template <>
struct type_caster<glm::dquat> {
  PYBIND11_TYPE_CASTER(glm::dquat, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    const array_t<double> numbers = ibr::python::numbersOf<double>(source, 4);
    if (numbers.size() != 4) return false;
    value = glm::dquat(numbers.at(3), numbers.at(0), numbers.at(1), numbers.at(2));
    return true;
  }
  static handle cast(const glm::dquat& source, return_value_policy, handle) {
    const ssize_t length = 4;
    array_t<double> numbers(length);
    const double parts[] = {source.x, source.y, source.z, source.w};
    std::copy_n(parts, length, numbers.mutable_data());
    return ibr::python::readOnly(numbers).release();
  }
};

}  // namespace pybind11::detail
