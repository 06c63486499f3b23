// SPDX-License-Identifier: Apache-2.0
// A C++ struct as an immutable Python class: fields are properties, `replace` returns a changed copy, and the
// constructor takes fields by position or keyword, as that of a frozen dataclass.
#pragma once

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "support/vectors.h"

namespace ibr::python {

template <class M>
inline constexpr bool kIsVector = false;
template <class X>
inline constexpr bool kIsVector<std::vector<X>> = true;
template <class M>
inline constexpr bool kIsOptional = false;
template <class X>
inline constexpr bool kIsOptional<std::optional<X>> = true;

/// Copies a field's value. An empty path becomes None; a vector becomes a tuple, one of floating-point numbers a
/// read-only array.
template <class M>
pybind11::object toPython(const M& value) {
  if constexpr (std::is_same_v<M, std::filesystem::path>) {
    return value.empty() ? pybind11::object(pybind11::none()) : pybind11::cast(value);
  } else if constexpr (kIsOptional<M>) {
    return value ? toPython(*value) : pybind11::object(pybind11::none());
  } else if constexpr (kIsVector<M>) {
    using Element = typename M::value_type;
    if constexpr (std::is_floating_point_v<Element>) {
      return readOnly(pybind11::array_t<Element>(pybind11::ssize_t(value.size()), value.data()));
    } else {
      pybind11::tuple all(value.size());
      for (std::size_t i = 0; i < value.size(); ++i) all[i] = toPython<Element>(value[i]);
      return all;
    }
  } else {
    return pybind11::cast(value);
  }
}

/// Converts the value of a field. None is an empty path. Throws pybind11::cast_error.
template <class M>
M fromPython(pybind11::handle value) {
  if constexpr (std::is_same_v<M, std::filesystem::path>)
    return value.is_none() ? M() : value.cast<M>();
  else
    return value.cast<M>();
}

template <class T>
struct Field {
  std::string name;
  std::function<void(T&, pybind11::handle)> set;
};

/// Fields in the order of their declaration.
template <class T>
std::vector<Field<T>>& fieldsOf() {
  static std::vector<Field<T>> fields;
  return fields;
}

/// Sets fields from the arguments of a constructor. Throws TypeError that names the class and the field.
template <class T>
void setFields(T& record, const std::string& type, const pybind11::args& args, const pybind11::kwargs& kwargs) {
  const std::vector<Field<T>>& fields = fieldsOf<T>();
  const auto set = [&](const Field<T>& field, pybind11::handle value) {
    try {
      field.set(record, value);
    } catch (const pybind11::cast_error&) {
      throw pybind11::type_error(
          fmt::format("{}.{} cannot be {}", type, field.name, std::string(pybind11::repr(value))));
    }
  };
  if (args.size() > fields.size())
    throw pybind11::type_error(fmt::format("{} has {} fields, but {} were given", type, fields.size(), args.size()));
  for (std::size_t i = 0; i < args.size(); ++i) set(fields[i], args[i]);
  for (const auto& [key, value] : kwargs) {
    const std::string name = pybind11::str(key);
    std::size_t i = 0;
    while (i < fields.size() && fields[i].name != name) ++i;
    if (i == fields.size()) throw pybind11::type_error(fmt::format("{} has no field {}", type, name));
    if (i < args.size()) throw pybind11::type_error(fmt::format("{}.{} is given twice", type, name));
    set(fields[i], value);
  }
}

/// Compares two records field by field, arrays by their values.
template <class T>
bool haveEqualFields(const pybind11::object& a, const pybind11::object& b) {
  for (const Field<T>& field : fieldsOf<T>()) {
    const pybind11::object x = a.attr(field.name.c_str()), y = b.attr(field.name.c_str());
    const bool equal = pybind11::isinstance<pybind11::array>(x)
                           ? pybind11::module_::import("numpy").attr("array_equal")(x, y).template cast<bool>()
                           : x.equal(y);
    if (!equal) return false;
  }
  return true;
}

template <class T>
class Record {
 public:
  Record(pybind11::handle scope, const char* name, const char* doc) : name_(name), class_(scope, name, doc) {
    class_.def("__repr__", [type = name_](const pybind11::object& self) {
      std::string text;
      for (const Field<T>& field : fieldsOf<T>())
        text += fmt::format("{}{}={}", text.empty() ? "" : ", ", field.name,
                            std::string(pybind11::repr(self.attr(field.name.c_str()))));
      return fmt::format("{}({})", type, text);
    });
    class_.def("__eq__", [](const pybind11::object& self, const pybind11::object& other) -> pybind11::object {
      if (!pybind11::isinstance<T>(other)) return pybind11::reinterpret_borrow<pybind11::object>(Py_NotImplemented);
      return pybind11::bool_(haveEqualFields<T>(self, other));
    });
  }

  template <class M>
  Record& field(const char* name, M T::*member, const char* doc) {
    class_.def_property_readonly(
        name, [member](const T& self) { return toPython<M>(self.*member); }, doc);
    fieldsOf<T>().push_back(
        {name, [member](T& record, pybind11::handle value) { record.*member = fromPython<M>(value); }});
    names_.append(name);
    class_.attr("__match_args__") = pybind11::tuple(names_);  // as dataclasses have it
    return *this;
  }

  /// Adds the constructor and `replace`. Call it after all fields.
  Record& constructible() {
    class_.def(pybind11::init([type = name_](const pybind11::args& args, const pybind11::kwargs& kwargs) {
      T record{};
      setFields(record, type, args, kwargs);
      return record;
    }));
    class_.def(
        "replace",
        [type = name_](const T& self, const pybind11::kwargs& changes) {
          T record = self;
          setFields(record, type, pybind11::args(), changes);
          return record;
        },
        "Returns a copy with other values of the fields that are given.");
    return *this;
  }

  pybind11::class_<T>& type() { return class_; }

 private:
  std::string name_;
  pybind11::list names_;  // of the fields
  pybind11::class_<T> class_;
};

}  // namespace ibr::python
