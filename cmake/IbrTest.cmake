# SPDX-License-Identifier: Apache-2.0
# ibr_test(name [GPU] [JSON] [SLOW] SOURCES … LIBRARIES … [LABELS …] [SEPARATE part file…]): adds a Catch2 executable
# and registers it with CTest.
# SEPARATE: the cases of these files, named without .cpp, form the test name_part, which can run in parallel.
# JSON: most sources use the JSON library (see IbrPrecompiled.cmake).
# SLOW: label slow instead of fast: `ctest -L fast` takes a minute on two cores.
# GPU: the program first creates a device with validation (tests/support/gpu.h). A validation message fails the case.
# Exit code 77 means "skipped" (no device, no datasets). With IBR_REQUIRE_DEVICE (as in CI) a missing device is a
# failure. IBR_DATASETS names the folder of datasets for tests with label `data`.
find_package(Catch2 REQUIRED)
if(Catch2_VERSION VERSION_LESS 2.13)
  message(FATAL_ERROR "Catch2 ${Catch2_VERSION} is too old: the tests need 2.13 or newer")
endif()
set(ibr_test_timeout 3600)  # s: about ten times the slowest test on an idle machine, for busy machines
# -O1 compiles test cases a quarter faster. The tested library keeps its optimisation level.
set(ibr_test_options $<$<NOT:$<CONFIG:Debug>>:-O1>)

find_package(nlohmann_json REQUIRED)
add_library(ibr_test_json STATIC ${PROJECT_SOURCE_DIR}/tests/support/json.cpp)
target_include_directories(ibr_test_json PUBLIC ${PROJECT_SOURCE_DIR}/tests)
if(Catch2_VERSION VERSION_GREATER_EQUAL 3)
  target_include_directories(ibr_test_json SYSTEM PUBLIC ${PROJECT_SOURCE_DIR}/tests/catch2_3)
endif()
target_link_libraries(ibr_test_json PUBLIC Catch2::Catch2 nlohmann_json::nlohmann_json)
# Compiles assertions without a try block each. An exception still ends its case, but the report names the case's last
# assertion instead of the expression that threw. All sources of an executable need the same setting.
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
  cmake_parse_arguments(arg "GPU;JSON;SLOW" "" "SOURCES;LIBRARIES;LABELS;ARGUMENTS;SEPARATE" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE $<IF:$<BOOL:${arg_GPU}>,ibr_test_gpu_support,ibr_test_support> ${arg_LIBRARIES})
  ibr_warnings(${name})
  target_compile_options(${name} PRIVATE ${ibr_test_options})
  set(json)
  if(arg_JSON)
    set(json JSON)
  endif()
  ibr_precompiled(${name} TEST ${json})
  set(tests ${name})
  if(arg_SEPARATE)
    list(POP_FRONT arg_SEPARATE part)
    # Filters exclude hidden cases, [.], because Catch2 runs these if a filter has exclusions only.
    list(TRANSFORM arg_SEPARATE REPLACE "(.+)" "[#\\1]~[.]" OUTPUT_VARIABLE separate)
    list(TRANSFORM arg_SEPARATE REPLACE "(.+)" "~[#\\1]" OUTPUT_VARIABLE others)
    list(JOIN separate "," separate)
    list(JOIN others "" others)
    list(APPEND tests ${name}_${part})
    add_test(NAME ${name}_${part} COMMAND ${name} --filenames-as-tags "${separate}")
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

# ibr_test_without(name [TESTS filter] FEATURES …): runs the filtered test cases again, once for each feature, on a
# device without this feature (IBR_DISABLE_FEATURES). A comma joins features that are disabled together.
function(ibr_test_without name)
  cmake_parse_arguments(arg "" "TESTS" "FEATURES" ${ARGN})
  foreach(feature IN LISTS arg_FEATURES)
    string(REPLACE "," "_" suffix ${feature})
    add_test(NAME ${name}_without_${suffix} COMMAND ${name} ${arg_TESTS})
    set_tests_properties(${name}_without_${suffix} PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT ${ibr_test_timeout}
                         ENVIRONMENT IBR_DISABLE_FEATURES=${feature})
  endforeach()
endfunction()

# ibr_test_german(name …): runs the test programs again in a locale with a decimal comma and a point between thousands,
# for C and C++ (tests/support/locale.h). tests/run.sh creates the locale.
function(ibr_test_german)
  foreach(name IN LISTS ARGN)
    if(TARGET ${name})
      add_test(NAME ${name}_german COMMAND ${name})
      set_tests_properties(${name}_german PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT ${ibr_test_timeout}
                           ENVIRONMENT "IBR_TEST_LOCALE=de_DE.UTF-8;LC_ALL=de_DE.UTF-8")
    endif()
  endforeach()
endfunction()
