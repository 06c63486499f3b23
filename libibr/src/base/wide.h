// SPDX-License-Identifier: Apache-2.0
// Compiles inner loops twice: for every x86-64 processor, and for processors with AVX2 and FMA, where std::fma is one
// instruction. Both give the same bits, since the compiler neither contracts nor reorders operations.
//
//   [[gnu::always_inline]] inline void sums(const float* a, float* out, int n) { … }
//   runVectorised<sums>(a, out, n);
#pragma once

namespace ibr {

#if defined(__x86_64__) && defined(__GNUC__)

inline bool cpuHasAvx2AndFma() {
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
}
#define IBR_AVX2 __attribute__((target("avx2,fma")))

#else

inline bool cpuHasAvx2AndFma() {
  return false;
}
#define IBR_AVX2

#endif

/// True if runVectorised uses the version for AVX2 and FMA. Only tests set the value, on one thread.
inline bool& usesAvx2() {
  static bool uses = cpuHasAvx2AndFma();
  return uses;
}

template <auto kLoop, class... Arguments>
IBR_AVX2 auto runWithAvx2(Arguments... arguments) {
  return kLoop(arguments...);
}

/// Runs kLoop(arguments…), `arguments` by value. kLoop and the functions that kLoop calls are always inlined: a call
/// would run code for every processor, with the same bits but slower.
template <auto kLoop, class... Arguments>
auto runVectorised(Arguments... arguments) {
  return usesAvx2() ? runWithAvx2<kLoop>(arguments...) : kLoop(arguments...);
}

}  // namespace ibr
