// SPDX-License-Identifier: Apache-2.0
#include "batch/doctor/findings.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "ibr/device.h"

namespace ibr::app {
namespace {

constexpr std::size_t kMaxPerSubject = 4;

const char* mark(Severity severity) {
  return severity == Severity::serious ? "!!" : severity == Severity::warning ? "! " : "- ";
}

}  // namespace

std::vector<Finding> Findings::sorted() const {
  std::vector<Finding> all = list_;
  std::ranges::stable_sort(all, std::greater<>(), &Finding::severity);
  return all;
}

void Findings::fact(std::string text) {
  facts_.push_back(std::move(text));
}

void Findings::print(const Context& context) const {
  for (const std::string& fact : facts_) context.print("{}\n", fact);
  if (!facts_.empty()) context.print("\n");
  const std::vector<Finding> all = sorted();
  const auto key = [](const Finding& f) { return std::pair(f.severity, f.subject); };
  std::map<std::pair<Severity, std::string>, std::size_t> total, told;
  for (const Finding& finding : all) ++total[key(finding)];
  for (const Finding& finding : all) {
    const std::size_t number = ++told[key(finding)];
    if (number <= kMaxPerSubject) context.print("{} {} {}\n", mark(finding.severity), finding.sentence, finding.remedy);
    if (number == kMaxPerSubject + 1)
      context.print("   and {} more of this kind (--json lists all)\n", total[key(finding)] - kMaxPerSubject);
  }
  if (all.empty()) context.print("no problems found\n");
}

nlohmann::ordered_json Findings::json() const {
  nlohmann::ordered_json json{{"facts", facts_}, {"findings", nlohmann::ordered_json::array()}};
  for (const Finding& f : sorted())
    json["findings"].push_back({{"subject", f.subject},
                                {"severity", severityName(f.severity)},
                                {"problem", f.sentence},
                                {"remedy", f.remedy}});
  if (!devices_.empty()) json["devices"] = devices_;
  if (!devices_.empty()) json["disabledFeatures"] = Device::disabledFeatures();
  return json;
}

ExitCode Findings::code() const {
  const std::vector<Finding> all = sorted();
  return !all.empty() && all[0].severity == Severity::serious ? all[0].code : kExitOk;
}

std::string someOf(const std::vector<std::string>& names) {
  constexpr std::size_t kNamed = 3;
  std::string text;
  const std::size_t named = names.size() > kNamed ? kNamed - 1 : names.size();
  for (std::size_t i = 0; i < named; ++i) text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return names.size() > named ? fmt::format("{} and {} more", text, names.size() - named) : text;
}

}  // namespace ibr::app
