// SPDX-License-Identifier: Apache-2.0
#include "support/arrays.h"

#include <algorithm>
#include <limits>
#include <memory>

namespace py = pybind11;

namespace ibr::python {
namespace {

template <class T>
py::array ownedArray(Image<T>&& image) {
  auto owned = std::make_unique<Image<T>>(std::move(image));
  std::vector<py::ssize_t> shape{owned->height, owned->width};
  if (owned->channels > 1) shape.push_back(owned->channels);
  const T* values = owned->values.data();
  const py::capsule owner(owned.get(), [](void* pointer) { delete static_cast<Image<T>*>(pointer); });
  owned.release();  // the capsule deletes it
  return py::array_t<T>(shape, values, owner);
}

}  // namespace

py::array toArray(Image8&& image) {
  return ownedArray(std::move(image));
}
py::array toArray(ImageF&& image) {
  return ownedArray(std::move(image));
}

Image8 imageOf(const py::array& array, const std::string& name, const std::vector<int>& channels) {
  if (!py::isinstance<py::array_t<std::uint8_t>>(array))
    throw py::type_error(name + ": the dtype must be uint8, not " + std::string(py::str(array.dtype())));
  const py::ssize_t count = array.ndim() == 2 ? 1 : array.ndim() == 3 ? array.shape(2) : 0;
  if (std::ranges::find(channels, count) == channels.end()) {
    std::string allowed;
    for (const int c : channels) allowed += (allowed.empty() ? "" : " or ") + std::to_string(c);
    throw py::value_error(name + ": the shape must be (height, width, channels) with " + allowed + " channels");
  }
  constexpr py::ssize_t kMaxSide = std::numeric_limits<int>::max();
  if (array.shape(0) < 1 || array.shape(1) < 1 || array.shape(0) > kMaxSide || array.shape(1) > kMaxSide)
    throw py::value_error(name + ": an image has at least one pixel, and at most 2^31 - 1 along a side");
  const auto dense = py::array_t<std::uint8_t, py::array::c_style>::ensure(array);
  if (!dense) throw py::error_already_set();
  Image8 image;
  image.height = int(array.shape(0));
  image.width = int(array.shape(1));
  image.channels = int(count);
  image.values.assign(dense.data(), dense.data() + dense.size());
  return image;
}

py::array arrayOf(py::handle object, const std::string& name) {
  if (!py::isinstance<py::array>(object)) throw py::type_error(name + ": must be a NumPy array");
  return py::reinterpret_borrow<py::array>(object);
}

Image8 maskOf(const py::object& array, const std::string& name) {
  if (array.is_none()) return {};
  return imageOf(arrayOf(array, name), name, {1});
}

}  // namespace ibr::python
