// SPDX-License-Identifier: Apache-2.0
#include "support/calls.h"

namespace py = pybind11;

namespace ibr::python {
namespace {

// Text from the library may hold a file name that is not UTF-8.
py::str textOf(std::string_view text) {
  return py::reinterpret_steal<py::str>(PyUnicode_DecodeUTF8(text.data(), py::ssize_t(text.size()), "surrogateescape"));
}

int pythonLevel(LogLevel level) {
  constexpr int kDebug = 10, kInfo = 20, kWarning = 30, kError = 40;  // of the module logging
  switch (level) {
    case LogLevel::debug:
      return kDebug;
    case LogLevel::info:
      return kInfo;
    case LogLevel::warning:
      return kWarning;
    case LogLevel::error:
      break;
  }
  return kError;
}

}  // namespace

LogCallback logToPython() {
  return [](LogLevel level, std::string_view message) {
    const py::gil_scoped_acquire locked;
    try {
      py::module_::import("logging").attr("getLogger")("ibr").attr("log")(pythonLevel(level), "%s", textOf(message));
    } catch (py::error_already_set& error) {
      if (error.matches(PyExc_KeyboardInterrupt))
        PyErr_SetInterrupt();  // the main thread raises it again outside this callback
      else
        error.discard_as_unraisable("the logger ibr");
    }
  };
}

bool goesOn(const py::object& result) {
  return result.is_none() || py::bool_(result);
}

bool LongCall::report(const Progress& now) {
  return ask([&] {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    return progress_.is_none() || goesOn(progress_(textOf(now.stage), now.done, now.total));
  });
}

void LongCall::rethrow() {
  if (exception_) std::rethrow_exception(std::exchange(exception_, nullptr));
}

}  // namespace ibr::python
