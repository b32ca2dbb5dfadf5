#include "log_parts.hpp"

#include "beginning.hpp"
#include "issue_list.hpp"
#include "repairs.hpp"
#include "sound_log.hpp"

#include <algorithm>

namespace goingrate {

namespace {

// A part is read in chunks of text, the last of which may bring more events than are asked for.
constexpr double room_for_last_chunk = 1.1;

} // namespace

LogParts::LogParts(LineReader& lines, const ReadingOptions& options)
    : lines_(lines), options_(options) {
  check(options);
  log_.source = lines.name();
  const std::string_view beginning = lines.head(head_lines);
  const bool sound = is_sound(beginning);
  refuse_another_format(sound, lines.name(), options);
  if (sound) {
    const std::string bytes = lines.all();
    log_ = read_recording(Recording::in_memory(bytes, lines.name()), lines.name(), options);
    return;
  }
  layout_ = settle_layout(beginning, lines.whole_is_in_head(), log_, options);
  rows_.emplace(layout_, options, log_);
}

std::size_t LogParts::lines_expected() const { return lines_.lines_expected(); }

bool LogParts::can_be_divided() const {
  return !log_.grid && layout_.format != LogFormat::angle && !layout_.newest_first &&
         layout_.label_step_s == 0.0 && !layout_.find(ColumnRole::clock_error);
}

bool LogParts::read(std::size_t most) {
  if (!rows_) return true;
  if (!can_be_divided()) most = std::numeric_limits<std::size_t>::max();
  const std::size_t part = static_cast<std::size_t>(
      room_for_last_chunk * static_cast<double>(std::min(most, lines_expected())));
  const std::size_t room = std::min(room_for(lines_.lines_expected()), part);
  if (room > room_) rows_->reserve(room_ = room);
  if (!add_rows(lines_, *rows_, options_.progress, most)) return false;
  complete(log_, *rows_, layout_, options_);
  log_.origin = origin_.value_or(log_.origin);
  return true;
}

void LogParts::put_in_order() {
  if (!origin_) origin_ = log_.origin = origin_of(layout_, log_.events.front().time);
  IssueList issues(log_, options_.strict);
  if (!rows_->in_order()) restore_order(log_, are_dates(layout_, log_.events.front().time), issues);
}

} // namespace goingrate
