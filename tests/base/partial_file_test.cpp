#include "base/partial_file.hpp"

#include "goingrate/base/errors.hpp"
#include "support/scratch_folder.hpp"

namespace goingrate {
namespace {

class PartialFileTest : public test::ScratchFolderTest {};

TEST_F(PartialFileTest, LinesOutliveTheirWriter) {
  {
    PartialFile file(path("a.part"));
    EXPECT_TRUE(file.lines().empty());
    file.append("one");
    file.append("");
    file.append("three");
  }
  PartialFile file(path("a.part"));
  ASSERT_EQ(file.lines().size(), 3u);
  EXPECT_EQ(file.read(file.lines()[0]), "one");
  EXPECT_EQ(file.read(file.lines()[1]), "");
  EXPECT_EQ(file.read(file.lines()[2]), "three");
  file.discard();
  EXPECT_FALSE(exists("a.part"));
}

TEST_F(PartialFileTest, ALineWithoutEndIsCutOff) {
  put("a.part", "one\ntwo\nthr");
  PartialFile file(path("a.part"));
  ASSERT_EQ(file.lines().size(), 2u);
  file.append("3");
  EXPECT_EQ(content("a.part"), "one\ntwo\n3\n");
}

TEST_F(PartialFileTest, LinesMayBeLongerThanWhatIsReadAtATime) {
  const std::string longer(200000, 'x');
  put("a.part", longer + "\n" + longer + "y\n");
  PartialFile file(path("a.part"));
  ASSERT_EQ(file.lines().size(), 2u);
  EXPECT_EQ(file.read(file.lines()[1]), longer + "y");
}

TEST_F(PartialFileTest, TwoDoNotWriteOne) {
  PartialFile file(path("a.part"));
  EXPECT_THROW(PartialFile(path("a.part")), OutputError);
  EXPECT_THROW(PartialFile(path("no/such/a.part")), OutputError);
}

} // namespace
} // namespace goingrate
