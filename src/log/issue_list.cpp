#include "issue_list.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate {

namespace {
void lengthen(LineIssue& issue, std::size_t line) {
  issue.last_line = std::max(issue.last_line, line);
  ++issue.lines;
}
} // namespace

FaultWords words_of(std::string_view fault) {
  constexpr std::string_view before = "found ", between = ", expected ";
  const std::size_t at = fault.find(between);
  if (!fault.starts_with(before) || at == std::string_view::npos) return {fault, {}};
  return {fault.substr(before.size(), at - before.size()), fault.substr(at + between.size())};
}

void IssueList::refuse(std::size_t line, std::size_t column, std::string_view found,
                       std::string_view action) const {
  const FaultWords words = words_of(found);
  throw InputError(log_.place(line, column), words.found,
                   fmt::format("{} (where faults are mended: {})",
                               words.expected.empty() ? "a log without faults" : words.expected,
                               action));
}

void IssueList::add(std::size_t line, std::size_t column, IssueKind kind, std::string found,
                    std::string action) {
  if (strict_) refuse(line, column, found, action);
  auto& issues = log_.issues;
  if (!issues.empty()) {
    LineIssue& last = issues.back();
    const bool same_file = log_.files.empty() || last.last_line > log_.files.back().lines_before;
    if (same_file && !last.scattered && last.kind == kind && last.column == column &&
        last.last_line + 1 == line && last.action == action)
      return lengthen(last, line);
  }
  constexpr std::size_t issues_in_full = 500, lines_an_issue = 25; // 250 bytes for 25 lines
  constexpr std::size_t most_issues = 20'000; // 5 MB: a log may be followed for years
  const bool too_many =
      issues.size() >= std::clamp(line / lines_an_issue, issues_in_full, most_issues);
  if (too_many) {
    constexpr std::ptrdiff_t issues_looked_at = 64; // more than there are kinds
    const auto end =
        issues.rbegin() + std::min(issues_looked_at, static_cast<std::ptrdiff_t>(issues.size()));
    const auto alike = std::find_if(issues.rbegin(), end, [&](const LineIssue& issue) {
      return issue.scattered && issue.kind == kind && issue.action == action;
    });
    if (alike != end) return lengthen(*alike, line);
  }
  issues.push_back({line, column, kind, std::move(found), std::move(action), line, 1, too_many});
}

std::string_view name_of(IssueKind kind) {
  switch (kind) {
  case IssueKind::unreadable:
    return "unreadable";
  case IssueKind::missing:
    return "missing";
  case IssueKind::no_value:
    return "no value";
  case IssueKind::out_of_range:
    return "out of range";
  case IssueKind::binary:
    return "binary";
  case IssueKind::truncated:
    return "truncated";
  case IssueKind::out_of_order:
    return "out of order";
  case IssueKind::label_jitter:
    return "label jitter";
  case IssueKind::gap:
    return "gap";
  case IssueKind::header:
    return "header";
  case IssueKind::repeated:
    return "repeated";
  case IssueKind::incomplete:
    break;
  }
  return "incomplete";
}

} // namespace goingrate
