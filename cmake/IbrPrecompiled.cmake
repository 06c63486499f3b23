# SPDX-License-Identifier: Apache-2.0
# ibr_precompiled(target [TEST] [JSON]): precompiles the standard headers, fmt and GLM for a target, which shortens a cold
# build. TEST: also Catch2. JSON: also the JSON library, for targets with mostly sources that use it. Each source
# without JSON takes 0.7 s longer. Targets with the same type and options share one precompiled header. Sources still
# include all headers that they use: tests/check_tidy.py parses the runtime without precompiled headers.
option(IBR_PRECOMPILE "Precompile headers" ON)

set(ibr_precompiled_headers
    <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <optional> <span> <string>
    <string_view> <vector> <fmt/format.h> <fmt/ranges.h> <glm/glm.hpp> <glm/gtc/quaternion.hpp>)

# Adds the target that owns the precompiled header of all targets of a type: an OBJECT library or an executable.
function(_ibr_precompiled_header name type headers libraries)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp CONTENT "int main() {}\n")
  if(type STREQUAL "EXECUTABLE")
    add_executable(${name} ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp)
  else()
    add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp)
  endif()
  find_package(fmt REQUIRED)
  find_package(glm REQUIRED)
  find_package(Threads REQUIRED)
  target_link_libraries(${name} PRIVATE fmt::fmt glm::glm Threads::Threads ${libraries})
  ibr_warnings(${name})
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)  # for ccache
  target_precompile_headers(${name} PRIVATE ${ibr_precompiled_headers} ${headers})
endfunction()

function(ibr_precompiled target)
  cmake_parse_arguments(arg "JSON;TEST" "" "" ${ARGN})
  if(NOT IBR_PRECOMPILE)
    return()
  endif()
  get_target_property(type ${target} TYPE)
  string(TOLOWER ibr_precompiled_${type} header)
  set(headers)
  set(libraries)
  if(arg_TEST)
    string(APPEND header _test)
    list(APPEND headers <catch2/catch.hpp>)
    list(APPEND libraries ibr_test_json)
  endif()
  if(arg_JSON)
    string(APPEND header _json)
    find_package(nlohmann_json REQUIRED)
    list(APPEND headers <nlohmann/json.hpp>)
    list(APPEND libraries nlohmann_json::nlohmann_json)
  endif()
  if(NOT TARGET ${header})
    _ibr_precompiled_header(${header} ${type} "${headers}" "${libraries}")
    if(arg_TEST)
      target_compile_options(${header} PRIVATE ${ibr_test_options})
    endif()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${header})
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endfunction()
