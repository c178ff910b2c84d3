#include "cli/whole_file.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "cli/files.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {
namespace {

/// More of them were left behind by programs that were killed than anybody has.
constexpr int kTriesMax = 10'000;

// What creates a file that must be new; not all of Windows' libraries know 'x'.
#if defined(_WIN32)
constexpr const char* kNewFile = "wb";
#else
constexpr const char* kNewFile = "wbx";
#endif

/// Whether another file can be put in its place: an open file, a pipe or a device keeps its own.
bool is_replaceable(const std::string& target) {
  const PathKind kind = kind_of(target);
  return !is_open_file(target) && (kind.is_file || !kind.exists);
}

void close(std::FILE* file) {
  if (file != nullptr) std::fclose(file);
}

}  // namespace

std::string unwritable_text(const std::string& file, int error) {
  const std::string text = file + ": cannot be written";
  return error == 0 ? text : text + ": " + std::generic_category().message(error);
}

WholeFile::WholeFile(std::string file) : file_(std::move(file)), target_(behind_links(file_)) {
  if (kind_of(target_).is_folder) throw Failure(kExitIo, file_ + ": is a directory");
  errno = 0;
  if (is_replaceable(target_)) open_beside();
  stream_.open(beside_.empty() ? target_ : beside_, std::ios::binary | std::ios::trunc);
  check();
}

WholeFile::~WholeFile() {
  stream_.close();
  if (!beside_.empty()) std::remove(beside_.c_str());
}

/// In the folder of the target, under a name that nobody else has. A file that its owner has made
/// read-only is not replaced either.
void WholeFile::open_beside() {
  if (kind_of(target_).exists) {
    std::FILE* there = std::fopen(target_.c_str(), "r+b");
    if (there == nullptr) throw Failure(kExitIo, unwritable_text(file_, errno));
    close(there);
  }
  for (int i = 0; i < kTriesMax; ++i) {
    const std::string name = path_to(target_, ".cycloid-" + std::to_string(i) + ".new");
    if (kind_of(name).exists) continue;
    std::FILE* made = std::fopen(name.c_str(), kNewFile);
    if (made == nullptr && errno == EEXIST) continue;
    if (made == nullptr) break;
    close(made);
    beside_ = name;
    return;
  }
  throw Failure(kExitIo, unwritable_text(file_, errno));
}

void WholeFile::check() const {
  if (!stream_) throw Failure(kExitIo, unwritable_text(file_, errno));
}

void WholeFile::write(std::string_view bytes) {
  errno = 0;
  stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  check();
}

void WholeFile::finish() {
  if (stream_) errno = 0;
  stream_.close();
  check();
  if (beside_.empty()) return;
  if (const std::error_code error = replace_file(beside_, target_))
    throw Failure(kExitIo, file_ + ": cannot be written: " + error.message());
  beside_.clear();
}

void write_file(const std::string& file, std::string_view bytes) {
  WholeFile whole(file);
  whole.write(bytes);
  whole.finish();
}

void check_output(const std::string& file) {
  const std::string target = behind_links(file);
  if (is_replaceable(target) || kind_of(target).is_folder) WholeFile{file};
}

}  // namespace cycloid::cli
