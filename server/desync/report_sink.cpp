#include "server/desync/report_sink.hpp"

#include <algorithm>
#include <filesystem>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "server/log/new_file.hpp"

namespace cycloid::server {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kReportHourNs = 3'600'000'000'000;

constexpr const char* kJsonEnding = ".json";
constexpr const char* kTextEnding = ".txt";
constexpr const char* kLogEnding = ".cylog";
constexpr const char* kEndings[] = {kJsonEnding, kTextEnding, kLogEnding};

/// A room's name comes from outside: only what is harmless in a file name is left of it.
std::string file_word(const std::string& name) {
  std::string word = name.substr(0, 32);
  for (char& c : word) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!plain && c != '-') c = '_';
  }
  return word.empty() ? "room" : word;
}

}  // namespace

std::uint64_t ReportSink::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

/// A name that no report in the folder has, without its ending; "" with a reason.
std::string ReportSink::take_name(const Finding& finding, std::string& error) {
  const std::lock_guard lock(mutex_);
  const std::int64_t now = options_.now_ns();
  if (!hour_began_ || now - hour_begin_ns_ >= kReportHourNs) {
    hour_began_ = true;
    hour_begin_ns_ = now;
    hour_reports_ = 0;
  }
  if (hour_reports_ >= options_.reports_per_hour) {
    error = std::to_string(hour_reports_) + " reports in this hour, of at most " +
            std::to_string(options_.reports_per_hour);
    ++dropped_;
    return "";
  }
  std::error_code failed;
  fs::create_directories(options_.folder, failed);
  std::uint32_t there = 0;
  for (fs::directory_iterator at(options_.folder, failed), end; !failed && at != end;
       at.increment(failed))
    there += at->path().extension() == ".json" ? 1 : 0;
  if (failed || there >= options_.reports_max) {
    error = failed ? options_.folder + ": " + failed.message()
                   : options_.folder + ": " + std::to_string(there) + " reports, of at most " +
                         std::to_string(options_.reports_max);
    ++dropped_;
    return "";
  }
  ++hour_reports_;
  const std::string base = "desync-" + file_word(finding.room->room) + "-tick-" +
                           std::to_string(finding.tick) + "-peer-" +
                           std::to_string(finding.client.peer);
  std::string name = base;
  for (int i = 2; !name_is_free(name); ++i) name = base + "-" + std::to_string(i);
  taken_.insert(name);
  return name;
}

bool ReportSink::name_is_free(const std::string& name) const {
  if (taken_.contains(name)) return false;
  return std::ranges::none_of(kEndings, [&](const char* ending) {
    return options_.disk->exists((fs::path(options_.folder) / (name + ending)).string());
  });
}

ReportSink::Written ReportSink::publish(const Finding& finding, DesyncReport* report) {
  DesyncReport found = investigate(finding);
  Written written;
  const std::string name = take_name(finding, written.error);
  if (!name.empty()) {
    write(finding, name, found, written);
    const std::lock_guard lock(mutex_);
    taken_.erase(name);
    dropped_ += written.report.empty() ? 1 : 0;
  }
  if (report != nullptr) *report = std::move(found);
  return written;
}

/// All of a report's files, or none but where the log alone does not fit: then the report says so.
void ReportSink::write(const Finding& finding, const std::string& name, const DesyncReport& report,
                       Written& written) {
  std::vector<std::string> made;
  const auto put = [&](const char* ending, std::span<const std::byte> bytes) {
    const std::string path = (fs::path(options_.folder) / (name + ending)).string();
    const int error = write_new_file(*options_.disk, path, bytes);
    if (error == 0) made.push_back(path);
    return error == 0 ? "" : path + ": " + std::generic_category().message(error);
  };
  ReportFiles files{name + kJsonEnding, "", ""};
  const protocol::Bytes log = cut_log(finding, report.before, files.log_reason);
  if (!log.empty()) {
    files.log_reason = put(kLogEnding, log);
    if (files.log_reason.empty()) files.log = name + kLogEnding;
  }
  const std::string json = report_json_text(report, files);
  std::string ignored;
  const std::string text = report_as_text(json, ignored).value_or("");
  written.error = put(kJsonEnding, std::as_bytes(std::span(json)));
  if (written.error.empty()) written.error = put(kTextEnding, std::as_bytes(std::span(text)));
  if (written.error.empty()) {
    written.report = (fs::path(options_.folder) / files.report).string();
    return;
  }
  for (const std::string& path : made) (void)options_.disk->remove(path);
}

}  // namespace cycloid::server
