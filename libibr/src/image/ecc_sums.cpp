// SPDX-License-Identifier: Apache-2.0
#include "image/ecc_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/check.h"

namespace ibr {
namespace {

__extension__ using Int128 = __int128;

// n·Σ(x − x̄)(y − ȳ) and both variances likewise: integers; the floor is added per sample.
struct Moments {
  Int128 covariance, varianceX, varianceY;
};

Moments momentsOf(const EccMoments& s, std::int64_t floor) {
  const Int128 n = s.n, added = floor * n * n;
  return {n * s.xy - Int128(s.x) * s.y + added, n * s.xx - Int128(s.x) * s.x + added,
          n * s.yy - Int128(s.y) * s.y + added};
}

// Tuples whose moments are summed: the given ones, or their merged tuple.
struct Parts {
  EccMoments merged;
  std::span<const EccMoments> list;
  std::int64_t floor = 0;
  bool enough = false;  // at least one tuple has two samples

  Parts(std::span<const EccMoments> sums, EccDefinition definition, std::int64_t varianceFloor)
      : list(sums), floor(varianceFloor) {
    for (const EccMoments& s : sums) {
      enough = enough || s.n > 1;
      merged.merge(s);
    }
    if (definition == EccDefinition::channels) return;
    list = {&merged, 1};
    floor = 0;
  }
  Parts(const Parts&) = delete;  // the list may point to its own member
  Parts& operator=(const Parts&) = delete;
};

// Moments are means over samples and channels, in squared units of the values.
Ecc fromMeans(double covariance, double varianceA, double varianceB, double constant) {
  const double product = varianceA * varianceB;
  if (!(varianceA > constant) || !(varianceB > constant) || !std::isfinite(product)) return {};
  const double value = covariance / std::sqrt(product);
  if (!std::isfinite(value)) return {};
  return {std::clamp(value, -1.0, 1.0), true};
}

// --- Integers of 640 bits in two's complement. A moment has at most 133 bits; comparisons
// multiply four of them. ---

class BigInt {
 public:
  BigInt(Int128 value = 0) {
    limb_.fill(value < 0 ? ~std::uint64_t(0) : 0);
    limb_[0] = std::uint64_t(value);
    limb_[1] = std::uint64_t(value >> 64);
  }
  int sign() const {
    if (limb_.back() >> 63) return -1;
    return std::any_of(limb_.begin(), limb_.end(), [](std::uint64_t l) { return l != 0; }) ? 1 : 0;
  }
  friend BigInt operator+(const BigInt& a, const BigInt& b) {
    BigInt sum;
    Unsigned128 carry = 0;
    for (std::size_t i = 0; i < kLimbs; ++i) {
      carry += Unsigned128(a.limb_[i]) + b.limb_[i];
      sum.limb_[i] = std::uint64_t(carry);
      carry >>= 64;
    }
    return sum;
  }
  friend BigInt operator*(const BigInt& a, const BigInt& b) {
    BigInt product;
    for (std::size_t i = 0; i < kLimbs; ++i) {
      Unsigned128 carry = 0;
      for (std::size_t j = 0; i + j < kLimbs; ++j) {
        carry += Unsigned128(a.limb_[i]) * b.limb_[j] + product.limb_[i + j];
        product.limb_[i + j] = std::uint64_t(carry);
        carry >>= 64;
      }
    }
    return product;
  }

 private:
  __extension__ using Unsigned128 = unsigned __int128;
  static constexpr std::size_t kLimbs = 10;
  std::array<std::uint64_t, kLimbs> limb_;
};

// Moments of all parts, times one common positive factor.
struct BigMoments {
  BigInt covariance, varianceX, varianceY;
};

BigMoments bigMoments(const Parts& parts) {
  std::array<std::int64_t, 3> counts{};
  std::size_t different = 0;
  for (const EccMoments& s : parts.list) {
    if (s.n == 0 || std::find(counts.begin(), counts.begin() + different, s.n) != counts.begin() + different) continue;
    check(different < counts.size(), ErrorCode::invalidInput, "ECC: more than {} different sample counts",
          counts.size());
    counts[different++] = s.n;
  }
  BigMoments sum;
  for (const EccMoments& s : parts.list) {
    BigInt scale(1);  // from M/n to the common denominator, the product of the counts
    for (std::size_t i = 0; i < different; ++i)
      if (counts[i] != s.n) scale = scale * BigInt(counts[i]);
    const Moments m = momentsOf(s, parts.floor);
    sum.covariance = sum.covariance + BigInt(m.covariance) * scale;
    sum.varianceX = sum.varianceX + BigInt(m.varianceX) * scale;
    sum.varianceY = sum.varianceY + BigInt(m.varianceY) * scale;
  }
  return sum;
}

}  // namespace

Ecc ecc(std::span<const EccMoments> sums, EccDefinition definition, std::int64_t varianceFloor) {
  const Parts parts(sums, definition, varianceFloor);
  if (!parts.enough) return {};
  double covariance = 0, varianceX = 0, varianceY = 0;
  for (const EccMoments& s : parts.list) {
    if (s.n == 0) continue;
    const Moments m = momentsOf(s, parts.floor);
    const double scale = 1.0 / double(s.n);
    covariance += double(m.covariance) * scale;
    varianceX += double(m.varianceX) * scale;
    varianceY += double(m.varianceY) * scale;
  }
  return fromMeans(covariance, varianceX, varianceY, 0.0);
}

bool eccGreater(std::span<const EccMoments> a, std::span<const EccMoments> b, EccDefinition definition,
                std::int64_t varianceFloor) {
  const Parts partsA(a, definition, varianceFloor), partsB(b, definition, varianceFloor);
  const BigMoments p = bigMoments(partsA), q = bigMoments(partsB);
  const auto defined = [](const Parts& parts, const BigMoments& m) {
    return parts.enough && m.varianceX.sign() > 0 && m.varianceY.sign() > 0;
  };
  if (!defined(partsA, p)) return false;
  const int sign = p.covariance.sign();
  if (!defined(partsB, q)) return true;
  if (sign != q.covariance.sign()) return sign > q.covariance.sign();
  const BigInt left = p.covariance * p.covariance * q.varianceX * q.varianceY;
  const BigInt right = q.covariance * q.covariance * p.varianceX * p.varianceY;
  return (left + BigInt(-1) * right).sign() * sign > 0;
}

void EccSums::add(glm::dvec3 a, glm::dvec3 b) {
  if (count_++ == 0) originA_ = a, originB_ = b;
  a -= originA_;
  b -= originB_;
  sumA_ += a;
  sumB_ += b;
  sumAA_ += glm::dot(a, a);
  sumBB_ += glm::dot(b, b);
  sumAB_ += glm::dot(a, b);
}

Ecc EccSums::result(double varianceFloor) const {
  if (count_ < 2) return {};
  constexpr double kConstant = 1e-6;
  const double n = double(count_), scale = 1.0 / (3.0 * n);
  return fromMeans((sumAB_ - glm::dot(sumA_, sumB_) / n) * scale + varianceFloor,
                   (sumAA_ - glm::dot(sumA_, sumA_) / n) * scale + varianceFloor,
                   (sumBB_ - glm::dot(sumB_, sumB_) / n) * scale + varianceFloor, kConstant);
}

}  // namespace ibr
