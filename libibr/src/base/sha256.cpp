// SPDX-License-Identifier: Apache-2.0
#include "base/sha256.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace ibr {
namespace {

constexpr std::size_t kBlock = 64;  // bytes

constexpr bool isPrime(std::uint32_t n) {
  for (std::uint32_t d = 2; d * d <= n; ++d)
    if (n % d == 0) return false;
  return true;
}

// The largest x with x^power <= n·2^(32·power): the root of n with 32 binary places, §4.2.2 and §5.3.3.
constexpr std::uint32_t rootPlaces(std::uint32_t n, int power) {
  __extension__ using Wide = unsigned __int128;
  std::uint64_t root = 0;
  for (std::uint64_t bit = std::uint64_t(1) << 35; bit > 0; bit >>= 1) {
    const Wide x = root | bit;
    const Wide product = power == 2 ? x * x : x * x * x;
    if (product <= (Wide(n) << (32 * power))) root |= bit;
  }
  return std::uint32_t(root);
}

template <std::size_t N>
constexpr std::array<std::uint32_t, N> rootsOfPrimes(int power) {
  std::array<std::uint32_t, N> roots{};
  std::uint32_t prime = 2;
  for (std::uint32_t& root : roots) {
    while (!isPrime(prime)) ++prime;
    root = rootPlaces(prime++, power);
  }
  return roots;
}
constexpr auto kConstants = rootsOfPrimes<64>(3);
constexpr auto kStart = rootsOfPrimes<8>(2);

void digest(std::array<std::uint32_t, 8>& state, const std::byte* block) {
  std::array<std::uint32_t, 64> w{};
  for (std::size_t t = 0; t < 16; ++t)
    for (std::size_t b = 0; b < 4; ++b) w[t] = w[t] << 8 | std::uint32_t(block[4 * t + b]);
  for (std::size_t t = 16; t < 64; ++t) {
    const std::uint32_t a = w[t - 15], b = w[t - 2];
    w[t] = w[t - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ a >> 3) + w[t - 7] +
           (std::rotr(b, 17) ^ std::rotr(b, 19) ^ b >> 10);
  }
  auto [a, b, c, d, e, f, g, h] = state;
  for (std::size_t t = 0; t < 64; ++t) {
    const std::uint32_t t1 =
        h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) + ((e & f) ^ (~e & g)) + kConstants[t] + w[t];
    const std::uint32_t t2 = (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
    h = g, g = f, f = e, e = d + t1, d = c, c = b, b = a, a = t1 + t2;
  }
  const std::array<std::uint32_t, 8> more{a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < 8; ++i) state[i] += more[i];
}

}  // namespace

std::string sha256(std::span<const std::byte> bytes) {
  std::array<std::uint32_t, 8> state = kStart;
  const std::size_t whole = bytes.size() / kBlock * kBlock;
  for (std::size_t at = 0; at < whole; at += kBlock) digest(state, bytes.data() + at);
  // What is left, a bit, zeros, and the length in bits.
  std::vector<std::byte> rest(bytes.begin() + std::ptrdiff_t(whole), bytes.end());
  rest.push_back(std::byte(0x80));
  rest.resize(rest.size() <= kBlock - 8 ? kBlock : 2 * kBlock);
  for (std::size_t b = 0; b < 8; ++b) rest[rest.size() - 1 - b] = std::byte(std::uint64_t(bytes.size()) * 8 >> 8 * b);
  for (std::size_t at = 0; at < rest.size(); at += kBlock) digest(state, rest.data() + at);
  std::string text;
  for (const std::uint32_t word : state) text += fmt::format("{:08x}", word);
  return text;
}

}  // namespace ibr
