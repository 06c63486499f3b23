# SPDX-License-Identifier: Apache-2.0
# ibr_shaders(target FILES …): compiles GLSL to SPIR-V with glslang at build time and embeds the words into `target`.
#
# A file shaders/render/cell.vert becomes `extern const std::span<const uint32_t> cell_vert` of namespace
# ibr::shaders, declared in the generated header "shaders/cell_vert.h". Editing a shared header rebuilds (depfile).
find_program(IBR_GLSLANG glslangValidator REQUIRED)

function(ibr_shaders target)
  cmake_parse_arguments(arg "" "" "FILES" ${ARGN})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/generated/shaders)
  file(MAKE_DIRECTORY ${out})
  foreach(file IN LISTS arg_FILES)
    get_filename_component(name ${file} NAME)
    string(REPLACE "." "_" name ${name})
    set(IBR_SHADER ${name})
    configure_file(${PROJECT_SOURCE_DIR}/cmake/shader.h.in ${out}/${name}.h @ONLY)
    configure_file(${PROJECT_SOURCE_DIR}/cmake/shader.cpp.in ${out}/${name}.cpp @ONLY)
    add_custom_command(
      OUTPUT ${out}/${name}.inc
      COMMAND ${IBR_GLSLANG} -V --target-env vulkan1.2 --quiet -I${PROJECT_SOURCE_DIR}/shaders
              --depfile ${out}/${name}.d -x -o ${out}/${name}.inc ${PROJECT_SOURCE_DIR}/${file}
      DEPENDS ${PROJECT_SOURCE_DIR}/${file}
      DEPFILE ${out}/${name}.d
      COMMENT "GLSL ${file}"
      VERBATIM)
    set_source_files_properties(${out}/${name}.cpp PROPERTIES OBJECT_DEPENDS ${out}/${name}.inc)
    target_sources(${target} PRIVATE ${out}/${name}.cpp)
  endforeach()
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated)
endfunction()
