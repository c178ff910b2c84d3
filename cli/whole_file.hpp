#pragma once

#include <fstream>
#include <string>
#include <string_view>

namespace cycloid::cli {

/// A file that is there whole or stays as it was: written beside its place, and put there when it
/// is done. What is no regular file, such as /dev/stdout, is written where it is. A Failure with
/// kExitIo names it where it cannot be written.
class WholeFile {
 public:
  explicit WholeFile(std::string file);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  std::ostream& stream() { return stream_; }
  void write(std::string_view bytes);
  void finish();

 private:
  void open_beside();
  void check() const;

  std::string file_;
  std::string target_;  ///< Behind links.
  std::string beside_;  ///< "" where there is none, or it has been put in place.
  std::ofstream stream_;
};

void write_file(const std::string& file, std::string_view bytes);

/// A Failure where a file cannot be written, before there is anything to write.
void check_output(const std::string& file);

/// "FILE: cannot be written: why", as the system says it.
std::string unwritable_text(const std::string& file, int error);

}  // namespace cycloid::cli
