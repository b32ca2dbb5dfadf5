// How the log of a source begins, which tells it only once.
#pragma once

#include <string>

namespace goingrate::apps {

/// DIR/.head: the source and the lines before its first data. A monitor that is started again in
/// the middle of them knows by these what the columns are (MonitorLinesTest.AHeadOutlivesARestart).
class SourceHead {
public:
  /// Reads what an earlier run of the same source left.
  SourceHead(const std::string& folder, std::string source);

  [[nodiscard]] const std::string& text() const { return text_; }
  /// What it is now; nothing where it has none. Where it cannot be written, the one before stays.
  void keep(const std::string& text);

private:
  std::string path_, source_, text_;
};

} // namespace goingrate::apps
