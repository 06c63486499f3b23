// SPDX-License-Identifier: Apache-2.0
#include "render/plan/cover_mask.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace ibr {
namespace {

// Bits from `first` to one before `end`; 0 <= first < 64, end <= 64.
std::uint64_t bits(int first, int end) {
  return first >= end ? 0 : (~std::uint64_t(0) >> (64 - (end - first))) << first;
}

}  // namespace

CoverMask::CoverMask(int width, int height, double marginPx, std::pmr::memory_resource* memory)
    : width_(width),
      height_(height),
      columns_((width + kTile - 1) / kTile),
      rows_((height + kTile - 1) / kTile),
      words_((columns_ + 63) / 64),
      margin_(marginPx),
      covered_(std::size_t(words_) * std::size_t(rows_), memory),
      open_(memory),
      touched_(covered_.size(), memory),
      crossed_(covered_.size(), memory),
      winding_(64 * covered_.size(), memory) {
  for (int row = 0; row < rows_; ++row) covered_[word(row, words_ - 1)] = ~bits(0, columns_ - 64 * (words_ - 1));
  open_.reserve(std::size_t((columns_ + kBlock - 1) / kBlock) * std::size_t((rows_ + kBlock - 1) / kBlock));
  for (int y = 0; y < rows_; y += kBlock)
    for (int x = 0; x < columns_; x += kBlock) open_.emplace_back(x, y);
}

// Marks tiles that come within the margin of the edge, row by row.
void CoverMask::touch(const Edge& edge) {
  const bool down = edge.from.y < edge.to.y;
  const glm::dvec2 a = down ? edge.from : edge.to, b = down ? edge.to : edge.from;
  const double margin = margin_ + edge.marginPx;
  const auto tile = [](double at, int count) { return int(std::clamp(at * (1.0 / kTile), 0.0, double(count - 1))); };
  if (b.y + margin < 0 || a.y - margin > rows_ * kTile) return;
  for (int row = tile(a.y - margin, rows_), bottom = tile(b.y + margin, rows_); row <= bottom; ++row) {
    const double from = row * kTile - margin, to = (row + 1) * kTile + margin;
    double left = std::min(a.x, b.x), right = std::max(a.x, b.x);
    if (a.y < from || b.y > to) {  // the part of the edge between `from` and `to`
      const auto xAt = [&](double y) { return a.x + (b.x - a.x) * std::clamp((y - a.y) / (b.y - a.y), 0.0, 1.0); };
      const double first = xAt(from), last = xAt(to);
      left = std::min(first, last);
      right = std::max(first, last);
    }
    if (right + margin < 0 || left - margin > columns_ * kTile) continue;
    const int first = tile(left - margin, columns_), end = tile(right + margin, columns_) + 1;
    for (int w = first / 64; 64 * w < end; ++w)
      touched_[word(row, w)] |= bits(std::max(first - 64 * w, 0), std::min(end - 64 * w, 64));
  }
}

// Counts a crossing in every row of tile centres that the edge passes: winding changes for all centres to its right.
void CoverMask::cross(const Edge& edge) {
  const double low = std::min(edge.from.y, edge.to.y), high = std::max(edge.from.y, edge.to.y);
  const auto firstCentre = [](double at, int count) {  // at or after the coordinate
    const double centre = std::clamp(at * (1.0 / kTile) - 0.5, 0.0, double(count));
    const int before = int(centre);
    return before + (before < centre);
  };
  for (int row = firstCentre(low, rows_); row < rows_ && (row + 0.5) * kTile < high; ++row) {
    const double share = ((row + 0.5) * kTile - edge.from.y) / (edge.to.y - edge.from.y);
    const int column = firstCentre(edge.from.x + share * (edge.to.x - edge.from.x), columns_);
    if (column >= columns_) continue;
    const std::size_t at = word(row, column / 64);
    winding_[64 * at + std::size_t(column % 64)] += edge.from.y < edge.to.y ? 1 : -1;
    crossed_[at] |= std::uint64_t(1) << (column % 64);
  }
}

void CoverMask::add(std::span<const Edge> outline) {
  std::ranges::fill(touched_, 0);
  std::ranges::fill(crossed_, 0);
  for (const Edge& edge : outline) {
    touch(edge);
    cross(edge);
  }
  for (int row = 0; row < rows_; ++row)
    for (int w = 0, winding = 0; w < words_; ++w) {
      const std::size_t at = word(row, w);
      std::uint64_t inside = 0;
      int from = 0;
      for (std::uint64_t left = crossed_[at]; left != 0; left &= left - 1) {
        const int bit = std::countr_zero(left);
        if (winding != 0) inside |= bits(from, bit);
        from = bit;
        winding += std::exchange(winding_[64 * at + std::size_t(bit)], 0);
      }
      if (winding != 0) inside |= bits(from, 64);
      covered_[at] |= inside & ~touched_[at];
    }
}

std::optional<CoverMask::Rectangle> CoverMask::openIn(int x, int y) const {
  unsigned columns = 0;
  int top = rows_, bottom = -1;
  for (int row = y; row < std::min(y + kBlock, rows_); ++row) {
    const auto open = unsigned(~covered_[word(row, x / 64)] >> (x % 64)) & 0xffu;
    if (open == 0) continue;
    columns |= open;
    top = std::min(top, row);
    bottom = row;
  }
  if (columns == 0) return std::nullopt;
  const int left = x + std::countr_zero(columns), end = x + std::bit_width(columns);
  return Rectangle{left * kTile - margin_, top * kTile - margin_, std::min(end * kTile, width_) + margin_,
                   std::min((bottom + 1) * kTile, height_) + margin_};
}

}  // namespace ibr
