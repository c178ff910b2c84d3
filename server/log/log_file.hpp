#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "server/log/disk.hpp"

namespace cycloid::server {

/// One file that is only appended to. It has a temporary name until what it begins with is on the
/// disk, so that a file by its right name always has its header.
///
/// After a call has returned false nothing more is written, and `error` and `code` say why: after a
/// failed sync nobody knows what is on the disk.
class LogFile {
 public:
  /// @param temporary_name  Beside `path`; must be of nobody else.
  LogFile(std::shared_ptr<Disk> disk, std::string path, std::string temporary_name);
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;
  /// Closes it; a file that has only its temporary name is removed.
  ~LogFile();

  bool create();                                  ///< EEXIST where `path` is taken.
  bool append(std::span<const std::byte> bytes);  ///< All of it, in as many writes as it takes.
  bool sync();
  bool publish();  ///< Syncs, gives the file its name, and syncs the folder.

  const std::string& path() const { return path_; }
  const std::string& error() const { return error_; }
  int code() const { return code_; }  ///< An errno value; 0: no failure.

 private:
  bool fail(const char* what, int code);

  std::shared_ptr<Disk> disk_;
  std::string path_;
  std::string temporary_name_;
  int file_ = -1;
  bool published_ = false;
  std::string error_;
  int code_ = 0;
};

}  // namespace cycloid::server
