// Logs inside a ZIP, as exported by telephones, and ZIPs that are not what they claim to be.
#include "log/zip.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/log/reading.hpp"
#include "support/scratch_folder.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <utility>
#include <vector>
#include <zip.h>

namespace goingrate {
namespace {

using Files = std::vector<std::pair<std::string, std::string>>; // name and content

class ZipTest : public test::ScratchFolderTest {
protected:
  // A ZIP in the test's folder; returns its path.
  [[nodiscard]] std::string zip(const Files& files, bool encrypted = false) const {
    const std::string path = this->path("export.zip");
    zip_t* archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
    for (const auto& [name, content] : files) {
      zip_source_t* source = zip_source_buffer(archive, content.data(), content.size(), 0);
      const zip_int64_t at = zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8);
      EXPECT_GE(at, 0) << name;
      if (encrypted)
        zip_file_set_encryption(archive, static_cast<zip_uint64_t>(at), ZIP_EM_AES_256, "secret");
    }
    EXPECT_EQ(zip_close(archive), 0);
    return path;
  }
  [[nodiscard]] std::string refusal(const ReadingOptions& options = {}) const {
    try {
      (void)read_log_files({path("export.zip")}, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "read";
  }
  static std::string swings(int count) {
    std::string text = "\"Time (s)\",\"Angle (rad)\"\n";
    for (int i = 0; i < count; ++i)
      text += fmt::format("{:.3f},{:.6f}\n", 0.1 * i, 0.1 * std::cos(0.31 * i));
    return text;
  }
  static std::string beats(double first, int count) {
    std::string text;
    for (int i = 0; i < count; ++i)
      text += fmt::format("{:.6f}\n", first + 2.0 * i);
    return text;
  }
};

TEST_F(ZipTest, ATelephonesExportIsItsData) {
  const std::string text = swings(400);
  const std::string path =
      zip({{"Raw Data.csv", text},
           {"meta/device.csv", "\"property\",\"value\"\n\"version\",\"1.1\"\n"},
           {"meta/time.csv", "\"event\",\"experiment time\"\n\"START\",0.0\n"}});
  const ClockLog log = read_log_files({path}), same = read_log(text, "text");
  ASSERT_EQ(log.events.size(), same.events.size());
  for (std::size_t i = 0; i < log.events.size(); ++i)
    EXPECT_EQ(log.events[i].time, same.events[i].time);
  EXPECT_EQ(log.source, path);
  EXPECT_EQ(log.place(3).file, path + "/Raw Data.csv");
  EXPECT_EQ(read_log_file(path + "/Raw Data.csv").events.size(), same.events.size());
}

TEST_F(ZipTest, ItsFilesAreOneLog) {
  const std::string path = zip({{"days/b.txt", beats(1.5e9, 100)},
                                {"days/a.txt", beats(1.5e9 + 1000.0, 100)},
                                {"days/.hidden", "x"}});
  const ClockLog log = read_log_files({path});
  EXPECT_EQ(log.events.size(), 200u);
  ASSERT_EQ(log.files.size(), 2u);
  EXPECT_EQ(log.files.front().name, path + "/days/b.txt");
}

TEST_F(ZipTest, WhatUnpacksToTooMuchIsRefused) {
  ReadingOptions options;
  options.unpacked_limit = 1 << 20;
  (void)zip({{"a.txt", std::string(2 << 20, '0')}}); // 2 kB packed
  EXPECT_NE(refusal(options).find("unpacks to more than 1048576 bytes"), std::string::npos)
      << refusal(options);
  (void)zip({{"a.txt", std::string(600 << 10, '0')}, {"b.txt", std::string(600 << 10, '0')}});
  EXPECT_NE(refusal(options).find("unpacks to more than"), std::string::npos) << refusal(options);
}

TEST_F(ZipTest, MoreBytesThanItSaysAreRefused) {
  const std::string text = beats(1.5e9, 1000), path = zip({{"a.txt", text}});
  std::string bytes = content("export.zip");
  for (const auto& [sign, offset] : {std::pair{"PK\x01\x02", 24}, {"PK\x03\x04", 22}}) {
    const std::size_t at = bytes.find(sign);
    ASSERT_NE(at, std::string::npos);
    bytes[at + static_cast<std::size_t>(offset) + 1] = 1; // some hundred bytes
    bytes[at + static_cast<std::size_t>(offset)] = 0;
  }
  put("export.zip", bytes);
  EXPECT_NE(refusal(), "read");
}

TEST_F(ZipTest, NamesThatLeadOutAreRefused) {
  for (const char* name : {"../a.txt", "/etc/a.txt", "b/../../a.txt", "b\\a.txt"}) {
    (void)zip({{name, beats(1.5e9, 100)}});
    EXPECT_NE(refusal().find("names that stay inside the ZIP"), std::string::npos) << name;
  }
}

TEST_F(ZipTest, DamageIsToldAsSuch) {
  (void)zip({{"a.txt", beats(1.5e9, 1000)}});
  const std::string whole = content("export.zip");
  for (std::size_t kept = 4; kept < whole.size(); kept += whole.size() / 29 + 1) {
    put("export.zip", whole.substr(0, kept));
    EXPECT_NE(refusal().find("a ZIP that cannot be read"), std::string::npos) << kept;
  }
  int refused = 0;
  for (std::size_t at = 40; at < 1000 && at < whole.size(); at += 97) { // inside the packed text
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x55);
    put("export.zip", bytes);
    refused += refusal() != "read" ? 1 : 0;
  }
  EXPECT_GT(refused, 0); // all that the checksum sees
  (void)zip({{"a.txt", beats(1.5e9, 100)}}, true);
  EXPECT_NE(refusal().find("an entry that cannot be read"), std::string::npos) << refusal();
}

TEST_F(ZipTest, AFileThatIsNotInItIsToldByName) {
  const std::string path = zip({{"a.txt", beats(1.5e9, 100)}});
  try {
    (void)read_log_file(path + "/b.txt");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no file of that name in it, expected b.txt"),
              std::string::npos)
        << error.what();
  }
}

} // namespace
} // namespace goingrate
