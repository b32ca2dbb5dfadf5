#include "base/printable.hpp"

#include "goingrate/base/errors.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(PrintableTest, WhatSteersATerminalIsWrittenOut) {
  EXPECT_EQ(printable("a\x1b[31mb"), "a\\x1b[31mb");
  EXPECT_EQ(printable("two\nlines\r\t\x7f"), "two\\x0alines\\x0d\\x09\\x7f");
  EXPECT_EQ(printable(std::string_view("\0", 1)), "\\x00");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\xc2\\x9b31m")
      << "the same in one character";
  EXPECT_EQ(printable("\u202egnp.exe"), "\\xe2\\x80\\xaegnp.exe") << "written from the right";
  EXPECT_EQ(printable("\u2066x\u2029"), "\\xe2\\x81\\xa6x\\xe2\\x80\\xa9");
}

TEST(PrintableTest, WordsOfAllLanguagesStayAsTheyAre) {
  const std::string words = "Grüße, часы, 時計, ε = 2.5e-4, – “x” 😀";
  EXPECT_EQ(printable(words), words);
  EXPECT_EQ(printable("caf\xe9"), "caf\\xe9") << "Latin-1 is no UTF-8";
}

TEST(PrintableTest, MessagesHoldNothingElse) {
  const std::string evil = "a\x1b]0;title\x07";
  EXPECT_EQ(std::string(InputError({evil, 1, 2}, evil, evil).what()).find('\x1b'),
            std::string::npos);
  EXPECT_EQ(std::string(OutputError(evil, evil).what()).find('\x1b'), std::string::npos);
  EXPECT_EQ(std::string(ArgumentError(evil, evil, evil).what()).find('\x1b'), std::string::npos);
  EXPECT_EQ(std::string(ArgumentError(evil, 1.0, evil).what()).find('\x1b'), std::string::npos);
  EXPECT_EQ(InputError({evil}, "x", "y").place().file, evil) << "still the file's name";
}

} // namespace
} // namespace goingrate
