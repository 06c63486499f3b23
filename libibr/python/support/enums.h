// SPDX-License-Identifier: Apache-2.0
// C++ enumerations as classes of Python's enum.Enum. A module defines its own; the other module finds them by import.
#pragma once

#include <pybind11/pybind11.h>

#include <type_traits>

namespace ibr::python {

struct EnumMember {
  const char* name;
  int value;
};

/// Specialised for each enumeration that Python sees: `module` and `label` name the Python class; `members`.
template <class E>
struct EnumTraits;

template <class E>
concept PythonEnum = std::is_enum_v<E> && requires {
  EnumTraits<E>::members;
};

/// The Python class; never released. A module must not import itself while it initialises, hence the slot.
template <PythonEnum E>
pybind11::handle& enumSlot() {
  static pybind11::handle slot;
  return slot;
}

template <PythonEnum E>
pybind11::handle enumType() {
  pybind11::handle& slot = enumSlot<E>();
  if (!slot) {
    pybind11::object type = pybind11::module_::import(EnumTraits<E>::module).attr(EnumTraits<E>::label.text);
    slot = type.release();
  }
  return slot;
}

/// Adds the class to the module that EnumTraits<E>::module names.
template <PythonEnum E>
void defineEnum(pybind11::module_& module, const char* doc) {
  pybind11::list members;
  for (const EnumMember& member : EnumTraits<E>::members)
    members.append(pybind11::make_tuple(member.name, member.value));
  const char* name = EnumTraits<E>::label.text;
  pybind11::object type =
      pybind11::module_::import("enum").attr("Enum")(name, members, pybind11::arg("module") = EnumTraits<E>::module);
  type.attr("__doc__") = doc;
  module.attr(name) = type;
  enumSlot<E>() = type.release();
}

}  // namespace ibr::python

namespace pybind11::detail {

template <class E>
struct type_caster<E, std::enable_if_t<ibr::python::PythonEnum<E>>> {
  PYBIND11_TYPE_CASTER(E, ibr::python::EnumTraits<E>::label);

  bool load(handle source, bool) {
    if (!isinstance(source, ibr::python::enumType<E>())) return false;
    value = E(source.attr("value").cast<int>());
    return true;
  }
  static handle cast(E source, return_value_policy, handle) {
    return ibr::python::enumType<E>()(int(source)).release();
  }
};

}  // namespace pybind11::detail
