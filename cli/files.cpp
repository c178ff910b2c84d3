#include "cli/files.hpp"

#include <algorithm>
#include <version>
#if defined(__cpp_lib_filesystem)
#include <filesystem>
#else
#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#endif

namespace cycloid::cli {

/// A circle of links leads nowhere.
static constexpr int kLinksMax = 40;

bool is_open_file(const std::string& path) {
  return path.starts_with("/proc/") || path.starts_with("/dev/fd/");
}

/// What nobody can tell may be one: who reads it will say what is wrong.
static bool may_be_file(const std::string& path) {
  const PathKind kind = kind_of(path);
  return kind.is_file || !kind.exists;
}

#if defined(__cpp_lib_filesystem)

PathKind kind_of(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  return {std::filesystem::exists(status), std::filesystem::is_directory(status),
          std::filesystem::is_regular_file(status), std::filesystem::is_character_file(status)};
}

static void find_below(const std::string& folder, const std::string& suffix,
                       std::vector<std::string>& found) {
  using std::filesystem::directory_iterator;
  std::error_code error;
  directory_iterator entry(folder, error);
  for (; !error && entry != directory_iterator(); entry.increment(error)) {
    const std::string path = entry->path().generic_string();
    std::error_code unknown;
    const bool is_folder = std::filesystem::is_directory(entry->symlink_status(unknown));
    if (is_folder) find_below(path, suffix, found);
    if (!is_folder && path.ends_with(suffix) && may_be_file(path)) found.push_back(path);
  }
  if (error) found.push_back(folder);
}

std::error_code replace_file(const std::string& by, const std::string& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (std::filesystem::exists(status))
    std::filesystem::permissions(by, status.permissions(), error);
  std::filesystem::rename(by, file, error);
  return error;
}

std::string behind_links(const std::string& path) {
  std::filesystem::path end = path;
  std::error_code error;
  for (int i = 0; i < kLinksMax && !is_open_file(end.string()); ++i) {
    if (!std::filesystem::is_symlink(end, error)) break;
    end = end.parent_path() / std::filesystem::read_symlink(end, error);
  }
  return end.string();
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  const PathKind kind = kind_of(a);
  if (kind.exists) return kind.is_file && std::filesystem::equivalent(a, b, error);
  const auto whole = [&](const std::string& path) {
    const std::string end = std::filesystem::absolute(behind_links(path), error).string();
    return std::filesystem::weakly_canonical(end, error);
  };
  return !kind_of(b).exists && whole(a) == whole(b);
}

std::string path_from(const std::string& file, const std::string& path) {
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  const std::filesystem::path whole = std::filesystem::absolute(path).lexically_normal();
  const std::string name = whole.lexically_relative(folder.lexically_normal()).generic_string();
  return name.empty() ? whole.generic_string() : name;
}

std::string path_to(const std::string& file, const std::string& name) {
  return (std::filesystem::path(file).parent_path() / name).generic_string();
}

#else  // The C++ library of wasi has no <filesystem>; POSIX is there.

PathKind kind_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return {};
  return {true, S_ISDIR(status.st_mode), S_ISREG(status.st_mode), S_ISCHR(status.st_mode)};
}

static void find_below(const std::string& folder, const std::string& suffix,
                       std::vector<std::string>& found) {
  const std::unique_ptr<DIR, int (*)(DIR*)> entries(opendir(folder.c_str()), closedir);
  if (!entries) return found.push_back(folder);
  while (const dirent* entry = readdir(entries.get())) {
    const std::string name = entry->d_name;
    if (name == "." || name == "..") continue;
    const std::string path = folder + (folder.ends_with('/') ? "" : "/") + name;
    const bool is_folder = entry->d_type == DT_DIR;
    if (is_folder) find_below(path, suffix, found);
    if (!is_folder && name.ends_with(suffix) && may_be_file(path)) found.push_back(path);
  }
}

std::error_code replace_file(const std::string& by, const std::string& file) {
  if (std::rename(by.c_str(), file.c_str()) == 0) return {};
  return {errno, std::generic_category()};
}

std::string behind_links(const std::string& path) {
  std::string end = path;
  for (int i = 0; i < kLinksMax && !is_open_file(end); ++i) {
    char text[4096];
    const ssize_t size = readlink(end.c_str(), text, sizeof text);
    if (size <= 0) break;
    end = path_to(end, {text, static_cast<std::size_t>(size)});
  }
  return end;
}

bool same_file(const std::string& a, const std::string& b) {
  struct stat of_a {};
  struct stat of_b {};
  if (stat(a.c_str(), &of_a) != 0) return behind_links(a) == behind_links(b);
  return S_ISREG(of_a.st_mode) && stat(b.c_str(), &of_b) == 0 && of_a.st_dev == of_b.st_dev &&
         of_a.st_ino == of_b.st_ino;
}

std::string path_from(const std::string&, const std::string& path) {
  return path;
}

std::string path_to(const std::string& file, const std::string& name) {
  return name.starts_with('/') ? name : file.substr(0, file.rfind('/') + 1) + name;
}

#endif

std::vector<std::string> files_below(const std::string& folder, const std::string& suffix) {
  std::vector<std::string> found;
  find_below(folder, suffix, found);
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace cycloid::cli
