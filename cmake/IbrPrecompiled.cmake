# SPDX-License-Identifier: Apache-2.0
# ibr_precompiled(target [TEST]): precompiles the standard headers, fmt and GLM for a target (TEST: and Catch2), which
# shortens a cold build. Targets of a kind share one precompiled header; ibr_app_batch has its own, with JSON. Sources
# include what they need all the same: tests/check_tidy.py parses those of the runtime without it.
option(IBR_PRECOMPILE "Precompile headers" ON)

set(ibr_precompiled_headers
    <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <optional> <span> <string>
    <string_view> <vector> <fmt/format.h> <fmt/ranges.h> <glm/glm.hpp> <glm/gtc/quaternion.hpp>)

# One for each way in which objects are compiled: of libraries, of programs, of tests.
function(_ibr_precompiled_header name)
  cmake_parse_arguments(arg "LIBRARY" "" "HEADERS;LIBRARIES" ${ARGN})
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp CONTENT "int main() {}\n")
  if(arg_LIBRARY)
    add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp)
  else()
    add_executable(${name} ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp)
  endif()
  target_link_libraries(${name} PRIVATE fmt::fmt glm::glm Threads::Threads ${arg_LIBRARIES})
  ibr_warnings(${name})
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)  # for ccache
  target_precompile_headers(${name} PRIVATE ${ibr_precompiled_headers} ${arg_HEADERS})
endfunction()

function(ibr_precompiled target)
  cmake_parse_arguments(arg "TEST" "" "" ${ARGN})
  if(NOT IBR_PRECOMPILE)
    return()
  endif()
  get_target_property(type ${target} TYPE)
  if(arg_TEST)
    set(header ibr_precompiled_test)
  elseif(type STREQUAL "EXECUTABLE")
    set(header ibr_precompiled_program)
  else()
    set(header ibr_precompiled_library)
  endif()
  if(NOT TARGET ${header})
    find_package(fmt REQUIRED)
    find_package(glm REQUIRED)
    find_package(Threads REQUIRED)
    if(arg_TEST)
      _ibr_precompiled_header(${header} HEADERS <catch2/catch.hpp> LIBRARIES Catch2::Catch2)
      target_compile_options(${header} PRIVATE ${ibr_test_options})
    elseif(type STREQUAL "EXECUTABLE")
      _ibr_precompiled_header(${header})
    else()
      _ibr_precompiled_header(${header} LIBRARY)
    endif()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${header})
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endfunction()
