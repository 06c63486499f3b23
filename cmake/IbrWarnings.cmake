# SPDX-License-Identifier: Apache-2.0
# ibr_warnings(target): sets the warnings, sanitizers and floating-point rules for all code of this repository.
function(ibr_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                                           -Wno-missing-field-initializers -ffp-contract=off)
  if(IBR_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(IBR_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${IBR_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${IBR_SANITIZE})
  endif()
endfunction()
