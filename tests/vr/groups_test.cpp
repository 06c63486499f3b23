// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/groups.h"

#include <catch2/catch.hpp>
#include <limits>
#include <random>

using namespace ibr::app;

namespace {

using Groups = std::vector<std::vector<std::uint32_t>>;

std::vector<glm::dvec3> row(int count, double step, glm::dvec3 from = glm::dvec3(0)) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < count; ++i) points.push_back(from + glm::dvec3(i * step, 0, 0));
  return points;
}

// `each` points around each of `places`, with a deviation of at most `jitter`.
std::vector<glm::dvec3> crowds(const std::vector<glm::dvec3>& places, int each, double jitter) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> off(-jitter, jitter);
  std::vector<glm::dvec3> points;
  for (const glm::dvec3& place : places)
    for (int i = 0; i < each; ++i) points.push_back(place + glm::dvec3(off(random), off(random), off(random)));
  return points;
}

std::size_t sizeOfEach(const Groups& groups) {
  for (const auto& group : groups)
    if (group.size() != groups.front().size()) return 0;
  return groups.empty() ? 0 : groups.front().size();
}

}  // namespace

TEST_CASE("groups: evenly spaced points form one group each, at any scale and origin") {
  for (const double scale : {1e-9, 1.0, 1e9})
    for (const double far : {0.0, 1e6}) CHECK(groupsOf(row(40, scale, glm::dvec3(far * scale))).size() == 40);
  CHECK(groupsOf({}).empty());
  CHECK(groupsOf(row(1, 1)) == Groups{{0}});
  CHECK(groupsOf(row(2, 1)) == Groups{{0}, {1}});
}

TEST_CASE("groups: parts of a panorama form one group, exactly and up to rounding") {
  for (const double jitter : {0.0, 1e-7}) {
    for (const int places : {2, 3, 10}) {
      const Groups groups = groupsOf(crowds(row(places, 2.5), 8, jitter));
      CHECK(groups.size() == std::size_t(places));
      CHECK(sizeOfEach(groups) == 8);
    }
  }
  CHECK(groupsOf(crowds({{5, 6, 7}}, 8, 0)) == Groups{{0, 1, 2, 3, 4, 5, 6, 7}});
  // Groups are ordered by their first member, and each group ascends.
  const std::vector<glm::dvec3> mixed{{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {5, 0, 0}};
  CHECK(groupsOf(mixed) == Groups{{0, 2}, {1, 3}, {4}});
}

TEST_CASE("groups: exposure brackets form one group despite different estimated poses") {
  const Groups groups = groupsOf(crowds(row(20, 1), 3, 2e-3));
  CHECK(groups.size() == 20);
  CHECK(sizeOfEach(groups) == 3);
  // A few pairs among many single photographs.
  auto some = row(20, 1);
  for (int i = 0; i < 5; ++i) some.push_back(some[std::size_t(4 * i)] + glm::dvec3(0, 0.02, 0));
  CHECK(groupsOf(some).size() == 20);
}

TEST_CASE("groups: rooms that are far apart keep their separate capture sites") {
  auto rooms = row(12, 0.5);
  for (const glm::dvec3& place : row(12, 0.5, {40, 0, 0})) rooms.push_back(place);
  CHECK(groupsOf(rooms).size() == 24);
  for (glm::dvec3& point : rooms) point.x += point.x > 20 ? 200 : 0;
  CHECK(groupsOf(rooms).size() == 24);
  std::vector<glm::dvec3> many;
  for (int room = 0; room < 10; ++room)
    for (const glm::dvec3& place : row(5, 0.5, {room * 32.0, 0, 0})) many.push_back(place);
  CHECK(groupsOf(many).size() == 50);
  // Photographs at many different distances, as people take them.
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(0, 30);
  std::vector<glm::dvec3> scattered;
  for (int i = 0; i < 300; ++i) scattered.push_back({any(random), 0.1 * any(random), any(random)});
  CHECK(groupsOf(scattered).size() > 285);
}

TEST_CASE("groups: points that are not finite form their own groups and change no other") {
  auto points = crowds(row(3, 1), 4, 0);
  points.insert(points.begin() + 5, glm::dvec3(std::numeric_limits<double>::quiet_NaN(), 0, 0));
  points.push_back(glm::dvec3(std::numeric_limits<double>::infinity()));
  const Groups groups = groupsOf(points);
  CHECK(groups.size() == 5);
  CHECK(groups[2] == std::vector<std::uint32_t>{5});
  CHECK(groups[4] == std::vector<std::uint32_t>{13});
}
