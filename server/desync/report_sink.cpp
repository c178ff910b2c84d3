#include "server/desync/report_sink.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

namespace cycloid::server {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kReportHourNs = 3'600'000'000'000;

/// A room's name comes from outside: only what is harmless in a file name is left of it.
std::string file_word(const std::string& name) {
  std::string word = name.substr(0, 32);
  for (char& c : word) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!plain && c != '-') c = '_';
  }
  return word.empty() ? "room" : word;
}

/// False where the file was there already or the disk does not take it.
bool write_new(const fs::path& path, const char* data, std::size_t size) {
  std::error_code ignored;
  if (fs::exists(path, ignored)) return false;
  std::ofstream stream(path, std::ios::binary);
  stream.write(data, static_cast<std::streamsize>(size));
  stream.close();
  if (stream) return true;
  fs::remove(path, ignored);
  return false;
}
bool write_new(const fs::path& path, const std::string& text) {
  return write_new(path, text.data(), text.size());
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
  for (int i = 2; fs::exists(fs::path(options_.folder) / (name + ".json"), failed); ++i)
    name = base + "-" + std::to_string(i);
  return name;
}

ReportSink::Written ReportSink::publish(const Finding& finding, DesyncReport* report) {
  DesyncReport found = investigate(finding);
  Written written;
  const std::string name = take_name(finding, written.error);
  if (!name.empty()) {
    const fs::path folder(options_.folder);
    ReportFiles files{name + ".json", "", ""};
    const protocol::Bytes log = cut_log(finding, files.log_reason);
    const char* bytes = reinterpret_cast<const char*>(log.data());
    if (!log.empty()) {
      if (write_new(folder / (name + ".cylog"), bytes, log.size()))
        files.log = name + ".cylog";
      else
        files.log_reason = "it could not be written";
    }
    const std::string json = report_json_text(found, files);
    std::string ignored;
    const auto text = report_as_text(json, ignored);
    const bool good = write_new(folder / files.report, json) &&
                      write_new(folder / (name + ".txt"), text.value_or(""));
    if (good) written.report = (folder / files.report).string();
    if (!good) {
      written.error = (folder / files.report).string() + ": cannot be written";
      const std::lock_guard lock(mutex_);
      ++dropped_;
    }
  }
  if (report != nullptr) *report = std::move(found);
  return written;
}

}  // namespace cycloid::server
