// SPDX-License-Identifier: Apache-2.0
// Symbol visibility for a shared library that is built with -fvisibility=hidden. IBR_API exports a class or function;
// IBR_LOCAL keeps a class nested in an exported one out of the library's interface. Empty on compilers other than GCC
// and Clang.
#pragma once

#if defined(__GNUC__)
#define IBR_API __attribute__((visibility("default")))
#define IBR_LOCAL __attribute__((visibility("hidden")))
#else
#define IBR_API
#define IBR_LOCAL
#endif
