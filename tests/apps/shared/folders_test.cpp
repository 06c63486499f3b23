// SPDX-License-Identifier: Apache-2.0
// The user's folders, from the environment and from user-dirs.dirs.
#include "shared/cli/folders.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr::app;
using namespace ibr::test;

namespace {

// Sets environment variables for its lifetime; variables without a value are unset.
class Environment {
 public:
  explicit Environment(const std::map<std::string, std::optional<std::string>>& values) {
    for (const auto& [name, value] : values) {
      const char* before = std::getenv(name.c_str());
      before_[name] = before ? std::optional<std::string>(before) : std::nullopt;
      set(name, value);
    }
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() {
    for (const auto& [name, value] : before_) set(name, value);
  }

 private:
  static void set(const std::string& name, const std::optional<std::string>& value) {
    if (value)
      ::setenv(name.c_str(), value->c_str(), 1);
    else
      ::unsetenv(name.c_str());
  }
  std::map<std::string, std::optional<std::string>> before_;
};

}  // namespace

TEST_CASE("settings and cache folders follow the XDG variables, or lie below the home folder") {
  const TemporaryFolder folder;
  const fs::path home = folder / "home", config = folder / "config", cache = folder / "cache";
  {
    const Environment given(
        {{"HOME", home.string()}, {"XDG_CONFIG_HOME", config.string()}, {"XDG_CACHE_HOME", cache.string()}});
    CHECK(settingsFolder() == config / "libibr");
    CHECK(cacheFolder() == cache / "libibr");
    CHECK(fs::is_directory(config / "libibr"));
    CHECK(fs::is_directory(cache / "libibr"));
  }
  {
    const Environment bare({{"HOME", home.string()}, {"XDG_CONFIG_HOME", {}}, {"XDG_CACHE_HOME", ""}});
    CHECK(settingsFolder() == home / ".config/libibr");
    CHECK(cacheFolder() == home / ".cache/libibr");
    CHECK(fs::is_directory(home / ".cache/libibr"));
  }
  const Environment none({{"HOME", {}}, {"XDG_CONFIG_HOME", {}}, {"XDG_CACHE_HOME", "/dev/null"}});
  CHECK(settingsFolder().empty());
  CHECK(cacheFolder().empty());
}

TEST_CASE("screenshots go to the pictures folder of user-dirs.dirs, or to ~/Pictures") {
  const TemporaryFolder folder;
  const fs::path home = folder / "home", config = folder / "config";
  fs::create_directories(home / "Bilder");
  fs::create_directories(config);
  const Environment given({{"HOME", home.string()}, {"XDG_CONFIG_HOME", config.string()}});
  CHECK(picturesFolder() == fs::current_path());
  fs::create_directories(home / "Pictures");
  CHECK(picturesFolder() == home / "Pictures/ibr");
  const auto say = [&](const std::string& value) {
    std::ofstream(config / "user-dirs.dirs") << "# a comment\nXDG_MUSIC_DIR=\"$HOME/Pictures\"\n"
                                             << "XDG_PICTURES_DIR=\"" << value << "\"\n";
  };
  say("$HOME/Bilder");
  CHECK(picturesFolder() == home / "Bilder/ibr");
  say((home / "Bilder").string());
  CHECK(picturesFolder() == home / "Bilder/ibr");
  for (const char* none : {"$HOME/", "$HOME/is not there", "relative"}) {
    say(none);
    CHECK(picturesFolder() == home / "Pictures/ibr");
  }
  CHECK_FALSE(fs::exists(home / "Pictures/ibr"));
}
