// SPDX-License-Identifier: Apache-2.0
#include "support/errors.h"

#include <cstring>
#include <exception>
#include <filesystem>

#include "ibr/error.h"
#include "support/runtime_enums.h"

namespace py = pybind11;

namespace ibr::python {
namespace {

// The Python class; never released.
py::handle& errorSlot() {
  static py::handle slot;
  return slot;
}

void raise(ErrorCode code, const char* message) {
  py::handle& type = errorSlot();
  if (!type) type = py::object(py::module_::import("ibr._runtime").attr("Error")).release();
  // File names that are not UTF-8 come back as os.fsdecode returns them.
  const auto text = py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(message, py::ssize_t(std::strlen(message)), "surrogateescape"));
  py::object error = type(text);
  error.attr("code") = code;
  PyErr_SetObject(type.ptr(), error.ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Error& error) {
    raise(error.code(), error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    raise(ErrorCode::io, error.what());
  }
}

}  // namespace

void defineError(py::module_& module) {
  py::object type = py::reinterpret_steal<py::object>(
      PyErr_NewExceptionWithDoc("ibr._runtime.Error",
                                "An error of libibr. The attribute `code`, an ErrorCode, tells its kind; the message "
                                "names the file or the field.",
                                PyExc_RuntimeError, nullptr));
  module.attr("Error") = type;
  errorSlot() = type.release();
}

void translateErrors() {
  py::register_local_exception_translator(&translate);
}

}  // namespace ibr::python
