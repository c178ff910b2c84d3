#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "server/desync/report.hpp"
#include "server/log/disk.hpp"

namespace cycloid::server {

struct ReportSinkOptions {
  std::string folder;  ///< Is made where it is not there.
  std::uint32_t reports_per_hour = 20;
  std::uint32_t reports_max = 200;       ///< In the folder; what others put there counts too.
  std::function<std::int64_t()> now_ns;  ///< Never goes back.
  std::shared_ptr<Disk> disk = system_disk();
};

/// Writes reports to a folder, so that many desyncs fill no disk: for each a .json for programs, a
/// .txt for people, and a .cylog with which it can be repeated. Any thread may call it.
class ReportSink {
 public:
  explicit ReportSink(ReportSinkOptions options) : options_(std::move(options)) {}

  struct Written {
    std::string report;  ///< Path of the .json; "" where nothing was written, ...
    std::string error;   ///< ... and why.
  };
  /// Looks into the finding and writes what it is. Takes as long as `investigate` and the disk do.
  /// @param report  Also gets the report, whether it could be written or not, unless null.
  Written publish(const Finding& finding, DesyncReport* report = nullptr);

  std::uint64_t dropped() const;  ///< Reports that were over a bound, or that the disk refused.

 private:
  std::string take_name(const Finding& finding, std::string& error);
  bool name_is_free(const std::string& name) const;
  void write(const Finding& finding, const std::string& name, const DesyncReport& report,
             Written& written);

  ReportSinkOptions options_;
  mutable std::mutex mutex_;
  std::int64_t hour_begin_ns_ = 0;
  std::uint32_t hour_reports_ = 0;
  bool hour_began_ = false;
  std::uint64_t dropped_ = 0;
  std::set<std::string> taken_;  ///< Names of reports that are being written.
};

/// The match around a finding as a log of its own: from a state before the tick that differs, with
/// the server's digests. Empty, with a reason in `error`, where it cannot be made.
/// @param before  A state on the way, from which one tick is made again: a client had this state
///                from the server, and its build need not come to it by itself.
protocol::Bytes cut_log(const Finding& finding, const std::optional<KeptState>& before,
                        std::string& error);

}  // namespace cycloid::server
