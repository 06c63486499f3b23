# SPDX-License-Identifier: Apache-2.0
# ibr_shaders(target FILES …): compiles GLSL to SPIR-V with glslang at build time and embeds the words into `target`.
#
# A file shaders/render/cell.vert becomes `extern const std::span<const uint32_t> cell_vert` of namespace
# ibr::shaders, declared in the generated header "shaders/cell_vert.h". Editing a shared header rebuilds (depfile).
find_program(IBR_GLSLANG glslangValidator REQUIRED)
set(IBR_GLSLANG_FLAGS -V --target-env vulkan1.2 --quiet)

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
      COMMAND ${IBR_GLSLANG} ${IBR_GLSLANG_FLAGS} -I${PROJECT_SOURCE_DIR}/shaders
              --depfile ${out}/${name}.d -x -o ${out}/${name}.inc ${PROJECT_SOURCE_DIR}/${file}
      DEPENDS ${PROJECT_SOURCE_DIR}/${file}
      DEPFILE ${out}/${name}.d
      COMMENT "GLSL ${file}"
      VERBATIM)
    set_source_files_properties(${out}/${name}.cpp PROPERTIES OBJECT_DEPENDS ${out}/${name}.inc)
    target_sources(${target} PRIVATE ${out}/${name}.cpp)
    if(file MATCHES "^shaders/")
      set_property(GLOBAL APPEND PROPERTY IBR_SHADER_FILES ${file})
      set_property(GLOBAL APPEND PROPERTY IBR_SHADER_TARGETS ${target})
    endif()
  endforeach()
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated)
endfunction()

# ibr_shader_registry(target): adds the table of libibr/src/reload/embedded_shaders.h to the sources of `target`, and
# links the targets of the shaders. The table contains all files of shaders/ in earlier calls of ibr_shaders().
function(ibr_shader_registry target)
  get_property(files GLOBAL PROPERTY IBR_SHADER_FILES)
  get_property(targets GLOBAL PROPERTY IBR_SHADER_TARGETS)
  list(REMOVE_DUPLICATES targets)
  foreach(file IN LISTS files)
    get_filename_component(name ${file} NAME)
    string(REPLACE "." "_" name ${name})
    string(REGEX REPLACE "^shaders/" "" file ${file})
    string(APPEND IBR_SHADER_DECLARATIONS "extern const std::span<const std::uint32_t> ${name};\n")
    string(APPEND IBR_SHADER_ENTRIES "    {\"${file}\", &shaders::${name}},\n")
  endforeach()
  list(TRANSFORM IBR_GLSLANG_FLAGS REPLACE "(.+)" "\"\\1\"" OUTPUT_VARIABLE IBR_SHADER_FLAGS)
  list(JOIN IBR_SHADER_FLAGS ", " IBR_SHADER_FLAGS)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/shader_registry.cpp.in ${CMAKE_CURRENT_BINARY_DIR}/shader_registry.cpp @ONLY)
  target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/shader_registry.cpp)
  target_link_libraries(${target} PRIVATE ${targets})
endfunction()
