// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/file.h"
#include "ibr/lab/matchers.h"

namespace fs = std::filesystem;

namespace ibr {
namespace {

using Json = nlohmann::json;

class CaseReader {
 public:
  CaseReader(const fs::path& file, const fs::path& data) : file_(file), data_(data) {}

  std::vector<MatchCase> run() const {
    Json document;
    try {
      document = Json::parse(readTextFile(file_));
    } catch (const Json::exception& e) {
      fail(ErrorCode::invalidInput, "{}: {}", file_.string(), e.what());
    }
    require(document.is_object() && document.contains("cases") && document["cases"].is_array(), "/cases",
            "is not a list");
    std::vector<MatchCase> cases;
    for (std::size_t c = 0; c < document["cases"].size(); ++c)
      cases.push_back(one(document["cases"][c], fmt::format("/cases/{}", c)));
    return cases;
  }

 private:
  void require(bool holds, const std::string& pointer, const char* fault) const {
    check(holds, ErrorCode::invalidInput, "{}: {} {}", file_.string(), pointer, fault);
  }
  fs::path path(const Json& value, const std::string& pointer) const {
    require(value.is_string() && !value.get<std::string>().empty(), pointer, "is not a path");
    return data_ / value.get<std::string>();
  }

  MatchCase one(const Json& json, const std::string& at) const {
    require(json.is_object(), at, "is not an object");
    MatchCase result;
    int truths = 0;
    for (const auto& [key, value] : json.items()) {
      const std::string pointer = at + "/" + key;
      if (key == "name") {
        require(value.is_string(), pointer, "is not text");
        result.name = value.get<std::string>();
      } else if (key == "images") {
        require(value.is_array() && value.size() >= 2 && value.size() <= 4, pointer, "are not 2 to 4 files");
        for (std::size_t i = 0; i < value.size(); ++i)
          result.images.push_back(path(value[i], fmt::format("{}/{}", pointer, i)));
      } else if (key == "model") {
        result.model = path(value, pointer);
      } else if (key == "disparity" || key == "homography" || key == "depth") {
        (key == "disparity" ? result.disparity
         : key == "depth"   ? result.depth
                            : result.homography) = path(value, pointer);
        require(++truths == 1, pointer, "is a second ground truth; a case has at most one");
      } else if (key == "depthUnit") {
        require(value.is_number() && value.get<double>() > 0, pointer, "is not a positive number");
        result.depthUnit = value.get<double>();
      } else if (key == "maxSize") {
        require(value.is_number_unsigned() && value.get<std::uint64_t>() <= 65536, pointer,
                "is not an integer from 0 to 65536");
        result.maxSize = value.get<int>();
      } else {
        require(false, pointer, "is an unknown key");
      }
    }
    require(!result.name.empty(), at + "/name", "is missing");
    require(!result.images.empty(), at + "/images", "is missing");
    require((result.disparity.empty() && result.homography.empty()) || result.images.size() == 2, at + "/images",
            "are not 2 files, which a disparity or a homography needs");
    require(result.depth.empty() || !result.model.empty(), at + "/model", "is missing, but exact depth needs poses");
    return result;
  }

  const fs::path &file_, &data_;
};

}  // namespace

std::vector<MatchCase> readMatchCases(const fs::path& file, const fs::path& data) {
  return CaseReader(file, data).run();
}

}  // namespace ibr
