// SPDX-License-Identifier: Apache-2.0
// A vector inside a scene or a model as an immutable Python sequence, without copies.
#pragma once

#include <pybind11/pybind11.h>

#include <vector>

namespace ibr::python {

/// Elements are references; each keeps `owner` alive, as does the sequence.
template <class T>
struct Sequence {
  const std::vector<T>* elements;
  pybind11::object owner;

  pybind11::object at(std::size_t index) const {
    return pybind11::cast((*elements)[index], pybind11::return_value_policy::reference_internal, owner);
  }
};

/// Adds the class of Sequence<T>: length, elements by index or slice, iteration.
template <class T>
void defineSequence(pybind11::module_& module, const char* name, const char* doc) {
  namespace py = pybind11;
  using S = Sequence<T>;
  py::class_<S> type(module, name, doc);
  type.def("__len__", [](const S& self) { return self.elements->size(); })
      .def(
          "__iter__",
          [](const S& self) {
            return py::make_iterator<py::return_value_policy::reference_internal>(self.elements->begin(),
                                                                                  self.elements->end());
          },
          py::keep_alive<0, 1>())
      .def("__getitem__",
           [](const S& self, py::ssize_t index) {
             const auto size = py::ssize_t(self.elements->size());
             if (index < -size || index >= size) throw py::index_error("index out of range");
             return self.at(std::size_t(index < 0 ? index + size : index));
           })
      .def("__getitem__", [](const S& self, const py::slice& slice) {
        py::ssize_t start = 0, stop = 0, step = 0, length = 0;
        if (!slice.compute(py::ssize_t(self.elements->size()), &start, &stop, &step, &length))
          throw py::error_already_set();
        py::tuple all(static_cast<std::size_t>(length));
        for (py::ssize_t i = 0; i < length; ++i) all[std::size_t(i)] = self.at(std::size_t(start + i * step));
        return all;
      });
}

}  // namespace ibr::python
