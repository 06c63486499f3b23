# SPDX-License-Identifier: Apache-2.0
# Documentation from the programs' own tables (libibr/docs/reference/main.py): man pages and shell completion, which are
# installed with the programs; target ibr_docs: all pages and the library's interface as HTML, in docs/html of the build.
# python3 -B leaves no files among the sources.
include(GNUInstallDirs)
find_program(IBR_PYTHON python3 HINTS /usr/bin)
find_program(IBR_DOXYGEN doxygen)
if(NOT TARGET ibr_batch OR NOT IBR_PYTHON OR CMAKE_CROSSCOMPILING)
  return()
endif()
set(reference ${PROJECT_SOURCE_DIR}/libibr/docs/reference)
set(apps ${PROJECT_BINARY_DIR}/apps)
set(manual ${PROJECT_BINARY_DIR}/docs)
file(GLOB sources CONFIGURE_DEPENDS ${reference}/*.py)
set(programs)
foreach(program IN ITEMS ibr_batch ibr_viewer ibr_vr)
  if(TARGET ${program})
    list(APPEND programs ${program})
  endif()
endforeach()
add_custom_command(OUTPUT ${manual}/manual.stamp
                   COMMAND ${IBR_PYTHON} -B ${reference}/main.py ${apps} --man ${manual}/man --completion ${manual}/completion
                   COMMAND ${CMAKE_COMMAND} -E touch ${manual}/manual.stamp
                   DEPENDS ${programs} ${sources} COMMENT "Writing man pages and shell completion" VERBATIM)
add_custom_target(ibr_manual ALL DEPENDS ${manual}/manual.stamp)
install(DIRECTORY ${manual}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools FILES_MATCHING PATTERN *.1)
foreach(name IN ITEMS ibr ibr-viewer ibr-vr)
  install(FILES ${manual}/completion/ibr.bash RENAME ${name} COMPONENT tools
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
endforeach()
install(DIRECTORY ${manual}/completion/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT tools
        FILES_MATCHING PATTERN *.fish)

if(IBR_DOXYGEN)
  add_custom_target(ibr_docs COMMAND ${IBR_PYTHON} -B ${reference}/main.py ${apps} --html ${manual}
                    DEPENDS ${programs} ibr_lab COMMENT "Writing documentation" VERBATIM)
endif()
if(IBR_BUILD_TESTS)
  add_test(NAME ibr_docs_messages COMMAND ${IBR_PYTHON} -B ${reference}/messages_test.py)
  add_test(NAME ibr_docs_filter COMMAND ${IBR_PYTHON} -B ${PROJECT_SOURCE_DIR}/libibr/docs/doxygen/filter_test.py)
  add_test(NAME ibr_docs_reference COMMAND ${IBR_PYTHON} -B ${reference}/reference_test.py ${apps})
  set_tests_properties(ibr_docs_messages ibr_docs_filter ibr_docs_reference PROPERTIES LABELS fast)
  if(IBR_DOXYGEN)
    # Warnings are errors: an undocumented symbol, a broken link, a page without a chapter.
    add_test(NAME ibr_docs COMMAND ${IBR_PYTHON} -B ${reference}/main.py ${apps} --html ${manual})
  endif()
endif()
