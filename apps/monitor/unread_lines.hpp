// Lines of a source whose layout is not recognised yet, kept so that no end of the program loses
// them.
#pragma once

#include <string>
#include <string_view>

namespace goingrate::apps {

/// The file DIR/.unread: the first lines of a source, as they came, until events have been made of
/// them and are safe (MonitorLinesTest.LinesThatAreNotRecognisedYetOutliveAKill).
class UnreadLines {
public:
  /// Reads what an earlier run left.
  explicit UnreadLines(const std::string& folder);

  /// What the source has said since its beginning, or since what was left: whole lines of it are on
  /// disk when this returns. Throws OutputError.
  void hold(std::string_view text);
  /// Called once they have become events.
  void clear();
  /// Called if no log was found in them: drops them if there are so many that none will be.
  void give_up();
  [[nodiscard]] const std::string& text() const { return text_; }

private:
  std::string path_, text_;
};

} // namespace goingrate::apps
