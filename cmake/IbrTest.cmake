# SPDX-License-Identifier: Apache-2.0
# ibr_test(name [GPU] [JSON] [SLOW] SOURCES … LIBRARIES … [LABELS …] [APART part file…]): one Catch2 executable, registered
# with CTest.
# APART: the cases of these files, named without .cpp, are the test name_part, so that they run beside the others.
# Exit code 77 means "skipped" (no device, no datasets). Where IBR_REQUIRE_DEVICE is set (as in CI) a missing
# device is a failure; IBR_DATASETS names the folder of datasets for tests labelled `data`.
# JSON: most sources use the JSON library (see IbrPrecompiled.cmake).
# SLOW: label slow, not fast: `ctest -L fast` takes a minute on two cores.
# GPU: the program makes a device with validation first (tests/support/gpu.h); any message fails the test case.
find_package(Catch2 2.13 REQUIRED)
set(ibr_test_timeout 3600)  # s: ten times the slowest test, for machines busy with other work
# Test cases compile a quarter faster; the library that they call is optimised as always.
set(ibr_test_options $<$<NOT:$<CONFIG:Debug>>:-O1>)

find_package(nlohmann_json REQUIRED)
add_library(ibr_test_json STATIC ${PROJECT_SOURCE_DIR}/tests/support/json.cpp)
target_include_directories(ibr_test_json PUBLIC ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(ibr_test_json PUBLIC Catch2::Catch2 nlohmann_json::nlohmann_json)
# Assertions without a try block each. An exception ends its case as always, but the report names the case's last
# assertion in place of the expression. One executable must not mix both.
target_compile_definitions(ibr_test_json PUBLIC CATCH_CONFIG_FAST_COMPILE)
ibr_warnings(ibr_test_json)

add_library(ibr_test_support STATIC ${PROJECT_SOURCE_DIR}/tests/support/main.cpp)
target_link_libraries(ibr_test_support PUBLIC ibr_test_json ${CMAKE_DL_LIBS})
ibr_warnings(ibr_test_support)

if(TARGET ibr_gpu)
  add_library(ibr_test_gpu_support STATIC ${PROJECT_SOURCE_DIR}/tests/support/gpu.cpp
                                          ${PROJECT_SOURCE_DIR}/tests/support/gpu_main.cpp)
  target_link_libraries(ibr_test_gpu_support PUBLIC ibr_test_json ibr_gpu ${CMAKE_DL_LIBS})
  ibr_warnings(ibr_test_gpu_support)
endif()

function(ibr_test name)
  cmake_parse_arguments(arg "GPU;JSON;SLOW" "" "SOURCES;LIBRARIES;LABELS;ARGUMENTS;APART" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE $<IF:$<BOOL:${arg_GPU}>,ibr_test_gpu_support,ibr_test_support> ${arg_LIBRARIES})
  ibr_warnings(${name})
  target_compile_options(${name} PRIVATE ${ibr_test_options})
  if(arg_JSON)
    ibr_precompiled(${name} TEST JSON)
  else()
    ibr_precompiled(${name} TEST)
  endif()
  set(tests ${name})
  if(arg_APART)
    list(POP_FRONT arg_APART part)
    # Catch2 runs hidden cases, [.], where only exclusions are given.
    list(TRANSFORM arg_APART REPLACE "(.+)" "[#\\1]~[.]" OUTPUT_VARIABLE these)
    list(TRANSFORM arg_APART REPLACE "(.+)" "~[#\\1]" OUTPUT_VARIABLE others)
    list(JOIN these "," these)
    list(JOIN others "" others)
    list(APPEND tests ${name}_${part})
    add_test(NAME ${name}_${part} COMMAND ${name} --filenames-as-tags "${these}")
    list(APPEND arg_ARGUMENTS --filenames-as-tags "${others}~[.]")
  endif()
  add_test(NAME ${name} COMMAND ${name} ${arg_ARGUMENTS})
  if(arg_SLOW)
    list(APPEND arg_LABELS slow)
  else()
    list(APPEND arg_LABELS fast)
  endif()
  set_tests_properties(${tests} PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT ${ibr_test_timeout} LABELS "${arg_LABELS}")
endfunction()

# ibr_test_without(name TESTS filter FEATURES …): those of its test cases again, once for each feature as if the device had
# it not (IBR_DISABLE_FEATURES).
function(ibr_test_without name)
  cmake_parse_arguments(arg "" "TESTS" "FEATURES" ${ARGN})
  foreach(feature IN LISTS arg_FEATURES)
    string(REPLACE "," "_" all ${feature})
    add_test(NAME ${name}_without_${all} COMMAND ${name} ${arg_TESTS})
    set_tests_properties(${name}_without_${all} PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT ${ibr_test_timeout}
                         ENVIRONMENT IBR_DISABLE_FEATURES=${feature})
  endforeach()
endfunction()

# ibr_test_german(name …): the programs again where numbers have a decimal comma and a point between thousands, in C and
# C++ alike (tests/support/locale.h). tests/run.sh makes the locale.
function(ibr_test_german)
  foreach(name IN LISTS ARGN)
    if(TARGET ${name})
      add_test(NAME ${name}_german COMMAND ${name})
      set_tests_properties(${name}_german PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT ${ibr_test_timeout}
                           ENVIRONMENT "IBR_TEST_LOCALE=de_DE.UTF-8;LC_ALL=de_DE.UTF-8")
    endif()
  endforeach()
endfunction()
