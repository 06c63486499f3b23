# SPDX-License-Identifier: Apache-2.0
# The libraries for users, from the objects of the rooms, and their installation.
#
#   ibr_shared         libibr.so         the runtime; exports the public headers' symbols only
#   ibr_static         libibr.a          the runtime
#   ibr_author_static  libibr-author.a   the author, reference and io; links libibr.a, whose internal symbols it uses
#
# ibr::runtime is ibr_shared if BUILD_SHARED_LIBS is on, else ibr_static; ibr::author is ibr_author_static.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

# Libraries that the runtime links. A room's target lists them, too.
set(ibr_runtime_links fmt::fmt Threads::Threads ${CMAKE_DL_LIBS})
set(ibr_author_links opencv_calib3d opencv_core opencv_features2d opencv_imgproc opencv_video Ceres::ceres gmp mpfr
    JPEG::JPEG OpenEXR::OpenEXR PNG::PNG TIFF::TIFF ZLIB::ZLIB lcms2 pugixml::pugixml)

# _ibr_rooms(variable target …): the static libraries of rooms that the targets link, directly or not.
function(_ibr_rooms variable)
  set(found)
  set(open ${ARGN})
  while(open)
    list(POP_FRONT open target)
    if(target IN_LIST seen OR NOT TARGET ${target} OR NOT target MATCHES "^ibr_")
      continue()
    endif()
    list(APPEND seen ${target})
    get_target_property(type ${target} TYPE)
    if(type STREQUAL "STATIC_LIBRARY")
      list(APPEND found ${target})
    endif()
    get_target_property(links ${target} INTERFACE_LINK_LIBRARIES)
    if(links)
      list(TRANSFORM links REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1")
      list(APPEND open ${links})
    endif()
  endwhile()
  list(SORT found)
  set(${variable} ${found} PARENT_SCOPE)
endfunction()

# _ibr_library(target type output ROOMS … LINKS …): a library of the rooms' objects.
function(_ibr_library target type output)
  cmake_parse_arguments(arg "" "" "ROOMS;LINKS" ${ARGN})
  list(TRANSFORM arg_ROOMS REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>")
  add_library(${target} ${type} ${arg_ROOMS})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/libibr/include>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC glm::glm Vulkan::Headers PRIVATE ${arg_LINKS})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${output} LINKER_LANGUAGE CXX)
  if(IBR_SANITIZE)
    target_link_options(${target} PUBLIC -fsanitize=${IBR_SANITIZE})
  endif()
  if(NOT PROJECT_IS_TOP_LEVEL AND NOT IBR_INSTALL)
    set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
endfunction()

_ibr_rooms(runtime ibr_runtime)
_ibr_library(ibr_static STATIC ibr ROOMS ${runtime} LINKS ${ibr_runtime_links})
_ibr_library(ibr_shared SHARED ibr ROOMS ${runtime} LINKS ${ibr_runtime_links})
set_target_properties(ibr_shared PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
# Templates of the standard library have default visibility; the script hides their instances, too.
target_link_options(ibr_shared PRIVATE -Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/libibr.map -Wl,--no-undefined)
set_target_properties(ibr_shared PROPERTIES LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/libibr.map)
# A program with both libraries would have two copies of each object's state. CMake refuses it.
foreach(linkage shared static)
  set_target_properties(ibr_${linkage} PROPERTIES INTERFACE_IBR_LINKAGE ${linkage} COMPATIBLE_INTERFACE_STRING IBR_LINKAGE)
endforeach()
if(BUILD_SHARED_LIBS)
  add_library(ibr::runtime ALIAS ibr_shared)
else()
  add_library(ibr::runtime ALIAS ibr_static)
endif()

if(IBR_BUILD_AUTHOR)
  foreach(package Ceres JPEG OpenCV OpenEXR PNG TIFF ZLIB pugixml)
    find_package(${package} REQUIRED)
  endforeach()
  _ibr_rooms(author ibr_author)
  list(REMOVE_ITEM author ${runtime})
  _ibr_library(ibr_author_static STATIC ibr-author ROOMS ${author} LINKS ${ibr_author_links})
  target_link_libraries(ibr_author_static PUBLIC ibr_static)
  add_library(ibr::author ALIAS ibr_author_static)
endif()

if(NOT IBR_INSTALL)
  return()
endif()

# Components: runtime (libibr.so), devel, author (its header files and archive), tools (programs).
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/ibr)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/libibr/include/ibr DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT devel
        PATTERN author EXCLUDE PATTERN lab EXCLUDE)
set_target_properties(ibr_shared PROPERTIES EXPORT_NAME runtime_shared)
install(TARGETS ibr_shared EXPORT ibr-shared
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT devel)
set_target_properties(ibr_static PROPERTIES EXPORT_NAME runtime_static)
install(TARGETS ibr_static EXPORT ibr-static ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT devel)
install(EXPORT ibr-shared NAMESPACE ibr:: DESTINATION ${package} COMPONENT devel)
install(EXPORT ibr-static NAMESPACE ibr:: DESTINATION ${package} COMPONENT devel)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/ibr-config.cmake.in ibr-config.cmake
                              INSTALL_DESTINATION ${package})
write_basic_package_version_file(ibr-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/ibr-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/ibr-config-version.cmake
        DESTINATION ${package} COMPONENT devel)
file(RELATIVE_PATH ibr_prefix_of_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(${PROJECT_SOURCE_DIR}/cmake/ibr.pc.in ibr.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/ibr.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT devel)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/libibr/schemas DESTINATION ${CMAKE_INSTALL_DATADIR}/ibr COMPONENT devel)
# For ShaderReloader, which compiles edited copies.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders DESTINATION ${CMAKE_INSTALL_DATADIR}/ibr COMPONENT devel)

if(IBR_BUILD_AUTHOR)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/libibr/include/ibr/author DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/ibr
          COMPONENT author)
  set_target_properties(ibr_author_static PROPERTIES EXPORT_NAME author)
  install(TARGETS ibr_author_static EXPORT ibr-author ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT author)
  install(EXPORT ibr-author NAMESPACE ibr:: DESTINATION ${package} COMPONENT author)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/ibr-author.pc.in ibr-author.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/ibr-author.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT author)
endif()
