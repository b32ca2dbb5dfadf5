// Runs the command as a script does: exit codes, messages, files.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

namespace goingrate::test {

inline const std::filesystem::path source = GOINGRATE_SOURCE_DIR;

inline std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A folder of its own for each test, and the command run in it.
class CommandTest : public testing::Test {
protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / fmt::format("goingrate-command-{}", ::getpid());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  struct Outcome {
    int code;
    std::string out, err;
  };

  // Runs `goingrate ARGUMENTS` in the test's own folder.
  Outcome run(const std::string& arguments, const std::string& before = "") const {
    const std::string line = fmt::format("cd '{}' && {} '{}' {} > out.txt 2> err.txt",
                                         folder_.string(), before, GOINGRATE_COMMAND, arguments);
    const int status = std::system(line.c_str());
    return {WEXITSTATUS(status), content(folder_ / "out.txt"), content(folder_ / "err.txt")};
  }
  void put(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  [[nodiscard]] nlohmann::json json(const std::string& name) const {
    return nlohmann::json::parse(content(folder_ / name));
  }
  [[nodiscard]] static std::string scenario(const std::string& name) {
    return (source / "data/scenarios" / (name + ".toml")).string();
  }

  std::filesystem::path folder_;
};

} // namespace goingrate::test
